//! The processor that runs: eight lanes of binary32, four of binary64, and lists of lanes.
//!
//! Kernels are written once, over [`Machine`], and compiled for what every processor of the target
//! has and, on x86-64, for AVX2, BMI and FMA as well (x86-64-v3); which of the two runs is asked of
//! the processor. Nothing is fused or re-ordered, so that both give the same bits.
//!
//! The work of a kernel with a machine must be inlined into it: a closure of its own is compiled
//! for the processor that every target has, and each operation in it becomes a call.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod baseline;
mod quad;

pub(super) use baseline::Baseline;
pub(super) use quad::{Quad, columns, dot};

/// Lanes of binary32.
pub(super) const LANES: usize = 8;

/// Lanes of binary64.
pub(super) const QUAD: usize = 4;

/// Operations on all lanes at once.
pub(super) trait Machine: Copy {
    /// A binary32 number for each of eight lanes.
    type Numbers: Copy;

    /// A binary64 number for each of four lanes: see [`Quad`], which has operators.
    type Doubles: Copy;

    fn load(self, numbers: &[f32; LANES]) -> Self::Numbers;
    fn splat(self, number: f32) -> Self::Numbers;
    fn add(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    fn mul(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;

    /// A bit for each lane above a limit; none for one that is not a number.
    fn above(self, a: Self::Numbers, limit: f32) -> u8;

    /// The items whose bit is set, in their order; behind them stands any of the items.
    fn compress(self, bits: u8, items: &[u32; LANES]) -> [u32; LANES];

    /// `first` plus each of the lanes whose bit is set, ascending; the rest means nothing.
    fn lanes_from(self, bits: u8, first: u32) -> [u32; LANES];

    fn load_doubles(self, numbers: &[f64; QUAD]) -> Self::Doubles;
    fn splat_double(self, number: f64) -> Self::Doubles;
    fn add_doubles(self, a: Self::Doubles, b: Self::Doubles) -> Self::Doubles;
    fn sub_doubles(self, a: Self::Doubles, b: Self::Doubles) -> Self::Doubles;
    fn mul_doubles(self, a: Self::Doubles, b: Self::Doubles) -> Self::Doubles;
    fn div_doubles(self, a: Self::Doubles, b: Self::Doubles) -> Self::Doubles;
    fn sqrt_doubles(self, a: Self::Doubles) -> Self::Doubles;
    fn array(self, a: Self::Doubles) -> [f64; QUAD];

    /// `then` in lanes where a < b, elsewhere `otherwise`; also where one is not a number.
    fn if_less(
        self,
        a: Self::Doubles,
        b: Self::Doubles,
        then: Self::Doubles,
        otherwise: Self::Doubles,
    ) -> Self::Doubles;

    /// A bit for each lane that is below a limit or not a number.
    fn not_from(self, a: Self::Doubles, limit: f64) -> u8;

    /// a · 2ᵏ, where k stands in the low bits of another number; no overflow is looked for.
    fn times_power(self, a: Self::Doubles, k: Self::Doubles) -> Self::Doubles;

    /// The numbers of one column after the other.
    fn columns(self, rows: [&[f64; QUAD]; QUAD]) -> [Self::Doubles; QUAD];
}

/// A computation that runs on any machine.
pub(super) trait Task {
    type Output;

    fn run<M: Machine>(self, machine: M) -> Self::Output;
}

/// Runs a task on the best machine there is.
#[inline]
pub(super) fn dispatch<T: Task>(task: T) -> T::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(machine) = pulp::x86::V3::try_new() {
        return machine.vectorize(avx2::Call { task, machine });
    }
    task.run(Baseline)
}

/// For each set of lanes: the lanes in it, ascending.
static ORDER: [[u8; LANES]; 256] = order();

const fn order() -> [[u8; LANES]; 256] {
    let mut order = [[0; LANES]; 256];
    let mut bits = 0;
    while bits < 256 {
        let (mut lane, mut count) = (0, 0);
        while lane < LANES {
            if bits >> lane & 1 == 1 {
                order[bits][count] = lane as u8;
                count += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Everything a machine can do, as bits.
    struct All;

    impl Task for All {
        type Output = Vec<u32>;

        fn run<M: Machine>(self, machine: M) -> Vec<u32> {
            let mut bits = Vec::new();
            single(machine, &mut bits);
            double(machine, &mut bits);
            bits
        }
    }

    fn single<M: Machine>(machine: M, bits: &mut Vec<u32>) {
        let numbers = [0.1, -0.0, 3.0e-40, f32::NAN, f32::INFINITY, -7.25, 1.0e20, 0.3];
        let a = machine.load(&numbers);
        let sum = machine.add(machine.mul(a, machine.splat(0.7)), a);
        let limits = [0.0, -0.0, 0.17, f32::NEG_INFINITY, 1.0e20, f32::NAN];
        bits.extend(limits.iter().map(|&limit| u32::from(machine.above(sum, limit))));
        for set in 0..=255u8 {
            let items = [9, 8, 7, 6, 5, 4, 3, 2];
            let count = set.count_ones() as usize;
            let picked = machine.compress(set, &items);
            assert!(picked.iter().all(|item| items.contains(item)));
            bits.extend(&picked[..count]);
            bits.extend(&machine.lanes_from(set, 1000)[..count]);
        }
    }

    fn double<M: Machine>(machine: M, bits: &mut Vec<u32>) {
        let rows = [0, 1, 2, 3].map(|i: i32| [0, 1, 2, 3].map(|j| f64::from(4 * i + j) + 0.1));
        let [a, b, c, d] = columns(machine, rows.each_ref());
        let nan = Quad::splat(machine, f64::NAN);
        let k = Quad::splat(machine, 6_755_399_441_055_744.0 - 3.0);
        bits.extend([a, nan].map(|quad| u32::from(quad.not_from(4.1))));
        let sums = [a + b, Quad::splat(machine, 7.3) - c, nan.least(a.least(b - a))];
        let products = [a * d, b / c, d.sqrt(), dot([a, b, c], [b, c, d]), a.times_power(k)];
        let chosen = [a.if_less(c - b * b, d, b), nan.if_less(a, a, b), a.if_less(nan, a, b)];
        for quad in sums.into_iter().chain(products).chain(chosen) {
            let words = quad.array().map(f64::to_bits);
            bits.extend(words.iter().flat_map(|&word| [word as u32, (word >> 32) as u32]));
        }
    }

    #[test]
    fn machines_agree() {
        let baseline = All.run(Baseline);
        assert_eq!(baseline[..4], [0b1101_0101, 0b1101_0101, 0b1101_0000, 0b1111_0111]);
        assert_eq!(baseline[6..14], [9, 1000, 8, 1001, 9, 8, 1000, 1001], "the sets 1, 2 and 3");
        assert!(baseline == dispatch(All));
    }

    #[test]
    fn a_power_is_read_from_the_low_bits() {
        let k = Quad::splat(Baseline, 6_755_399_441_055_744.0 - 3.0);
        assert_eq!(Quad::splat(Baseline, 10.0).times_power(k).array(), [1.25; QUAD]);
    }
}
