//! The processor that runs: eight lanes of binary32, four of binary64, and lists of lanes.
//!
//! Kernels are written once, over [`Machine`], and compiled for what every processor of the target
//! has and, on x86-64, for AVX2 and BMI as well; which of the two runs is asked of the processor.
//! Nothing is fused or re-ordered, so that both give the same bits.

use glam::Vec4;

/// Lanes of binary32.
pub(super) const LANES: usize = 8;

/// Lanes of binary64.
pub(super) const QUAD: usize = 4;

/// Operations on all lanes of a block.
pub(super) trait Machine: Copy {
    /// A binary32 number for each of eight lanes.
    type Numbers: Copy;

    /// A binary64 number for each of four lanes.
    type Quad: Copy;

    fn load(self, numbers: &[f32; LANES]) -> Self::Numbers;
    fn splat(self, number: f32) -> Self::Numbers;
    fn add(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;
    fn mul(self, a: Self::Numbers, b: Self::Numbers) -> Self::Numbers;

    /// A bit for each lane above a limit; none for one that is not a number.
    fn above(self, a: Self::Numbers, limit: f32) -> u8;

    /// The items whose bit is set, in their order; what stands behind them means nothing.
    fn compress(self, bits: u8, items: &[u32; LANES]) -> [u32; LANES];

    /// `first` plus each of the lanes whose bit is set, ascending; the rest means nothing.
    fn lanes_from(self, bits: u8, first: u32) -> [u32; LANES];

    fn quad(self, number: f64) -> Self::Quad;
    fn plus(self, a: Self::Quad, b: Self::Quad) -> Self::Quad;
    fn minus(self, a: Self::Quad, b: Self::Quad) -> Self::Quad;
    fn times(self, a: Self::Quad, b: Self::Quad) -> Self::Quad;
    fn over(self, a: Self::Quad, b: Self::Quad) -> Self::Quad;
    fn root(self, a: Self::Quad) -> Self::Quad;

    /// The lesser of two; `b` if one of them is not a number.
    fn least(self, a: Self::Quad, b: Self::Quad) -> Self::Quad;

    /// A bit for each lane that is below a limit or not a number.
    fn not_from(self, a: Self::Quad, limit: f64) -> u8;

    fn array(self, a: Self::Quad) -> [f64; QUAD];

    /// The numbers of one column after the other.
    fn columns(self, rows: [&[f64; QUAD]; QUAD]) -> [Self::Quad; QUAD];

    /// The dot product of three coordinates, summed from the first to the last.
    #[inline(always)]
    fn product(self, a: [Self::Quad; 3], b: [Self::Quad; 3]) -> Self::Quad {
        let sum = self.plus(self.times(a[0], b[0]), self.times(a[1], b[1]));
        self.plus(sum, self.times(a[2], b[2]))
    }
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

/// What every processor of the target can do.
#[derive(Clone, Copy)]
pub(super) struct Baseline;

impl Machine for Baseline {
    type Numbers = (Vec4, Vec4);
    type Quad = [f64; QUAD];

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
    fn quad(self, number: f64) -> Self::Quad {
        [number; QUAD]
    }

    #[inline(always)]
    fn plus(self, a: Self::Quad, b: Self::Quad) -> Self::Quad {
        std::array::from_fn(|lane| a[lane] + b[lane])
    }

    #[inline(always)]
    fn minus(self, a: Self::Quad, b: Self::Quad) -> Self::Quad {
        std::array::from_fn(|lane| a[lane] - b[lane])
    }

    #[inline(always)]
    fn times(self, a: Self::Quad, b: Self::Quad) -> Self::Quad {
        std::array::from_fn(|lane| a[lane] * b[lane])
    }

    #[inline(always)]
    fn over(self, a: Self::Quad, b: Self::Quad) -> Self::Quad {
        std::array::from_fn(|lane| a[lane] / b[lane])
    }

    #[inline(always)]
    fn root(self, a: Self::Quad) -> Self::Quad {
        a.map(f64::sqrt)
    }

    #[inline(always)]
    fn least(self, a: Self::Quad, b: Self::Quad) -> Self::Quad {
        std::array::from_fn(|lane| if a[lane] < b[lane] { a[lane] } else { b[lane] })
    }

    #[inline(always)]
    fn not_from(self, a: Self::Quad, limit: f64) -> u8 {
        (0..QUAD).map(|lane| u8::from(!(a[lane] >= limit)) << lane).sum()
    }

    #[inline(always)]
    fn array(self, a: Self::Quad) -> [f64; QUAD] {
        a
    }

    #[inline(always)]
    fn columns(self, rows: [&[f64; QUAD]; QUAD]) -> [Self::Quad; QUAD] {
        std::array::from_fn(|column| rows.map(|row| row[column]))
    }
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

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::{__m128i, __m256, __m256d, __m256i, _CMP_GT_OQ, _CMP_NGE_UQ};

    use pulp::bytemuck::cast;
    use pulp::x86::V3;

    use super::{LANES, Machine, ORDER, QUAD, Task};

    /// A task that is inlined where the vector instructions are enabled.
    pub(super) struct Call<T> {
        pub(super) task: T,
        pub(super) machine: V3,
    }

    impl<T: Task> pulp::NullaryFnOnce for Call<T> {
        type Output = T::Output;

        #[inline(always)]
        fn call(self) -> T::Output {
            self.task.run(self.machine)
        }
    }

    /// The lanes whose bit is set, ascending.
    #[inline(always)]
    fn order(machine: V3, bits: u8) -> __m256i {
        let order: __m128i = cast([u64::from_le_bytes(ORDER[bits as usize]), 0]);
        machine.avx2._mm256_cvtepu8_epi32(order)
    }

    impl Machine for V3 {
        type Numbers = __m256;
        type Quad = __m256d;

        #[inline(always)]
        fn load(self, numbers: &[f32; LANES]) -> __m256 {
            cast(*numbers)
        }

        #[inline(always)]
        fn splat(self, number: f32) -> __m256 {
            self.avx._mm256_set1_ps(number)
        }

        #[inline(always)]
        fn add(self, a: __m256, b: __m256) -> __m256 {
            self.avx._mm256_add_ps(a, b)
        }

        #[inline(always)]
        fn mul(self, a: __m256, b: __m256) -> __m256 {
            self.avx._mm256_mul_ps(a, b)
        }

        #[inline(always)]
        fn above(self, a: __m256, limit: f32) -> u8 {
            let limit = self.avx._mm256_set1_ps(limit);
            self.avx._mm256_movemask_ps(self.avx._mm256_cmp_ps::<_CMP_GT_OQ>(a, limit)) as u8
        }

        #[inline(always)]
        fn compress(self, bits: u8, items: &[u32; LANES]) -> [u32; LANES] {
            let items: __m256i = cast(*items);
            cast(self.avx2._mm256_permutevar8x32_epi32(items, order(self, bits)))
        }

        #[inline(always)]
        fn lanes_from(self, bits: u8, first: u32) -> [u32; LANES] {
            let first: __m256i = cast([first; LANES]);
            cast(self.avx2._mm256_add_epi32(first, order(self, bits)))
        }

        #[inline(always)]
        fn quad(self, number: f64) -> __m256d {
            self.avx._mm256_set1_pd(number)
        }

        #[inline(always)]
        fn plus(self, a: __m256d, b: __m256d) -> __m256d {
            self.avx._mm256_add_pd(a, b)
        }

        #[inline(always)]
        fn minus(self, a: __m256d, b: __m256d) -> __m256d {
            self.avx._mm256_sub_pd(a, b)
        }

        #[inline(always)]
        fn times(self, a: __m256d, b: __m256d) -> __m256d {
            self.avx._mm256_mul_pd(a, b)
        }

        #[inline(always)]
        fn over(self, a: __m256d, b: __m256d) -> __m256d {
            self.avx._mm256_div_pd(a, b)
        }

        #[inline(always)]
        fn root(self, a: __m256d) -> __m256d {
            self.avx._mm256_sqrt_pd(a)
        }

        #[inline(always)]
        fn least(self, a: __m256d, b: __m256d) -> __m256d {
            self.avx._mm256_min_pd(a, b)
        }

        #[inline(always)]
        fn not_from(self, a: __m256d, limit: f64) -> u8 {
            let limit = self.avx._mm256_set1_pd(limit);
            self.avx._mm256_movemask_pd(self.avx._mm256_cmp_pd::<_CMP_NGE_UQ>(a, limit)) as u8
        }

        #[inline(always)]
        fn array(self, a: __m256d) -> [f64; QUAD] {
            cast(a)
        }

        #[inline(always)]
        fn columns(self, rows: [&[f64; QUAD]; QUAD]) -> [__m256d; QUAD] {
            let [a, b, c, d] = rows;
            let (a, b, c, d): (__m256d, __m256d, __m256d, __m256d) =
                (cast(*a), cast(*b), cast(*c), cast(*d));
            let even = [self.avx._mm256_unpacklo_pd(a, b), self.avx._mm256_unpacklo_pd(c, d)];
            let odd = [self.avx._mm256_unpackhi_pd(a, b), self.avx._mm256_unpackhi_pd(c, d)];
            [
                self.avx._mm256_permute2f128_pd::<0x20>(even[0], even[1]),
                self.avx._mm256_permute2f128_pd::<0x20>(odd[0], odd[1]),
                self.avx._mm256_permute2f128_pd::<0x31>(even[0], even[1]),
                self.avx._mm256_permute2f128_pd::<0x31>(odd[0], odd[1]),
            ]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Everything a machine can do, as bits.
    struct All;

    impl Task for All {
        type Output = Vec<u32>;

        fn run<M: Machine>(self, machine: M) -> Vec<u32> {
            let numbers = [0.1, -0.0, 3.0e-40, f32::NAN, f32::INFINITY, -7.25, 1.0e20, 0.3];
            let a = machine.load(&numbers);
            let sum = machine.add(machine.mul(a, machine.splat(0.7)), a);
            let limits = [0.0, -0.0, 0.17, f32::NEG_INFINITY, 1.0e20, f32::NAN];
            let mut bits: Vec<u32> =
                limits.iter().map(|&limit| machine.above(sum, limit).into()).collect();
            for set in 0..=255u8 {
                let items = [9, 8, 7, 6, 5, 4, 3, 2];
                let count = set.count_ones() as usize;
                bits.extend(&machine.compress(set, &items)[..count]);
                bits.extend(&machine.lanes_from(set, 1000)[..count]);
            }
            let rows = [0, 1, 2, 3].map(|i: i32| [0, 1, 2, 3].map(|j| f64::from(4 * i + j) + 0.1));
            let [a, b, c, d] = machine.columns(rows.each_ref());
            let nan = machine.quad(f64::NAN);
            let limited = machine.least(nan, machine.least(a, machine.quad(5.0)));
            bits.extend([a, nan].map(|quad| u32::from(machine.not_from(quad, 4.1))));
            let sums = [machine.plus(a, b), machine.minus(machine.quad(7.3), c), limited];
            let products = [machine.times(a, d), machine.over(b, c), machine.root(d)];
            for quad in sums.into_iter().chain(products).chain([machine.product([a, b, c], [b, c, d])]) {
                let words = machine.array(quad).map(f64::to_bits);
                bits.extend(words.iter().flat_map(|&word| [word as u32, (word >> 32) as u32]));
            }
            bits
        }
    }

    #[test]
    fn machines_agree() {
        let baseline = All.run(Baseline);
        assert_eq!(baseline[..4], [0b1101_0101, 0b1101_0101, 0b1101_0000, 0b1111_0111]);
        assert!(baseline == dispatch(All));
        assert_eq!(baseline[6..14], [9, 1000, 8, 1001, 9, 8, 1000, 1001], "the sets 1, 2 and 3");
    }
}
