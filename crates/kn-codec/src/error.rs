//! Errors of the decoder and the encoder, each with its place and, for streams, its rule.

use kn_bitstream::rule::{FILE_ORDER, FILE_SIGNATURE_VALUE, Rule, UNIT_CRC_MATCH};
use std::fmt;

/// The reason why a stream cannot be decoded. The type is one pointer wide.
#[derive(Debug)]
pub struct DecodeError(Box<DecodeErrorKind>);

/// The kinds of errors. They differ in who can act: the owner of the reader, the author of the
/// stream, the author of a later version, or the caller who sets the limits.
#[derive(Debug)]
#[non_exhaustive]
pub enum DecodeErrorKind {
    /// The reader failed.
    Io(std::io::Error),
    /// The stream breaks a rule of the specification.
    Malformed {
        /// The rule.
        rule: Rule,
        /// Bit in the file at which this shows.
        at: u64,
        /// The frame that was being decoded, where there was one: its place in decode order.
        frame: Option<u64>,
    },
    /// The stream ends before its index: truncated, or still growing.
    Truncated {
        /// Bytes that are there.
        bytes: u64,
        /// Number of whole frames before the end.
        frames: u64,
    },
    /// The stream uses a value that this version reserves.
    Unsupported {
        /// The rule that reserves the value.
        rule: Rule,
        /// Bit in the file at which this shows.
        at: u64,
        /// Index of the frame, where one was being decoded.
        frame: Option<u64>,
    },
    /// The stream asks for more than the caller's [`crate::Limits`] allow.
    Limit {
        /// The quantity that is limited.
        what: &'static str,
        /// The amount that the stream asks for.
        asked: u64,
        /// The amount that is allowed.
        allowed: u64,
        /// Bit in the file.
        at: u64,
    },
    /// A decoded frame differs from the digest that its encoder wrote.
    Digest {
        /// The rule of the digest: of positions or of faces.
        rule: Rule,
        /// Bit in the file at which the frame's unit begins.
        at: u64,
        /// The frame's place in decode order.
        frame: u64,
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
    /// The kind of the error.
    pub fn kind(&self) -> &DecodeErrorKind {
        &self.0
    }

    /// The rule of the specification that is broken, where one is.
    pub fn rule(&self) -> Option<Rule> {
        match *self.0 {
            DecodeErrorKind::Malformed { rule, .. }
            | DecodeErrorKind::Unsupported { rule, .. }
            | DecodeErrorKind::Digest { rule, .. } => Some(rule),
            DecodeErrorKind::Truncated { .. } => Some(FILE_ORDER),
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
                write!(f, "this is not a .knm stream: {FILE_SIGNATURE_VALUE}")
            }
            &Kind::Malformed { rule, at, frame } => {
                let what = match rule {
                    UNIT_CRC_MATCH => "the stream is damaged",
                    _ => "the stream breaks a rule",
                };
                write!(f, "{}{what}: {rule}", Place { frame, at })
            }
            Kind::Truncated { bytes, frames } => {
                let plural = if *frames == 1 { "" } else { "s" };
                write!(
                    f,
                    "the stream ends after {bytes} bytes and {frames} whole frame{plural}, before \
                     its index: {FILE_ORDER}"
                )
            }
            &Kind::Unsupported { rule, at, frame } => {
                let place = Place { frame, at };
                write!(
                    f,
                    "{place}the stream uses a reserved value that this version does not know: {rule}"
                )
            }
            Kind::Limit { what, asked, allowed, at } => {
                write!(f, "bit {at}: the stream asks for {asked} {what}, the limit is {allowed}")
            }
            &Kind::Digest { rule, at, frame } => {
                let place = Place { frame: Some(frame), at };
                write!(f, "{place}the decoded frame is not the encoder's: {rule}")
            }
            Kind::Failed => f.write_str("an earlier error ended the stream"),
            Kind::NoSuchFrame { frame, frames } => {
                write!(f, "there is no frame {frame}; the stream has {frames}")
            }
        }
    }
}

/// The place of an error, as the beginning of its message.
struct Place {
    frame: Option<u64>,
    at: u64,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(frame) = self.frame {
            write!(f, "frame {frame}, ")?;
        }
        write!(f, "bit {}: ", self.at)
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

/// The reason why a sequence cannot be encoded.
#[cfg(feature = "encode")]
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EncodeError {
    /// The writer failed.
    #[error("cannot write the stream: {0}")]
    Io(#[from] std::io::Error),
    /// A frame cannot be coded.
    #[error("frame {frame}: {fault}")]
    Input {
        /// Index of the frame, in the order of pushing.
        frame: u64,
        /// The fault of the frame.
        fault: crate::InputFault,
    },
    /// The encoder has a fault of its own, which this frame shows.
    #[error("frame {frame}: internal error: {message}; please report it with this frame")]
    Internal {
        /// Index of the frame, in the order of pushing.
        frame: u64,
        /// The message of the panic.
        message: String,
    },
    /// The sequence was finished before a frame was pushed.
    #[error("a sequence has at least one frame, and none was pushed")]
    NoFrames,
    /// A setting is out of its range, or settings contradict each other.
    #[error("settings: {0}")]
    Settings(#[from] crate::SettingsError),
}

#[cfg(feature = "encode")]
impl EncodeError {
    /// Index of the frame that the error is about, in the order of pushing; `None` for an error of
    /// the writer, the settings or the whole sequence.
    pub fn frame(&self) -> Option<u64> {
        match self {
            Self::Input { frame, .. } | Self::Internal { frame, .. } => Some(*frame),
            _ => None,
        }
    }

    /// Does the work on a frame. A panic of the work is the error of that frame.
    pub(crate) fn of_frame<T>(
        frame: u64,
        work: impl FnOnce() -> Result<T, Self>,
    ) -> Result<T, Self> {
        kn_mesh::caught(work).unwrap_or_else(|message| Err(Self::Internal { frame, message }))
    }
}
