//! Quantisation of fitted transforms: the steps, and rotations, scales and shears.

use crate::encode::choices::StepChoice;
use crate::encode::frame_settings::Quantisers;
use crate::encode::tuning::StepTuning;
use kn_bitstream::params::Combination;
use kn_bitstream::{HUFFMAN_VALUE_LIMIT, MotionFrame, ValueList, parameter_step, translation_step};
use kn_deform::NodeTransform;

/// Quantiser steps of a frame, as indices of the specification's families of steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Steps {
    pub(crate) translation: u8,
    pub(crate) rotation: u8,
    pub(crate) scale: u8,
    pub(crate) shear: u8,
}

/// Components whose steps are chosen together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StepComponents {
    Translation,
    Rotation,
    Stretch,
}

impl Steps {
    /// The steps nearest to those of `quantisers`.
    ///
    /// `reach` is the distance over which a node moves vertices, in reference units: an angle's, a
    /// scale's or a shear's error grows with it. `unit` is a grid step in reference units.
    pub(crate) fn new(quantisers: &Quantisers, tuning: &StepTuning, unit: f64, reach: f64) -> Self {
        let motion = match quantisers.motion {
            StepChoice::Fixed(step) => step,
            StepChoice::Cost => tuning.usual,
        };
        let parameter = |step: Option<f64>, default: f64| {
            let moved = step.unwrap_or(default * motion) * unit;
            nearest(moved / reach.max(1.0) * ONE, parameter_step)
        };
        Self {
            translation: nearest(motion * unit, translation_step),
            rotation: parameter(quantisers.rotation, 1.0),
            scale: parameter(quantisers.scale, tuning.stretch),
            shear: parameter(quantisers.shear, tuning.stretch),
        }
    }
}

/// The range in which steps are searched.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepRange {
    pub(crate) quantisers: Quantisers,
    /// The steps where the search begins in every GoF.
    pub(crate) usual: Steps,
    /// Largest distance of a step from them, as a number of indices.
    pub(crate) farthest: u8,
}

impl StepRange {
    /// `steps` with those of some components `by` indices coarser; `None` where the settings fix
    /// them or where that is out of range.
    pub(crate) fn coarser(
        &self,
        steps: Steps,
        components: StepComponents,
        by: i8,
    ) -> Option<Steps> {
        let Self { quantisers, usual, farthest } = self;
        if quantisers.motion != StepChoice::Cost {
            return None;
        }
        let moved = |step: u8, fixed: Option<f64>, usual: u8| match fixed {
            Some(_) => Some(step),
            None => {
                let step = step.checked_add_signed(by).filter(|&step| step < 64)?;
                (step.abs_diff(usual) <= *farthest).then_some(step)
            }
        };
        let changed = match components {
            StepComponents::Translation => {
                let translation = moved(steps.translation, None, usual.translation)?;
                Steps { translation, ..steps }
            }
            StepComponents::Rotation => {
                let rotation = moved(steps.rotation, quantisers.rotation, usual.rotation)?;
                Steps { rotation, ..steps }
            }
            StepComponents::Stretch => Steps {
                scale: moved(steps.scale, quantisers.scale, usual.scale)?,
                shear: moved(steps.shear, quantisers.shear, usual.shear)?,
                ..steps
            },
        };
        (changed != steps).then_some(changed)
    }
}

/// The index whose step is nearest to `wanted`, the lowest of equals.
fn nearest(wanted: f64, step: impl Fn(u8) -> i64) -> u8 {
    let error = |index: &u8| (step(*index) as f64 - wanted).abs();
    (0..64).min_by(|a, b| error(a).total_cmp(&error(b))).unwrap_or(0)
}

/// 1 in units of the parameter steps.
const ONE: f64 = 65536.0;
/// Largest quantised value that a Huffman code carries.
const MAX_VALUE: f64 = (HUFFMAN_VALUE_LIMIT - 1) as f64;
/// The encoder's bound of angles: inside the decoder's bound by more than half a step.
const ANGLE_BOUND: f64 = 3.2;
const STRETCH_BOUND: f64 = 4.0;
const SCALE_BOUNDS: (f64, f64) = (0.1, 4.0);

