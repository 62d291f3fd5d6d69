//! The codec's settings: flags of `kn encode` and, under the same names, keys of a `kn rd`
//! configuration.

use crate::choices::{self, named};
use crate::nearest::nearest;
use anyhow::{Result, anyhow};
use clap::{Args, Command, FromArgMatches};
use kn_bitstream::params::{Combination, InfluenceMode, Weights};
use kn_codec::{
    AffineChoice, CombinationChoice, Decimation, DistortionMeasure, EncoderConfig, GridChoice,
    NodeChoice, NodePlacement, PartStart, Setting, SmoothingChoice, StepChoice, TranslationChoice,
};

/// Heading of the flags that `--help` leaves to `--help-all`.
const EXPERT: &str = "Expert settings";

/// Settings of the codec. A setting that is not given keeps the value of the preset.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct Settings {
    /// Bits for the longest side of the sequence's box [default: 11]
    #[arg(long, value_name = "N")]
    bits: Option<u8>,
    /// Step of the grid in world units, instead of --bits
    #[arg(long, conflicts_with = "bits", value_name = "LENGTH", value_parser = choices::length)]
    step: Option<f64>,
    /// Frames in a GoF: an I-frame, then P-frames [default: 8]
    #[arg(long, value_name = "N")]
    gof: Option<u8>,
    /// Decimate I-frames to at most this number of faces, such as 5000, or to a share, such as 25%
    #[arg(long, value_name = "N|P%")]
    iframe_faces: Option<Decimation>,
    /// Decimate I-frames as far as no vertex lies further than this from the surface, in world
    /// units
    #[arg(long, conflicts_with = "iframe_faces", value_name = "LENGTH")]
    #[arg(value_parser = choices::length)]
    iframe_error: Option<f64>,
    /// Number of key nodes in a GoF, or `auto`: as many as pay for their bytes [default: auto, or
    /// the preset's]
    #[arg(long, value_name = "N|AUTO")]
    nodes: Option<NodeChoice>,
    /// Places of the key nodes [default: generated]
    #[arg(long, value_parser = named::<NodePlacement>())]
    #[arg(help_heading = EXPERT, hide_short_help = true)]
    placement: Option<NodePlacement>,
    /// Region without key nodes: an error, or moved by the nearest nodes of any region
    #[arg(long, value_parser = named::<InfluenceMode>())]
    #[arg(help_heading = EXPERT, hide_short_help = true)]
    influence: Option<InfluenceMode>,
    /// Affine key nodes: none, those of the torso, those that pay for their bytes, or all
    #[arg(long, value_parser = named::<AffineChoice>())]
    #[arg(help_heading = EXPERT, hide_short_help = true)]
    affine: Option<AffineChoice>,
    /// Choice of the components of affine nodes by least J = D + λR [default: first-p]
    #[arg(long, value_parser = named::<CombinationChoice>())]
    #[arg(help_heading = EXPERT, hide_short_help = true)]
    choice: Option<CombinationChoice>,
    /// Components of affine nodes instead of a choice: T, RT, TS, TH, RTS, RTH, TSH or RTSH
    #[arg(long, conflicts_with = "choice")]
    #[arg(help_heading = EXPERT, hide_short_help = true)]
    combination: Option<Combination>,
    /// Measure of D [default: surrogate]
    #[arg(long, value_parser = named::<DistortionMeasure>())]
    #[arg(help_heading = EXPERT, hide_short_help = true)]
    distortion: Option<DistortionMeasure>,
    /// λ: the distortion that a byte of a P-frame is worth [default: 3e-5]
    #[arg(long, value_name = "D", allow_negative_numbers = true)]
    #[arg(help_heading = EXPERT, hide_short_help = true)]
    lambda: Option<f64>,
    /// Segment-guided correspondence: whether labelled parts are first aligned rigidly, before
    /// their nodes move [default: on]
    #[arg(long, value_parser = named::<PartStart>())]
    #[arg(help_heading = EXPERT, hide_short_help = true)]
    part_start: Option<PartStart>,
    /// Prediction of translations: none, as in the paper, or the cheapest in each frame
    /// [default: cost]
    #[arg(long, value_parser = named::<TranslationChoice>())]
    #[arg(help_heading = EXPERT, hide_short_help = true)]
    translation: Option<TranslationChoice>,
    /// Strength of the smoothing of I-frames: auto, or 0 (none) to 5 [default: auto]
    #[arg(long, value_name = "AUTO|N")]
    #[arg(help_heading = EXPERT, hide_short_help = true)]
    smoothing: Option<SmoothingChoice>,
    /// Weights by distance: inverse-square, sumner or gaussian:SIGMA (in grid steps)
    #[arg(long)]
    #[arg(help_heading = EXPERT, hide_short_help = true)]
    weights: Option<Weights>,
    /// Key nodes that move a vertex, Q [default: 4]
    #[arg(long, value_name = "N")]
    #[arg(help_heading = EXPERT, hide_short_help = true)]
    nodes_per_vertex: Option<u8>,
    /// Quantiser step of translations in grid steps, or `auto`: all steps by least J in every
    /// P-frame [default: auto]
    #[arg(long, value_name = "STEPS|AUTO")]
    #[arg(help_heading = EXPERT, hide_short_help = true)]
    motion_step: Option<StepChoice>,
    /// Quantiser step of rotations: the distance that it moves a vertex, in grid steps [default:
    /// that of translations, or by least J]
    #[arg(long, value_name = "STEPS", value_parser = choices::length)]
    #[arg(help_heading = EXPERT, hide_short_help = true)]
    rotation_step: Option<f64>,
    /// Quantiser step of scales [default: twice that of translations, or by least J]
    #[arg(long, value_name = "STEPS", value_parser = choices::length)]
    #[arg(help_heading = EXPERT, hide_short_help = true)]
    scale_step: Option<f64>,
    /// Quantiser step of shears [default: twice that of translations, or by least J]
    #[arg(long, value_name = "STEPS", value_parser = choices::length)]
    #[arg(help_heading = EXPERT, hide_short_help = true)]
    shear_step: Option<f64>,
}

