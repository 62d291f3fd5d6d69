//! All metrics of two meshes in one call.

use kn_mesh::vec3::sub;
use kn_mesh::{BoundingBox, Precision};

use crate::d1d2::{Grid, PointCloud, PointError, point_distortion};
use crate::msdm2::{Interpolation, Msdm2Error, msdm2_of_matches};
use crate::p2s::{P2s, P2sError, distances_to_surface, p2s_of_matches, sample_surface};
use crate::surface::{Matches, MeshRef, Surface};
use crate::tree::TreeError;

mod empty;
mod result;
#[cfg(feature = "serde")]
mod serial;

pub use empty::{EmptySide, compare_empty};
pub use result::{Comparison, Metric, UnknownMetric};

/// The reason why two meshes cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// A mesh without faces, or with indices or coordinates that cannot be used.
    #[error(transparent)]
    Mesh(#[from] TreeError),
    /// Point-to-surface distances cannot be measured.
    #[error(transparent)]
    Distance(#[from] P2sError),
    /// MSDM2 cannot be computed.
    #[error(transparent)]
    Msdm2(#[from] Msdm2Error),
    /// D1 and D2 cannot be computed.
    #[error("D1 and D2: {0}")]
    Points(#[from] PointError),
    /// The box that relative distances refer to has no extent.
    #[error("all vertices of the reference are at one point: relative distances need a box")]
    NoExtent,
    /// MSDM2 was asked for of a surface that was prepared without it.
    #[error("MSDM2: a surface was prepared without it")]
    NotPrepared,
}

/// The points that D1 and D2 measure a mesh by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PointSampling {
    /// The vertices and the samples of the surface, [`CompareOptions::samples`] of them.
    Surface,
    /// The points where the lines of a regular grid meet the faces, as in MPEG's test conditions:
    /// this many lines (1024 there) along the longest side of the box. A scanned person has about a
    /// million of them, and time and memory grow with their number.
    Grid(usize),
}

/// Options of a comparison: the metrics that are computed, and the number of samples.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CompareOptions {
    /// The box that relative distances (its diagonal) and decibels (its longest side) refer to. For
    /// a sequence it is the box of the whole reference. `None` is the box of the reference mesh.
    pub bounds: Option<BoundingBox>,
    /// Number of samples on each surface for point-to-surface distances, D1 and D2, uniform by area.
    pub samples: usize,
    /// Whether MSDM2 is computed, in both directions.
    pub msdm2: bool,
    /// Whether MSDM2 is also computed with the curvature at the closest points, which does not
    /// depend on the order of faces. Nothing happens without `msdm2`.
    pub projected: bool,
    /// The points for D1 and D2; `None` leaves D1 and D2 out.
    pub points: Option<PointSampling>,
}

impl CompareOptions {
    /// Options for point-to-surface distances only.
    pub fn distances() -> Self {
        Self { bounds: None, samples: 100_000, msdm2: false, projected: false, points: None }
    }

    /// Options for point-to-surface distances and MSDM2.
    pub fn perceptual() -> Self {
        Self { msdm2: true, ..Self::distances() }
    }

    /// Sets the box that the metrics are relative to.
    pub fn with_bounds(self, bounds: BoundingBox) -> Self {
        Self { bounds: Some(bounds), ..self }
    }
}

impl Default for CompareOptions {
    /// All metrics.
    fn default() -> Self {
        Self { projected: true, points: Some(PointSampling::Surface), ..Self::perceptual() }
    }
}

/// Measures `distorted` against `reference`, with the metrics that `options` name.
///
/// # Errors
/// A mesh that cannot be used: without faces or area, with a face that names no vertex, or with
/// coordinates that are not finite.
pub fn compare(
    reference: MeshRef<'_>,
    distorted: MeshRef<'_>,
    options: &CompareOptions,
) -> Result<Comparison, CompareError> {
    let (reference, distorted) =
        rayon::join(|| Surface::new(reference, options), || Surface::new(distorted, options));
    compare_surfaces(&reference?, &distorted?, options)
}

/// Measures like [`compare`], on surfaces that are prepared already. They must be prepared with
/// these options or with options that name more metrics.
///
/// # Errors
/// The errors of [`compare`], or MSDM2 of a surface that was prepared without it.
pub fn compare_surfaces(
    reference: &Surface,
    distorted: &Surface,
    options: &CompareOptions,
) -> Result<Comparison, CompareError> {
    let bounds = bounds_of(reference, options)?;
    let mut comparison = Comparison::default();
    let (from, to) = (reference.indexed(), distorted.indexed());
    let matches = Matches::new(from, to);
    comparison.set_distance(&p2s_of_matches(from, to, options.samples, &matches)?, &bounds);
    if options.msdm2 {
        set_msdm2(&mut comparison, reference, distorted, &matches, options.projected)?;
    }
    if let Some(sampling) = options.points {
        let cloud = |surface| cloud(surface, sampling, options.samples, &bounds);
        let points = point_distortion(&cloud(reference)?, &cloud(distorted)?);
        comparison.set(Metric::D1Psnr, points.d1_psnr(bounds.longest_side()));
        comparison.set(Metric::D2Psnr, points.d2_psnr(bounds.longest_side()));
    }
    Ok(comparison)
}

fn cloud(
    surface: &Surface,
    sampling: PointSampling,
    samples: usize,
    bounds: &BoundingBox,
) -> Result<PointCloud, PointError> {
    let mesh = surface.mesh();
    // Points are binary32. Far from the origin they are those of meshes that are moved there.
    let (origin, moved);
    let positions = match bounds.precision() {
        Precision::Single => {
            origin = [0.0; 3];
            mesh.positions
        }
        Precision::Double => {
            origin = bounds.min;
            moved = mesh.positions.iter().map(|&p| sub(p, origin)).collect::<Vec<_>>();
            &moved
        }
    };
    match sampling {
        PointSampling::Surface => PointCloud::from_surface(positions, mesh.faces, samples),
        PointSampling::Grid(lines) => {
            let grid = Grid::new(sub(bounds.min, origin), sub(bounds.max, origin), lines)?;
            PointCloud::from_grid(positions, mesh.faces, &grid)
        }
    }
}

/// Marked faces of both surfaces, such as those of a body part.
#[derive(Clone, Copy, Debug)]
pub struct FaceMarks<'m> {
    /// `#F` marks of the reference.
    pub reference: &'m [bool],
    /// `#F` marks of the distorted surface.
    pub distorted: &'m [bool],
}

