//! Settings of an encoder.

use crate::encode::choices::{
    AffineChoice, CombinationChoice, Decimation, DistortionMeasure, LabelChoice, NodeChoice,
    NodePlacement, SmoothingChoice, StepChoice, TranslationChoice,
};
use crate::encode::tuning::Tuning;
use kn_bitstream::params::{FileNames, FrameRate, InfluenceMode, UnitOfLength, UpAxis, Weights};
use kn_fit::PartStart;
use kn_mesh::{BoundingBox, Grid};

/// The choice of the sequence's grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GridChoice {
    /// A number of bits for the longest side of the box: step = side / (2^bits − 1).
    Bits {
        /// Number of bits, 4 to 20.
        bits: u8,
        /// The box of all frames. `None` is the box of the first frame, for input that cannot be
        /// read beforehand.
        bounds: Option<BoundingBox>,
    },
    /// A step in world units.
    Step {
        /// The step, finite and positive.
        step: f64,
        /// The box, as for bits. Here it places the origin alone.
        bounds: Option<BoundingBox>,
    },
    /// A grid that all coordinates lie on already (see [`kn_mesh::ExactGrid`]): they come back to
    /// the last bit, and a frame that is not on it is an error. Only I-frames are exact, so GoFs
    /// have one frame and nothing is decimated.
    Lossless(Grid),
}

impl GridChoice {
    /// Sets the box of the sequence. A lossless grid has its own origin and stays as it is.
    #[must_use]
    pub fn with_bounds(self, bounds: Option<BoundingBox>) -> Self {
        match self {
            Self::Bits { bits, .. } => Self::Bits { bits, bounds },
            Self::Step { step, .. } => Self::Step { step, bounds },
            Self::Lossless(grid) => Self::Lossless(grid),
        }
    }

    /// The step in world units; `None` for a number of bits without a box.
    pub fn step(&self) -> Option<f64> {
        match *self {
            Self::Bits { bits, bounds } => bounds.map(|bounds| step_of_bits(bits, &bounds)),
            Self::Step { step, .. } => Some(step),
            Self::Lossless(grid) => Some(grid.step),
        }
    }
}

/// The step of a number of bits. A box without extent may have any step.
pub(crate) fn step_of_bits(bits: u8, bounds: &BoundingBox) -> f64 {
    let side = bounds.longest_side();
    if side > 0.0 { side / f64::from((1_u32 << bits) - 1) } else { 1.0 }
}

/// Settings of an [`crate::Encoder`] in four parts. The default is the preset `default`: bi-modal,
/// with as many key nodes as pay for their bytes.
///
/// Settings are changed by the chainable `with_…` methods or through the fields of its four parts.
/// They are checked by [`Self::validate`], which [`crate::Encoder::new`] calls.
///
/// ```
/// use kn_codec::{AffineChoice, EncoderConfig};
///
/// let config = EncoderConfig::default().with_bits(12).with_nodes(150).with_affine(AffineChoice::All);
/// assert!(config.validate().is_ok());
/// assert!(config.with_lambda(-1.0).validate().is_err());
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct EncoderConfig {
    /// Settings of the whole sequence.
    pub sequence: SequenceConfig,
    /// Settings of I-frames.
    pub intra: IntraConfig,
    /// Settings of P-frames.
    pub motion: MotionConfig,
    /// Settings of the choices by J = D + λR.
    pub rate: RateConfig,
}

/// Settings of the whole sequence.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SequenceConfig {
    /// The grid of all frames.
    pub grid: GridChoice,
    /// Frames per second. The stream carries the value; the codec does not use it.
    pub frame_rate: FrameRate,
    /// Unit of the world coordinates. The stream carries the value; the codec does not use it.
    pub unit: UnitOfLength,
    /// The axis that points up.
    pub up_axis: UpAxis,
    /// Fractional bits of reference positions, 0 to 8.
    pub fraction_bits: u8,
    /// Largest number of frames in a GoF, 1 to 255.
    pub group_length: u8,
    /// Whether frames carry digests (8 bytes each).
    pub digests: bool,
    /// Names of the input files, where they follow a pattern.
    pub names: Option<FileNames>,
}

/// Settings of I-frames.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct IntraConfig {
    /// Decimation of I-frames; `None` keeps all their faces.
    pub decimation: Option<Decimation>,
    /// Strength of the smoothing of I-frames.
    pub smoothing: SmoothingChoice,
    /// Source of the labels.
    pub labels: LabelChoice,
    /// Whether the reports of I-frames have a vertex map.
    pub vertex_maps: bool,
}

/// Settings of P-frames: key nodes, and the motion that they carry.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotionConfig {
    /// Number of key nodes in a GoF.
    pub nodes: NodeChoice,
    /// Places of the key nodes.
    pub placement: NodePlacement,
    /// Q: number of nodes that move a vertex, 1 to 8.
    pub nodes_per_vertex: u8,
    /// Weights of the nodes, by their distance from the vertex.
    pub weights: Weights,
    /// Influence in a region that has no node.
    pub influence: InfluenceMode,
    /// Affine nodes.
    pub affine: AffineChoice,
    /// Components of affine nodes.
    pub combination: CombinationChoice,
    /// Whether the fit begins with a rigid motion of every labelled part (the paper's
    /// segment-guided correspondence). Without labels the setting has no effect.
    pub part_start: PartStart,
    /// Prediction of translations.
    pub translation: TranslationChoice,
    /// Quantiser step of translations.
    pub translation_step: StepChoice,
    /// Quantiser step of rotations: the distance, in grid steps, that it moves a vertex at the mean
    /// distance from its node. `None` is the step of translations, or a choice by cost where that
    /// is chosen by cost.
    pub rotation_step: Option<f64>,
    /// Quantiser step of scales, measured likewise. `None` is twice the step of translations, or a
    /// choice by cost.
    pub scale_step: Option<f64>,
    /// Quantiser step of shears, measured likewise. `None` is twice the step of translations, or a
    /// choice by cost.
    pub shear_step: Option<f64>,
    /// By how much a decoded P-frame may be farther from its scan than its GoF's I-frame is from
    /// its own (RMS distance, both directions), as a share of the scan's size. A region of the
    /// surface has half of this bound for its part of the RMS distance. A frame that would be
    /// beyond it begins a new GoF. [`crate::FrameError`] says how it is measured.
    pub max_error: f64,
}

