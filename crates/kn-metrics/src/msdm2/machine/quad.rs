//! Four numbers with operators.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use super::{Machine, QUAD};

/// A binary64 number for each of four lanes.
#[derive(Clone, Copy)]
pub(in super::super) struct Quad<M: Machine>(M, M::Doubles);

impl<M: Machine> Quad<M> {
    #[inline(always)]
    pub(in super::super) fn new(machine: M, numbers: &[f64; QUAD]) -> Self {
        Self(machine, machine.load_doubles(numbers))
    }

    /// The same number in all lanes.
    #[inline(always)]
    pub(in super::super) fn splat(machine: M, number: f64) -> Self {
        Self(machine, machine.splat_double(number))
    }

    #[inline(always)]
    pub(in super::super) fn array(self) -> [f64; QUAD] {
        self.0.array(self.1)
    }

    #[inline(always)]
    pub(in super::super) fn sqrt(self) -> Self {
        Self(self.0, self.0.sqrt_doubles(self.1))
    }

    /// `then` in lanes where this is less, elsewhere `otherwise`; also where one of those compared
    /// is not a number.
    #[inline(always)]
    pub(in super::super) fn if_less(self, than: Self, then: Self, otherwise: Self) -> Self {
        Self(self.0, self.0.if_less(self.1, than.1, then.1, otherwise.1))
    }

    /// The lesser of two; `other` if one of them is not a number.
    #[inline(always)]
    pub(in super::super) fn least(self, other: Self) -> Self {
        self.if_less(other, self, other)
    }

    #[inline(always)]
    pub(in super::super) fn abs(self) -> Self {
        self.if_less(Self::splat(self.0, 0.0), -self, self)
    }

    /// A bit for each lane that is below a limit or not a number.
    #[inline(always)]
    pub(in super::super) fn not_from(self, limit: f64) -> u8 {
        self.0.not_from(self.1, limit)
    }

    /// Times 2ᵏ, where k stands in the low bits of another number; no overflow is looked for.
    #[inline(always)]
    pub(in super::super) fn times_power(self, k: Self) -> Self {
        Self(self.0, self.0.times_power(self.1, k.1))
    }
}

/// The numbers of four rows, one column after the other.
#[inline(always)]
pub(in super::super) fn columns<M: Machine>(
    machine: M,
    rows: [&[f64; QUAD]; QUAD],
) -> [Quad<M>; QUAD] {
    let [a, b, c, d] = machine.columns(rows);
    [Quad(machine, a), Quad(machine, b), Quad(machine, c), Quad(machine, d)]
}

/// The dot product, summed from the first coordinate to the last.
#[inline(always)]
pub(in super::super) fn dot<M: Machine>(a: [Quad<M>; 3], b: [Quad<M>; 3]) -> Quad<M> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl<M: Machine> Add for Quad<M> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0, self.0.add_doubles(self.1, other.1))
    }
}

impl<M: Machine> AddAssign for Quad<M> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<M: Machine> Sub for Quad<M> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0, self.0.sub_doubles(self.1, other.1))
    }
}

impl<M: Machine> Neg for Quad<M> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::splat(self.0, -0.0) - self
    }
}

impl<M: Machine> Mul for Quad<M> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0, self.0.mul_doubles(self.1, other.1))
    }
}

impl<M: Machine> Mul<f64> for Quad<M> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * Self::splat(self.0, factor)
    }
}

impl<M: Machine> Div for Quad<M> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(self.0, self.0.div_doubles(self.1, other.1))
    }
}
