//! What an encoder can be told.

use kn_bitstream::UnitOfLength;
use kn_deform::{Combination, InfluenceMode, WeightScheme};
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

/// How far I-frames are decimated; P-frames then deform the coarser mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Decimation {
    /// At most so many faces, as far as topology allows.
    Faces(u32),
    /// At most this share of the faces, between 0 and 1.
    Share(f64),
    /// No vertex of the scan further than this from the coarser surface, world units.
    Error(f64),
}

/// Where the body parts of a frame's vertices come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LabelChoice {
    /// The frames' own labels; a sequence without them is coded without.
    Given,
    /// The frames' own; where they have none, those of the segmentation
    /// ([`kn_segment::Segmenter`]). Frames in which it does not find a person are coded as if
    /// they had no labels.
    Auto,
}

/// Which key nodes are affine; the others are rigid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AffineChoice {
    /// All nodes are rigid.
    None,
    /// Nodes that carry one of these labels; the paper's choice is the torso (7).
    Labels(Vec<u8>),
    /// Nodes whose scales and shears lower J in the key frame of their group.
    Cost,
    /// All nodes are affine.
    All,
}

/// How the components of affine nodes are chosen: a combination Ω of least J = D + λR (bi-modal
/// paper, section on rate-distortion optimization). What is not chosen is disabled while fitting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CombinationChoice {
    /// This one in every P-frame.
    Fixed(Combination),
    /// By the first P-frame of each group, for the whole group: the paper's choice. Among the
    /// combinations with rotation: one frame does not show what the others lose in a chain of frames
    /// (`docs/notes/choice.md`).
    FirstP,
    /// In every P-frame anew, among the same.
    PerFrame,
    /// For the whole group, by the sum of J over its P-frames, among all: each combination codes the
    /// group once, which takes eight times as long.
    LookAhead,
}

impl From<Combination> for CombinationChoice {
    fn from(combination: Combination) -> Self {
        Self::Fixed(combination)
    }
}

/// What D is measured by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DistortionMeasure {
    /// MSDM2, symmetric: half a second for each candidate.
    Msdm2,
    /// Distances and angles between the decoded surface and the scan at some thousand points,
    /// scaled to differ as MSDM2 does: milliseconds for each candidate.
    Surrogate,
}

/// How a quantiser step is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepChoice {
    /// So many grid steps.
    Fixed(f64),
    /// In every P-frame those of translations, rotations, and scales and shears with the least J.
    Cost,
}

/// How many key nodes a group has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeChoice {
    /// So many, 1 to 4096.
    Fixed(usize),
    /// In every group as many as lower J = D + λR of its key frame by their bytes, at least one for
    /// every region of influence and at most one for 60 vertices of the I-frame; 150, or `most` if that
    /// is less, where they are spread evenly or no frame can be tracked.
    Cost {
        /// The largest number, 1 to 4096.
        most: usize,
    },
}

impl NodeChoice {
    /// The largest number that a group can have.
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

/// Where key nodes are put.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NodePlacement {
    /// Evenly over the surface of the I-frame, by farthest points.
    Farthest,
    /// Where the motion to a later frame of the group needs them: the key-node generator of the
    /// bi-modal paper, with new nodes where the distance is largest.
    #[default]
    Generated,
    /// The same with new nodes where MSDM2 is highest, as in the paper; slower.
    GeneratedByMsdm2,
}

/// How strongly I-frames are smoothed within their grid's uncertainty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SmoothingChoice {
    /// As strongly as leaves the decoded surface as near to the scan, within 3 %.
    Auto,
    /// 0 (decoded positions are exactly the quantised ones) to 5.
    Strength(u8),
}

/// What translations are predicted from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TranslationChoice {
    /// Nothing.
    Direct,
    /// The paper's choice: spatial in the first P-frame of a group, spatio-temporal in the others.
    Paper,
    /// In every frame the mode with the fewest bits; the decoded frames are the same in all.
    Cost,
}

/// Names of the frames: `prefix`, then the frame number with at least `digits` digits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamePattern {
    /// Text before the number, at most 255 bytes.
    pub prefix: String,
    /// Smallest number of digits, padded with zeros.
    pub digits: u8,
    /// Number of the first frame.
    pub first: u32,
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
    /// Frames per second as numerator and denominator.
    pub frame_rate: (u32, u32),
    /// Unit of the world coordinates.
    pub unit: UnitOfLength,
    /// The axis that points up: 0, 1 or 2.
    pub up_axis: u8,
    /// Fractional bits of reference positions, 0 to 8.
    pub fraction_bits: u8,
    /// Smoothing of I-frames.
    pub smoothing: SmoothingChoice,
    /// Q, 1 to 8.
    pub nodes_per_vertex: u8,
    /// Distance to weight.
    pub weights: WeightScheme,
    /// What happens where a region has no node.
    pub influence: InfluenceMode,
    /// Which nodes are affine.
    pub affine: AffineChoice,
    /// Components of affine nodes.
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
    pub names: Option<NamePattern>,
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
            frame_rate: (30, 1),
            unit: UnitOfLength::Unspecified,
            up_axis: 1,
            fraction_bits: 8,
            smoothing: SmoothingChoice::Auto,
            nodes_per_vertex: 4,
            weights: WeightScheme::Sumner,
            influence: InfluenceMode::Fallback,
            affine: AffineChoice::Labels(vec![TORSO]),
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
/// The paper's label of the torso.
const TORSO: u8 = 7;
