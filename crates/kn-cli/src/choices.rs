//! The values that flags take, and what they mean to the encoder.

use clap::ValueEnum;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use kn_codec::{
    AffineChoice, CombinationChoice, Decimation, DistortionMeasure, LabelChoice, NodeChoice,
    NodePlacement, PartStart, Preset, SmoothingChoice, StepChoice, TranslationChoice, UnitOfLength,
};
use kn_deform::{Combination, InfluenceMode, WeightScheme};
use kn_io::LabelSource;
use std::convert::Infallible;
use std::fmt;
use std::num::NonZeroU16;
use std::path::PathBuf;
use std::str::FromStr;

/// Frames per second as a fraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FrameRate {
    pub(crate) numerator: u32,
    pub(crate) denominator: u32,
}

impl FrameRate {
    pub(crate) fn per_second(self) -> f64 {
        f64::from(self.numerator) / f64::from(self.denominator)
    }
}

impl Default for FrameRate {
    fn default() -> Self {
        Self { numerator: 30, denominator: 1 }
    }
}

impl fmt::Display for FrameRate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.denominator {
            1 => write!(f, "{}", self.numerator),
            denominator => write!(f, "{}/{denominator}", self.numerator),
        }
    }
}

impl FromStr for FrameRate {
    type Err = String;

    /// Reads `30`, `29.97` or `30000/1001`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (numerator, denominator) = match (text.split_once('/'), text.split_once('.')) {
            (Some((over, under)), _) => (over.parse().ok(), under.parse().ok()),
            (None, Some((whole, decimals))) if decimals.len() <= 4 => {
                let digits = format!("{whole}{decimals}").parse().ok();
                (digits, Some(10_u32.pow(decimals.len() as u32)))
            }
            _ => (text.parse().ok(), Some(1)),
        };
        match (numerator, denominator) {
            (Some(numerator @ 1..), Some(denominator @ 1..)) => Ok(Self { numerator, denominator }),
            _ => Err("a frame rate is a positive number such as 30, 29.97 or 30000/1001".into()),
        }
    }
}

/// Where labels come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum LabelArgument {
    None,
    Auto,
    Colours,
    Files(PathBuf),
}

impl FromStr for LabelArgument {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text {
            "none" => Self::None,
            "auto" => Self::Auto,
            "colours" | "colors" => Self::Colours,
            pattern => Self::Files(pattern.into()),
        })
    }
}

impl LabelArgument {
    /// Where a single file's reader looks; files beside the meshes are added to the sequence.
    pub(crate) fn source(choice: Option<&Self>) -> LabelSource {
        match choice {
            None => LabelSource::Property,
            Some(Self::Colours) => LabelSource::Colours,
            Some(Self::None | Self::Auto | Self::Files(_)) => LabelSource::None,
        }
    }

    /// What the encoder does about frames without labels.
    pub(crate) fn choice(choice: Option<&Self>, preset: LabelChoice) -> LabelChoice {
        match choice {
            None => preset,
            Some(Self::Auto) => LabelChoice::Auto,
            Some(_) => LabelChoice::Given,
        }
    }
}

/// How many key nodes a group has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NodeArgument {
    Exactly(u16),
    Auto,
}

impl From<NodeArgument> for NodeChoice {
    fn from(argument: NodeArgument) -> Self {
        match argument {
            NodeArgument::Exactly(count) => Self::Fixed(count.into()),
            NodeArgument::Auto => Self::default(),
        }
    }
}

impl FromStr for NodeArgument {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse() {
            _ if is_auto(text) => Ok(Self::Auto),
            Ok(count @ 1..=4096) => Ok(Self::Exactly(count)),
            _ => Err("the number of nodes is 1 to 4096, or `auto`".into()),
        }
    }
}

/// Where key nodes are put.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PlacementArgument {
    /// Evenly, by farthest points
    Farthest,
    /// Where the motion needs them, by distance to the scans
    Generated,
    /// The same by MSDM2, as in the paper; slower
    Msdm2,
}

impl From<PlacementArgument> for NodePlacement {
    fn from(argument: PlacementArgument) -> Self {
        match argument {
            PlacementArgument::Farthest => Self::Farthest,
            PlacementArgument::Generated => Self::Generated,
            PlacementArgument::Msdm2 => Self::GeneratedByMsdm2,
        }
    }
}

/// What happens in a region without key nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum InfluenceArgument {
    /// An error: the paper's manual mode
    Strict,
    /// The nearest nodes of any region: the paper's auto mode
    Fallback,
}

impl From<InfluenceArgument> for InfluenceMode {
    fn from(argument: InfluenceArgument) -> Self {
        match argument {
            InfluenceArgument::Strict => Self::Strict,
            InfluenceArgument::Fallback => Self::Fallback,
        }
    }
}

/// Which key nodes are affine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum AffineArgument {
    /// All nodes are rigid
    None,
    /// Those of the torso; none where the scans have no labels
    Labels,
    /// Those whose scales and shears pay for their bytes, labels or not
    Cost,
    /// All nodes are affine
    All,
}

