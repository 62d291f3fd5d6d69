//! Settings of the encoder that no stream carries: choices by name.

use kn_bitstream::impl_named;
use kn_bitstream::params::{BodyPart, Combination, NameError, Named};
use std::fmt;
use std::str::FromStr;
use strum::{AsRefStr, Display, EnumMessage, VariantArray};

impl_named! {
    LabelChoice: "label choice",
    DistortionMeasure: "distortion measure",
    NodePlacement: "placement of key nodes",
    TranslationChoice: "prediction of translations",
}

/// The source of the labels of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, AsRefStr, EnumMessage, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum LabelChoice {
    /// The frames' own labels; a sequence without labels is coded without labels.
    Given,
    /// The frames' own labels; where they have none, those that the segmentation finds.
    ///
    /// The segmentation is [`kn_segment::Segmenter`].
    /// Frames in which the segmentation does not find a person are coded as if they had no labels.
    Auto,
}

/// The choice of the affine key nodes. The others are rigid.
#[derive(Clone, Debug, PartialEq, Eq, AsRefStr, Display, EnumMessage)]
#[strum(serialize_all = "kebab-case")]
pub enum AffineChoice {
    /// All nodes are rigid.
    None,
    /// The nodes of these body parts, by default of the torso; no node where frames have no labels.
    Labels(Vec<BodyPart>),
    /// The nodes whose scales and shears pay for their bytes, with labels or without.
    ///
    /// They lower J in the key frame of their GoF.
    Cost,
    /// All nodes are affine.
    All,
}

impl AffineChoice {
    /// The bi-modal paper's choice: the nodes of the torso.
    pub fn torso() -> Self {
        Self::Labels(vec![BodyPart::Torso])
    }
}

impl Named for AffineChoice {
    const KIND: &'static str = "choice of affine nodes";

    fn all() -> Vec<Self> {
        vec![Self::None, Self::torso(), Self::Cost, Self::All]
    }
}

impl FromStr for AffineChoice {
    type Err = NameError;

    /// Parses the name of a choice. `labels` means [`Self::torso`].
    fn from_str(text: &str) -> Result<Self, NameError> {
        Self::of_name(text)
    }
}

/// The choice of the components of affine nodes: the combination of least J = D + λR (bi-modal
/// paper, section on rate-distortion optimization). Components that are not chosen are not fitted
/// either.
#[derive(Clone, Copy, Debug, PartialEq, Eq, AsRefStr, EnumMessage)]
#[strum(serialize_all = "kebab-case")]
pub enum CombinationChoice {
    /// This combination in every P-frame.
    Fixed(Combination),
    /// By the first P-frame of each GoF for the whole GoF, as in the paper.
    ///
    /// It is chosen among the combinations with rotation: one frame does not show what the others
    /// lose in a chain of frames (`docs/notes/choice.md`).
    FirstP,
    /// By each P-frame for itself.
    ///
    /// It is chosen among the combinations with rotation.
    PerFrame,
    /// By the cost of the whole GoF with each combination; slow.
    ///
    /// Each combination codes the GoF once, which takes eight times as long.
    LookAhead,
}

impl Named for CombinationChoice {
    const KIND: &'static str = "choice of combinations";

    fn all() -> Vec<Self> {
        vec![Self::FirstP, Self::PerFrame, Self::LookAhead]
    }
}

impl fmt::Display for CombinationChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fixed(combination) => write!(f, "{combination}"),
            choice => f.write_str(choice.name()),
        }
    }
}

impl FromStr for CombinationChoice {
    type Err = NameError;

    /// Parses the name of a choice, or the name of a combination that is then fixed.
    fn from_str(text: &str) -> Result<Self, NameError> {
        let fixed = || text.parse().ok().map(Self::Fixed);
        Self::of_name(text).ok().or_else(fixed).ok_or_else(|| {
            let (choices, fixed) = (Self::all(), Combination::ALL.map(Combination::name));
            NameError::new(Self::KIND, text, choices.iter().map(Self::name).chain(fixed))
        })
    }
}

impl From<Combination> for CombinationChoice {
    fn from(combination: Combination) -> Self {
        Self::Fixed(combination)
    }
}

/// The measure of D where something is chosen by J = D + λR.
#[derive(Clone, Copy, Debug, PartialEq, Eq, AsRefStr, EnumMessage, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum DistortionMeasure {
    /// MSDM2; slow.
    ///
    /// It is the mean of both directions. Each candidate takes half a second.
    Msdm2,
    /// Distances and normals, scaled to differ as MSDM2 does.
    ///
    /// They are measured between the decoded surface and the scan at some thousand points. Each
    /// candidate takes milliseconds.
    Surrogate,
}

/// The choice of the places of key nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, AsRefStr, EnumMessage, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum NodePlacement {
    /// Evenly over the surface of the I-frame, by farthest points.
    Farthest,
    /// Where the motion needs them, by the distance to the scans.
    ///
    /// This is the key-node generator of the bi-modal paper, run on the motion to a later frame of
    /// the GoF, with new nodes where the distance is largest.
    #[default]
    Generated,
    /// Where the motion needs them, by MSDM2, as in the paper; slower.
    #[strum(serialize = "msdm2")]
    GeneratedByMsdm2,
}

/// The choice of the prediction of translations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, AsRefStr, EnumMessage, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum TranslationChoice {
    /// No prediction.
    Direct,
    /// The paper's choice: spatial in the first P-frame of a GoF, spatio-temporal in the others.
    Paper,
    /// In every frame the mode with the fewest bits; the decoded frames are the same in every mode.
    Cost,
}
