//! Errors of settings that are out of their range or contradict each other.

use std::fmt;
use strum::{AsRefStr, Display, VariantArray};

/// The name of a setting of [`crate::EncoderConfig`] in errors: the path of its field, and in
/// parentheses the case where the field has several.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, AsRefStr, Display, VariantArray)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each is documented at the field that its name tells")]
pub enum Setting {
    #[strum(serialize = "sequence.grid (bits)")]
    Bits,
    #[strum(serialize = "sequence.grid (step)")]
    Step,
    #[strum(serialize = "sequence.grid (bounds)")]
    Bounds,
    #[strum(serialize = "sequence.grid (lossless)")]
    Lossless,
    #[strum(serialize = "sequence.frame_rate")]
    FrameRate,
    #[strum(serialize = "sequence.fraction_bits")]
    FractionBits,
    #[strum(serialize = "sequence.group_length")]
    GroupLength,
    #[strum(serialize = "sequence.names")]
    Names,
    #[strum(serialize = "intra.decimation (faces)")]
    DecimationFaces,
    #[strum(serialize = "intra.decimation (error)")]
    DecimationError,
    #[strum(serialize = "intra.smoothing")]
    Smoothing,
    #[strum(serialize = "motion.nodes")]
    Nodes,
    #[strum(serialize = "motion.placement")]
    Placement,
    #[strum(serialize = "motion.influence")]
    Influence,
    #[strum(serialize = "motion.nodes_per_vertex")]
    NodesPerVertex,
    #[strum(serialize = "motion.weights")]
    Weights,
    #[strum(serialize = "motion.affine")]
    Affine,
    #[strum(serialize = "motion.combination")]
    Combination,
    #[strum(serialize = "motion.combination (choice)")]
    Choice,
    #[strum(serialize = "motion.part_start")]
    PartStart,
    #[strum(serialize = "motion.translation")]
    Translation,
    #[strum(serialize = "motion.translation_step")]
    TranslationStep,
    #[strum(serialize = "motion.rotation_step")]
    RotationStep,
    #[strum(serialize = "motion.scale_step")]
    ScaleStep,
    #[strum(serialize = "motion.shear_step")]
    ShearStep,
    #[strum(serialize = "motion.max_error")]
    MaxError,
    #[strum(serialize = "rate.lambda")]
    Lambda,
    #[strum(serialize = "rate.distortion")]
    Distortion,
}

/// The error for settings that no stream can be encoded with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SettingsError {
    settings: Vec<Setting>,
    /// A sentence in which `{0}`, `{1}` … stand for the settings.
    sentence: String,
}

impl SettingsError {
    /// `sentence` has `{0}`, `{1}` … for the names of `settings`.
    pub(crate) fn new(settings: &[Setting], sentence: impl Into<String>) -> Self {
        Self { settings: settings.to_vec(), sentence: sentence.into() }
    }

    /// The settings that the error is about: one that is out of its range, or those that contradict
    /// each other.
    pub fn settings(&self) -> &[Setting] {
        &self.settings
    }

    /// The sentence of the error, in which `name` gives the names of the settings. A command line
    /// gives its flags.
    pub fn describe<N: fmt::Display>(&self, name: impl Fn(Setting) -> N) -> String {
        let named = |sentence: String, (place, &setting): (usize, &Setting)| {
            sentence.replace(&format!("{{{place}}}"), &name(setting).to_string())
        };
        self.settings.iter().enumerate().fold(self.sentence.clone(), named)
    }
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.describe(|setting| setting))
    }
}

impl std::error::Error for SettingsError {}
