//! The two mesh types: floats in world units, integers on the sequence's grid.

/// A triangle mesh in world units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// `#V × 3`, world units.
    pub positions: Vec<[f32; 3]>,
    /// `#F × 3` indices into `positions`.
    pub faces: Vec<[u32; 3]>,
    /// `#V` body-part labels, or empty where the mesh carries none.
    pub labels: Vec<u8>,
}

impl Mesh {
    /// Empties the mesh and keeps its buffers.
    pub fn clear(&mut self) {
        self.positions.clear();
        self.faces.clear();
        self.labels.clear();
    }

    /// Checks what every algorithm of this workspace relies on: finite coordinates, faces that
    /// index existing vertices, and no labels or one per vertex.
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
        let not_finite = |p: &[f32; 3]| p.iter().any(|coordinate| !coordinate.is_finite());
        if let Some(vertex) = self.positions.iter().position(not_finite) {
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

    /// The axis-aligned box of the faces whose three corners lie apart: that of the mesh when it has been
    /// cleaned and its isolated vertices dropped. `None` without such a face.
    pub fn surface_box(&self) -> Option<BoundingBox> {
        let corners = |face: &[u32; 3]| face.map(|vertex| self.positions[vertex as usize]);
        let apart = |&[a, b, c]: &[[f32; 3]; 3]| a != b && b != c && c != a;
        let mut bounds: Option<BoundingBox> = None;
        for corner in self.faces.iter().map(corners).filter(apart).flatten() {
            let corner = corner.map(f64::from);
            bounds.get_or_insert(BoundingBox { min: corner, max: corner }).include(corner);
        }
        bounds
    }

    /// `#V × 3` positions in binary64, for measuring.
    pub fn positions_f64(&self) -> Vec<[f64; 3]> {
        self.positions.iter().map(|p| p.map(f64::from)).collect()
    }
}

/// Most vertices or faces of a mesh: half-edge numbers (three per face) fit 32 bits.
const MAX_COUNT: usize = u32::MAX as usize / 3;

/// Why a [`Mesh`] is no valid mesh. Vertices and faces are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MeshFault {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is NaN or infinite")]
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
    /// More vertices or faces than 32-bit half-edge numbers can address.
    #[error("{vertices} vertices and {faces} faces are more than 1431655765")]
    TooLarge {
        /// The number of vertices.
        vertices: usize,
        /// The number of faces.
        faces: usize,
    },
}

/// A triangle mesh whose positions are integers: grid steps, or a fixed-point fraction of them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GridMesh {
    /// `#V × 3`, grid steps (or fractions, where the owner says so).
    pub positions: Vec<[i32; 3]>,
    /// `#F × 3` indices into `positions`.
    pub faces: Vec<[u32; 3]>,
    /// `#V` body-part labels, or empty where the mesh carries none.
    pub labels: Vec<u8>,
}

impl GridMesh {
    /// Empties the mesh and keeps its buffers.
    pub fn clear(&mut self) {
        self.positions.clear();
        self.faces.clear();
        self.labels.clear();
    }
}

/// An axis-aligned box in world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundingBox {
    /// Smallest coordinate on each axis.
    pub min: [f64; 3],
    /// Largest coordinate on each axis.
    pub max: [f64; 3],
}

impl BoundingBox {
    /// The box of `positions` (`#V × 3`); `None` where there are none.
    pub fn of(positions: &[[f32; 3]]) -> Option<Self> {
        let first = positions.first()?.map(f64::from);
        let mut bounds = Self { min: first, max: first };
        for position in positions {
            bounds.include(position.map(f64::from));
        }
        Some(bounds)
    }

    /// Grows the box so that it holds `point`.
    pub fn include(&mut self, point: [f64; 3]) {
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(point[axis]);
            self.max[axis] = self.max[axis].max(point[axis]);
        }
    }

    /// The smallest box that holds both.
    pub fn union(mut self, other: Self) -> Self {
        self.include(other.min);
        self.include(other.max);
        self
    }

    /// The longest side.
    pub fn longest_side(&self) -> f64 {
        (0..3).map(|axis| self.max[axis] - self.min[axis]).fold(0.0, f64::max)
    }

    /// The length of the diagonal.
    pub fn diagonal(&self) -> f64 {
        let side = |axis: usize| self.max[axis] - self.min[axis];
        (0..3).map(|axis| side(axis) * side(axis)).sum::<f64>().sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_name_their_place() {
        let good = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            faces: vec![[0, 1, 2]],
            labels: vec![0, 1, 2],
        };
        assert_eq!(good.check(), Ok(()));
        let mut bad = good.clone();
        bad.positions[2][1] = f32::NEG_INFINITY;
        assert_eq!(bad.check(), Err(MeshFault::NotFinite { vertex: 2 }));
        let mut bad = good.clone();
        bad.faces.push([0, 3, 1]);
        assert_eq!(bad.check(), Err(MeshFault::FaceIndex { face: 1, index: 3, vertices: 3 }));
        let mut bad = good;
        bad.labels.pop();
        assert_eq!(bad.check(), Err(MeshFault::LabelCount { labels: 2, vertices: 3 }));
    }
}