/// The label of the torso.
const TORSO: u8 = 7;

impl From<AffineArgument> for AffineChoice {
    fn from(argument: AffineArgument) -> Self {
        match argument {
            AffineArgument::None => Self::None,
            AffineArgument::Labels => Self::Labels(vec![TORSO]),
            AffineArgument::Cost => Self::Cost,
            AffineArgument::All => Self::All,
        }
    }
}

/// When the components of affine nodes are chosen by cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ChoiceArgument {
    /// In the first P-frame of each group, for all of it: the paper's choice
    FirstP,
    /// In every P-frame
    PerFrame,
    /// By what the whole group costs with each combination; slow
    LookAhead,
}

impl From<ChoiceArgument> for CombinationChoice {
    fn from(argument: ChoiceArgument) -> Self {
        match argument {
            ChoiceArgument::FirstP => Self::FirstP,
            ChoiceArgument::PerFrame => Self::PerFrame,
            ChoiceArgument::LookAhead => Self::LookAhead,
        }
    }
}

/// When labelled parts are first aligned rigidly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PartStartArgument {
    /// Never
    Off,
    /// In every frame, as in the paper
    On,
    /// Where it leaves the mesh nearer to the scan
    Auto,
}

impl From<PartStartArgument> for PartStart {
    fn from(argument: PartStartArgument) -> Self {
        match argument {
            PartStartArgument::Off => Self::Off,
            PartStartArgument::On => Self::On,
            PartStartArgument::Auto => Self::Auto,
        }
    }
}

/// What distortion is measured by where something is chosen by cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum DistortionArgument {
    /// MSDM2; slow
    Msdm2,
    /// Distances and normals, scaled to differ as MSDM2 does
    Surrogate,
}

impl From<DistortionArgument> for DistortionMeasure {
    fn from(argument: DistortionArgument) -> Self {
        match argument {
            DistortionArgument::Msdm2 => Self::Msdm2,
            DistortionArgument::Surrogate => Self::Surrogate,
        }
    }
}

/// In any case: placeholders of the help are in capitals.
fn is_auto(text: &str) -> bool {
    text.eq_ignore_ascii_case("auto")
}

/// Reads a number of threads or jobs.
pub(crate) fn count(text: &str) -> Result<NonZeroU16, String> {
    text.parse().map_err(|_| format!("it is a number from 1 to {}", u16::MAX))
}

/// Reads `auto` or a step in grid steps.
pub(crate) fn motion_step(text: &str) -> Result<StepChoice, String> {
    match is_auto(text) {
        true => Ok(StepChoice::Cost),
        false => length(text)
            .map(StepChoice::Fixed)
            .map_err(|_| "a motion step is auto or a positive number of grid steps".into()),
    }
}

/// Reads λ.
pub(crate) fn lambda(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(lambda) if lambda >= 0.0 && lambda.is_finite() => Ok(lambda),
        _ => Err("lambda is a number, 0 or more".into()),
    }
}

/// What translations are predicted from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TranslationArgument {
    /// Nothing
    Direct,
    /// Spatial in the first P-frame of a group, spatio-temporal in the others
    Paper,
    /// In every frame the mode with the fewest bits
    Cost,
}

impl From<TranslationArgument> for TranslationChoice {
    fn from(argument: TranslationArgument) -> Self {
        match argument {
            TranslationArgument::Direct => Self::Direct,
            TranslationArgument::Paper => Self::Paper,
            TranslationArgument::Cost => Self::Cost,
        }
    }
}

/// Reads `auto` or a strength.
pub(crate) fn smoothing(text: &str) -> Result<SmoothingChoice, String> {
    match (is_auto(text), text.parse()) {
        (true, _) => Ok(SmoothingChoice::Auto),
        (_, Ok(strength @ 0..=5)) => Ok(SmoothingChoice::Strength(strength)),
        _ => Err("smoothing is auto or 0 to 5".into()),
    }
}

/// Unit of the coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum UnitArgument {
    Unspecified,
    M,
    Cm,
    Mm,
    In,
    Ft,
}

impl From<UnitArgument> for UnitOfLength {
    fn from(argument: UnitArgument) -> Self {
        match argument {
            UnitArgument::Unspecified => Self::Unspecified,
            UnitArgument::M => Self::Metre,
            UnitArgument::Cm => Self::Centimetre,
            UnitArgument::Mm => Self::Millimetre,
            UnitArgument::In => Self::Inch,
            UnitArgument::Ft => Self::Foot,
        }
    }
}

/// The axis that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum UpAxis {
    X,
    Y,
    Z,
}

/// Reads the paper's name of a combination.
pub(crate) fn combination(text: &str) -> Result<Combination, String> {
    Combination::from_name(text).ok_or_else(|| {
        let names = Combination::ALL.map(Combination::name).join(", ");
        format!("the combinations are {names}")
    })
}

