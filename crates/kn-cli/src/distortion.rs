//! How far two meshes are apart, as `kn compare` and `kn demo` report it.

use anyhow::{Context, Result};
use kn_mesh::{BoundingBox, Mesh};
use kn_metrics::{
    DEFAULT_LEVELS, Interpolation, Msdm2Surface, SurfaceDistance, TriangleTree, msdm2,
    surface_distance,
};
use serde::Serialize;

/// What relative distances and decibels refer to: the box of the whole reference sequence.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Scale {
    /// Longest side, world units: the peak of the PSNR.
    pub(crate) side: f64,
    /// Diagonal, world units: the unit of relative distances.
    pub(crate) diagonal: f64,
}

impl From<BoundingBox> for Scale {
    fn from(bounds: BoundingBox) -> Self {
        Self { side: bounds.longest_side(), diagonal: bounds.diagonal() }
    }
}

/// Which metrics to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Depth {
    /// Point to surface only.
    Distance,
    /// MSDM2 too.
    Perceptual,
}

/// Distortion of one frame, or its mean over several.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Distortion {
    /// Point-to-surface RMS of the worse direction, relative to the diagonal.
    pub(crate) p2s_rms: f64,
    /// The same in world units.
    pub(crate) p2s_rms_world: f64,
    /// 10·log10(3·side²/rms²); infinite where the surfaces are equal.
    pub(crate) p2s_psnr: f64,
    /// Largest distance found, relative to the diagonal.
    pub(crate) hausdorff: f64,
    /// The same in world units.
    pub(crate) hausdorff_world: f64,
    /// MSDM2, symmetric, from the reference to the other, and back.
    #[serde(flatten)]
    pub(crate) perceptual: Option<Perceptual>,
}

/// MSDM2: 0 for equal, below 1.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Perceptual {
    pub(crate) msdm2: f64,
    /// The first mesh is the reference.
    pub(crate) msdm2_ab: f64,
    /// The second mesh is the reference.
    pub(crate) msdm2_ba: f64,
    /// Symmetric, with the curvature at the closest points: independent of the order of faces.
    pub(crate) msdm2_projected: f64,
}

/// A mesh prepared for measuring.
pub(crate) struct Surface {
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    tree: TriangleTree,
}
