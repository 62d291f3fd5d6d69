//! Settings of the encoder that no stream carries: numbers, and `auto` for a choice by the encoder.

use std::fmt;
use std::str::FromStr;

/// The error for a text that is not a form of a setting. The message names the forms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct FormError(&'static str);

/// The decimation of I-frames. P-frames then deform the coarser mesh.
///
/// Text forms of the first two are `5000` and `25%`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Decimation {
    /// At most this number of faces, as far as topology allows.
    Faces(u32),
    /// At most this share of the faces, between 0 and 1.
    Share(f64),
    /// The largest distance from a vertex of the scan to the decimated surface, in world units.
    Error(f64),
}

impl FromStr for Decimation {
    type Err = FormError;

    fn from_str(text: &str) -> Result<Self, FormError> {
        let share = text.strip_suffix('%').map(|percent| percent.parse::<f64>());
        match (share, text.parse()) {
            (Some(Ok(percent)), _) => Ok(Self::Share(percent / 100.0)),
            (None, Ok(faces)) => Ok(Self::Faces(faces)),
            _ => Err(FormError("give a number of faces such as 5000, or a share such as 25%")),
        }
    }
}

impl fmt::Display for Decimation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Faces(faces) => write!(f, "{faces}"),
            Self::Share(share) => write!(f, "{}%", 100.0 * share),
            Self::Error(error) => write!(f, "error of {error}"),
        }
    }
}

/// The choice of a quantiser step. Text forms are `auto` and a number of grid steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepChoice {
    /// This number of grid steps.
    Fixed(f64),
    /// In every P-frame the steps of least J, for translations, for rotations, and for scales and
    /// shears.
    Cost,
}

impl FromStr for StepChoice {
    type Err = FormError;

    fn from_str(text: &str) -> Result<Self, FormError> {
        match text.parse() {
            _ if is_auto(text) => Ok(Self::Cost),
            Ok(step) => Ok(Self::Fixed(step)),
            Err(_) => Err(FormError("give auto, or a motion step in grid steps")),
        }
    }
}

impl fmt::Display for StepChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fixed(step) => write!(f, "{step}"),
            Self::Cost => f.write_str(AUTO),
        }
    }
}

/// The choice of the number of key nodes of a GoF. Text forms are `auto` and a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeChoice {
    /// This number, 1 to 4096.
    Fixed(usize),
    /// The number of nodes that pay for their bytes: each lowers J = D + λR of the GoF's key frame.
    ///
    /// There is at least one node for every region, and at most one for 60 vertices of the I-frame.
    /// There are 150 nodes, or `most` if that is less, where nodes are spread evenly or no frame
    /// can be tracked.
    Cost {
        /// The largest number, 1 to 4096.
        most: usize,
    },
}

impl NodeChoice {
    /// The largest number of nodes that a GoF can have.
    pub fn most(self) -> usize {
        match self {
            Self::Fixed(count) | Self::Cost { most: count } => count,
        }
    }
}

impl Default for NodeChoice {
    fn default() -> Self {
        Self::Cost { most: 512 }
    }
}

impl From<usize> for NodeChoice {
    fn from(count: usize) -> Self {
        Self::Fixed(count)
    }
}

impl FromStr for NodeChoice {
    type Err = FormError;

    fn from_str(text: &str) -> Result<Self, FormError> {
        match text.parse() {
            _ if is_auto(text) => Ok(Self::default()),
            Ok(count) => Ok(Self::Fixed(count)),
            Err(_) => Err(FormError("give auto, or a number of key nodes such as 150")),
        }
    }
}

impl fmt::Display for NodeChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fixed(count) => write!(f, "{count}"),
            Self::Cost { .. } => f.write_str(AUTO),
        }
    }
}

/// The choice of the strength of smoothing, which moves the vertices of an I-frame by at most half
/// a grid step. Text forms are `auto` and a strength.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SmoothingChoice {
    /// The greatest strength that leaves the decoded surface as near to the scan, within 3 %.
    Auto,
    /// This strength, 0 to 5. With 0 the decoded positions are exactly the quantised ones.
    Strength(u8),
}

impl FromStr for SmoothingChoice {
    type Err = FormError;

    fn from_str(text: &str) -> Result<Self, FormError> {
        match text.parse() {
            _ if is_auto(text) => Ok(Self::Auto),
            Ok(strength) => Ok(Self::Strength(strength)),
            Err(_) => Err(FormError("give auto, or a strength from 0 to 5")),
        }
    }
}

impl fmt::Display for SmoothingChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str(AUTO),
            Self::Strength(strength) => write!(f, "{strength}"),
        }
    }
}

/// The text form of a choice that the encoder makes. It is read in any case, since help texts write
/// it in capitals.
const AUTO: &str = "auto";

fn is_auto(text: &str) -> bool {
    text.eq_ignore_ascii_case(AUTO)
}
