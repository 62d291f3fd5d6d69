//! Finds the body parts of a scanned person without a learned model.
//!
//! A jointed body of capsules is registered to each frame. It starts from the last frame's pose, or
//! in the first frame from a template in several poses. Toes, knees and elbows tell the front from
//! the back, and so left from right; the evidence is summed over the frames. Each vertex gets the
//! body part of the closest capsule. The labels are smoothed over the surface and kept close to
//! those of the last frame, which move with the bones. Hanging cloth belongs to the torso, a held
//! object is [`OTHER`], and a part that cannot be told from the torso joins it.
//!
//! Nothing here is normative. The same frames give the same labels for any number of threads.

mod body;
mod check;
mod confidence;
mod error;
mod fit;
mod hem;
mod label;
mod memory;
mod object;
mod pieces;
mod side;
mod solve;
mod start;
mod surface;
#[cfg(test)]
mod tests;
mod track;

use kn_bitstream::params::BodyPart;

pub use check::{LabelWarning, check_labels};
pub use error::SegmentError;
pub use track::{SegmentOptions, SegmentWarning, Segmentation, Segmenter};

type V3 = nalgebra::Vector3<f64>;

/// Number of labels: the paper's 14 body parts and [`OTHER`].
pub const LABELS: usize = BodyPart::COUNT;
/// Label of the torso. Head and arms come before it, the legs after it.
pub const TORSO: u8 = BodyPart::Torso.label();
/// Label of what is not a body part.
pub const OTHER: u8 = BodyPart::Other.label();