impl Settings {
    /// Writes the settings that are given into `config`.
    pub(crate) fn apply(&self, config: &mut EncoderConfig) {
        let set = |setting: &mut u8, value: Option<u8>| *setting = value.unwrap_or(*setting);
        if let Some(bits) = self.bits {
            config.sequence.grid = GridChoice::Bits { bits, bounds: None };
        }
        if let Some(step) = self.step {
            config.sequence.grid = GridChoice::Step { step, bounds: None };
        }
        let by_error = self.iframe_error.map(Decimation::Error);
        config.intra.decimation = self.iframe_faces.or(by_error).or(config.intra.decimation);
        set(&mut config.sequence.group_length, self.gof);
        set(&mut config.motion.nodes_per_vertex, self.nodes_per_vertex);
        config.motion.nodes = self.nodes.unwrap_or(config.motion.nodes);
        config.motion.placement = self.placement.unwrap_or(config.motion.placement);
        config.motion.influence = self.influence.unwrap_or(config.motion.influence);
        let fixed = self.combination.map(CombinationChoice::Fixed);
        config.motion.combination = fixed.or(self.choice).unwrap_or(config.motion.combination);
        config.rate.distortion = self.distortion.unwrap_or(config.rate.distortion);
        config.rate.lambda = self.lambda.unwrap_or(config.rate.lambda);
        config.motion.part_start = self.part_start.unwrap_or(config.motion.part_start);
        config.motion.translation = self.translation.unwrap_or(config.motion.translation);
        config.intra.smoothing = self.smoothing.unwrap_or(config.intra.smoothing);
        config.motion.weights = self.weights.unwrap_or(config.motion.weights);
        config.motion.translation_step = self.motion_step.unwrap_or(config.motion.translation_step);
        config.motion.rotation_step = self.rotation_step.or(config.motion.rotation_step);
        config.motion.scale_step = self.scale_step.or(config.motion.scale_step);
        config.motion.shear_step = self.shear_step.or(config.motion.shear_step);
        if let Some(affine) = &self.affine {
            config.motion.affine = affine.clone();
        }
    }

    /// The flag that was given and has no effect without body parts.
    pub(crate) fn needs_labels(&self) -> Option<&'static str> {
        let affine = matches!(self.affine, Some(AffineChoice::Labels(_)));
        let start = matches!(self.part_start, Some(PartStart::On | PartStart::Auto));
        affine.then_some("--affine labels").or(start.then_some("--part-start"))
    }

    /// Whether a configuration may hold this key: the flags with `_` for `-`.
    pub(crate) fn has_key(key: &str) -> bool {
        Self::keys().iter().any(|known| known == key)
    }

    /// All keys.
    pub(crate) fn keys() -> Vec<String> {
        flags().get_arguments().map(|argument| argument.get_id().to_string()).collect()
    }

    /// Reads settings from a configuration; values go through the same checks as those of flags.
    ///
    /// # Errors
    /// An unknown key, with the nearest known one, or a value that its flag does not take.
    pub(crate) fn from_table(table: &toml::Table) -> Result<Self> {
        let keys = Self::keys();
        if let Some(unknown) = table.keys().find(|key| !keys.contains(key)) {
            let nearest = nearest(unknown, keys.iter().map(String::as_str));
            return Err(anyhow!("there is no setting '{unknown}'{nearest}"));
        }
        let matches = flags().try_get_matches_from(flags_of(table)).map_err(|e| first_line(&e))?;
        Self::from_arg_matches(&matches).map_err(|error| first_line(&error))
    }
}

