//! Stream in, frames out.

mod files;
mod key_nodes;
mod nearest;
mod reconstruction;
mod stream;
mod transforms;

pub use files::Decoder;
pub use stream::{FrameInfo, FrameKind, Progress, StreamDecoder};

#[cfg(feature = "encode")]
pub(crate) use reconstruction::Reconstruction;
