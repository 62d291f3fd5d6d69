//! Frames in, stream out.

mod choices;
mod config;
mod cost;
mod decimate;
mod encoder;
mod failure;
mod frame_settings;
mod group;
mod labels;
mod motion;
mod nodes;
mod preset;
mod quantise;
mod report;
mod scan;
mod sequence;
mod smoothing;
mod translation;
mod tuning;

pub use choices::{
    AffineChoice, CombinationChoice, Decimation, DistortionMeasure, FormError, LabelChoice,
    NodeChoice, NodePlacement, SmoothingChoice, StepChoice, TranslationChoice,
};
pub use config::{EncoderConfig, GridChoice};
pub use encoder::{Encoder, Finished};
pub use failure::{EarlierFrames, FailureTuning, FitFailure};
pub use preset::Preset;
pub use report::{CostReport, FrameReport, StepReport, Summary};
