//! The triangle mesh, in world units or on the sequence's grid.

use crate::{BoundingBox, Precision, vec3};

/// A mesh in world units, in binary64: a scan may lie far from the origin.
pub type Mesh = TriangleMesh<f64>;

/// A mesh whose positions are integers: grid steps, or a fixed-point fraction of them where its
/// owner says so.
pub type GridMesh = TriangleMesh<i32>;

/// A triangle mesh with coordinates of type `C` and the attributes that the codec carries.
///
/// It is made by [`new`](Self::new) and the `with_` methods, or by `default` where the buffers are
/// filled again and again. Fields can be read and written in place. No code outside this crate
/// can list them all, so a new attribute breaks no user.
///
/// # How an attribute comes in
///
/// Attributes belong to a vertex (`#V`: labels today; colours), to a face (`#F`: a material) or to
/// a corner (`#F × 3` indices into a table of values: texture coordinates with seams; a vertex on a
/// seam stays one vertex). What belongs to a frame as a whole, such as a texture, stays beside the
/// mesh. A new attribute is one more field here, empty where a mesh does not have it, and has to be
/// carried through these places:
///
/// 1. [`clear`](Self::clear) and [`check`](Mesh::check), in this file;
/// 2. [`map_vertices`](Self::map_vertices), [`retain_faces`](Self::retain_faces) and
///    [`replace_faces`](Self::replace_faces). Welding, cleaning, dropping isolated vertices and
///    decimation change a mesh through these three alone;
/// 3. kn-io, which reads and writes it;
/// 4. the intra coder of kn-codec, which orders vertices and faces anew.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct TriangleMesh<C> {
    /// `#V × 3`.
    pub positions: Vec<[C; 3]>,
    /// `#F × 3` indices into `positions`.
    pub faces: Vec<[u32; 3]>,
    /// `#V` body-part labels, or empty where the mesh carries none.
    pub labels: Vec<u8>,
}

impl<C> TriangleMesh<C> {
    /// Makes a mesh of `positions` (`#V × 3`) and `faces` (`#F × 3` indices into `positions`),
    /// without attributes. Nothing is checked; see [`Mesh::check`].
    pub fn new(positions: Vec<[C; 3]>, faces: Vec<[u32; 3]>) -> Self {
        Self { positions, faces, labels: Vec::new() }
    }

    /// Whether there is no vertex, and so no face: an empty frame of a sequence.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Sets the labels: one for each vertex, or none at all.
    pub fn with_labels(self, labels: Vec<u8>) -> Self {
        Self { labels, ..self }
    }

    /// Copies the mesh with the vertices at other `positions` (`#V × 3`), which may have another
    /// type of coordinate.
    pub fn with_positions<D>(&self, positions: Vec<[D; 3]>) -> TriangleMesh<D> {
        TriangleMesh { positions, faces: self.faces.clone(), labels: self.labels.clone() }
    }

    /// Empties the mesh and keeps its buffers.
    pub fn clear(&mut self) {
        self.positions.clear();
        self.faces.clear();
        self.labels.clear();
    }
}