/// Writes the quantised rotations, scales and shears of `transforms` (`#N`) into `motion` and
/// chooses their Huffman table. `affine` has one entry per node.
pub(crate) fn quantise_parameters(
    transforms: &[NodeTransform],
    affine: &[bool],
    combination: Combination,
    steps: Steps,
    motion: &mut MotionFrame,
) {
    let any_affine = affine.contains(&true);
    let carried = |component: bool| component && any_affine;
    motion.enabled = Combination {
        rotation: carried(combination.rotation),
        scale: carried(combination.scale),
        shear: carried(combination.shear),
    };
    motion.rotation.clear();
    motion.scale.clear();
    motion.shear.clear();
    let [r_step, s_step, h_step] = [steps.rotation, steps.scale, steps.shear].map(unit_step);
    for (transform, &affine) in transforms.iter().zip(affine) {
        if !affine || motion.enabled.rotation {
            let angle = |angle: f64| quantised(wrapped(angle), r_step, ANGLE_BOUND);
            motion.rotation.push(transform.rotation.map(angle));
        }
        if affine && motion.enabled.scale {
            motion.scale.push(transform.scale.map(|s| quantised_scale(s, s_step)));
        }
        if affine && motion.enabled.shear {
            motion.shear.push(transform.shear.map(|h| quantised(h, h_step, STRETCH_BOUND)));
        }
    }
    let used = |index: u8, list: &[[i32; 3]]| if list.is_empty() { 0 } else { index };
    motion.rotation_step = used(steps.rotation, &motion.rotation);
    motion.scale_step = used(steps.scale, &motion.scale);
    motion.shear_step = used(steps.shear, &motion.shear);
    // One table for P = [R', S', H'].
    let parameters = [
        (ValueList::Rotation, &motion.rotation[..]),
        (ValueList::Scale, &motion.scale),
        (ValueList::Shear, &motion.shear),
    ];
    motion.parameter_table = motion.entropy_mode.best_table(&parameters).0;
}

/// The quantiser step of an index, as a number.
pub(crate) fn unit_step(index: u8) -> f64 {
    parameter_step(index) as f64 / ONE
}

/// Quantises a value to the nearest step. Of two the upper is taken, so that a prediction by whole
/// steps does not change the result. Where the nearest would be beyond `bound` or the code, the
/// value is rounded towards zero.
pub(crate) fn quantised(value: f64, step: f64, bound: f64) -> i32 {
    let most = (bound / step).floor().min(MAX_VALUE);
    // A NaN, which no fit should give, becomes zero.
    (value / step + 0.5).floor().clamp(-most, most) as i32
}

/// Quantises S' = S − 1. The scale stays positive.
fn quantised_scale(scale: f64, step: f64) -> i32 {
    let q = quantised(scale.clamp(SCALE_BOUNDS.0, SCALE_BOUNDS.1) - 1.0, step, STRETCH_BOUND);
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
    use crate::decode::Translations;
    use crate::encode::choices::TranslationChoice;
    use crate::encode::translation::code_translations;
    use kn_bitstream::{BitReader, BitWriter, MotionContext, translation_step};

    const FREE: Quantisers =
        Quantisers { motion: StepChoice::Cost, rotation: None, scale: None, shear: None };

    fn steps(quantisers: &Quantisers) -> Steps {
        Steps::new(quantisers, &StepTuning::default(), 256.0, 256.0 * 64.0)
    }

    #[test]
    fn steps_move_vertices_as_far_as_told() {
        let told = Quantisers { motion: StepChoice::Fixed(1.0), shear: Some(4.0), ..FREE };
        let steps = steps(&told);
        assert_eq!(translation_step(steps.translation), 256);
        assert_eq!(unit_step(steps.rotation), 1.0 / 64.0);
        assert_eq!(unit_step(steps.shear), 1.0 / 16.0);
    }

    #[test]
    fn only_steps_by_cost_are_changed() {
        let by_cost = Quantisers { scale: Some(4.0), ..FREE };
        let usual = steps(&by_cost);
        let range = StepRange { quantisers: by_cost, usual, farthest: 12 };
        let stretch = range.coarser(usual, StepComponents::Stretch, 2).expect("shear is free");
        assert_eq!((stretch.scale, stretch.shear), (usual.scale, usual.shear + 2));
        assert_eq!(range.coarser(usual, StepComponents::Translation, 13), None);
        let fixed = Quantisers { motion: StepChoice::Fixed(2.0), ..by_cost };
        let range = StepRange { quantisers: fixed, ..range };
        assert_eq!(range.coarser(usual, StepComponents::Rotation, 2), None);
    }

    #[test]
    fn whatever_is_quantised_can_be_read() {
        let wild = NodeTransform {
            rotation: [7.0, -9.0, 1e9],
            scale: [-3.0, 1e9, f64::NAN],
            shear: [1e9, -1e9, 0.0],
            translation: [1.0, 1e30, -1e30],
        };
        let mut before = Translations::default();
        before.begin(&[0; 2], Vec::new());
        let mut motion = MotionFrame::default();
        for index in 0..64 {
            let steps = Steps { translation: index, rotation: index, scale: index, shear: index };
            quantise_parameters(&[wild; 2], &[true, false], Combination::RTSH, steps, &mut motion);
            let (choice, limit) = (TranslationChoice::Direct, 1 << 20);
            code_translations(&[wild; 2], &before, choice, index, limit, &mut motion);
            let mut bits = BitWriter::new();
            let context = MotionContext { node_count: 2, affine_count: 1, ..Default::default() };
            motion.write(&mut bits, &context);
            let mut read = MotionFrame::default();
            let bytes = bits.into_bytes();
            read.read(&mut BitReader::new(&bytes), &context).expect("in range");
            assert_eq!(read, motion, "step {index}");
        }
    }
}
