//! MPEG's point metrics D1 and D2, on vertices and on points sampled along a grid.

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::prelude::*;

use crate::p2s::psnr;
use crate::tree::{TreeError, check};
use kn_mesh::vec3::{Vec3, cross, dot, mul_add, norm, scale, sub};

mod grid;

pub use grid::Grid;

/// Points that a thread takes at least.
const CHUNK: usize = 1024;

/// Largest factor by which a point may be farther than the nearest one and still count as equally
/// near.
const EQUAL: f64 = 1.0 + 1e-9;

/// The reason why points cannot be made of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PointError {
    /// The mesh has no faces, or indices or coordinates that cannot be used.
    #[error(transparent)]
    Mesh(#[from] TreeError),
    /// No grid line meets the mesh.
    #[error("no line of the grid meets the mesh")]
    NoPoints,
    /// The grid is too fine for the mesh, or the mesh far outside of the box.
    #[error("the grid cuts the mesh into more than {limit} points")]
    TooManyPoints {
        /// The largest number that is allowed.
        limit: usize,
    },
    /// The search tree refuses the points.
    #[error("no search tree can be built over the points")]
    Tree,
    /// A box without extent, or a grid of fewer than two lines.
    #[error("a grid needs a box with extent and at least two lines")]
    BadGrid,
}

/// Points with normals. No two points are at the same place.
pub struct PointCloud {
    points: Vec<Vec3>,
    /// Unit, or zero where undefined.
    normals: Vec<Vec3>,
    tree: ImmutableKdTree<f64, 3>,
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

impl PointCloud {
    /// Makes points of the vertices, with normals weighted by the area of the faces around (`#V ×
    /// 3`, `#F × 3`).
    ///
    /// # Errors
    /// The errors of [`TriangleTree::new`](crate::TriangleTree::new).
    pub fn from_vertices(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<Self, PointError> {
        check(positions, faces)?;
        let mut normals = vec![[0.0; 3]; positions.len()];
        for face in faces {
            let [a, b, c] = face.map(|vertex| positions[vertex as usize]);
            let normal = cross(sub(b, a), sub(c, a));
            for &vertex in face {
                let sum = &mut normals[vertex as usize];
                *sum = mul_add(*sum, 1.0, normal);
            }
        }
        Self::merged(positions.iter().copied().zip(normals).collect())
    }

    /// Makes points where the lines of a grid meet the faces, with the faces' normals.
    ///
    /// # Errors
    /// The errors of [`TriangleTree::new`](crate::TriangleTree::new), no hit, or too many hits.
    pub fn from_grid(
        positions: &[[f64; 3]],
        faces: &[[u32; 3]],
        grid: &Grid,
    ) -> Result<Self, PointError> {
        check(positions, faces)?;
        let hits = grid.hits(positions, faces)?;
        if hits.is_empty() {
            return Err(PointError::NoPoints);
        }
        Self::merged(hits)
    }

    /// Points at the same place become one with the mean normal. Coordinates are rounded to
    /// binary32, in which MPEG's tools hold them: it decides what is at the same place and which
    /// neighbours are equally near.
    fn merged(mut points: Vec<(Vec3, Vec3)>) -> Result<Self, PointError> {
        let order = |a: &Vec3, b: &Vec3| {
            a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
        };
        for (point, _) in &mut points {
            *point = point.map(|x| f64::from(x as f32));
        }
        points.sort_by(|a, b| order(&a.0, &b.0));
        let (mut unique, mut normals) = (Vec::new(), Vec::new());
        for same in points.chunk_by(|a, b| a.0 == b.0) {
            let sum = same.iter().fold([0.0; 3], |sum, (_, normal)| mul_add(sum, 1.0, *normal));
            let length = norm(sum);
            unique.push(same[0].0);
            normals.push(if length > 0.0 { scale(sum, 1.0 / length) } else { [0.0; 3] });
        }
        let tree = ImmutableKdTree::new_from_slice(&unique).map_err(|_| PointError::Tree)?;
        Ok(Self { points: unique, normals, tree })
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there are no points. A cloud always has points, so this is false.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }
}

/// D1 and D2 between two clouds, as MPEG's tools define them.
///
/// Both directions of D2 use the reference's normals: a point of the other cloud takes the mean
/// normal of those reference points that it is nearest to, or, where it is nearest to none, of
/// those that are nearest to it. The way to the nearest point is projected on that point's normal;
/// equally near points count with the mean of their squares.
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
            from_other: to_reference.mean_square_to_planes(other, reference, &reference.normals),
        },
    }
}

/// The nearest points of one cloud for each point of another.
struct Neighbours {
    /// Squared.
    distances: Vec<f64>,
    /// Per point all that are equally near, in ascending order.
    nearest: Vec<Vec<u32>>,
}

impl Neighbours {
    fn new(from: &PointCloud, to: &PointCloud) -> Self {
        let found = from.points.par_iter().with_min_len(CHUNK).map(|point| {
            let query = to.tree.query(point).nearest_one::<SquaredEuclidean<f64>>().execute();
            let reach = query.distance * EQUAL;
            let around = to.tree.query(point).within::<SquaredEuclidean<f64>>(reach);
            let mut nearest: Vec<u32> =
                around.unsorted().execute().iter().map(|found| found.item).collect();
            nearest.sort_unstable();
            (query.distance, nearest)
        });
        let (distances, nearest) = found.unzip();
        Self { distances, nearest }
    }

    fn mean_square(&self) -> f64 {
        self.distances.iter().sum::<f64>() / self.distances.len() as f64
    }

    fn mean_square_to_planes(&self, from: &PointCloud, to: &PointCloud, normals: &[Vec3]) -> f64 {
        let mut sum = 0.0;
        for (point, nearest) in from.points.iter().zip(&self.nearest) {
            let to_plane = |&index: &u32| {
                dot(sub(to.points[index as usize], *point), normals[index as usize]).powi(2)
            };
            sum += nearest.iter().map(to_plane).sum::<f64>() / nearest.len().max(1) as f64;
        }
        sum / from.points.len() as f64
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
    let mut heirs: Vec<Vec<u32>> = vec![Vec::new(); other.len()];
    for (index, nearest) in to_other.nearest.iter().enumerate() {
        for &heir in nearest {
            heirs[heir as usize].push(index as u32);
        }
    }
    let mean = |points: &[u32]| {
        let sum = points
            .iter()
            .fold([0.0; 3], |sum, &index| mul_add(sum, 1.0, reference.normals[index as usize]));
        scale(sum, 1.0 / points.len().max(1) as f64)
    };
    heirs
        .iter()
        .zip(&to_reference.nearest)
        .map(|(from, nearest)| mean(if from.is_empty() { nearest } else { from }))
        .collect()
}

#[cfg(test)]
mod tests;
