//! Encoder and decoder of the kn codec: what an application embeds.
//!
//! The decoder is normative, safe on untrusted input and bit-exact; the encoder (feature `encode`,
//! on by default) owns the decoder's reconstruction and calls it for its reference, so that there
//! is one copy of every decoding step.

mod decode;
pub mod digest;
mod error;
pub mod intra;
mod limits;
mod order;

pub use decode::{Decoder, FrameInfo, FrameKind, Progress, StreamDecoder};
pub use error::{DecodeError, DecodeErrorKind};
pub use kn_bitstream::params;
pub use kn_mesh::{BoundingBox, Grid, Mesh};
pub use limits::Limits;

#[cfg(feature = "encode")]
mod encode;
#[cfg(feature = "encode")]
pub use encode::{
    AffineChoice, CodedFrame, CombinationChoice, CostReport, Decimation, DistortionMeasure,
    EarlierFrames, Encoder, EncoderConfig, FailureTuning, Finished, FitFailure, FormError,
    FrameReport, GridChoice, IntraConfig, IntraReport, LabelChoice, MotionConfig, NodeChoice,
    NodePlacement, PredictedReport, Preset, RateConfig, SequenceConfig, Setting, SettingsError,
    SmoothingChoice, StepChoice, StepReport, Summary, TranslationChoice,
};

#[cfg(feature = "encode")]
pub use error::EncodeError;
#[cfg(feature = "encode")]
pub use kn_fit::PartStart;
#[cfg(feature = "encode")]
pub use kn_mesh::DROPPED;
