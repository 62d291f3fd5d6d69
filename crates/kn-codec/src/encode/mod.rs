//! The encoder: frames become a stream.

mod choices;
mod config;
mod cost;
mod decimate;
mod encoder;
mod failure;
mod fault;
mod frame_error;
mod frame_settings;
mod group;
mod labels;
mod motion;
mod named_setting;
mod nodes;
mod preset;
mod quantise;
mod report;
mod scan;
mod sequence;
mod settings;
mod smoothing;
mod translation;
mod tuning;
mod validate;

pub use choices::{
    AffineChoice, CombinationChoice, Decimation, DistortionMeasure, FormError, LabelChoice,
    NodeChoice, NodePlacement, SmoothingChoice, StepChoice, TranslationChoice,
};
pub use config::{
    EncoderConfig, GridChoice, IntraConfig, MotionConfig, RateConfig, SequenceConfig,
};
pub use encoder::{Encoder, Finished};
pub use failure::{EarlierFrames, FailureTuning, FitFailure};
pub use fault::InputFault;
pub use frame_error::FrameError;
pub use named_setting::{NamedSetting, SetError};
pub use preset::Preset;
pub use report::{
    CodedFrame, CostReport, FrameReport, IntraReport, PredictedReport, StepReport, Summary,
};
pub use settings::{Setting, SettingsError};
