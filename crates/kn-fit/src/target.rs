//! The mesh that a fit aims at, prepared once per frame.

use crate::constants::sampling::SAMPLES;
use crate::error::{FitError, Side};
use crate::geodesic::EdgeGraph;
use crate::reach::reach;
use crate::sample::Sample;
use crate::source::{check_length, check_mesh};
use crate::surface::{diagonal, vertex_areas, vertex_normals};
use kn_mesh::adjacency::EdgeTable;
use kn_mesh::vec3::{Vec3, add, dot, scale, unit};
use kn_metrics::{IndexedMesh, MeshRef, TriangleTree};

/// A target frame with what every pass needs of it.
#[derive(Debug)]
pub struct FitTarget {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) tree: TriangleTree,
    pub(crate) normals: Vec<Vec3>,
    pub(crate) boundary: Vec<bool>,
    /// `#V`, see [`reach`].
    pub(crate) reach: Vec<f64>,
    pub(crate) sample: Sample,
    /// Diagonal of the box.
    pub(crate) diagonal: f64,
    pub(crate) labels: Option<Vec<u8>>,
}

/// The deviation of a surface from a target: its distance, and the angle between the surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Root mean square distance, relative to the diagonal of the target's box.
    pub distance: f64,
    /// Mean of 1 − cos of the angle between the normals.
    pub bend: f64,
}

impl FitTarget {
    /// Prepares a cleaned scan: `positions` is `#V × 3`, `faces` `#F × 3`.
    ///
    /// # Errors
    /// A mesh without a surface, a coordinate that is not finite, a face out of range.
    pub fn new(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<Self, FitError> {
        check_mesh(positions, faces, Side::Target)?;
        let areas = vertex_areas(positions, faces);
        if areas.iter().sum::<f64>() <= 0.0 {
            return Err(FitError::NoSurface { mesh: Side::Target });
        }
        let table = EdgeTable::new(positions.len(), faces);
        let graph = EdgeGraph::new(positions, &table.edges, |_, _| true);
        let mut normals = Vec::new();
        vertex_normals(positions, faces, &mut normals);
        Ok(Self {
            tree: TriangleTree::new(positions, faces)
                .map_err(|source| FitError::Tree { mesh: Side::Target, source })?,
            normals,
            boundary: table.boundary_vertices(positions.len()),
            reach: reach(positions, &areas, &graph),
            sample: Sample::spread(positions, &areas, SAMPLES),
            diagonal: diagonal(positions),
            positions: positions.to_vec(),
            faces: faces.to_vec(),
            labels: None,
        })
    }

    /// The mesh, and the BVH over its faces.
    pub fn surface(&self) -> IndexedMesh<'_> {
        IndexedMesh::new(MeshRef::new(&self.positions, &self.faces), &self.tree)
    }

    /// The deviation of a surface, given by `points` (`#P × 3`) and its normals there (of any
    /// length), from the target.
    pub fn deviation(&self, points: &[Vec3], normals: &[Vec3]) -> Deviation {
        let (mut squared, mut bend) = (0.0, 0.0);
        for (closest, &normal) in self.tree.closest_all(points).iter().zip(normals) {
            let face = self.faces[closest.face as usize];
            let own = smooth_normal(&self.normals, face, closest.barycentric);
            squared += closest.distance_squared;
            bend += 1.0 - dot(own, unit(normal));
        }
        let count = points.len().max(1) as f64;
        Deviation { distance: (squared / count).sqrt() / self.diagonal, bend: bend / count }
    }

    /// Adds body-part labels (`#V`) for part-wise starts.
    ///
    /// # Errors
    /// `labels` does not have one entry per vertex.
    pub fn with_labels(mut self, labels: &[u8]) -> Result<Self, FitError> {
        check_length("labels", labels.len(), self.positions.len())?;
        self.labels = Some(labels.to_vec());
        Ok(self)
    }
}

/// The unit normal at a point of a face, between the normals of its corners.
pub(crate) fn smooth_normal(normals: &[Vec3], face: [u32; 3], barycentric: Vec3) -> Vec3 {
    let corner = |i: usize| scale(normals[face[i] as usize], barycentric[i]);
    unit(add(add(corner(0), corner(1)), corner(2)))
}

/// Whether a point of a face lies on the border of its mesh.
pub(crate) fn on_boundary(boundary: &[bool], face: [u32; 3], barycentric: Vec3) -> bool {
    // Inside the face all three weights are positive, and at most an edge can be on the border.
    let inner = barycentric.iter().all(|&w| w > 1e-9);
    let corners = (0..3).filter(|&i| barycentric[i] > 1e-9);
    !inner && corners.into_iter().all(|i| boundary[face[i] as usize])
}