/// Checks the settings of a command; the message names flags.
///
/// # Errors
/// A value out of its range, or flags that contradict each other.
pub(crate) fn check_settings(config: &EncoderConfig) -> Result<()> {
    config.validate().map_err(|error| anyhow!(error.describe(flag_of)))
}

/// The flag of a setting. Those that no flag sets are named as the library names them.
fn flag_of(setting: Setting) -> String {
    let flag = match setting {
        Setting::Bits => "--bits",
        Setting::Step => "--step",
        Setting::Bounds => "the box of all frames",
        Setting::Lossless => "--lossless",
        Setting::FrameRate => "--fps",
        Setting::GroupLength => "--gof",
        Setting::Names => "the name of the first file",
        Setting::DecimationFaces => "--iframe-faces",
        Setting::DecimationError => "--iframe-error",
        Setting::Smoothing => "--smoothing",
        Setting::Nodes => "--nodes",
        Setting::NodesPerVertex => "--nodes-per-vertex",
        Setting::Weights => "--weights",
        Setting::Affine => "--affine",
        Setting::Combination => "--combination",
        Setting::TranslationStep => "--motion-step",
        Setting::RotationStep => "--rotation-step",
        Setting::ScaleStep => "--scale-step",
        Setting::ShearStep => "--shear-step",
        Setting::Lambda => "--lambda",
        Setting::Distortion => "--distortion",
        other => return other.to_string(),
    };
    flag.to_owned()
}

/// The flags that set what the table sets.
pub(crate) fn flags_of(table: &toml::Table) -> Vec<String> {
    let text = |value: &toml::Value| match value {
        toml::Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    table
        .iter()
        .map(|(key, value)| format!("--{}={}", key.replace('_', "-"), text(value)))
        .collect()
}

fn flags() -> Command {
    Settings::augment_args(Command::new("settings").no_binary_name(true).disable_help_flag(true))
}

/// clap's message without its advice for a command line.
fn first_line(error: &clap::Error) -> anyhow::Error {
    let text = error.to_string();
    let line = text.lines().next().unwrap_or_default();
    anyhow!("{}", line.strip_prefix("error: ").unwrap_or(line))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(toml: &str) -> Result<Settings> {
        Settings::from_table(&toml::from_str(toml).expect("TOML"))
    }

    #[test]
    fn keys_are_the_flags() {
        let table = "nodes = 40\ncombination = 'RTS'\nmotion_step = 0.5\naffine = 'all'\nbits = 9";
        let mut config = EncoderConfig::default();
        settings(table).expect("known").apply(&mut config);
        assert_eq!(
            (config.motion.nodes, config.motion.translation_step),
            (40.into(), StepChoice::Fixed(0.5))
        );
        assert_eq!(config.motion.combination, Combination::new(true, true, false).into());
        assert_eq!(config.motion.affine, kn_codec::AffineChoice::All);
        assert_eq!(config.sequence.grid, GridChoice::Bits { bits: 9, bounds: None });
        assert_eq!(config.sequence.group_length, EncoderConfig::default().sequence.group_length);
    }

    #[test]
    fn settings_are_checked_and_named_by_their_flags() {
        let message = |toml| {
            let mut config = EncoderConfig::default();
            settings(toml).expect("known").apply(&mut config);
            check_settings(&config).expect_err("a mistake").to_string()
        };
        assert_eq!(message("gof = 0"), "--gof is 0; it must be from 1 to 255");
        let both = message("combination = 'RT'\nscale_step = 1.0");
        assert_eq!(both, "--scale-step is 1, but --combination is RT: no node carries scales");
    }

    #[test]
    fn errors_name_the_key_and_the_nearest() {
        let message = |toml| settings(toml).expect_err("a mistake").to_string();
        let unknown = message("motion_stpe = 1");
        assert_eq!(unknown, "there is no setting 'motion_stpe'; did you mean 'motion_step'?");
        let value = message("gof = 300");
        assert!(value.contains("'300' for '--gof <N>': 300 is not in 0..=255"), "{value}");
        assert!(message("choice = 'per-frame'\ncombination = 'RT'").contains("--choice"));
        assert!(message("bits = 9\nstep = 1.0").contains("--step"), "both exclude each other");
    }
}
