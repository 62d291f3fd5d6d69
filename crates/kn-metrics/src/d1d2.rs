//! MPEG's point metrics D1 and D2, on vertices, on samples of the surface and on points along a
//! grid.

use crate::p2s::{P2sError, psnr};
use crate::tree::TreeError;
use kn_mesh::vec3::{Vec3, mul_add, scale};
use nearest::Neighbours;

mod cloud;
mod grid;
mod nearest;

pub use cloud::PointCloud;
pub use grid::Grid;

/// The reason why points cannot be made of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PointError {
    /// The mesh has no faces, or indices or coordinates that cannot be used.
    #[error(transparent)]
    Mesh(#[from] TreeError),
    /// The surface cannot be sampled.
    #[error(transparent)]
    Samples(#[from] P2sError),
    /// A coordinate whose square binary32 does not hold.
    #[error("a coordinate is beyond ±1e18")]
    TooLarge,
    /// No grid line meets the mesh.
    #[error("no line of the grid meets the mesh")]
    NoPoints,
    /// The grid is too fine for the mesh, or the mesh far outside of the box.
    #[error("the grid cuts the mesh into more than {limit} points")]
    TooManyPoints {
        /// The largest number that is allowed.
        limit: usize,
    },
    /// A box without extent, or a grid of fewer than two lines.
    #[error("a grid needs a box with extent and at least two lines")]
    BadGrid,
}

/// Mean squared distances in both directions, in squared world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanSquares {
    /// Mean over the points of the reference.
    pub from_reference: f64,
    /// Mean over the points of the other cloud.
    pub from_other: f64,
}

impl MeanSquares {
    /// The larger of both.
    pub fn worse(&self) -> f64 {
        self.from_reference.max(self.from_other)
    }
}

/// D1 and D2 between two clouds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointDistortion {
    /// D1, point to point.
    pub d1: MeanSquares,
    /// D2, point to plane.
    pub d2: MeanSquares,
}

impl PointDistortion {
    /// PSNR of D1 in the worse direction, `10·log10(3·peak² / mse)`.
    pub fn d1_psnr(&self, peak: f64) -> f64 {
        psnr(self.d1.worse(), peak)
    }

    /// PSNR of D2 in the worse direction, `10·log10(3·peak² / mse)`.
    pub fn d2_psnr(&self, peak: f64) -> f64 {
        psnr(self.d2.worse(), peak)
    }
}

/// D1 and D2 between two clouds, as MPEG's tools define them.
///
/// Both directions of D2 use the reference's normals: a point of the other cloud takes the mean
/// normal of those reference points that it is nearest to, or, where it is nearest to none, of
/// those that are nearest to it. The way to the nearest point is projected on that point's normal;
/// equally near points count with the mean of their squares. As in MPEG's tool at most 30 points
/// count as equally near.
pub fn point_distortion(reference: &PointCloud, other: &PointCloud) -> PointDistortion {
    let (to_other, to_reference) =
        rayon::join(|| Neighbours::new(reference, other), || Neighbours::new(other, reference));
    let normals = inherited_normals(reference, other, &to_other, &to_reference);
    PointDistortion {
        d1: MeanSquares {
            from_reference: to_other.mean_square(),
            from_other: to_reference.mean_square(),
        },
        d2: MeanSquares {
            from_reference: to_other.mean_square_to_planes(reference, other, &normals),
            from_other: to_reference.mean_square_to_planes(other, reference, reference.normals()),
        },
    }
}

/// Normals for the points of `other`; means of unit vectors, themselves not of unit length, as in
/// MPEG's tool.
fn inherited_normals(
    reference: &PointCloud,
    other: &PointCloud,
    to_other: &Neighbours,
    to_reference: &Neighbours,
) -> Vec<Vec3> {
    let heirs = to_other.transposed(other.len());
    let mean = |points: &[u32]| {
        let sum = points
            .iter()
            .fold([0.0; 3], |sum, &index| mul_add(sum, 1.0, reference.normals()[index as usize]));
        scale(sum, 1.0 / points.len().max(1) as f64)
    };
    let nearest = |point| to_reference.nearest(point);
    let inherited =
        |(point, from): (usize, &[u32])| mean(if from.is_empty() { nearest(point) } else { from });
    heirs.iter().enumerate().map(inherited).collect()
}

#[cfg(test)]
mod tests;
