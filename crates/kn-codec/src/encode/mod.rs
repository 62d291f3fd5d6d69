//! Frames in, stream out.

mod config;
mod decimate;
mod encoder;
mod group;
mod labels;
mod motion;
mod nodes;
mod preset;
mod quantise;
mod report;
mod sequence;
mod smoothing;
mod translation;

pub use config::{
    AffineChoice, Decimation, EncoderConfig, GridChoice, LabelChoice, NamePattern, NodePlacement,
    SmoothingChoice, TranslationChoice,
};
pub use decimate::GONE;
pub use encoder::{Encoder, Finished};
pub use preset::Preset;
pub use report::{FrameReport, Summary};
