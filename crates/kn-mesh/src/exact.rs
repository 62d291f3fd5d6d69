//! Grids that coordinates lie on already: integers, fixed fractions, decimals.

use crate::{BoundingBox, Grid};

/// Looks for the coarsest grid that gives every coordinate of a sequence back to the last bit (but
/// the sign of a zero). Steps tried: 1, its halves down to 2^-20 and its tenths down to 10^-7.
#[derive(Clone, Debug)]
pub struct ExactGrid {
    /// Steps that hold for all positions so far, the largest first.
    steps: Vec<f64>,
    bounds: Option<BoundingBox>,
}

/// Why coordinates cannot be coded without loss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ExactGridError {
    /// They are no multiples of a step that is tried, or there are none.
    NoStep,
    /// Their box has 2^20 steps or more along an axis.
    TooWide {
        /// The step that all are multiples of, world units.
        step: f64,
        /// Steps along the longest side.
        steps: f64,
    },
}

impl std::fmt::Display for ExactGridError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoStep => f.write_str(
                "the coordinates are neither integers nor multiples of a power of 1/2 (to 2^-20) or \
                 1/10 (to 10^-7)",
            ),
            Self::TooWide { step, steps } => write!(
                f,
                "the coordinates are multiples of {step}, but their box is {steps} steps long: more \
                 than 20 bits"
            ),
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
        Self { steps, bounds: None }
    }
}

impl ExactGrid {
    /// Takes a frame's positions (`#V × 3`) into account.
    pub fn include(&mut self, positions: &[[f32; 3]]) {
        let coordinates = positions.as_flattened();
        self.steps.retain(|&step| coordinates.iter().all(|&x| is_multiple(x, step)));
        self.bounds = match (self.bounds, BoundingBox::of(positions)) {
            (Some(all), Some(one)) => Some(all.union(one)),
            (all, one) => all.or(one),
        };
    }

    /// The grid, with its origin at the lowest corner of all positions.
    ///
    /// # Errors
    /// No step holds for all, or the largest that does needs more than 20 bits.
    pub fn grid(&self) -> Result<Grid, ExactGridError> {
        let (Some(&step), Some(bounds)) = (self.steps.first(), self.bounds) else {
            return Err(ExactGridError::NoStep);
        };
        let steps = (bounds.longest_side() / step).round();
        if steps >= f64::from(Grid::LIMIT) {
            return Err(ExactGridError::TooWide { step, steps });
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
        assert_eq!(grid(&[]), Err(ExactGridError::NoStep));
        assert_eq!(grid(&[[0.1, 1.234e-8, 0.0]]), Err(ExactGridError::NoStep));
        let wide = grid(&[[0.0; 3], [2_097_152.0, 0.0, 0.0]]);
        assert_eq!(wide, Err(ExactGridError::TooWide { step: 1.0, steps: 2_097_152.0 }));
        let mut search = ExactGrid::default();
        search.include(&[[3.0; 3]]);
        search.include(&[[f32::NAN, 0.0, 0.0]]);
        assert_eq!(search.grid(), Err(ExactGridError::NoStep));
    }
}
