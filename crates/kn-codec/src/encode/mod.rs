//! Frames in, stream out.

mod config;

pub use config::{AffineChoice, EncoderConfig, GridChoice, NamePattern, UnitOfLength};
