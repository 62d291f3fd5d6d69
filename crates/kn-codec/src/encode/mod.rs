//! Frames in, stream out.

mod config;
mod encoder;
mod group;
mod motion;
mod nodes;
mod quantise;
mod report;
mod sequence;

pub use config::{AffineChoice, EncoderConfig, GridChoice, NamePattern, NodePlacement};
pub use encoder::{Encoder, Finished};
pub use report::{FrameReport, Summary};
