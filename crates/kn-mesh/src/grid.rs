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

/// The precision that the coordinates of a file need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// binary32 is enough.
    #[default]
    Single,
    /// binary32 would move vertices by a share of a grid step that counts: coordinates are written
    /// in binary64.
    Double,
}

impl Grid {
    /// Integers on the grid are smaller than this in magnitude (2^20): with 8 fractional bits a
    /// reference position fits 29 bits and a squared distance of grid points is exact in binary64.
    pub const LIMIT: i32 = 1 << 20;

    /// The grid point nearest to every position, ties away from zero.
    ///
    /// # Errors
    /// The first vertex that is not finite or not within [`Grid::LIMIT`] of the origin.
    pub fn quantise(&self, positions: &[[f64; 3]]) -> Result<Vec<[i32; 3]>, GridError> {
        let mut integers = Vec::with_capacity(positions.len());
        for (vertex, position) in positions.iter().enumerate() {
            let mut integer = [0; 3];
            for axis in 0..3 {
                let world = position[axis];
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

    /// The map from grid points to world positions.
    pub fn to_world(&self) -> GridToWorld {
        match self.points_per_unit() {
            Some(points) => {
                let origin = self.origin.map(|x| (x * points).round());
                GridToWorld { origin, step: 1.0, points }
            }
            None => GridToWorld { origin: self.origin, step: self.step, points: 1.0 },
        }
    }

    /// The precision that files of positions need, which are multiples of 2^−`fraction_bits` steps.
    ///
    /// Up to 2^17 steps from the world's origin to the grid's, binary32 moves a vertex by less than
    /// 1/64 of a step, and the files are half as large. Points of a grid of decimals are written in
    /// full: their numbers are short, and those of the file that was coded.
    pub fn precision(&self, fraction_bits: u8) -> Precision {
        let near = self.origin.iter().all(|x| x.abs() <= f64::from(Self::LIMIT / 8) * self.step);
        let decimals = fraction_bits == 0 && self.points_per_unit().is_some_and(is_power_of_ten);
        if near && !decimals { Precision::Single } else { Precision::Double }
    }

    /// How many steps make a unit, where that is an integer and the origin is a multiple of the
    /// step. The step of such a grid stands for the fraction 1/n, which binary64 may not hold.
    fn points_per_unit(&self) -> Option<f64> {
        let points = (1.0 / self.step).round();
        let multiple = |x: f64| {
            let count = (x * points).round();
            count.abs() < MOST_EXACT && count / points == x
        };
        let exact = (1.0..MOST_EXACT).contains(&points) && 1.0 / points == self.step;
        (exact && self.origin.iter().all(|&x| multiple(x))).then_some(points)
    }
}

/// Integers below this (2^52) and their sums with grid points are exact in binary64.
const MOST_EXACT: f64 = (1_u64 << 52) as f64;

fn is_power_of_ten(points: f64) -> bool {
    std::iter::successors(Some(10.0), |power| Some(power * 10.0))
        .take_while(|power| *power <= points)
        .any(|power| power == points)
}

/// The map from grid points to world positions, in binary64: (`origin` + `step` · integer) /
/// `points`. Where the step is 1/n, the division gives the number that is nearest to the decimal or
/// the fraction; one of `step` and `points` is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridToWorld {
    origin: [f64; 3],
    step: f64,
    points: f64,
}

impl GridToWorld {
    /// The world position of a grid point.
    #[inline]
    pub fn at(&self, integer: [i32; 3]) -> [f64; 3] {
        let coordinate =
            |axis: usize| (self.origin[axis] + self.step * f64::from(integer[axis])) / self.points;
        [coordinate(0), coordinate(1), coordinate(2)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_position_comes_back_within_half_a_step() {
        for far in [0.0, 691_234.567, -5_334_567.891] {
            let grid = Grid { origin: [far - 1.0, 0.5, 2.0], step: 0.011 };
            let positions = [[far - 0.123, 0.879, 1.5], [far - 1.0, 0.5, 2.0], [far, -2.0, 0.0]];
            let integers = grid.quantise(&positions).expect("inside");
            assert_eq!(integers[1], [0, 0, 0]);
            for (position, integer) in positions.iter().zip(integers) {
                for axis in 0..3 {
                    let off = (grid.to_world().at(integer)[axis] - position[axis]).abs();
                    assert!(off <= 0.0055 + 1e-9, "{off} at {far}");
                }
            }
        }
    }

    #[test]
    fn decimals_and_fractions_are_given_back_to_the_last_bit() {
        let decimals = Grid { origin: [691_234.567, 5_334_567.891, -0.3], step: 1e-3 };
        let world = [691_234.573, 5_335_067.89, 0.0];
        let integers = decimals.quantise(&[world]).expect("inside");
        assert_eq!(decimals.to_world().at(integers[0]), world);
        assert_eq!(decimals.precision(0), Precision::Double);
        let halves = Grid { origin: [-12.5, 0.0, 3.0], step: 0.5 };
        assert_eq!(halves.to_world().at([1, -7, 2]), [-12.0, -3.5, 4.0]);
        assert_eq!(halves.precision(0), Precision::Single);
        let near = Grid { origin: [-0.3; 3], ..decimals };
        assert_eq!([0, 8].map(|bits| near.precision(bits)), [Precision::Double, Precision::Single]);
        // The formula gives this as it is.
        let odd = Grid { origin: [0.1, 0.2, 0.3], step: 0.07 };
        assert_eq!(odd.to_world().at([3, 0, -1]), [0.1 + 0.07 * 3.0, 0.2, 0.3 - 0.07]);
    }

    #[test]
    fn far_from_the_origin_files_need_binary64() {
        let precision = |far: f64| Grid { origin: [0.0, far, 0.0], step: 1.1e-4 }.precision(8);
        let cases = [(0.0, Precision::Single), (-14.0, Precision::Single)];
        for (far, expected) in cases.into_iter().chain([(15.0, Precision::Double)]) {
            assert_eq!(precision(far), expected, "{far}");
        }
    }

    #[test]
    fn bad_coordinates_name_their_vertex() {
        let grid = Grid { origin: [0.0; 3], step: 1e-6 };
        let nan = grid.quantise(&[[0.0; 3], [0.0, f64::NAN, 0.0]]);
        assert_eq!(nan, Err(GridError::NotFinite { vertex: 1 }));
        assert_eq!(grid.quantise(&[[2.0, 0.0, 0.0]]), Err(GridError::Outside { vertex: 0 }));
    }
}
