//! From quantised motion to node transforms (`spec/07-motion.md`).

use kn_bitstream::{MotionFrame, rule};
use kn_deform::NodeTransform;

/// Largest quantised value: with it every product below is exact in binary64.
const MAX_TRANSLATION: i64 = 1 << 28;
/// Largest angle in radians.
const MAX_ANGLE: f64 = 4.0;
/// Largest scale and largest shear.
const MAX_STRETCH: f64 = 8.0;

/// Quantiser step of translations in reference units (`motion.step.translation`).
pub(crate) fn translation_step(index: u8) -> i64 {
    ((i64::from(4 + index % 4) << (index / 4)) >> 2).max(1)
}

/// Quantiser step of angles, scales and shears (`motion.step.parameter`).
pub(crate) fn parameter_step(index: u8) -> f64 {
    let mantissa = f64::from(4 + index % 4);
    let exponent = i64::from(index / 4) - 16;
    mantissa * f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// Dequantises the transforms of a frame; `affine` has one entry per node. Components that a node
/// does not carry are the identity. Translations are integers in reference units.
///
/// # Errors
/// The rule that is broken where a value leaves its range.
pub(crate) fn decode_transforms(
    motion: &MotionFrame,
    affine: &[bool],
    transforms: &mut Vec<NodeTransform>,
) -> Result<(), &'static str> {
    transforms.clear();
    let step = translation_step(motion.translation_step);
    for &quantised in &motion.translations {
        let translation = scaled_translation(quantised, step)?;
        transforms.push(NodeTransform { translation, ..NodeTransform::IDENTITY });
    }
    let carriers = |enabled: bool, rigid: bool| {
        (0..affine.len()).filter(move |&node| if affine[node] { enabled } else { rigid })
    };
    let step = parameter_step(motion.rotation_step);
    for (node, &quantised) in carriers(motion.rotation_enabled, true).zip(&motion.rotations) {
        transforms[node].rotation = parameter(quantised, step, MAX_ANGLE, rule::MOTION_ROTATION_RANGE)?;
    }
    let step = parameter_step(motion.scale_step);
    for (node, &quantised) in carriers(motion.scale_enabled, false).zip(&motion.scales) {
        transforms[node].scale = scale(quantised, step)?;
    }
    let step = parameter_step(motion.shear_step);
    for (node, &quantised) in carriers(motion.shear_enabled, false).zip(&motion.shears) {
        transforms[node].shear = parameter(quantised, step, MAX_STRETCH, rule::MOTION_SHEAR_RANGE)?;
    }
    Ok(())
}

fn scaled_translation(quantised: [i32; 3], step: i64) -> Result<[f64; 3], &'static str> {
    let values = quantised.map(|q| i64::from(q) * step);
    if values.iter().any(|value| value.abs() >= MAX_TRANSLATION) {
        return Err(rule::MOTION_TRANSLATION_RANGE);
    }
    Ok(values.map(|value| value as f64))
}

fn parameter(
    quantised: [i32; 3],
    step: f64,
    bound: f64,
    rule: &'static str,
) -> Result<[f64; 3], &'static str> {
    let values = quantised.map(|q| f64::from(q) * step);
    if values.iter().any(|value| value.abs() > bound) { Err(rule) } else { Ok(values) }
}

fn scale(quantised: [i32; 3], step: f64) -> Result<[f64; 3], &'static str> {
    let values = quantised.map(|q| 1.0 + f64::from(q) * step);
    let in_range = |&value: &f64| value > 0.0 && value <= MAX_STRETCH;
    if values.iter().all(in_range) { Ok(values) } else { Err(rule::MOTION_SCALE_RANGE) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_grow_by_quarter_octaves() {
        assert_eq!([0, 3, 4, 8, 9, 12, 63].map(translation_step), [1, 1, 2, 4, 5, 8, 7 << 13]);
        assert_eq!(parameter_step(64 - 1), 3.5);
        assert_eq!(parameter_step(0), 4.0 / 65536.0);
    }
}
