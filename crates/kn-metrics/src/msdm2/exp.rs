//! The exponential function in plain arithmetic that the compiler vectorises.

/// 1.5 · 2⁵²: adding it rounds to an integer, which then stands in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// ln 2 in two parts; the first has enough zeros at its end that its products are exact.
const LN_2_HIGH: f64 = 0.693_147_180_369_123_8;
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// eˣ for x ≤ 0; the relative error is below 1e-14. From −700 on the result stays at e⁻⁷⁰⁰, which
/// as a weight is nothing.
#[inline(always)]
pub(super) fn exp_of_negative(x: f64) -> f64 {
    let x = if x > -700.0 { x } else { -700.0 };
    let shifted = x * std::f64::consts::LOG2_E + ROUND;
    let k = shifted - ROUND;
    let r = x - k * LN_2_HIGH - k * LN_2_LOW;
    // Taylor's series in pairs: |r| ≤ ln 2 / 2, and r¹²/12! < 7e-15.
    let r2 = r * r;
    let r4 = r2 * r2;
    let low = 1.0 + r + r2 * (1.0 / 2.0 + r * (1.0 / 6.0));
    let middle = 1.0 / 24.0 + r * (1.0 / 120.0) + r2 * (1.0 / 720.0 + r * (1.0 / 5040.0));
    let high = 1.0 / 40_320.0
        + r * (1.0 / 362_880.0)
        + r2 * (1.0 / 3_628_800.0 + r * (1.0 / 39_916_800.0));
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
            prop_assert!((exp_of_negative(x) / x.exp() - 1.0).abs() < 1e-14);
            prop_assert!((exp_of_negative(small) / small.exp() - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn ends_are_exact_or_nothing() {
        assert_eq!(exp_of_negative(0.0), 1.0);
        let least = exp_of_negative(f64::NEG_INFINITY);
        assert!(least < 1e-300 && least == exp_of_negative(-1e300));
    }
}
