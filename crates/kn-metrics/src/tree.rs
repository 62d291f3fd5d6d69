//! Exact closest points on a triangle mesh.

use rayon::prelude::*;

use crate::bvh::{self, Bounds, Item, LANES, Node};
use kn_mesh::vec3::{Vec3, scale, sub};
use leaf::Leaf;
use triangle::Triangle;

mod leaf;
mod query;
mod triangle;

/// Queries that share hints and a thread.
const CHUNK: usize = 512;

/// Beyond this the fourth power of a distance overflows.
const LARGEST: f64 = 1e60;

/// The reason why no BVH can be built over a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TreeError {
    /// There are no faces.
    #[error("the mesh has no faces")]
    NoFaces,
    /// There are more faces than the BVH can number.
    #[error("the mesh has more than {} faces", i32::MAX)]
    TooManyFaces,
    /// A face names a vertex that does not exist.
    #[error("face {face} refers to vertex {vertex}, but there are {vertex_count}")]
    VertexOutOfRange {
        /// The first such face.
        face: usize,
        /// The vertex it names.
        vertex: u32,
        /// `#V`.
        vertex_count: usize,
    },
    /// A coordinate is not a number, infinite, or beyond ±1e60.
    #[error("vertex {vertex} has a coordinate that is not a number within ±1e60")]
    NotFinite {
        /// The first such vertex.
        vertex: usize,
    },
}

/// The point of a surface that is closest to a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// Index of the face that the point is on.
    pub face: u32,
    /// The point, world units.
    pub point: [f64; 3],
    /// Weights of the face's corners, in the face's order: at least 0, sum 1.
    pub barycentric: [f64; 3],
    /// Squared distance between the query and `point`.
    pub distance_squared: f64,
}

/// A bounding-volume hierarchy (BVH) over the faces of a mesh. It answers closest-point queries
/// exactly.
///
/// Faces without area count as the segment or the point that they are. Memory: about 250 bytes a
/// face.
#[derive(Clone, Debug)]
pub struct TriangleTree {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    /// `#F`, in the order of the faces.
    triangles: Vec<Triangle>,
    centre: Vec3,
    /// From world units to normalised ones, in which the box's longest side is 2.
    to_unit: f64,
}

impl TriangleTree {
    /// Builds the BVH over `faces` (`#F × 3`, indices into `positions`, `#V × 3`).
    ///
    /// # Errors
    /// There is no face, an index is out of range, or a coordinate is no number within ±1e60 (also
    /// of a vertex without faces).
    pub fn new(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<Self, TreeError> {
        check(positions, faces)?;
        let corners = |face: usize| faces[face].map(|vertex| positions[vertex as usize]);
        let (mut min, mut max) = (corners(0)[0], corners(0)[0]);
        for corner in faces.iter().flatten().map(|&vertex| positions[vertex as usize]) {
            for axis in 0..3 {
                min[axis] = min[axis].min(corner[axis]);
                max[axis] = max[axis].max(corner[axis]);
            }
        }
        let centre = [0, 1, 2].map(|axis| 0.5 * (min[axis] + max[axis]));
        let longest = (0..3).map(|axis| max[axis] - min[axis]).fold(0.0, f64::max);
        let to_unit = if longest > 1e-100 { 2.0 / longest } else { 1.0 };
        let normalised = |face| corners(face).map(|corner| scale(sub(corner, centre), to_unit));
        let mut items: Vec<Item> = (0..faces.len())
            .map(|face| Item { bounds: bounds_of(normalised(face)), index: face as u32 })
            .collect();
        let mut leaves = Vec::with_capacity(faces.len() / 3 + 1);
        let nodes = bvh::build(&mut items, LANES, |_, items| {
            let mut leaf = Leaf::new();
            items.iter().for_each(|item| leaf.push(item.index, normalised(item.index as usize)));
            leaves.push(leaf);
        });
        let triangles = (0..faces.len()).map(|face| Triangle::new(corners(face))).collect();
        Ok(Self { nodes, leaves, triangles, centre, to_unit })
    }

    /// Number of faces.
    pub fn face_count(&self) -> usize {
        self.triangles.len()
    }

    /// Finds the closest point for each of `points`, on all threads of rayon's current pool. It is
    /// fastest where neighbours in the list are neighbours in space.
    pub fn closest_all(&self, points: &[[f64; 3]]) -> Vec<Closest> {
        let chunks = points.par_chunks(CHUNK).map(|chunk| {
            let mut hint = u32::MAX;
            let answer = |&point: &Vec3| {
                let closest = self.closest_from(point, hint);
                hint = closest.face;
                closest
            };
            chunk.iter().map(answer).collect::<Vec<_>>()
        });
        chunks.flatten_iter().collect()
    }

    fn normalise(&self, point: Vec3) -> Vec3 {
        scale(sub(point, self.centre), self.to_unit)
    }
}

/// The box of a triangle in normalised coordinates, rounded outwards.
fn bounds_of(corners: [Vec3; 3]) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    for corner in corners {
        bounds.include(corner.map(|x| x as f32));
    }
    // More than the rounding of coordinates in −1..=1; a thousandth of `leaf::ROUNDING`.
    bounds.widened(f32::EPSILON / 2.0)
}

/// Checks that all indices and coordinates can be used.
pub(crate) fn check(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<(), TreeError> {
    if faces.is_empty() {
        return Err(TreeError::NoFaces);
    }
    if faces.len() > i32::MAX as usize {
        return Err(TreeError::TooManyFaces);
    }
    let vertex_count = positions.len();
    for (face, corners) in faces.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&vertex| vertex as usize >= vertex_count) {
            return Err(TreeError::VertexOutOfRange { face, vertex, vertex_count });
        }
    }
    let usable = |position: &Vec3| position.iter().all(|x| x.abs() <= LARGEST);
    match positions.iter().position(|position| !usable(position)) {
        Some(vertex) => Err(TreeError::NotFinite { vertex }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
