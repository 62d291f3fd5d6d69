//! How far two meshes are apart, as `kn compare` and `kn demo` report it.

use anyhow::Result;
use kn_mesh::{BoundingBox, Mesh};
use kn_metrics::{Closest, DEFAULT_LEVELS, Interpolation, Msdm2Surface, TriangleTree, msdm2};
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

/// A mesh prepared for measuring: it costs a tree, and for MSDM2 the curvature.
pub(crate) struct Surface {
    positions: Vec<[f64; 3]>,
    tree: TriangleTree,
    perceptual: Option<Msdm2Surface>,
}

impl Surface {
    /// Prepares a mesh for those metrics.
    pub(crate) fn new(mesh: &Mesh, depth: Depth) -> Result<Self> {
        let positions = mesh.positions_f64();
        let tree = TriangleTree::new(&positions, &mesh.faces)?;
        let perceptual = match depth {
            Depth::Distance => None,
            Depth::Perceptual => Some(Msdm2Surface::new(&positions, &mesh.faces, DEFAULT_LEVELS)?),
        };
        Ok(Self { positions, tree, perceptual })
    }

    /// `#V of other` distances from the vertices of `other` to this surface, world units.
    pub(crate) fn distances_of(&self, other: &Self) -> Vec<f64> {
        let distance = |closest: Closest| closest.distance_squared.sqrt();
        self.tree.closest_all(&other.positions).into_iter().map(distance).collect()
    }
}

impl Distortion {
    /// Measures `other` against `reference`; MSDM2 where both are prepared for it.
    pub(crate) fn measure(reference: &Surface, other: &Surface, scale: &Scale) -> Self {
        let perceptual = Perceptual::measure(reference, other);
        Self { perceptual, ..Self::distance(reference, other, scale) }
    }

    /// Measures distances only.
    pub(crate) fn distance(reference: &Surface, other: &Surface, scale: &Scale) -> Self {
        let one_way = |from: &Surface, to: &Surface| {
            let distances = to.distances_of(from);
            let max = distances.iter().copied().fold(0.0, f64::max);
            ((distances.iter().map(|d| d * d).sum::<f64>() / distances.len() as f64).sqrt(), max)
        };
        let (forward, backward) = (one_way(reference, other), one_way(other, reference));
        let (rms, max) = (forward.0.max(backward.0), forward.1.max(backward.1));
        Self {
            p2s_rms: rms / scale.diagonal,
            p2s_rms_world: rms,
            p2s_psnr: 10.0 * (3.0 * (scale.side / rms).powi(2)).log10(),
            hausdorff: max / scale.diagonal,
            hausdorff_world: max,
            perceptual: None,
        }
    }

    /// The mean of each number; `None` where there is none to take it of.
    pub(crate) fn mean<'d>(all: impl Iterator<Item = &'d Self> + Clone) -> Option<Self> {
        let count = all.clone().count();
        let mean =
            |value: &dyn Fn(&Self) -> f64| all.clone().map(value).sum::<f64>() / count as f64;
        let perceptual = |value: fn(&Perceptual) -> f64| {
            mean(&|one: &Self| one.perceptual.as_ref().map_or(f64::NAN, value))
        };
        let has_perceptual = all.clone().all(|one| one.perceptual.is_some());
        (count > 0).then(|| Self {
            p2s_rms: mean(&|one| one.p2s_rms),
            p2s_rms_world: mean(&|one| one.p2s_rms_world),
            p2s_psnr: mean(&|one| one.p2s_psnr),
            hausdorff: mean(&|one| one.hausdorff),
            hausdorff_world: mean(&|one| one.hausdorff_world),
            perceptual: has_perceptual.then(|| Perceptual {
                msdm2: perceptual(|p| p.msdm2),
                msdm2_ab: perceptual(|p| p.msdm2_ab),
                msdm2_ba: perceptual(|p| p.msdm2_ba),
                msdm2_projected: perceptual(|p| p.msdm2_projected),
            }),
        })
    }
}

impl Perceptual {
    fn measure(reference: &Surface, other: &Surface) -> Option<Self> {
        let (reference, other) = (reference.perceptual.as_ref()?, other.perceptual.as_ref()?);
        let plain = msdm2(reference, other, Interpolation::AtVertex);
        let projected = msdm2(reference, other, Interpolation::Projected);
        Some(Self {
            msdm2: plain.symmetric,
            msdm2_ab: plain.forward.score,
            msdm2_ba: plain.backward.score,
            msdm2_projected: projected.symmetric,
        })
    }
}
