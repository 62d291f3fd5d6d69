//! The decoder: streams become frames.

mod files;
mod frame_info;
mod key_nodes;
mod nearest;
mod node_graph;
mod path;
mod reconstruction;
mod references;
mod stream;
mod transforms;
mod translation;

pub use files::Decoder;
pub use frame_info::{FrameInfo, FrameKind};
pub use stream::{Progress, StreamDecoder};

#[cfg(all(test, feature = "encode"))]
pub(crate) use path::Visit;
#[cfg(feature = "encode")]
pub(crate) use reconstruction::Reconstruction;
#[cfg(feature = "encode")]
pub(crate) use references::Slot;
#[cfg(feature = "encode")]
pub(crate) use translation::Translations;
