//! What an encoder can be told.

use crate::encode::choices::{
    AffineChoice, CombinationChoice, Decimation, DistortionMeasure, LabelChoice, NodeChoice,
    NodePlacement, SmoothingChoice, StepChoice, TranslationChoice,
};
use kn_bitstream::params::{FileNames, FrameRate, InfluenceMode, UnitOfLength, UpAxis, Weights};
use kn_fit::PartStart;
use kn_mesh::{BoundingBox, Grid};

/// How the sequence's grid is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GridChoice {
    /// So many bits for the longest side of the box: step = side / (2^bits − 1).
    Bits {
        /// 4 to 20.
        bits: u8,
        /// The box of all frames, where the input could be read beforehand; else the first frame's.
        bounds: Option<BoundingBox>,
    },
    /// A step in world units.
    Step {
        /// Finite and positive.
        step: f64,
        /// As for bits; here it only places the origin.
        bounds: Option<BoundingBox>,
    },
    /// A grid that all coordinates lie on already (see [`kn_mesh::ExactGrid`]): they come back to
    /// the last bit, and a frame that is not on it is an error. Only I-frames are exact, so groups
    /// have one frame and nothing is decimated.
    Lossless(Grid),
}

impl GridChoice {
    /// The step in world units; `None` for bits of a box that the first frame will tell.
    pub fn step(&self) -> Option<f64> {
        match *self {
            Self::Bits { bits, bounds } => bounds.map(|bounds| step_of_bits(bits, &bounds)),
            Self::Step { step, .. } => Some(step),
            Self::Lossless(grid) => Some(grid.step),
        }
    }
}

/// A box without extent has any step.
pub(crate) fn step_of_bits(bits: u8, bounds: &BoundingBox) -> f64 {
    let side = bounds.longest_side();
    if side > 0.0 { side / f64::from((1_u32 << bits) - 1) } else { 1.0 }
}

/// Settings of an [`crate::Encoder`]; the default is the preset `default`: bi-modal, with as many key
/// nodes as pay.
#[derive(Clone, Debug, PartialEq)]
pub struct EncoderConfig {
    /// The grid of the whole sequence.
    pub grid: GridChoice,
    /// Whether and how far I-frames are decimated.
    pub decimation: Option<Decimation>,
    /// Whether reports of I-frames have a vertex map.
    pub vertex_maps: bool,
    /// Where body-part labels come from.
    pub labels: LabelChoice,
    /// Frames in a group of frames, 1 to 255.
    pub group_length: u8,
    /// Key nodes in a group of frames.
    pub nodes: NodeChoice,
    /// Where the nodes are put.
    pub placement: NodePlacement,
    /// Frames per second.
    pub frame_rate: FrameRate,
    /// Unit of the world coordinates.
    pub unit: UnitOfLength,
    /// The axis that points up.
    pub up_axis: UpAxis,
    /// Fractional bits of reference positions, 0 to 8.
    pub fraction_bits: u8,
    /// Smoothing of I-frames.
    pub smoothing: SmoothingChoice,
    /// Q, 1 to 8.
    pub nodes_per_vertex: u8,
    /// Distance to weight.
    pub weights: Weights,
    /// What happens where a region has no node.
    pub influence: InfluenceMode,
    /// Which nodes are affine.
    pub affine: AffineChoice,
    /// Combination of affine nodes.
    pub combination: CombinationChoice,
    /// What D is measured by where something is chosen by J = D + λR.
    pub distortion: DistortionMeasure,
    /// λ: the distortion that a byte of a P-frame is worth, 0 or more.
    pub lambda: f64,
    /// Whether labelled parts are first aligned rigidly, before their nodes move (the paper's
    /// segment-guided correspondence); nothing happens without labels.
    pub part_start: PartStart,
    /// What translations are predicted from.
    pub translation: TranslationChoice,
    /// Quantiser step of translations.
    pub motion_step: StepChoice,
    /// Quantiser step of rotations, as how far it moves a vertex at the mean distance from its node,
    /// in grid steps; `None` is as far as that of translations, or by cost where that one is.
    pub rotation_step: Option<f64>,
    /// Likewise of scales; `None` is twice as far, or by cost.
    pub scale_step: Option<f64>,
    /// Likewise of shears; `None` is twice as far, or by cost.
    pub shear_step: Option<f64>,
    /// Whether frames carry digests (8 bytes each).
    pub digests: bool,
    /// Names of the frames, where they follow a pattern.
    pub names: Option<FileNames>,
}

impl Default for EncoderConfig {
    fn default() -> Self {
        Self {
            grid: GridChoice::Bits { bits: 11, bounds: None },
            decimation: None,
            vertex_maps: false,
            labels: LabelChoice::Auto,
            group_length: 8,
            nodes: NodeChoice::default(),
            placement: NodePlacement::default(),
            frame_rate: FrameRate::default(),
            unit: UnitOfLength::Unspecified,
            up_axis: UpAxis::Y,
            fraction_bits: 8,
            smoothing: SmoothingChoice::Auto,
            nodes_per_vertex: 4,
            weights: Weights::SUMNER,
            influence: InfluenceMode::Fallback,
            affine: AffineChoice::torso(),
            combination: CombinationChoice::FirstP,
            distortion: DistortionMeasure::Surrogate,
            lambda: LAMBDA,
            part_start: PartStart::On,
            translation: TranslationChoice::Cost,
            motion_step: StepChoice::Cost,
            rotation_step: None,
            scale_step: None,
            shear_step: None,
            digests: true,
            names: None,
        }
    }
}

/// See `docs/notes/choice.md`.
const LAMBDA: f64 = 3e-5;
