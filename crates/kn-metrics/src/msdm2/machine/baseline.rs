//! Operations that every processor of the target has.

use glam::Vec4;

use super::{LANES, Machine, ORDER, QUAD};

/// Two vectors of four binary32 each, and arrays that the compiler may vectorise.
#[derive(Clone, Copy)]
pub(in super::super) struct Baseline;

impl Machine for Baseline {
    type Numbers = (Vec4, Vec4);
    type Doubles = [f64; QUAD];

    #[inline(always)]
    fn load(self, &[a, b, c, d, e, f, g, h]: &[f32; LANES]) -> Self::Numbers {
        (Vec4::new(a, b, c, d), Vec4::new(e, f, g, h))
    }

    #[inline(always)]
    fn splat(self, number: f32) -> Self::Numbers {
        (Vec4::splat(number), Vec4::splat(number))
    }

    #[inline(always)]
    fn add(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers {
        (a.0 + b.0, a.1 + b.1)
    }

    #[inline(always)]
    fn mul(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers {
        (a.0 * b.0, a.1 * b.1)
    }

    #[inline(always)]
    fn above(self, a: Self::Numbers, limit: f32) -> u8 {
        let limit = Vec4::splat(limit);
        (a.0.cmpgt(limit).bitmask() | a.1.cmpgt(limit).bitmask() << (LANES / 2)) as u8
    }

    #[inline(always)]
    fn compress(self, bits: u8, items: &[u32; LANES]) -> [u32; LANES] {
        ORDER[bits as usize].map(|lane| items[lane as usize % LANES])
    }

    #[inline(always)]
    fn lanes_from(self, bits: u8, first: u32) -> [u32; LANES] {
        ORDER[bits as usize].map(|lane| first.wrapping_add(lane.into()))
    }

    #[inline(always)]
    fn load_doubles(self, numbers: &[f64; QUAD]) -> Self::Doubles {
        *numbers
    }

    #[inline(always)]
    fn splat_double(self, number: f64) -> Self::Doubles {
        [number; QUAD]
    }

    #[inline(always)]
    fn add_doubles(self, a: Self::Doubles, b: Self::Doubles) -> Self::Doubles {
        std::array::from_fn(|lane| a[lane] + b[lane])
    }

    #[inline(always)]
    fn sub_doubles(self, a: Self::Doubles, b: Self::Doubles) -> Self::Doubles {
        std::array::from_fn(|lane| a[lane] - b[lane])
    }

    #[inline(always)]
    fn mul_doubles(self, a: Self::Doubles, b: Self::Doubles) -> Self::Doubles {
        std::array::from_fn(|lane| a[lane] * b[lane])
    }

    #[inline(always)]
    fn div_doubles(self, a: Self::Doubles, b: Self::Doubles) -> Self::Doubles {
        std::array::from_fn(|lane| a[lane] / b[lane])
    }

    #[inline(always)]
    fn sqrt_doubles(self, a: Self::Doubles) -> Self::Doubles {
        a.map(f64::sqrt)
    }

    #[inline(always)]
    fn array(self, a: Self::Doubles) -> [f64; QUAD] {
        a
    }

    #[inline(always)]
    fn if_less(
        self,
        a: Self::Doubles,
        b: Self::Doubles,
        then: Self::Doubles,
        otherwise: Self::Doubles,
    ) -> Self::Doubles {
        std::array::from_fn(|lane| if a[lane] < b[lane] { then[lane] } else { otherwise[lane] })
    }

    #[inline(always)]
    fn not_from(self, a: Self::Doubles, limit: f64) -> u8 {
        (0..QUAD).map(|lane| u8::from(a[lane] < limit || a[lane].is_nan()) << lane).sum()
    }

    #[inline(always)]
    fn times_power(self, a: Self::Doubles, k: Self::Doubles) -> Self::Doubles {
        std::array::from_fn(|lane| {
            f64::from_bits(a[lane].to_bits().wrapping_add(k[lane].to_bits() << 52))
        })
    }

    #[inline(always)]
    fn columns(self, rows: [&[f64; QUAD]; QUAD]) -> [Self::Doubles; QUAD] {
        std::array::from_fn(|column| rows.map(|row| row[column]))
    }
}
