//! Errors of the decoder, with the rule, the bit of the file and the frame.

use super::StreamDecoder;
use crate::error::{DecodeError, DecodeErrorKind};
use crate::intra::IntraError;
use kn_bitstream::rule::{self, Rule};
use kn_bitstream::{Error, ErrorKind};

impl StreamDecoder {
    /// A broken rule at a bit of the file.
    pub(super) fn malformed(&self, rule: Rule, at: u64) -> DecodeError {
        malformed(rule, at, self.frame_in_progress())
    }

    /// The frame that is being decoded; none before the first.
    fn frame_in_progress(&self) -> Option<u64> {
        self.header.as_ref().map(|_| self.decoded)
    }

    /// An error of the bitstream, placed in this file.
    pub(super) fn at(&self, error: Error) -> DecodeError {
        place(error, self.frame_in_progress())
    }

    /// An error of the I-frame's mesh, placed in this file.
    pub(super) fn intra_error(&self, error: IntraError, sections_start: u64) -> DecodeError {
        match error {
            IntraError::Malformed { rule, at } => {
                self.malformed(rule, sections_start + 8 * at as u64)
            }
            IntraError::Limit { what, asked, allowed } => {
                let (asked, allowed) = (u64::from(asked), u64::from(allowed));
                DecodeErrorKind::Limit { what, asked, allowed, at: sections_start }.into()
            }
            // What only an encoder meets.
            IntraError::FaceIndex { .. }
            | IntraError::Outside { .. }
            | IntraError::LabelCount { .. }
            | IntraError::TooLarge { .. } => DecodeErrorKind::Failed.into(),
        }
    }
}

/// The error for a rule that is broken at a bit of the file.
pub(super) fn malformed(rule: Rule, at: u64, frame: Option<u64>) -> DecodeError {
    DecodeErrorKind::Malformed { rule, at, frame }.into()
}

/// The error for an error of the bitstream, whose bit is counted from the start of the file.
pub(super) fn place(error: Error, frame: Option<u64>) -> DecodeError {
    let at = error.bit;
    match error.kind {
        ErrorKind::UnexpectedEnd => malformed(rule::UNIT_SIZE_EXACT, at, frame),
        ErrorKind::Malformed { rule } => malformed(rule, at, frame),
        ErrorKind::Unsupported { rule } => DecodeErrorKind::Unsupported { rule, at, frame }.into(),
        ErrorKind::Limit { what, asked, allowed } => {
            DecodeErrorKind::Limit { what, asked, allowed, at }.into()
        }
    }
}