impl Mesh {
    /// Checks what every algorithm of this workspace relies on: coordinates within
    /// [`MAX_COORDINATE`], faces that index existing vertices, and no labels or one per vertex.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check(&self) -> Result<(), MeshFault> {
        let vertices = self.positions.len();
        if vertices > MAX_COUNT || self.faces.len() > MAX_COUNT {
            return Err(MeshFault::TooLarge { vertices, faces: self.faces.len() });
        }
        if !self.labels.is_empty() && self.labels.len() != vertices {
            return Err(MeshFault::LabelCount { labels: self.labels.len(), vertices });
        }
        let unusable =
            |p: &[f64; 3]| !p.iter().all(|coordinate| coordinate.abs() <= MAX_COORDINATE);
        if let Some(vertex) = self.positions.iter().position(unusable) {
            return Err(MeshFault::NotFinite { vertex });
        }
        for (face, corners) in self.faces.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&index| index as usize >= vertices) {
                return Err(MeshFault::FaceIndex { face, index, vertices });
            }
        }
        Ok(())
    }

    /// The axis-aligned box of all vertices; `None` without vertices.
    pub fn bounding_box(&self) -> Option<BoundingBox> {
        BoundingBox::of(&self.positions)
    }

    /// The axis-aligned box of the faces whose three corners lie apart: that of the mesh when it
    /// has been cleaned and its isolated vertices dropped. `None` without such a face.
    pub fn surface_box(&self) -> Option<BoundingBox> {
        let corners = |face: &[u32; 3]| face.map(|vertex| self.positions[vertex as usize]);
        let apart = |&[a, b, c]: &[[f64; 3]; 3]| a != b && b != c && c != a;
        let mut bounds: Option<BoundingBox> = None;
        for corner in self.faces.iter().map(corners).filter(apart).flatten() {
            bounds.get_or_insert(BoundingBox { min: corner, max: corner }).include(corner);
        }
        bounds
    }

    /// The precision that a file of this mesh needs, see [`BoundingBox::precision`].
    pub fn precision(&self) -> Precision {
        self.bounding_box().map_or(Precision::Single, |bounds| bounds.precision())
    }

    /// `#V × 3` positions relative to the middle of the box, in binary32: for what looks at a mesh
    /// and needs no more.
    pub fn centred(&self) -> Vec<[f32; 3]> {
        let middle = self.bounding_box().map_or([0.0; 3], |bounds| bounds.middle());
        self.positions.iter().map(|&p| vec3::sub(p, middle).map(|x| x as f32)).collect()
    }
}

/// The largest coordinate of a mesh, in magnitude: squares and cubes of lengths stay far inside
/// binary64, and files can have any coordinate in binary32.
pub const MAX_COORDINATE: f64 = 1e38;

/// Most vertices or faces of a mesh: half-edge numbers (three per face) fit 32 bits.
const MAX_COUNT: usize = u32::MAX as usize / 3;

/// The reason why a [`Mesh`] is not valid. Vertices and faces are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MeshFault {
    /// A coordinate is NaN, infinite, or beyond [`MAX_COORDINATE`].
    #[error("vertex {vertex} has a coordinate that is NaN or infinite, or beyond 1e38")]
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
    },
    /// A face uses a vertex that does not exist.
    #[error("face {face} uses vertex {index}, but there are {vertices} vertices")]
    FaceIndex {
        /// Index of the face.
        face: usize,
        /// The vertex index it holds.
        index: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// The labels are neither absent nor one per vertex.
    #[error("{labels} labels for {vertices} vertices")]
    LabelCount {
        /// The number of labels.
        labels: usize,
        /// The number of vertices.
        vertices: usize,
    },
    /// There are more vertices or faces than 32-bit half-edge numbers can address.
    #[error("{vertices} vertices and {faces} faces are more than 1431655765")]
    TooLarge {
        /// The number of vertices.
        vertices: usize,
        /// The number of faces.
        faces: usize,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_name_their_place() {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let good = Mesh::new(positions, vec![[0, 1, 2]]).with_labels(vec![0, 1, 2]);
        assert_eq!(good.check(), Ok(()));
        let mut bad = good.clone();
        bad.positions[2][1] = f64::NEG_INFINITY;
        assert_eq!(bad.check(), Err(MeshFault::NotFinite { vertex: 2 }));
        let mut bad = good.clone();
        bad.faces.push([0, 3, 1]);
        assert_eq!(bad.check(), Err(MeshFault::FaceIndex { face: 1, index: 3, vertices: 3 }));
        let mut bad = good;
        bad.labels.pop();
        assert_eq!(bad.check(), Err(MeshFault::LabelCount { labels: 2, vertices: 3 }));
    }
}
