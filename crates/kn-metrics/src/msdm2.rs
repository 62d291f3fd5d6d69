//! MSDM2, the multi-scale mesh structural distortion measure.
//!
//! G. Lavoué, «A multiscale metric for 3D mesh visual quality assessment», Computer Graphics Forum
//! 30 (2011). It compares statistics of curvature over small neighbourhoods, after matching each
//! vertex of the distorted mesh with the closest point of the original.

use std::borrow::Cow;

use crate::surface::{IndexedMesh, Matches, MeshRef};
use crate::tree::{Closest, TreeError, TriangleTree, check};
use curvature::Ring;
use direction::Direction;
use kn_mesh::vec3::Vec3;
use topology::Topology;

mod curvature;
mod direction;
mod eigenvalues;
mod exp;
mod flood;
mod list;
mod machine;
mod matching;
mod sphere;
mod statistics;
mod topology;

/// The number of levels that MSDM2 is defined with.
pub const DEFAULT_LEVELS: usize = 3;

/// The largest number of levels.
pub const MAX_LEVELS: usize = 16;

/// Radius of the curvature's sphere at the first level, and its growth from level to level, as a
/// part of the box's longest side.
const FIRST_RADIUS: f64 = 0.002;
const RADIUS_STEP: f64 = 0.001;

/// Below this, fourth powers of edges leave binary64.
const LEAST_SIDE: f64 = 1e-60;

/// The reason why MSDM2 cannot be computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Msdm2Error {
    /// The mesh has no faces, or indices or coordinates that cannot be used.
    #[error(transparent)]
    Mesh(#[from] TreeError),
    /// All vertices of faces coincide, or are within 1e-60: there is no length to measure curvature
    /// in.
    #[error("the mesh has no extent")]
    NoExtent,
    /// There are no levels, or too many.
    #[error("{levels} levels asked for; 1 to {MAX_LEVELS} are defined")]
    Levels {
        /// The number of levels that was asked for.
        levels: usize,
    },
}

/// The point at which the curvature of a matched triangle is interpolated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// At the distorted vertex itself, as the reference program does. Where the closest point is
    /// on a side or a corner, the result depends on which of its faces is taken: the lowest, but
    /// at a corner one that starts with that corner goes first, as in the reference.
    #[default]
    AtVertex,
    /// At the closest point: does not depend on the order of faces.
    Projected,
}

/// A mesh prepared to be compared with others, as the original or as the distorted one.
///
/// Preparing costs the closest-point tree, the edges, and the curvature in the mesh's own unit;
/// an encoder that compares many candidates with one scan prepares the scan once.
#[derive(Clone, Debug)]
pub struct Msdm2Surface {
    positions: Vec<Vec3>,
    faces: Vec<[u32; 3]>,
    topology: Topology,
    rings: Vec<Ring>,
    tree: TriangleTree,
    /// `#V`: the lowest face that starts with the vertex, if any.
    first_faces: Vec<Option<u32>>,
    /// The longest side of the box.
    side: f64,
    levels: usize,
    /// `#V × levels`, for the radii that `side` gives.
    curvature: Vec<f64>,
}

/// MSDM2 from one distorted mesh to its original.
#[derive(Clone, Debug, PartialEq)]
pub struct Msdm2Direction {
    /// The distance: 0 for equal surfaces with equal tessellation, below 1.
    pub score: f64,
    /// `#V` of the distorted mesh: the mean over the levels for each vertex, 0 for isolated
    /// vertices.
    pub local: Vec<f64>,
    /// Number of vertices without an edge. They do not enter the score.
    pub isolated: usize,
    /// Number of vertices that the score is the mean of: all with an edge, or evenly chosen ones
    /// where the neighbourhoods hold nearly the whole mesh. Then the others have the value of the
    /// measured vertex before them.
    pub measured: usize,
}

/// MSDM2 in both directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Msdm2 {
    /// The mean of both directions.
    pub symmetric: f64,
    /// The distance of the distorted mesh from the reference, with values on the distorted mesh
    /// (D→O, `ab`).
    pub forward: Msdm2Direction,
    /// The reverse direction, with values on the reference (`ba`).
    pub backward: Msdm2Direction,
}

