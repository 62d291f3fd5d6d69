//! The exponential function in plain arithmetic that the compiler vectorises.

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
pub(super) fn exp_of_negative(x: f64) -> f64 {
    let x = if x > -700.0 { x } else { -700.0 };
    let shifted = x * std::f64::consts::LOG2_E + ROUND;
    let k = shifted - ROUND;
    let r = x - k * LN_2_HIGH - k * LN_2_LOW;
    // 1 + r plus terms that interpolate eʳ at Chebyshev's points of |r| ≤ ln 2 / 2, in pairs.
    let r2 = r * r;
    let r4 = r2 * r2;
    let low = 1.0 + r + r2 * (SERIES[0] + r * SERIES[1]);
    let middle = SERIES[2] + r * SERIES[3] + r2 * (SERIES[4] + r * SERIES[5]);
    let high = SERIES[6] + r * SERIES[7];
    let series = low + r4 * (middle + r4 * high);
    // Multiplies by 2ᵏ: the low bits of `shifted` move to the exponent.
    f64::from_bits(series.to_bits().wrapping_add(shifted.to_bits() << 52))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn agrees_with_the_standard_library(x in -699.0..0.0f64, small in -2.0..0.0f64) {
            prop_assert!((exp_of_negative(x) / x.exp() - 1.0).abs() < 5e-14);
            prop_assert!((exp_of_negative(small) / small.exp() - 1.0).abs() < 5e-14);
        }
    }

    #[test]
    fn ends_are_exact_or_nothing() {
        assert_eq!(exp_of_negative(0.0), 1.0);
        let least = exp_of_negative(f64::NEG_INFINITY);
        assert!(least < 1e-300 && least == exp_of_negative(-1e300));
    }
}
