//! Meshes as the metrics take them: borrowed, with a BVH over the faces, or fully prepared.

use kn_mesh::{BoundingBox, Mesh};

use crate::compare::{CompareError, CompareOptions};
use crate::msdm2::{DEFAULT_LEVELS, Interpolation, Msdm2Surface, msdm2};
use crate::tree::{Closest, TriangleTree};

/// A borrowed triangle mesh in world units.
#[derive(Clone, Copy, Debug)]
pub struct MeshRef<'m> {
    /// `#V × 3`.
    pub positions: &'m [[f64; 3]],
    /// `#F × 3` indices into `positions`.
    pub faces: &'m [[u32; 3]],
}

impl<'m> MeshRef<'m> {
    /// Makes a mesh of `positions` (`#V × 3`) and `faces` (`#F × 3` indices into `positions`).
    /// Nothing is checked here: every metric checks its meshes.
    pub fn new(positions: &'m [[f64; 3]], faces: &'m [[u32; 3]]) -> Self {
        Self { positions, faces }
    }

    /// The axis-aligned box of all vertices; `None` without vertices.
    pub fn bounding_box(&self) -> Option<BoundingBox> {
        BoundingBox::of(self.positions)
    }
}

impl<'m> From<&'m Mesh> for MeshRef<'m> {
    fn from(mesh: &'m Mesh) -> Self {
        Self::new(&mesh.positions, &mesh.faces)
    }
}

/// A mesh and the BVH over its faces.
#[derive(Clone, Copy, Debug)]
pub struct IndexedMesh<'m> {
    /// The mesh.
    pub mesh: MeshRef<'m>,
    /// The BVH over the same faces.
    pub tree: &'m TriangleTree,
}

impl<'m> IndexedMesh<'m> {
    /// Joins a mesh and `tree`, which must be made of the same mesh.
    pub fn new(mesh: MeshRef<'m>, tree: &'m TriangleTree) -> Self {
        Self { mesh, tree }
    }
}

/// The closest points of each vertex in both directions. They serve all metrics that start from the
/// vertices.
#[derive(Clone, Debug)]
pub(crate) struct Matches {
    /// `#V` of the reference: the closest points of the other mesh.
    pub(crate) from_reference: Vec<Closest>,
    /// `#V` of the other mesh: the closest points of the reference.
    pub(crate) from_other: Vec<Closest>,
}

impl Matches {
    pub(crate) fn new(reference: IndexedMesh<'_>, other: IndexedMesh<'_>) -> Self {
        Self {
            from_reference: other.tree.closest_all(reference.mesh.positions),
            from_other: reference.tree.closest_all(other.mesh.positions),
        }
    }
}

/// A mesh that is prepared for comparisons. Preparing builds the BVH and, for MSDM2, computes the
/// curvature. A mesh that is compared several times is prepared once.
#[derive(Clone, Debug)]
pub struct Surface {
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    prepared: Prepared,
}

/// MSDM2 brings its tree.
#[derive(Clone, Debug)]
enum Prepared {
    Distance(TriangleTree),
    Perceptual(Box<Msdm2Surface>),
}

impl Surface {
    /// Prepares a mesh for the metrics that `options` name.
    ///
    /// # Errors
    /// The mesh has no faces, a face names no vertex, or a coordinate is not finite; for MSDM2
    /// also: the mesh has no extent.
    pub fn new(mesh: MeshRef<'_>, options: &CompareOptions) -> Result<Self, CompareError> {
        let prepared = if options.msdm2 {
            let surface = Msdm2Surface::new(mesh.positions, mesh.faces, DEFAULT_LEVELS)?;
            Prepared::Perceptual(Box::new(surface))
        } else {
            Prepared::Distance(TriangleTree::new(mesh.positions, mesh.faces)?)
        };
        Ok(Self { positions: mesh.positions.to_vec(), faces: mesh.faces.to_vec(), prepared })
    }

    /// The mesh.
    pub fn mesh(&self) -> MeshRef<'_> {
        MeshRef::new(&self.positions, &self.faces)
    }

    /// The BVH over the faces.
    pub fn tree(&self) -> &TriangleTree {
        match &self.prepared {
            Prepared::Distance(tree) => tree,
            Prepared::Perceptual(surface) => surface.tree(),
        }
    }

    /// The mesh and its BVH.
    pub fn indexed(&self) -> IndexedMesh<'_> {
        IndexedMesh::new(self.mesh(), self.tree())
    }

    /// The surface prepared for MSDM2; `None` where it was prepared without it.
    pub fn perceptual(&self) -> Option<&Msdm2Surface> {
        match &self.prepared {
            Prepared::Distance(_) => None,
            Prepared::Perceptual(surface) => Some(surface),
        }
    }

    /// Distances from the vertices of this surface to `other`, `#V` in world units.
    pub fn vertex_distances(&self, other: &Self) -> Vec<f64> {
        let closest = other.tree().closest_all(&self.positions);
        closest.into_iter().map(|closest| closest.distance_squared.sqrt()).collect()
    }

    /// MSDM2 of the vertices of this surface against `reference`, `#V` values from 0 to 1. `None`
    /// where one of the two surfaces was prepared without MSDM2.
    pub fn vertex_msdm2(&self, reference: &Self) -> Option<Vec<f64>> {
        let (reference, own) = (reference.perceptual()?, self.perceptual()?);
        Some(msdm2(reference, own, Interpolation::AtVertex).forward.local)
    }
}
