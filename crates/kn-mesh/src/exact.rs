//! Search for the grid that coordinates lie on already: integers, fixed fractions, decimals.

use crate::{BoundingBox, Grid, Precision};

/// Looks for the coarsest grid that gives every coordinate of a sequence back to the last bit (but
/// the sign of a zero). Steps tried: 1, its halves down to 2^-20 and its tenths down to 10^-7.
///
/// A coordinate that is a binary32 number may also be what a decimal rounds to in binary32, as in a
/// file of such numbers: the grid then has the decimal. That is for coordinates near the origin
/// alone. Further out, decimals are too close to each other for binary32.
#[derive(Clone, Debug)]
pub struct ExactGrid {
    /// Steps that hold for all positions so far, the largest first.
    steps: Vec<Step>,
    bounds: Option<BoundingBox>,
    frames: usize,
    /// The last coordinate that ruled out the largest step so far.
    finest: Option<Coordinate>,
}

/// A coordinate of a sequence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinate {
    /// Number of the call of [`ExactGrid::include`] that had the coordinate, from 0.
    pub frame: usize,
    /// Index of the vertex.
    pub vertex: usize,
    /// The coordinate in world units.
    pub value: f64,
}

/// A step, 1/`points`.
#[derive(Clone, Copy, Debug)]
struct Step {
    points: f64,
    /// Whether all positions so far are multiples of it in binary64, not only in binary32.
    double: bool,
}

/// The reason why coordinates cannot be coded without loss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ExactGridError {
    /// There are no coordinates.
    Empty,
    /// The coordinates are not multiples of any step that is tried. This one ruled out the last
    /// step.
    NoStep(Coordinate),
    /// The box of the coordinates has 2^20 steps or more along an axis.
    TooWide {
        /// The step that all are multiples of, world units.
        step: f64,
        /// Number of steps along the longest side.
        steps: f64,
        /// The coordinate that needs a step as small as this; `None` where the step is the largest.
        because: Option<Coordinate>,
    },
}

impl std::fmt::Display for ExactGridError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Empty => f.write_str("there are no coordinates"),
            Self::NoStep(Coordinate { vertex, value, .. }) => write!(
                f,
                "vertex {vertex} has a coordinate {value}: together with those before they are \
                 neither integers nor multiples of a power of 1/2 (to 2^-20) or 1/10 (to 10^-7)"
            ),
            Self::TooWide { step, steps, because } => {
                if let Some(Coordinate { vertex, value, .. }) = because {
                    write!(f, "vertex {vertex} has a coordinate {value}: ")?;
                }
                write!(
                    f,
                    "the coordinates are multiples of {step}, but their box is {steps} steps long: \
                     too large for 20 bits"
                )
            }
        }
    }
}

impl ExactGridError {
    /// The frame of the coordinate that is the reason, where there is one.
    pub fn frame(&self) -> Option<usize> {
        match self {
            Self::Empty => None,
            Self::NoStep(coordinate) => Some(coordinate.frame),
            Self::TooWide { because, .. } => because.map(|coordinate| coordinate.frame),
        }
    }
}

impl std::error::Error for ExactGridError {}

impl Default for ExactGrid {
    fn default() -> Self {
        let halves = (1..=20).map(|n| f64::from(1 << n));
        let tenths = (1..=7).map(|n| f64::from(10_i32.pow(n)));
        let mut points: Vec<f64> = std::iter::once(1.0).chain(halves).chain(tenths).collect();
        points.sort_by(f64::total_cmp);
        let steps = points.into_iter().map(|points| Step { points, double: true }).collect();
        Self { steps, bounds: None, frames: 0, finest: None }
    }
}

impl ExactGrid {
    /// Takes a frame's positions (`#V × 3`) into account.
    pub fn include(&mut self, positions: &[[f64; 3]]) {
        let coordinates = positions.as_flattened();
        let misfit = |step: &mut Step| {
            coordinates.iter().position(|&x| match step.fit(x) {
                Some(precision) => {
                    step.double &= precision == Precision::Double;
                    false
                }
                None => true,
            })
        };
        let misfits: Vec<Option<usize>> = self.steps.iter_mut().map(misfit).collect();
        // The steps before the first that is left are ruled out; the last to go shows why.
        let ruled_out = misfits.iter().map_while(|misfit| *misfit).max();
        if let Some(at) = ruled_out {
            let (frame, value) = (self.frames, coordinates[at]);
            self.finest = Some(Coordinate { frame, vertex: at / 3, value });
        }
        let mut misfits = misfits.into_iter();
        self.steps.retain(|_| misfits.next().flatten().is_none());
        self.frames += 1;
        self.bounds = match (self.bounds, BoundingBox::of(positions)) {
            (Some(all), Some(one)) => Some(all.union(one)),
            (all, one) => all.or(one),
        };
    }

