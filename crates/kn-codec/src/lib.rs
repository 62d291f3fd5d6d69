//! Encoder and decoder of the kn codec: what an application embeds.
//!
//! The decoder is normative, safe on untrusted input and bit-exact. The encoder (feature `encode`,
//! on by default) owns the decoder's reconstruction and calls it for its reference, so that there
//! is one copy of every decoding step.
//!
//! An application depends on this crate alone: [`Mesh`] is here, and [`params`] is the vocabulary
//! of settings and headers.
//!
//! # A complete encoder
//!
#![cfg_attr(feature = "encode", doc = "```")]
#![cfg_attr(not(feature = "encode"), doc = "```ignore")]
//! use kn_codec::params::{FrameRate, UnitOfLength};
//! use kn_codec::{Encoder, EncoderConfig, Mesh};
//!
//! fn encode(scans: &[Mesh]) -> Result<Vec<u8>, kn_codec::EncodeError> {
//!     let config = EncoderConfig::default()
//!         .with_bits(11)
//!         .with_frame_rate(FrameRate::new(25, 1))
//!         .with_unit(UnitOfLength::Metre);
//!     let mut encoder = Encoder::new(Vec::new(), config)?;
//!     for scan in scans {
//!         encoder.push(scan)?;
//!     }
//!     Ok(encoder.finish()?.writer)
//! }
//!
//! let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
//! let stream = encode(&[Mesh::new(corners, faces)])?;
//! # assert!(!stream.is_empty());
//! # Ok::<(), kn_codec::EncodeError>(())
//! ```
//!
//! # A complete decoder
//!
//! ```
//! use kn_codec::{DecodeError, Decoder, Mesh};
//! use std::io::{Read, Seek};
//!
//! fn decode(stream: impl Read + Seek) -> Result<(), DecodeError> {
//!     let mut decoder = Decoder::new(stream)?;
//!     // One mesh whose buffers are used for every frame.
//!     let mut mesh = Mesh::default();
//!     while let Some(frame) = decoder.next_frame(&mut mesh)? {
//!         println!("frame {}: {} vertices", frame.index, mesh.positions.len());
//!     }
//!     Ok(())
//! }
//!
//! let error = decode(std::io::Cursor::new(b"no stream")).expect_err("it is none");
//! println!("{error}");
//! ```

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
    FrameError, FrameReport, GridChoice, InputFault, IntraConfig, IntraReport, LabelChoice,
    MotionConfig, NamedSetting, NodeChoice, NodePlacement, PredictedReport, Preset, RateConfig,
    SequenceConfig, SetError, Setting, SettingsError, SmoothingChoice, StepChoice, StepReport,
    Summary, TranslationChoice,
};

#[cfg(feature = "encode")]
pub use error::EncodeError;
#[cfg(feature = "encode")]
pub use kn_fit::PartStart;
#[cfg(feature = "encode")]
pub use kn_mesh::DROPPED;
