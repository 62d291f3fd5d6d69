//! Axis-aligned boxes.

use crate::Precision;

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
    pub fn of(positions: &[[f64; 3]]) -> Option<Self> {
        let &first = positions.first()?;
        let mut bounds = Self { min: first, max: first };
        positions.iter().for_each(|&position| bounds.include(position));
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

    /// The precision that coordinates in the box need: binary32 where it moves no vertex by more than
    /// 2^-19 of the longest side.
    pub fn precision(&self) -> Precision {
        let farthest = self.min.iter().chain(&self.max).fold(0.0_f64, |far, x| far.max(x.abs()));
        match farthest <= 32.0 * self.longest_side() {
            true => Precision::Single,
            false => Precision::Double,
        }
    }

    /// The point in the middle.
    pub fn middle(&self) -> [f64; 3] {
        std::array::from_fn(|axis| self.min[axis] + (self.max[axis] - self.min[axis]) / 2.0)
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