/// Point-to-surface distances of marked faces: samples of the marked faces of either side against
/// the whole other surface. The other metrics are those of whole meshes and are left out.
///
/// # Errors
/// The errors of [`compare`]; the marks are not one per face; or no marked face has an area.
pub fn compare_faces(
    reference: &Surface,
    distorted: &Surface,
    marks: FaceMarks<'_>,
    options: &CompareOptions,
) -> Result<Comparison, CompareError> {
    let bounds = bounds_of(reference, options)?;
    let distances = |from: &Surface, marks: &[bool], to: &Surface| {
        let mesh = from.mesh();
        let points = sample_surface(mesh.positions, mesh.faces, Some(marks), options.samples)?;
        distances_to_surface(&points, None, to.tree())
    };
    let distance = P2s {
        from_reference: distances(reference, marks.reference, distorted)?,
        from_other: distances(distorted, marks.distorted, reference)?,
    };
    let mut comparison = Comparison::default();
    comparison.set_distance(&distance, &bounds);
    Ok(comparison)
}

fn bounds_of(reference: &Surface, options: &CompareOptions) -> Result<BoundingBox, CompareError> {
    let bounds = options.bounds.or_else(|| reference.mesh().bounding_box());
    bounds.filter(|bounds| bounds.diagonal() > 0.0).ok_or(CompareError::NoExtent)
}

fn set_msdm2(
    comparison: &mut Comparison,
    reference: &Surface,
    distorted: &Surface,
    matches: &Matches,
    projected: bool,
) -> Result<(), CompareError> {
    let both = reference.perceptual().zip(distorted.perceptual());
    let (reference, distorted) = both.ok_or(CompareError::NotPrepared)?;
    let interpolations = &[Interpolation::AtVertex, Interpolation::Projected];
    let interpolations = if projected { &interpolations[..] } else { &interpolations[..1] };
    let found = msdm2_of_matches(reference, distorted, matches, interpolations);
    if let Some(plain) = found.first() {
        comparison.set(Metric::Msdm2, plain.symmetric);
        comparison.set(Metric::Msdm2Forward, plain.forward.score);
        comparison.set(Metric::Msdm2Backward, plain.backward.score);
    }
    if let Some(projected) = found.get(1) {
        comparison.set(Metric::Msdm2Projected, projected.symmetric);
    }
    Ok(())
}

#[cfg(test)]
mod tests;
