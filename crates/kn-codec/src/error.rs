//! Errors by who can act on them, with a place and a rule.

use kn_bitstream::rule::{FILE_SIGNATURE_VALUE, UNIT_CRC_MATCH};
use std::fmt;

/// Why a stream cannot be decoded. One word wide.
#[derive(Debug)]
pub struct DecodeError(Box<DecodeErrorKind>);

/// What went wrong, by who can act: the caller's reader, the stream's author, this version, the
/// caller's limits.
#[derive(Debug)]
#[non_exhaustive]
pub enum DecodeErrorKind {
    /// The reader failed.
    Io(std::io::Error),
    /// The stream breaks a rule of the specification.
    Malformed {
        /// Rule id in `spec/`, such as `nodes.count.range`.
        rule: &'static str,
        /// Bit in the file at which this shows.
        at: u64,
        /// Index of the frame, where one was being decoded.
        frame: Option<u64>,
    },
    /// The stream ends before its index: truncated, or still growing.
    Truncated {
        /// Bytes that are there.
        bytes: u64,
        /// Number of whole frames before the end.
        frames: u64,
    },
    /// The stream uses what this version does not know.
    Unsupported {
        /// Rule id of the reserved value.
        rule: &'static str,
        /// Bit in the file.
        at: u64,
    },
    /// The stream asks for more than the caller's [`crate::Limits`] allow.
    Limit {
        /// What there is too much of.
        what: &'static str,
        /// How much the stream asks for.
        asked: u64,
        /// How much is allowed.
        allowed: u64,
        /// Bit in the file.
        at: u64,
    },
    /// A decoded frame differs from the digest that its encoder wrote.
    Digest {
        /// Index of the frame.
        frame: u64,
        /// `positions` or `faces`.
        what: &'static str,
    },
    /// An earlier error ended the stream.
    Failed,
    /// The caller asked for a frame that the stream does not have.
    NoSuchFrame {
        /// The frame asked for.
        frame: u64,
        /// Number of frames in the stream.
        frames: u64,
    },
}

impl DecodeError {
    /// What went wrong.
    pub fn kind(&self) -> &DecodeErrorKind {
        &self.0
    }

    /// The rule of the specification that is broken, where one is.
    pub fn rule(&self) -> Option<&'static str> {
        match *self.0 {
            DecodeErrorKind::Malformed { rule, .. } | DecodeErrorKind::Unsupported { rule, .. } => {
                Some(rule)
            }
            _ => None,
        }
    }
}

impl From<DecodeErrorKind> for DecodeError {
    fn from(kind: DecodeErrorKind) -> Self {
        Self(Box::new(kind))
    }
}

impl From<std::io::Error> for DecodeError {
    fn from(error: std::io::Error) -> Self {
        DecodeErrorKind::Io(error).into()
    }
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use DecodeErrorKind as Kind;
        match &*self.0 {
            Kind::Io(error) => write!(f, "cannot read the stream: {error}"),
            Kind::Malformed { rule: FILE_SIGNATURE_VALUE, .. } => {
                write!(f, "this is not a .knm stream (rule {FILE_SIGNATURE_VALUE})")
            }
            &Kind::Malformed { rule, at, frame } => {
                if let Some(frame) = frame {
                    write!(f, "frame {frame}, ")?;
                }
                match rule {
                    UNIT_CRC_MATCH => write!(
                        f,
                        "bit {at}: damaged: the bytes before do not match their CRC (rule {rule})"
                    ),
                    _ => write!(f, "bit {at}: the stream breaks rule {rule}"),
                }
            }
            Kind::Truncated { bytes, frames } => {
                let plural = if *frames == 1 { "" } else { "s" };
                write!(
                    f,
                    "the stream ends after {bytes} bytes and {frames} whole frame{plural}, before \
                     its index (rule file.order)"
                )
            }
            Kind::Unsupported { rule, at } => {
                write!(
                    f,
                    "bit {at}: a reserved value that this version does not know (rule {rule})"
                )
            }
            Kind::Limit { what, asked, allowed, at } => {
                write!(f, "bit {at}: {asked} {what}, more than the allowed {allowed}")
            }
            Kind::Digest { frame, what } => {
                write!(f, "frame {frame}: the decoded {what} do not match the stream's digest")
            }
            Kind::Failed => f.write_str("an earlier error ended the stream"),
            Kind::NoSuchFrame { frame, frames } => {
                write!(f, "there is no frame {frame}; the stream has {frames}")
            }
        }
    }
}

impl std::error::Error for DecodeError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &*self.0 {
            DecodeErrorKind::Io(error) => Some(error),
            _ => None,
        }
    }
}

/// Why a sequence cannot be encoded.
#[cfg(feature = "encode")]
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EncodeError {
    /// The writer failed.
    #[error("cannot write the stream: {0}")]
    Io(#[from] std::io::Error),
    /// A frame cannot be coded.
    #[error("frame {frame}: {reason}")]
    Input {
        /// Index of the frame, in the order of pushing.
        frame: u64,
        /// What is wrong with it.
        reason: String,
    },
    /// The configuration contradicts itself.
    #[error("configuration: {0}")]
    Config(String),
}
