//! Meshes as the metrics take them: borrowed, with a tree over the faces, or fully prepared.

use kn_mesh::{BoundingBox, Mesh, TriangleMesh};

use crate::compare::{CompareError, CompareOptions};
use crate::msdm2::{DEFAULT_LEVELS, Interpolation, Msdm2Surface, msdm2};
use crate::tree::TriangleTree;

/// A borrowed triangle mesh in world units.
#[derive(Clone, Copy, Debug)]
pub struct MeshRef<'m> {
    /// `#V × 3`.
    pub positions: &'m [[f64; 3]],
    /// `#F × 3` indices into `positions`.
    pub faces: &'m [[u32; 3]],
}

impl<'m> MeshRef<'m> {
    /// A mesh of `positions` (`#V × 3`) and `faces` (`#F × 3` indices into `positions`). Nothing is
    /// checked here: every metric checks what it is given.
    pub fn new(positions: &'m [[f64; 3]], faces: &'m [[u32; 3]]) -> Self {
        Self { positions, faces }
    }

    /// The axis-aligned box of all vertices; `None` without vertices.
    pub fn bounding_box(&self) -> Option<BoundingBox> {
        let &first = self.positions.first()?;
        let mut bounds = BoundingBox { min: first, max: first };
        self.positions.iter().for_each(|&position| bounds.include(position));
        Some(bounds)
    }
}

impl<'m> From<&'m TriangleMesh<f64>> for MeshRef<'m> {
    fn from(mesh: &'m TriangleMesh<f64>) -> Self {
        Self::new(&mesh.positions, &mesh.faces)
    }
}

/// A mesh and the tree over its faces.
#[derive(Clone, Copy, Debug)]
pub struct IndexedMesh<'m> {
    /// The mesh.
    pub mesh: MeshRef<'m>,
    /// The tree over the same faces.
    pub tree: &'m TriangleTree,
}

impl<'m> IndexedMesh<'m> {
    /// A mesh and `tree`, which was made of the same mesh.
    pub fn new(mesh: MeshRef<'m>, tree: &'m TriangleTree) -> Self {
        Self { mesh, tree }
    }
}

/// A mesh prepared to be compared with others. Preparing costs the tree, and for MSDM2 the
/// curvature: a mesh that is compared several times is prepared once.
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
    /// A mesh without faces, with a face that names no vertex, or with coordinates that are not
    /// finite; for MSDM2 also a mesh without extent.
    pub fn new(mesh: MeshRef<'_>, options: &CompareOptions) -> Result<Self, CompareError> {
        let prepared = if options.msdm2 {
            let surface = Msdm2Surface::new(mesh.positions, mesh.faces, DEFAULT_LEVELS)?;
            Prepared::Perceptual(Box::new(surface))
        } else {
            Prepared::Distance(TriangleTree::new(mesh.positions, mesh.faces)?)
        };
        Ok(Self { positions: mesh.positions.to_vec(), faces: mesh.faces.to_vec(), prepared })
    }

    /// Prepares a mesh with coordinates in binary32.
    ///
    /// # Errors
    /// As for [`Self::new`].
    pub fn of_mesh(mesh: &Mesh, options: &CompareOptions) -> Result<Self, CompareError> {
        Self::new(MeshRef::new(&mesh.positions_f64(), &mesh.faces), options)
    }

    /// The mesh.
    pub fn mesh(&self) -> MeshRef<'_> {
        MeshRef::new(&self.positions, &self.faces)
    }

    /// The tree over the faces.
    pub fn tree(&self) -> &TriangleTree {
        match &self.prepared {
            Prepared::Distance(tree) => tree,
            Prepared::Perceptual(surface) => surface.tree(),
        }
    }

    /// The mesh and its tree.
    pub fn indexed(&self) -> IndexedMesh<'_> {
        IndexedMesh::new(self.mesh(), self.tree())
    }

    /// What MSDM2 is computed of; `None` where the surface was prepared without it.
    pub fn perceptual(&self) -> Option<&Msdm2Surface> {
        match &self.prepared {
            Prepared::Distance(_) => None,
            Prepared::Perceptual(surface) => Some(surface),
        }
    }

    /// Distances from the own vertices to `other`, `#V` in world units.
    pub fn vertex_distances(&self, other: &Self) -> Vec<f64> {
        let closest = other.tree().closest_all(&self.positions);
        closest.into_iter().map(|closest| closest.distance_squared.sqrt()).collect()
    }

    /// MSDM2 of the own vertices against `reference`, `#V` values from 0 to 1; `None` where one of
    /// both surfaces was prepared without MSDM2.
    pub fn vertex_msdm2(&self, reference: &Self) -> Option<Vec<f64>> {
        let (reference, own) = (reference.perceptual()?, self.perceptual()?);
        Some(msdm2(reference, own, Interpolation::AtVertex).forward.local)
    }
}