impl Msdm2Surface {
    /// Prepares a mesh: `positions` `#V × 3`, `faces` `#F × 3`, and the number of levels (usually
    /// [`DEFAULT_LEVELS`]).
    ///
    /// Safe on untrusted input; memory is proportional to the mesh. Vertices without faces do not
    /// count for the box. An edge with one face or more than two bends nothing; beside a face
    /// without area the curvature is 0.
    ///
    /// # Errors
    /// The errors of [`TriangleTree::new`]; all used vertices coincide; there is no level, or more
    /// than [`MAX_LEVELS`].
    pub fn new(
        positions: &[[f64; 3]],
        faces: &[[u32; 3]],
        levels: usize,
    ) -> Result<Self, Msdm2Error> {
        if !(1..=MAX_LEVELS).contains(&levels) {
            return Err(Msdm2Error::Levels { levels });
        }
        check(positions, faces)?;
        let side = longest_side(faces.iter().flatten().map(|&vertex| positions[vertex as usize]));
        if side < LEAST_SIDE {
            return Err(Msdm2Error::NoExtent);
        }
        let (topology, tree) = rayon::join(
            || Topology::new(positions, faces, side),
            || TriangleTree::new(positions, faces),
        );
        let rings = curvature::rings(&topology, positions);
        let radii = radii(side, levels);
        let curvature = curvature::curvature(&topology, &rings, positions, side, &radii);
        let mut first_faces = vec![None; positions.len()];
        for (index, face) in faces.iter().enumerate().rev() {
            first_faces[face[0] as usize] = Some(index as u32);
        }
        let (positions, faces) = (positions.to_vec(), faces.to_vec());
        Ok(Self {
            positions,
            faces,
            topology,
            rings,
            tree: tree?,
            first_faces,
            side,
            levels,
            curvature,
        })
    }

    /// The BVH over the faces.
    pub fn tree(&self) -> &TriangleTree {
        &self.tree
    }

    fn indexed(&self) -> IndexedMesh<'_> {
        IndexedMesh::new(MeshRef::new(&self.positions, &self.faces), &self.tree)
    }

    /// `#V × levels` curvatures in units of 1 / `side`, at the radii that `side` gives.
    fn curvature(&self, side: f64, levels: usize) -> Cow<'_, [f64]> {
        if side == self.side && levels == self.levels {
            return Cow::Borrowed(&self.curvature);
        }
        let radii = radii(side, levels);
        Cow::Owned(curvature::curvature(&self.topology, &self.rings, &self.positions, side, &radii))
    }
}

/// Computes MSDM2 in both directions, and the mean. The levels are those of `reference`.
pub fn msdm2(
    reference: &Msdm2Surface,
    degraded: &Msdm2Surface,
    interpolation: Interpolation,
) -> Msdm2 {
    let indexed = [reference, degraded].map(Msdm2Surface::indexed);
    let matches = Matches::new(indexed[0], indexed[1]);
    let mut found = msdm2_of_matches(reference, degraded, &matches, &[interpolation]);
    found.swap_remove(0)
}

/// MSDM2 for each of the interpolations, which share the neighbourhoods.
pub(crate) fn msdm2_of_matches(
    reference: &Msdm2Surface,
    degraded: &Msdm2Surface,
    matches: &Matches,
    interpolations: &[Interpolation],
) -> Vec<Msdm2> {
    let levels = reference.levels;
    let one_way = |original, distorted, matches: &[Closest]| {
        let matches = matching::preferred(original, matches);
        Direction::new(distorted, original, &matches, levels, interpolations).evaluate()
    };
    let forward = one_way(reference, degraded, &matches.from_other);
    let backward = one_way(degraded, reference, &matches.from_reference);
    let joined = |(forward, backward): (Msdm2Direction, Msdm2Direction)| Msdm2 {
        symmetric: 0.5 * (forward.score + backward.score),
        forward,
        backward,
    };
    forward.into_iter().zip(backward).map(joined).collect()
}

/// Computes MSDM2 from `distorted` to `original`. The levels are those of `original`.
pub fn msdm2_one_way(
    original: &Msdm2Surface,
    distorted: &Msdm2Surface,
    interpolation: Interpolation,
) -> Msdm2Direction {
    let matches = original.tree.closest_all(&distorted.positions);
    let matches = matching::preferred(original, &matches);
    let levels = original.levels;
    let mut found =
        Direction::new(distorted, original, &matches, levels, &[interpolation]).evaluate();
    found.swap_remove(0)
}

/// Radii of the curvature's spheres.
fn radii(side: f64, levels: usize) -> Vec<f64> {
    (0..levels).map(|level| side * (FIRST_RADIUS + RADIUS_STEP * level as f64)).collect()
}

fn longest_side(mut positions: impl Iterator<Item = Vec3>) -> f64 {
    let Some(first) = positions.next() else { return 0.0 };
    let (mut min, mut max) = (first, first);
    for position in positions {
        for axis in 0..3 {
            min[axis] = min[axis].min(position[axis]);
            max[axis] = max[axis].max(position[axis]);
        }
    }
    (0..3).map(|axis| max[axis] - min[axis]).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests;
