//! Sine, cosine and exponential as the specification's own polynomials.
//!
//! Neither the platform's nor a crate's functions may be used in normative code: a decoder in
//! another language must reach the same bits. The coefficients are the Taylor coefficients
//! ±1/n!, rounded once to binary64; on the reduced ranges the truncation error is below 1e-14.

/// Head of π/2: its 33 leading bits, so that the product with a small integer is exact.
const HALF_PI_HEAD: f64 = 1.570_796_326_734_125_6;
/// π/2 − [`HALF_PI_HEAD`].
const HALF_PI_TAIL: f64 = 6.077_100_506_506_192e-11;
/// 2/π.
const TWO_OVER_PI: f64 = std::f64::consts::FRAC_2_PI;
/// Head of ln 2: its 33 leading bits.
const LN_2_HEAD: f64 = 6.931_471_803_691_238e-1;
/// ln 2 − [`LN_2_HEAD`].
const LN_2_TAIL: f64 = 1.908_214_929_270_587_7e-10;
/// 1/ln 2.
const LOG2_E: f64 = std::f64::consts::LOG2_E;

/// Sine and cosine of `angle` (radians, magnitude at most 4): spec rule `deform.sincos`.
pub fn sin_cos(angle: f64) -> (f64, f64) {
    let quadrant = (angle * TWO_OVER_PI).round_ties_even();
    let r = (angle - quadrant * HALF_PI_HEAD) - quadrant * HALF_PI_TAIL;
    let z = r * r;
    let sine = r + r * (z * polynomial(&SINE, z));
    let cosine = 1.0 + z * polynomial(&COSINE, z);
    match quadrant as i32 & 3 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

/// −1/3!, 1/5!, … 1/15! negative: (sin r − r)/r³ by powers of r².
const SINE: [f64; 7] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
];
/// −1/2!, 1/4!, … 1/14! negative: (cos r − 1)/r² by powers of r².
const COSINE: [f64; 7] = [
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
];
/// 1/0! … 1/12!: e^r by powers of r, for |r| ≤ ln 2 / 2.
const EXPONENTIAL: [f64; 13] = [
    1.0,
    1.0,
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5_040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
];

/// Horner's rule, from the last coefficient on.
fn polynomial<const N: usize>(coefficients: &[f64; N], z: f64) -> f64 {
    let higher_first = coefficients.iter().rev().copied();
    higher_first.reduce(|p, coefficient| coefficient + z * p).unwrap_or_default()
}

/// e^(−x) for x ≥ 0, and 0 where x > 700: spec rule `deform.exp`.
pub fn exp_neg(x: f64) -> f64 {
    if x > 700.0 {
        return 0.0;
    }
    let halvings = (x * LOG2_E).round_ties_even();
    let r = -((x - halvings * LN_2_HEAD) - halvings * LN_2_TAIL);
    polynomial(&EXPONENTIAL, r) * f64::from_bits(((1023 - halvings as i64) as u64) << 52)
}

#[cfg(test)]
// The platform's functions are what the polynomials are compared with.
#[allow(clippy::disallowed_methods)]
mod tests {
    use super::*;

    #[test]
    fn the_constants_are_the_specifications_to_the_bit() {
        let constants = [HALF_PI_HEAD, HALF_PI_TAIL, TWO_OVER_PI, LOG2_E, LN_2_HEAD, LN_2_TAIL]
            .map(f64::to_bits);
        let printed = [
            0x3FF9_21FB_5440_0000,
            0x3DD0_B461_1A62_6331,
            0x3FE4_5F30_6DC9_C883,
            0x3FF7_1547_652B_82FE,
            0x3FE6_2E42_FEE0_0000,
            0x3DEA_39EF_3579_3C76,
        ];
        assert_eq!(constants, printed);
    }

    /// A last digit of 1/15! is far below a last bit of any sine.
    #[test]
    fn coefficients_are_inverse_factorials() {
        let inverse = |n: usize| 1.0 / (1..=n).map(|factor| factor as f64).product::<f64>();
        let signed =
            |k: usize, n: usize| if k.is_multiple_of(2) { -inverse(n) } else { inverse(n) };
        assert_eq!(SINE, std::array::from_fn(|k| signed(k, 2 * k + 3)));
        assert_eq!(COSINE, std::array::from_fn(|k| signed(k, 2 * k + 2)));
        assert_eq!(EXPONENTIAL, std::array::from_fn(inverse));
    }

    #[test]
    fn sine_and_cosine_agree_with_the_platform() {
        for step in -4000..=4000 {
            let angle = f64::from(step) * 1e-3;
            let (sine, cosine) = sin_cos(angle);
            assert!((sine - angle.sin()).abs() < 2e-15, "sin {angle}");
            assert!((cosine - angle.cos()).abs() < 2e-15, "cos {angle}");
        }
    }

    #[test]
    fn the_exponential_agrees_with_the_platform() {
        for step in 0..7000 {
            let x = f64::from(step) * 0.1;
            let expected = (-x).exp();
            assert!((exp_neg(x) - expected).abs() <= 1e-13 * expected, "exp −{x}");
        }
        assert_eq!(exp_neg(0.0), 1.0);
        assert_eq!(exp_neg(700.5), 0.0);
    }

    /// Frozen bits: any change of a constant or of the order of operations fails here.
    #[test]
    fn bits_are_frozen() {
        let mut hash = 0_u64;
        for step in -400..=400 {
            let (sine, cosine) = sin_cos(f64::from(step) * 0.01);
            let exponential = exp_neg(f64::from(step + 400));
            for value in [sine, cosine, exponential] {
                hash = (hash ^ value.to_bits()).wrapping_mul(0x0000_0100_0000_01b3);
            }
        }
        assert_eq!(hash, 4_993_620_912_279_044_330);
    }
}
