//! From fitted transforms to quantised motion: steps, values, tables.

use crate::decode::transforms::{parameter_step, translation_step};
use kn_bitstream::{MotionFrame, best_table};
use kn_deform::{Combination, NodeTransform};

/// Quantiser steps of a frame, as indices of the specification's families of steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Steps {
    pub(crate) translation: u8,
    pub(crate) rotation: u8,
    pub(crate) scale: u8,
    pub(crate) shear: u8,
}

impl Steps {
    /// Steps whose errors move vertices equally far.
    ///
    /// `translation` in reference units; `reach` is the distance over which a node moves vertices,
    /// in reference units: an angle's or a shear's error grows with it.
    pub(crate) fn balanced(translation: f64, reach: f64) -> Self {
        let parameter = nearest(translation / reach.max(1.0), parameter_step);
        Self {
            translation: nearest(translation, |index| translation_step(index) as f64),
            rotation: parameter,
            scale: parameter,
            shear: parameter,
        }
    }
}

/// The index whose step is nearest to `wanted`, the lowest of equals.
fn nearest(wanted: f64, step: impl Fn(u8) -> f64) -> u8 {
    let error = |index: &u8| (step(*index) - wanted).abs();
    (0..64).min_by(|a, b| error(a).total_cmp(&error(b))).unwrap_or(0)
}

/// Largest quantised value that a Huffman code carries.
const MAX_VALUE: f64 = ((1 << 20) - 1) as f64;
/// Angles, shears and scales stay inside the decoder's bounds by this much.
const ANGLE_BOUND: f64 = 3.9;
const SHEAR_BOUND: f64 = 7.9;
const SCALE_BOUNDS: (f64, f64) = (0.1, 7.9);

/// Writes the quantised transforms (`#N`, in reference units) into `motion` and chooses the
/// Huffman tables. `affine` has one entry per node.
pub(crate) fn quantise_motion(
    transforms: &[NodeTransform],
    affine: &[bool],
    combination: Combination,
    steps: Steps,
    motion: &mut MotionFrame,
) {
    let any_affine = affine.contains(&true);
    motion.rotation_enabled = combination.rotation && any_affine;
    motion.scale_enabled = combination.scale && any_affine;
    motion.shear_enabled = combination.shear && any_affine;
    motion.translation_step = steps.translation;
    motion.rotation_step = steps.rotation;
    motion.scale_step = steps.scale;
    motion.shear_step = steps.shear;
    motion.translations.clear();
    motion.rotations.clear();
    motion.scales.clear();
    motion.shears.clear();
    let t_step = translation_step(steps.translation) as f64;
    for (transform, &affine) in transforms.iter().zip(affine) {
        motion.translations.push(transform.translation.map(|t| quantised(t, t_step)));
        if !affine || motion.rotation_enabled {
            let step = parameter_step(steps.rotation);
            motion.rotations.push(transform.rotation.map(|angle| {
                quantised(wrapped(angle).clamp(-ANGLE_BOUND, ANGLE_BOUND), step)
            }));
        }
        if affine && motion.scale_enabled {
            let step = parameter_step(steps.scale);
            motion.scales.push(transform.scale.map(|s| quantised_scale(s, step)));
        }
        if affine && motion.shear_enabled {
            let step = parameter_step(steps.shear);
            let bounded = |h: f64| quantised(h.clamp(-SHEAR_BOUND, SHEAR_BOUND), step);
            motion.shears.push(transform.shear.map(bounded));
        }
    }
    choose_tables(motion);
}

/// The tables that cost the fewest bits: one for T, one for P = [R', S', H'].
fn choose_tables(motion: &mut MotionFrame) {
    motion.translation_table = best_table(motion.translations.as_flattened()).0;
    let parameters: Vec<i32> = [&motion.rotations, &motion.scales, &motion.shears]
        .into_iter()
        .flat_map(|list| list.as_flattened().iter().copied())
        .collect();
    motion.parameter_table = best_table(&parameters).0;
}

fn quantised(value: f64, step: f64) -> i32 {
    (value / step).round().clamp(-MAX_VALUE, MAX_VALUE) as i32
}

/// S' = S − 1, so that 1 + q·step stays inside the bounds of the decoder.
fn quantised_scale(scale: f64, step: f64) -> i32 {
    let q = quantised(scale.clamp(SCALE_BOUNDS.0, SCALE_BOUNDS.1) - 1.0, step);
    if 1.0 + f64::from(q) * step > 0.0 { q } else { q + 1 }
}

/// The same angle in [−π, π].
fn wrapped(angle: f64) -> f64 {
    let turn = 2.0 * std::f64::consts::PI;
    angle - turn * (angle / turn).round()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_balance_translation_and_rotation() {
        let steps = Steps::balanced(256.0, 256.0 * 64.0);
        assert_eq!(translation_step(steps.translation), 256);
        assert_eq!(parameter_step(steps.rotation), 1.0 / 64.0);
    }

    #[test]
    fn what_is_quantised_stays_in_range() {
        let wild = NodeTransform {
            rotation: [7.0, -9.0, 1e9],
            scale: [-3.0, 1e9, 0.0],
            shear: [1e9, -1e9, 0.0],
            translation: [1.0; 3],
        };
        let mut motion = MotionFrame::default();
        let mut decoded = Vec::new();
        for index in [0, 40, 63] {
            let steps = Steps { translation: 0, rotation: index, scale: index, shear: index };
            quantise_motion(&[wild], &[true], Combination::RTSH, steps, &mut motion);
            let result = crate::decode::transforms::decode_transforms(&motion, &[true], &mut decoded);
            assert_eq!(result, Ok(()), "step {index}");
        }
    }
}
