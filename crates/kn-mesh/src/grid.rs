//! The sequence's grid: converts world coordinates to integers and back.

/// One grid for a whole sequence: `world = origin + step · integer`, the same step on all axes.
///
/// Integers are signed, so that later frames may leave the first frame's box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// World position of the integer point (0, 0, 0).
    pub origin: [f64; 3],
    /// Distance between neighbouring grid points in world units; finite and positive.
    pub step: f64,
}

/// The reason why a position has no place on the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GridError {
    /// A coordinate is NaN or infinite.
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
    },
    /// A coordinate lies further than [`Grid::LIMIT`] steps from the origin.
    Outside {
        /// Index of the vertex.
        vertex: usize,
    },
}

impl std::fmt::Display for GridError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotFinite { vertex } => write!(f, "vertex {vertex} is not finite"),
            Self::Outside { vertex } => write!(f, "vertex {vertex} lies outside the grid"),
        }
    }
}

impl std::error::Error for GridError {}

impl Grid {
    /// Integers on the grid are smaller than this in magnitude (2^20): with 8 fractional bits a
    /// reference position fits 29 bits and a squared distance of grid points is exact in binary64.
    pub const LIMIT: i32 = 1 << 20;

    /// The grid point nearest to every position, ties away from zero.
    ///
    /// # Errors
    /// The first vertex that is not finite or not within [`Grid::LIMIT`] of the origin.
    pub fn quantise(&self, positions: &[[f32; 3]]) -> Result<Vec<[i32; 3]>, GridError> {
        let mut integers = Vec::with_capacity(positions.len());
        for (vertex, position) in positions.iter().enumerate() {
            let mut integer = [0; 3];
            for axis in 0..3 {
                let world = f64::from(position[axis]);
                if !world.is_finite() {
                    return Err(GridError::NotFinite { vertex });
                }
                let steps = ((world - self.origin[axis]) / self.step).round();
                if steps.abs() >= f64::from(Self::LIMIT) {
                    return Err(GridError::Outside { vertex });
                }
                integer[axis] = steps as i32;
            }
            integers.push(integer);
        }
        Ok(integers)
    }

    /// The world position of a grid point, rounded once to binary32.
    pub fn dequantise(&self, integer: [i32; 3]) -> [f32; 3] {
        std::array::from_fn(|axis| {
            (self.origin[axis] + self.step * f64::from(integer[axis])) as f32
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_position_comes_back_within_half_a_step() {
        let grid = Grid { origin: [-1.0, 0.5, 2.0], step: 0.01 };
        let positions = [[-0.123, 0.879, 1.5], [-1.0, 0.5, 2.0], [3.0, -2.0, 0.0]];
        let integers = grid.quantise(&positions).expect("inside");
        assert_eq!(integers[1], [0, 0, 0]);
        for (position, integer) in positions.iter().zip(integers) {
            for axis in 0..3 {
                assert!((grid.dequantise(integer)[axis] - position[axis]).abs() <= 0.00501);
            }
        }
    }

    #[test]
    fn bad_coordinates_name_their_vertex() {
        let grid = Grid { origin: [0.0; 3], step: 1e-6 };
        let nan = grid.quantise(&[[0.0; 3], [0.0, f32::NAN, 0.0]]);
        assert_eq!(nan, Err(GridError::NotFinite { vertex: 1 }));
        assert_eq!(grid.quantise(&[[2.0, 0.0, 0.0]]), Err(GridError::Outside { vertex: 0 }));
    }
}
