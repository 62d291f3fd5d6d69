//! x86-64 with AVX2.

use std::arch::x86_64::{__m128i, __m256, __m256d, __m256i, _CMP_GT_OQ, _CMP_LT_OQ, _CMP_NGE_UQ};

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
    type Doubles = __m256d;

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
    fn load_doubles(self, numbers: &[f64; QUAD]) -> __m256d {
        cast(*numbers)
    }

    #[inline(always)]
    fn splat_double(self, number: f64) -> __m256d {
        self.avx._mm256_set1_pd(number)
    }

    #[inline(always)]
    fn add_doubles(self, a: __m256d, b: __m256d) -> __m256d {
        self.avx._mm256_add_pd(a, b)
    }

    #[inline(always)]
    fn sub_doubles(self, a: __m256d, b: __m256d) -> __m256d {
        self.avx._mm256_sub_pd(a, b)
    }

    #[inline(always)]
    fn mul_doubles(self, a: __m256d, b: __m256d) -> __m256d {
        self.avx._mm256_mul_pd(a, b)
    }

    #[inline(always)]
    fn div_doubles(self, a: __m256d, b: __m256d) -> __m256d {
        self.avx._mm256_div_pd(a, b)
    }

    #[inline(always)]
    fn sqrt_doubles(self, a: __m256d) -> __m256d {
        self.avx._mm256_sqrt_pd(a)
    }

    #[inline(always)]
    fn array(self, a: __m256d) -> [f64; QUAD] {
        cast(a)
    }

    #[inline(always)]
    fn if_less(self, a: __m256d, b: __m256d, then: __m256d, otherwise: __m256d) -> __m256d {
        let is_less = self.avx._mm256_cmp_pd::<_CMP_LT_OQ>(a, b);
        self.avx._mm256_blendv_pd(otherwise, then, is_less)
    }

    #[inline(always)]
    fn not_from(self, a: __m256d, limit: f64) -> u8 {
        let limit = self.avx._mm256_set1_pd(limit);
        self.avx._mm256_movemask_pd(self.avx._mm256_cmp_pd::<_CMP_NGE_UQ>(a, limit)) as u8
    }

    #[inline(always)]
    fn times_power(self, a: __m256d, k: __m256d) -> __m256d {
        let power = self.avx2._mm256_slli_epi64::<52>(cast(k));
        cast(self.avx2._mm256_add_epi64(cast(a), power))
    }

    #[inline(always)]
    fn columns(self, [a, b, c, d]: [&[f64; QUAD]; QUAD]) -> [__m256d; QUAD] {
        let (a, b): (__m256d, __m256d) = (cast(*a), cast(*b));
        let (c, d): (__m256d, __m256d) = (cast(*c), cast(*d));
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