    /// The grid, with its origin at the lowest corner of all positions.
    ///
    /// # Errors
    /// No step holds for all coordinates, or the largest such step needs more than 20 bits.
    pub fn grid(&self) -> Result<Grid, ExactGridError> {
        let bounds = self.bounds.ok_or(ExactGridError::Empty)?;
        let near = |points: f64| {
            bounds.min.iter().chain(&bounds.max).all(|x| x.abs() * points <= f64::from(Grid::LIMIT))
        };
        let holds = |step: &&Step| step.double || near(step.points);
        let Some(&Step { points, .. }) = self.steps.iter().find(holds) else {
            return Err(self.finest.map_or(ExactGridError::Empty, ExactGridError::NoStep));
        };
        let step = 1.0 / points;
        let steps = (bounds.longest_side() * points).round();
        if steps >= f64::from(Grid::LIMIT) {
            return Err(ExactGridError::TooWide { step, steps, because: self.finest });
        }
        Ok(Grid { origin: bounds.min.map(|x| (x * points).round() / points), step })
    }
}

impl Step {
    /// The precision in which `x` is a multiple of the step; `None` where it is none.
    fn fit(&self, x: f64) -> Option<Precision> {
        let multiple = (x * self.points).round() / self.points;
        let single = || f64::from(multiple as f32) == x;
        match multiple == x {
            true => Some(Precision::Double),
            false => single().then_some(Precision::Single),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(positions: &[[f64; 3]]) -> Result<Grid, ExactGridError> {
        let mut search = ExactGrid::default();
        search.include(positions);
        search.grid()
    }

    #[test]
    fn the_coarsest_grid_is_found_and_gives_everything_back() {
        for (points, step) in [(1.0, 1.0), (8.0, 0.125), (1e3, 1e-3), (20.0, 1e-2)] {
            for far in [0.0, 691_234.0, -5_334_567.0] {
                let place = |i: i32| far + f64::from(i * 7919 % 40_001 - 20_000) / points;
                let decimal = |x: f64| format!("{x:.6}").parse::<f64>().expect("a number");
                let positions: Vec<_> =
                    (0..500).map(|i| [i, i + 1, 3 * i].map(place).map(decimal)).collect();
                let grid = grid(&positions).expect("on a grid");
                assert_eq!(grid.step, step);
                let (integers, world) =
                    (grid.quantise(&positions).expect("inside"), grid.to_world());
                assert!(integers.iter().zip(&positions).all(|(&q, &p)| world.at(q) == p));
            }
        }
    }

    #[test]
    fn decimals_in_binary32_are_taken_near_the_origin_alone() {
        let single = |x: f64| f64::from(x as f32);
        let near = [[0.1, -0.25, 1.7].map(single), [0.3; 3].map(single)];
        let found = grid(&near).expect("decimals");
        assert_eq!(found.step, 0.01);
        let world = found.to_world().at(found.quantise(&near).expect("inside")[0]);
        assert_eq!(world, [0.1, -0.25, 1.7]);
        // 10 km away these decimals are one binary32 number with others: it is taken as it is.
        let far = [[10_000.123; 3].map(single), [10_000.5; 3]];
        assert_eq!(grid(&far).expect("fractions").step, 1.0 / 512.0);
    }

    #[test]
    fn what_is_not_on_a_grid_is_refused_with_the_reason() {
        assert_eq!(grid(&[]), Err(ExactGridError::Empty));
        let no_step =
            |frame, vertex, value| Err(ExactGridError::NoStep(Coordinate { frame, vertex, value }));
        let odd = grid(&[[1.0; 3], [0.1, 1.234e-8, 0.0], [1.0; 3]]);
        assert_eq!(odd, no_step(0, 1, 1.234e-8));
        let wide = grid(&[[0.0; 3], [2_097_152.0, 0.0, 0.0]]);
        let (steps, because) = (2_097_152.0, None);
        assert_eq!(wide, Err(ExactGridError::TooWide { step: 1.0, steps, because }));
        let because = Some(Coordinate { frame: 0, vertex: 1, value: 0.5 });
        let wide = grid(&[[0.0; 3], [0.5; 3], [1_048_576.0, 0.0, 0.0]]);
        assert_eq!(wide, Err(ExactGridError::TooWide { step: 0.5, steps, because }));
        let mut search = ExactGrid::default();
        search.include(&[[3.0; 3]]);
        search.include(&[[f64::NAN, 0.0, 0.0]]);
        let found = search.grid().expect_err("no number");
        assert!(matches!(found, ExactGridError::NoStep(Coordinate { frame: 1, vertex: 0, .. })));
        assert_eq!(found.frame(), Some(1));
    }
}
