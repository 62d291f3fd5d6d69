//! Settings of a single frame: λ and quantisers.

use crate::encode::choices::StepChoice;
use crate::encode::config::EncoderConfig;

/// A P-frame's place in its GoF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FramePlace {
    /// Number of P-frames of the GoF that are coded before it.
    pub(crate) number: usize,
    /// Number of P-frames of the GoF.
    pub(crate) of: usize,
}

/// Settings of a P-frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FrameSettings {
    /// λ of J = D + λR where the frame alone pays: its quantiser steps.
    pub(crate) lambda: f64,
    /// λ where components are chosen. What a motion leaves unexplained stays so in the frames after
    /// it, so a byte counts for less where many follow.
    pub(crate) component_lambda: f64,
    /// Its quantiser steps.
    pub(crate) quantisers: Quantisers,
}

/// The choices of the quantiser steps of a P-frame, from the settings of the same names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Quantisers {
    pub(crate) motion: StepChoice,
    pub(crate) rotation: Option<f64>,
    pub(crate) scale: Option<f64>,
    pub(crate) shear: Option<f64>,
}

/// λ and quantisers of a P-frame. The one place where they are taken from the settings of the
/// sequence: a control of the rate gives every frame its own here.
pub(crate) fn frame_settings(config: &EncoderConfig, place: FramePlace) -> FrameSettings {
    let left = place.of.saturating_sub(place.number);
    // On average in half of the frames that are left, this one among them.
    let inherited = 2.0 / (left + 1) as f64;
    FrameSettings {
        lambda: config.rate.lambda,
        component_lambda: config.rate.lambda * inherited,
        quantisers: Quantisers {
            motion: config.motion.translation_step,
            rotation: config.motion.rotation_step,
            scale: config.motion.scale_step,
            shear: config.motion.shear_step,
        },
    }
}

/// λ by which the key nodes of a GoF are chosen: they count for all its P-frames.
pub(crate) fn node_lambda(config: &EncoderConfig) -> f64 {
    config.rate.lambda
}
