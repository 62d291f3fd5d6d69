//! Errors of a stream, with their place.

use crate::rule::{self, Rule};

/// An error of a stream, with the bit at which reading stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Error {
    /// The kind of the error.
    pub kind: ErrorKind,
    /// Offset of the bit, counted from where the reader counts (see [`crate::BitReader::at`]).
    pub bit: u64,
}

/// The kinds of errors. They differ in who can act.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The bytes end inside a syntax element: the data is cut short.
    UnexpectedEnd,
    /// The stream breaks a rule of the specification.
    Malformed {
        /// The rule.
        rule: Rule,
    },
    /// The stream uses a value that this version of the specification reserves.
    Unsupported {
        /// The rule that reserves the value.
        rule: Rule,
    },
    /// The stream may be sound but asks for more than the caller allows.
    Limit {
        /// The quantity that is limited.
        what: &'static str,
        /// The amount that the stream asks for.
        asked: u64,
        /// The amount that the caller allows.
        allowed: u64,
    },
}

impl Error {
    /// The error for a rule that is broken at a bit offset.
    pub fn malformed(rule: Rule, bit: u64) -> Self {
        Self { kind: ErrorKind::Malformed { rule }, bit }
    }

    /// The error for a reserved value at a bit offset.
    pub fn unsupported(rule: Rule, bit: u64) -> Self {
        Self { kind: ErrorKind::Unsupported { rule }, bit }
    }

    /// The rule that is broken, `None` for the caller's own limits.
    ///
    /// Inside a unit an unexpected end means that the structure is larger than its `unit_size`.
    pub fn rule(&self) -> Option<Rule> {
        match self.kind {
            ErrorKind::UnexpectedEnd => Some(rule::UNIT_SIZE_EXACT),
            ErrorKind::Malformed { rule } | ErrorKind::Unsupported { rule } => Some(rule),
            ErrorKind::Limit { .. } => None,
        }
    }
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "bit {}: {}", self.bit, self.kind)
    }
}

impl std::fmt::Display for ErrorKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match *self {
            Self::UnexpectedEnd => f.write_str("the data ends inside a syntax element"),
            Self::Malformed { rule } => write!(f, "the stream breaks a rule: {rule}"),
            Self::Unsupported { rule } => {
                write!(
                    f,
                    "the stream uses a reserved value that this version does not know: {rule}"
                )
            }
            Self::Limit { what, asked, allowed } => {
                write!(f, "the stream asks for {asked} {what}, {allowed} are allowed")
            }
        }
    }
}

impl std::error::Error for Error {}
