//! Seeded random numbers that depend on a position and not on earlier numbers, so that any frame
//! can be made alone.

use glam::DVec3;

/// A stream of random numbers that is read by index.
#[derive(Clone, Copy, Debug)]
pub(super) struct Random {
    key: u64,
}

impl Random {
    /// The stream of `name` under `seed`; streams of other names are independent of it.
    pub(super) fn new(seed: u64, name: u64) -> Self {
        Self { key: mix(mix(seed) ^ mix(name.wrapping_mul(0xd1b5_4a32_d192_ed03))) }
    }

    /// A stream of its own below this one, as for one frame.
    pub(super) fn fork(self, index: i64) -> Self {
        Self { key: self.bits(index) }
    }

    fn bits(self, index: i64) -> u64 {
        mix(self.key ^ (index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15))
    }

    /// Number `index` of the stream, uniform in 0 ≤ x < 1.
    pub(super) fn unit(self, index: i64) -> f64 {
        (self.bits(index) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Number `index` of the stream, uniform in −1 ≤ x < 1.
    pub(super) fn signed(self, index: i64) -> f64 {
        2.0 * self.unit(index) - 1.0
    }

    /// An integer below `count` (at least 1).
    pub(super) fn below(self, index: i64, count: usize) -> usize {
        (self.bits(index) >> 33) as usize % count.max(1)
    }

    /// Three numbers in −1 ≤ x < 1.
    pub(super) fn vector(self, index: i64) -> DVec3 {
        DVec3::new(self.signed(3 * index), self.signed(3 * index + 1), self.signed(3 * index + 2))
    }

    /// Smooth noise over space in −1 ≤ x < 1: random values on the integer lattice, blended by a
    /// curve with continuous second derivative.
    pub(super) fn noise(self, at: DVec3) -> f64 {
        let cell = at.floor();
        let [u, v, w] = (at - cell).to_array().map(fade);
        let [x, y, z] = cell.to_array().map(|c| c as i64);
        let mut sum = 0.0;
        for corner in 0..8_i64 {
            let (i, j, k) = (corner & 1, corner >> 1 & 1, corner >> 2);
            let weight = side(i, u) * side(j, v) * side(k, w);
            sum += weight * self.lattice(x + i, y + j, z + k);
        }
        sum
    }

    fn lattice(self, x: i64, y: i64, z: i64) -> f64 {
        let packed = (x & 0x1f_ffff) | (y & 0x1f_ffff) << 21 | (z & 0x1f_ffff) << 42;
        self.signed(packed)
    }
}

fn side(upper: i64, fraction: f64) -> f64 {
    if upper == 1 { fraction } else { 1.0 - fraction }
}

/// Quintic from 0 to 1 with two vanishing derivatives at both ends; clamps outside.
pub(super) fn fade(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (x * (6.0 * x - 15.0) + 10.0)
}

/// The finaliser of splitmix64: every input bit reaches every output bit.
fn mix(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_uniform_and_streams_differ() {
        let (a, b) = (Random::new(1, 0), Random::new(1, 1));
        let mean = (0..4000).map(|i| a.unit(i)).sum::<f64>() / 4000.0;
        let product = (0..4000).map(|i| a.signed(i) * b.signed(i)).sum::<f64>() / 4000.0;
        assert!((mean - 0.5).abs() < 0.02, "{mean}");
        assert!(product.abs() < 0.02, "{product}");
    }

    #[test]
    fn noise_is_continuous_across_lattice_planes() {
        let random = Random::new(7, 3);
        for i in 0..50 {
            let at = DVec3::new(f64::from(i) - 25.0, 0.37 * f64::from(i), -1.0);
            let step =
                random.noise(at + DVec3::splat(1e-9)) - random.noise(at - DVec3::splat(1e-9));
            assert!(step.abs() < 1e-7, "{step}");
        }
    }
}
