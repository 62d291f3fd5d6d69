//! Settings of the encoder that no stream carries. Each type has a text form.

use kn_bitstream::params::{BodyPart, Combination, NameError, Named};
use std::fmt;
use std::str::FromStr;
use strum::{AsRefStr, Display, EnumMessage, EnumString, VariantArray};

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

/// The source of the labels of a frame.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, AsRefStr, Display, EnumMessage, EnumString, VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
#[strum(parse_err_ty = NameError, parse_err_fn = NameError::of::<LabelChoice>)]
pub enum LabelChoice {
    /// The frames' own labels; a sequence without labels is coded without labels.
    Given,
    /// The frames' own labels; where they have none, those that the segmentation finds.
    ///
    /// The segmentation is [`kn_segment::Segmenter`].
    /// Frames in which the segmentation does not find a person are coded as if they had no labels.
    Auto,
}

impl Named for LabelChoice {
    const KIND: &'static str = "label choice";

    fn all() -> Vec<Self> {
        Self::VARIANTS.to_vec()
    }
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
        let found = Self::all().into_iter().find(|choice| choice.name() == text);
        found.ok_or_else(|| NameError::of::<Self>(text))
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
        let found = Self::all().into_iter().find(|choice| choice.name() == text);
        found.or_else(|| text.parse().ok().map(Self::Fixed)).ok_or_else(|| {
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
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, AsRefStr, Display, EnumMessage, EnumString, VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
#[strum(parse_err_ty = NameError, parse_err_fn = NameError::of::<DistortionMeasure>)]
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

impl Named for DistortionMeasure {
    const KIND: &'static str = "distortion measure";

    fn all() -> Vec<Self> {
        Self::VARIANTS.to_vec()
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

/// The choice of the places of key nodes.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    AsRefStr,
    Display,
    EnumMessage,
    EnumString,
    VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
#[strum(parse_err_ty = NameError, parse_err_fn = NameError::of::<NodePlacement>)]
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

impl Named for NodePlacement {
    const KIND: &'static str = "placement of key nodes";

    fn all() -> Vec<Self> {
        Self::VARIANTS.to_vec()
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

/// The choice of the prediction of translations.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, AsRefStr, Display, EnumMessage, EnumString, VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
#[strum(parse_err_ty = NameError, parse_err_fn = NameError::of::<TranslationChoice>)]
pub enum TranslationChoice {
    /// No prediction.
    Direct,
    /// The paper's choice: spatial in the first P-frame of a GoF, spatio-temporal in the others.
    Paper,
    /// In every frame the mode with the fewest bits; the decoded frames are the same in every mode.
    Cost,
}

impl Named for TranslationChoice {
    const KIND: &'static str = "prediction of translations";

    fn all() -> Vec<Self> {
        Self::VARIANTS.to_vec()
    }
}

/// The text form of a choice that the encoder makes. It is read in any case, since help texts write
/// it in capitals.
const AUTO: &str = "auto";

fn is_auto(text: &str) -> bool {
    text.eq_ignore_ascii_case(AUTO)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reads_what_it_prints<T>(values: impl IntoIterator<Item = T>)
    where
        T: FromStr<Err: fmt::Debug> + fmt::Display + fmt::Debug + PartialEq,
    {
        for value in values {
            assert_eq!(value.to_string().parse::<T>().expect("a form"), value);
        }
    }

    #[test]
    fn choices_are_read_back_from_their_text() {
        reads_what_it_prints(LabelChoice::all());
        reads_what_it_prints(AffineChoice::all());
        reads_what_it_prints(CombinationChoice::all());
        reads_what_it_prints(Combination::ALL.map(CombinationChoice::Fixed));
        reads_what_it_prints(DistortionMeasure::all());
        reads_what_it_prints(NodePlacement::all());
        reads_what_it_prints(TranslationChoice::all());
        reads_what_it_prints([StepChoice::Cost, StepChoice::Fixed(0.5)]);
        reads_what_it_prints([NodeChoice::default(), NodeChoice::Fixed(150)]);
        reads_what_it_prints([SmoothingChoice::Auto, SmoothingChoice::Strength(3)]);
        reads_what_it_prints([Decimation::Faces(5000), Decimation::Share(0.125)]);
    }

    #[test]
    fn auto_is_read_in_any_case() {
        assert_eq!("AUTO".parse(), Ok(NodeChoice::default()));
        assert_eq!("Auto".parse(), Ok(SmoothingChoice::Auto));
        assert_eq!("auto".parse(), Ok(StepChoice::Cost));
    }

    #[test]
    fn other_texts_are_refused_with_the_forms() {
        let message = "sometimes".parse::<CombinationChoice>().expect_err("no form").to_string();
        assert!(message.contains("first-p") && message.contains("RTSH"), "{message}");
        for bad in ["", "-1", "many", "1.5"] {
            assert!(bad.parse::<NodeChoice>().is_err(), "{bad}");
        }
        for bad in ["", "%", "-1", "x"] {
            assert!(bad.parse::<Decimation>().is_err(), "{bad}");
        }
    }
}
