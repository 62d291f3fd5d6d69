//! Numbers that the encoder decides by, each with its source. No number here changes what a decoder
//! does.

use crate::encode::failure::FailureTuning;

/// Numbers that the encoder decides by and that are no settings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Tuning {
    /// Default settings of the rate.
    pub(crate) rate: RateTuning,
    /// Thresholds at which a frame begins a new GoF.
    pub(crate) failure: FailureTuning,
    /// The bound on the error of decoded P-frames.
    pub(crate) error: ErrorTuning,
    /// Key nodes and affine nodes.
    pub(crate) nodes: NodeTuning,
    /// The surrogate of MSDM2.
    pub(crate) surrogate: SurrogateTuning,
    /// The search for quantiser steps.
    pub(crate) steps: StepTuning,
    /// The strength of smoothing of I-frames.
    pub(crate) smoothing: SmoothingTuning,
    /// Decimation of I-frames.
    pub(crate) decimation: DecimationTuning,
}

/// Default settings of the rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RateTuning {
    /// λ where the settings name none, in D per byte. J is flat around it (`docs/notes/choice.md`).
    pub(crate) lambda: f64,
}

impl Default for RateTuning {
    fn default() -> Self {
        Self { lambda: 3e-5 }
    }
}

/// The bound on the error of decoded P-frames (`docs/notes/fit.md`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ErrorTuning {
    /// The bound where the settings name none, as a share of the scan's size: more than any P-frame
    /// of seven real sequences has, and half of what is seen as a wrong shape.
    pub(crate) excess: f64,
    /// The bound for the part of one region, relative to that for the whole.
    pub(crate) region_bound: f64,
    /// Far points that are nearer than this share of the scan's size are one region. Samples of a
    /// body are a third of it apart.
    pub(crate) reach: f64,
    /// Share of the points beyond either side of the box that gives the scan's size.
    pub(crate) trimmed: f64,
    /// Components of less than this share of the area are specks ...
    pub(crate) speck: f64,
    /// ... in meshes of this number of faces: on a coarser mesh every face is seen.
    pub(crate) fine: usize,
    /// Number of points of each kind in each direction.
    pub(crate) samples: usize,
}

impl Default for ErrorTuning {
    fn default() -> Self {
        Self {
            excess: 0.01,
            region_bound: 0.5,
            reach: 0.025,
            trimmed: 0.01,
            speck: 0.01,
            fine: 2000,
            samples: 3000,
        }
    }
}

/// Numbers for the choice of key nodes and of affine nodes. The numbers of bytes and
/// `distortion` lie where J is least on six sequences (`docs/notes/fit.md`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NodeTuning {
    /// Place of the key frame in its GoF, as a share of the P-frames: later frames have drifted
    /// more, earlier ones moved less.
    pub(crate) key_frame: f64,
    /// Bytes of a key node's place, once a GoF.
    pub(crate) place_bytes: f64,
    /// Bytes of a key node's share of a P-frame.
    pub(crate) motion_bytes: f64,
    /// Bytes of the scales and shears of an affine node in a P-frame.
    pub(crate) stretch_bytes: f64,
    /// D of a P-frame for a rise of the mean squared distance by all of itself where a node is
    /// missing.
    pub(crate) distortion: f64,
    /// By how much D rises with the RMS distance, as a share of the diagonal, where nothing else is
    /// known: the slope of MSDM2 over the distance alone (`docs/notes/choice.md`).
    pub(crate) distortion_slope: f64,
    /// The search for nodes that pay begins with one for so many vertices of the I-frame.
    pub(crate) vertices_per_node: usize,
    /// Number of nodes where nothing says how many pay: they are spread evenly, or no frame can be
    /// tracked. The bi-modal paper's number.
    pub(crate) evenly: usize,
}

impl Default for NodeTuning {
    fn default() -> Self {
        Self {
            key_frame: 0.6,
            place_bytes: 1.0,
            motion_bytes: 2.7,
            stretch_bytes: 2.0,
            distortion: 0.0045,
            distortion_slope: 37.0,
            vertices_per_node: 60,
            evenly: 150,
        }
    }
}

/// The surrogate of MSDM2: a sum of the distance and of the angle between the surfaces at sampled
/// points. Its slopes are about those of MSDM2 over both, with more of the distance, since point to
/// surface is reported beside it (`docs/notes/choice.md`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurrogateTuning {
    /// Number of faces whose centres are looked at, about.
    pub(crate) samples: usize,
    /// D of an RMS distance of the box's diagonal.
    pub(crate) per_distance: f64,
    /// D of normals at a right angle, in the mean.
    pub(crate) per_bend: f64,
    /// D where nothing can be measured: MSDM2 is below it.
    pub(crate) worst: f64,
}

impl Default for SurrogateTuning {
    fn default() -> Self {
        Self { samples: 4000, per_distance: 15.0, per_bend: 0.87, worst: 1.0 }
    }
}

/// The search for quantiser steps (`docs/notes/choice.md`, `docs/notes/translation.md`). Indices
/// are those of the specification's families of steps, four to an octave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StepTuning {
    /// The step where the search begins, in grid steps.
    pub(crate) usual: f64,
    /// Scales and shears are quantised so many times more coarsely than translations: neighbours
    /// average their errors out.
    pub(crate) stretch: f64,
    /// Largest distance of a step from the start of the search, as a number of indices: three
    /// octaves.
    pub(crate) farthest: u8,
    /// Number of indices that a step changes at a time: half an octave.
    pub(crate) stride: i8,
    /// Number of rounds over the components.
    pub(crate) rounds: usize,
}

impl Default for StepTuning {
    fn default() -> Self {
        Self { usual: 2.0, stretch: 2.0, farthest: 12, stride: 2, rounds: 2 }
    }
}

/// The choice of the strength of smoothing (`docs/notes/smoothing.md`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SmoothingTuning {
    /// Number of faces whose centres are looked at, about.
    pub(crate) samples: usize,
    /// Largest distance of a smoothed surface from the scan, over that of the unsmoothed one. MSDM2
    /// still falls beyond the strength with the smallest distance.
    pub(crate) tolerance: f64,
}

impl Default for SmoothingTuning {
    fn default() -> Self {
        Self { samples: 4000, tolerance: 1.03 }
    }
}

/// Decimation of I-frames (`docs/notes/intra.md`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DecimationTuning {
    /// Cost of crossing a border between labels: as much as an error of this share of the box's
    /// longest side. Borders then move about as far as the surface does at a quarter of the faces.
    pub(crate) label_weight: f32,
    /// Largest number of times that the bound on the error is lowered until the measured error is
    /// within the limit.
    pub(crate) attempts: usize,
}

impl Default for DecimationTuning {
    fn default() -> Self {
        Self { label_weight: 1e-3, attempts: 8 }
    }
}