/// A preset by its name; help and errors list all of them.
pub(crate) fn preset() -> impl TypedValueParser<Value = &'static Preset> {
    let value = |preset: &Preset| PossibleValue::new(preset.name()).help(preset.about());
    PossibleValuesParser::new(Preset::all().iter().map(value))
        .try_map(|name| Preset::by_name(&name).ok_or("no such preset"))
}

/// Reads `inverse-square`, `sumner` or `gaussian:SIGMA`.
pub(crate) fn weights(text: &str) -> Result<WeightScheme, String> {
    let sigma = text.strip_prefix("gaussian:").map(str::parse);
    match (text, sigma) {
        ("inverse-square", _) => Ok(WeightScheme::InverseSquare),
        ("sumner", _) => Ok(WeightScheme::Sumner),
        (_, Some(Ok(sigma @ 1..))) => Ok(WeightScheme::Gaussian { sigma }),
        _ => {
            Err("weights are inverse-square, sumner or gaussian:SIGMA, SIGMA in grid steps".into())
        }
    }
}

/// Reads a number of faces, or a share of them in percent.
pub(crate) fn face_count(text: &str) -> Result<Decimation, String> {
    let share = text.strip_suffix('%').and_then(|percent| percent.parse::<f64>().ok());
    match (share, text.parse()) {
        (Some(percent), _) if percent > 0.0 && percent <= 100.0 => {
            Ok(Decimation::Share(percent / 100.0))
        }
        (None, Ok(faces @ 1..)) => Ok(Decimation::Faces(faces)),
        _ => Err("a number of faces is 1 or more, or a share such as 25%".into()),
    }
}

/// Reads a positive length.
pub(crate) fn length(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(length) if length > 0.0 && length.is_finite() => Ok(length),
        _ => Err("a length is a positive number".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_rates_are_exact() {
        let rate = |text: &str| text.parse::<FrameRate>().map(|r| (r.numerator, r.denominator));
        assert_eq!(rate("30"), Ok((30, 1)));
        assert_eq!(rate("29.97"), Ok((2997, 100)));
        assert_eq!(rate("30000/1001"), Ok((30000, 1001)));
        for bad in ["", "0", "-1", "1/0", "0/1", "x", "1.", "1e3", "1.23456", "9999999999"] {
            assert!(rate(bad).is_err() || bad == "1.", "{bad}");
        }
    }

    #[test]
    fn node_numbers_are_in_range() {
        assert_eq!("150".parse(), Ok(NodeArgument::Exactly(150)));
        assert_eq!(["auto", "AUTO"].map(str::parse), [const { Ok(NodeArgument::Auto) }; 2]);
        for bad in ["0", "4097", "-1", "70000", "many", ""] {
            assert!(bad.parse::<NodeArgument>().is_err(), "{bad}");
        }
    }

    #[test]
    fn faces_are_a_number_or_a_share() {
        assert_eq!(face_count("5000"), Ok(Decimation::Faces(5000)));
        assert_eq!(face_count("12.5%"), Ok(Decimation::Share(0.125)));
        for bad in ["0", "-1", "0%", "101%", "nan%", "%", "x"] {
            assert!(face_count(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn lengths_are_positive() {
        assert_eq!(length("0.5"), Ok(0.5));
        for bad in ["0", "-1", "nan", "inf", "1e999", "x"] {
            assert!(length(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn motion_steps_and_lambda_are_checked() {
        assert_eq!(["auto", "AUTO"].map(motion_step), [Ok(StepChoice::Cost), Ok(StepChoice::Cost)]);
        assert_eq!(smoothing("Auto"), Ok(SmoothingChoice::Auto));
        assert_eq!(count("7"), Ok(NonZeroU16::MIN.saturating_add(6)));
        for bad in ["0", "70000", "-1", "x"] {
            assert!(count(bad).is_err_and(|said| said.contains("1 to 65535")), "{bad}");
        }
        assert_eq!(motion_step("0.5"), Ok(StepChoice::Fixed(0.5)));
        assert_eq!((lambda("0"), lambda("3e-5")), (Ok(0.0), Ok(3e-5)));
        for bad in ["", "0", "-1", "nan", "automatic"] {
            assert!(motion_step(bad).is_err(), "{bad}");
        }
        for bad in ["", "-1e-9", "nan", "inf"] {
            assert!(lambda(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn weights_go_by_name() {
        assert_eq!(weights("sumner"), Ok(WeightScheme::Sumner));
        assert_eq!(weights("gaussian:40"), Ok(WeightScheme::Gaussian { sigma: 40 }));
        for bad in ["", "gaussian", "gaussian:0", "gaussian:-1", "sumner:3"] {
            assert!(weights(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn combinations_go_by_the_papers_names() {
        assert_eq!(combination("RTS"), Ok(Combination::new(true, true, false)));
        assert!(combination("RS").expect_err("T is always on").contains("RTSH"));
    }
}
