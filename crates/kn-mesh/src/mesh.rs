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

    /// The axis-aligned box of all vertices; `None` without vertices.
    pub fn bounding_box(&self) -> Option<BoundingBox> {
        BoundingBox::of(&self.positions)
    }

    /// `#V × 3` positions in binary64, for measuring.
    pub fn positions_f64(&self) -> Vec<[f64; 3]> {
        self.positions.iter().map(|p| p.map(f64::from)).collect()
    }
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
        (0..3).map(|axis| (self.max[axis] - self.min[axis]).powi(2)).sum::<f64>().sqrt()
    }
}
