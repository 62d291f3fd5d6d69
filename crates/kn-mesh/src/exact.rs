//! Search for the grid that coordinates lie on already: integers, fixed fractions, decimals.

use crate::{BoundingBox, Grid};

/// Looks for the coarsest grid that gives every coordinate of a sequence back to the last bit (but
/// the sign of a zero). Steps tried: 1, its halves down to 2^-20 and its tenths down to 10^-7.
#[derive(Clone, Debug)]
pub struct ExactGrid {
    /// Steps that hold for all positions so far, the largest first.
    steps: Vec<f64>,
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
    pub value: f32,
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
                     more than 20 bits"
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
        let halves = (1..=20).map(|n| 1.0 / f64::from(1 << n));
        // Written out: a power of 0.1 is not the number nearest to the decimal.
        let tenths = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
        let mut steps: Vec<f64> = std::iter::once(1.0).chain(halves).chain(tenths).collect();
        steps.sort_by(|a, b| b.total_cmp(a));
        Self { steps, bounds: None, frames: 0, finest: None }
    }
}

impl ExactGrid {
    /// Takes a frame's positions (`#V × 3`) into account.
    pub fn include(&mut self, positions: &[[f32; 3]]) {
        let coordinates = positions.as_flattened();
        let misfit = |&step: &f64| coordinates.iter().position(|&x| !is_multiple(x, step));
        let misfits: Vec<Option<usize>> = self.steps.iter().map(misfit).collect();
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
        let Some(&step) = self.steps.first() else {
            return Err(self.finest.map_or(ExactGridError::Empty, ExactGridError::NoStep));
        };
        let steps = (bounds.longest_side() / step).round();
        if steps >= f64::from(Grid::LIMIT) {
            return Err(ExactGridError::TooWide { step, steps, because: self.finest });
        }
        Ok(Grid { origin: bounds.min.map(|x| (x / step).round() * step), step })
    }
}

/// Whether `x` is what the nearest multiple of `step` rounds to.
fn is_multiple(x: f32, step: f64) -> bool {
    ((f64::from(x) / step).round() * step) as f32 == x
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(positions: &[[f32; 3]]) -> Result<Grid, ExactGridError> {
        let mut search = ExactGrid::default();
        search.include(positions);
        search.grid()
    }

    #[test]
    fn the_coarsest_grid_is_found_and_gives_everything_back() {
        for (scale, step) in [(1.0, 1.0), (0.125, 0.125), (1e-3, 1e-3), (0.05, 1e-2)] {
            let place = |i: i32| (f64::from(i * 7919 % 40_001 - 20_000) * scale) as f32;
            let positions: Vec<_> =
                (0..500).map(|i| [place(i), place(i + 1), place(3 * i)]).collect();
            let grid = grid(&positions).expect("on a grid");
            assert_eq!(grid.step, step);
            let integers = grid.quantise(&positions).expect("inside");
            assert!(integers.iter().zip(&positions).all(|(&q, &p)| grid.dequantise(q) == p));
        }
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
        search.include(&[[f32::NAN, 0.0, 0.0]]);
        let found = search.grid().expect_err("no number");
        assert!(matches!(found, ExactGridError::NoStep(Coordinate { frame: 1, vertex: 0, .. })));
        assert_eq!(found.frame(), Some(1));
    }
}
