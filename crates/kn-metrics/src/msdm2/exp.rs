//! The exponential function in plain arithmetic, four at a time.

use super::machine::{Machine, Quad};

/// 1.5 · 2⁵²: adding it rounds to an integer, which then stands in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// ln 2 in two parts; the first has enough zeros at its end that its products are exact.
const LN_2_HIGH: f64 = 0.693_147_180_369_123_8;
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// Coefficients from r² on. Taylor's series needs two terms more for the same error.
const SERIES: [f64; 8] = [
    0.499_999_999_997_979_34,
    0.166_666_666_666_483_03,
    0.041_666_666_890_957,
    0.008_333_333_353_717_156,
    0.001_388_882_167_763_036_2,
    0.000_198_412_087_569_923_2,
    2.487_616_402_262_596_7e-5,
    2.762_510_200_538_810_8e-6,
];

/// eˣ for x ≤ 0; the relative error is below 5e-14. From −700 on the result stays at e⁻⁷⁰⁰, which
/// as a weight is nothing.
#[inline(always)]
pub(super) fn exp_of_negative<M: Machine>(machine: M, x: Quad<M>) -> Quad<M> {
    let least = Quad::splat(machine, -700.0);
    let x = least.if_less(x, x, least);
    let shifted = x * std::f64::consts::LOG2_E + Quad::splat(machine, ROUND);
    let k = shifted - Quad::splat(machine, ROUND);
    let r = x - k * LN_2_HIGH - k * LN_2_LOW;
    // 1 + r plus terms that interpolate eʳ at Chebyshev's points of |r| ≤ ln 2 / 2, in pairs.
    let r2 = r * r;
    let r4 = r2 * r2;
    let low = Quad::splat(machine, 1.0) + r + r2 * pair(machine, r, 0);
    let middle = pair(machine, r, 2) + r2 * pair(machine, r, 4);
    let series = low + r4 * (middle + r4 * pair(machine, r, 6));
    series.times_power(shifted)
}

/// Two neighbouring terms of the series.
#[inline(always)]
fn pair<M: Machine>(machine: M, r: Quad<M>, first: usize) -> Quad<M> {
    Quad::splat(machine, SERIES[first]) + r * SERIES[first + 1]
}

#[cfg(test)]
mod tests {
    use super::super::machine::Baseline;
    use super::*;
    use proptest::prelude::*;

    fn exp(x: f64) -> f64 {
        exp_of_negative(Baseline, Quad::splat(Baseline, x)).array()[2]
    }

    proptest! {
        #[test]
        fn agrees_with_the_standard_library(x in -699.0..0.0f64, small in -2.0..0.0f64) {
            prop_assert!((exp(x) / x.exp() - 1.0).abs() < 5e-14);
            prop_assert!((exp(small) / small.exp() - 1.0).abs() < 5e-14);
        }
    }

    #[test]
    fn ends_are_exact_or_nothing() {
        assert_eq!(exp(0.0), 1.0);
        let least = exp(f64::NEG_INFINITY);
        assert!(least < 1e-300 && least == exp(-1e300));
    }
}