/// Settings of the choices by J = D + λR.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RateConfig {
    /// λ: the distortion that a byte of a P-frame is worth, 0 or more.
    pub lambda: f64,
    /// The measure of D.
    pub distortion: DistortionMeasure,
}

impl Default for SequenceConfig {
    fn default() -> Self {
        Self {
            grid: GridChoice::Bits { bits: 11, bounds: None },
            frame_rate: FrameRate::default(),
            unit: UnitOfLength::Unspecified,
            up_axis: UpAxis::Y,
            fraction_bits: 8,
            group_length: 8,
            digests: true,
            names: None,
        }
    }
}

impl Default for IntraConfig {
    fn default() -> Self {
        Self {
            decimation: None,
            smoothing: SmoothingChoice::Auto,
            labels: LabelChoice::Auto,
            vertex_maps: false,
        }
    }
}

impl Default for MotionConfig {
    fn default() -> Self {
        Self {
            nodes: NodeChoice::default(),
            placement: NodePlacement::default(),
            nodes_per_vertex: 4,
            weights: Weights::SUMNER,
            influence: InfluenceMode::Fallback,
            affine: AffineChoice::torso(),
            combination: CombinationChoice::FirstP,
            part_start: PartStart::On,
            translation: TranslationChoice::Cost,
            translation_step: StepChoice::Cost,
            rotation_step: None,
            scale_step: None,
            shear_step: None,
            max_error: Tuning::default().error.excess,
        }
    }
}

impl Default for RateConfig {
    fn default() -> Self {
        Self { lambda: Tuning::default().rate.lambda, distortion: DistortionMeasure::Surrogate }
    }
}

/// The chainable setter of each field: `name: argument => part.field`.
macro_rules! setters {
    ($($name:ident: $argument:ty => $part:ident.$field:ident of $config:ident,)*) => {
        impl EncoderConfig {
            $(
                #[doc = concat!("Sets [`", stringify!($config), "::", stringify!($field), "`].")]
                #[must_use]
                pub fn $name(mut self, $field: $argument) -> Self {
                    self.$part.$field = $field.into();
                    self
                }
            )*
        }
    };
}

setters! {
    with_grid: GridChoice => sequence.grid of SequenceConfig,
    with_frame_rate: FrameRate => sequence.frame_rate of SequenceConfig,
    with_unit: UnitOfLength => sequence.unit of SequenceConfig,
    with_up_axis: UpAxis => sequence.up_axis of SequenceConfig,
    with_fraction_bits: u8 => sequence.fraction_bits of SequenceConfig,
    with_group_length: u8 => sequence.group_length of SequenceConfig,
    with_digests: bool => sequence.digests of SequenceConfig,
    with_names: impl Into<Option<FileNames>> => sequence.names of SequenceConfig,
    with_decimation: impl Into<Option<Decimation>> => intra.decimation of IntraConfig,
    with_smoothing: SmoothingChoice => intra.smoothing of IntraConfig,
    with_labels: LabelChoice => intra.labels of IntraConfig,
    with_vertex_maps: bool => intra.vertex_maps of IntraConfig,
    with_nodes: impl Into<NodeChoice> => motion.nodes of MotionConfig,
    with_placement: NodePlacement => motion.placement of MotionConfig,
    with_nodes_per_vertex: u8 => motion.nodes_per_vertex of MotionConfig,
    with_weights: Weights => motion.weights of MotionConfig,
    with_influence: InfluenceMode => motion.influence of MotionConfig,
    with_affine: AffineChoice => motion.affine of MotionConfig,
    with_combination: impl Into<CombinationChoice> => motion.combination of MotionConfig,
    with_part_start: PartStart => motion.part_start of MotionConfig,
    with_translation: TranslationChoice => motion.translation of MotionConfig,
    with_translation_step: StepChoice => motion.translation_step of MotionConfig,
    with_rotation_step: impl Into<Option<f64>> => motion.rotation_step of MotionConfig,
    with_scale_step: impl Into<Option<f64>> => motion.scale_step of MotionConfig,
    with_shear_step: impl Into<Option<f64>> => motion.shear_step of MotionConfig,
    with_max_error: f64 => motion.max_error of MotionConfig,
    with_lambda: f64 => rate.lambda of RateConfig,
    with_distortion: DistortionMeasure => rate.distortion of RateConfig,
}

impl EncoderConfig {
    /// Sets the number of bits for the longest side of the first frame's box.
    #[must_use]
    pub fn with_bits(self, bits: u8) -> Self {
        self.with_grid(GridChoice::Bits { bits, bounds: None })
    }
}

impl MotionConfig {
    /// Whether any choice of the encoder compares costs of P-frames.
    pub(crate) fn is_by_cost(&self) -> bool {
        self.translation_step == StepChoice::Cost
            || !matches!(self.combination, CombinationChoice::Fixed(_))
    }
}
