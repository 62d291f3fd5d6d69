//! Decode order and display order.

/// The place of a frame in decode order and in display order, both counted from 0. They are equal
/// in streams of this version. A version that decodes a later frame of a GoF first, so that those
/// before it can refer to it, would tell them apart here: GoFs are closed and keep their order, so
/// that the numbers of a GoF's frames are the same set in both orders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FrameNumbers {
    /// Place in the stream: number of frames that are decoded before.
    pub(crate) decode: u64,
    /// Place in the sequence: number of frames that are shown before.
    pub(crate) display: u64,
}

impl FrameNumbers {
    /// The numbers of a frame that is shown in the order of decoding.
    pub(crate) fn in_order(number: u64) -> Self {
        Self { decode: number, display: number }
    }
}
