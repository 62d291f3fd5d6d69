//! A dense symmetric system over the joints, assembled from residuals that are linear in them.

use super::V3;
use super::body::{JOINTS, Pose};
use nalgebra::Matrix3;

const UNKNOWNS: usize = 3 * JOINTS;

/// Normal equations of a sum of weighted squares.
pub(super) struct System {
    /// `UNKNOWNS × UNKNOWNS`, row by row; only the lower triangle is read.
    matrix: Vec<f64>,
    right: [f64; UNKNOWNS],
}

impl System {
    /// Starts with `damping` times the squared step.
    pub(super) fn new(damping: f64) -> Self {
        let mut matrix = vec![0.0; UNKNOWNS * UNKNOWNS];
        for i in 0..UNKNOWNS {
            matrix[i * UNKNOWNS + i] = damping;
        }
        Self { matrix, right: [0.0; UNKNOWNS] }
    }

    /// Adds the square of `residual + Σ weight · step[joint]` in the given metric.
    pub(super) fn add(&mut self, terms: &[(usize, f64)], residual: &V3, metric: &Matrix3<f64>) {
        let pull = metric * residual;
        for &(j, wj) in terms {
            for axis in 0..3 {
                self.right[3 * j + axis] -= wj * pull[axis];
            }
            for &(k, wk) in terms {
                if k <= j {
                    self.add_block(j, k, wj * wk, metric);
                }
            }
        }
    }

    fn add_block(&mut self, j: usize, k: usize, weight: f64, metric: &Matrix3<f64>) {
        for row in 0..3 {
            let start = (3 * j + row) * UNKNOWNS + 3 * k;
            for column in 0..3 {
                self.matrix[start + column] += weight * metric[(row, column)];
            }
        }
    }

    /// The step of every joint; `None` where the system is not positive definite.
    pub(super) fn solve(mut self) -> Option<Pose> {
        self.factor()?;
        let (matrix, mut x) = (&self.matrix, self.right);
        for i in 0..UNKNOWNS {
            let row = &matrix[i * UNKNOWNS..i * UNKNOWNS + i];
            let known: f64 = row.iter().zip(&x).map(|(l, v)| l * v).sum();
            x[i] = (x[i] - known) / matrix[i * UNKNOWNS + i];
        }
        for i in (0..UNKNOWNS).rev() {
            x[i] /= matrix[i * UNKNOWNS + i];
            for j in 0..i {
                x[j] -= matrix[i * UNKNOWNS + j] * x[i];
            }
        }
        let finite = x.iter().all(|v| v.is_finite());
        finite.then(|| std::array::from_fn(|j| V3::new(x[3 * j], x[3 * j + 1], x[3 * j + 2])))
    }

    /// Cholesky in place.
    fn factor(&mut self) -> Option<()> {
        for i in 0..UNKNOWNS {
            for j in 0..=i {
                let (a, b) = (i * UNKNOWNS, j * UNKNOWNS);
                let dot: f64 = self.matrix[a..a + j]
                    .iter()
                    .zip(&self.matrix[b..b + j])
                    .map(|(x, y)| x * y)
                    .sum();
                let rest = self.matrix[a + j] - dot;
                if i == j {
                    if rest.is_nan() || rest <= 1e-15 {
                        return None;
                    }
                    self.matrix[a + i] = rest.sqrt();
                } else {
                    self.matrix[a + j] = rest / self.matrix[b + j];
                }
            }
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_to_where_the_residuals_vanish() {
        // Joint 0 wants to move by (1, 2, 3), joint 1 to keep up with it.
        let mut system = System::new(1e-9);
        let goal = V3::new(1.0, 2.0, 3.0);
        system.add(&[(0, 1.0)], &-goal, &Matrix3::identity());
        system.add(&[(0, 1.0), (1, -1.0)], &V3::zeros(), &Matrix3::identity());
        let step = system.solve().unwrap();
        assert!((step[0] - goal).norm() < 1e-6 && (step[1] - goal).norm() < 1e-6);
        assert!(step[2].norm() < 1e-12);
    }

    #[test]
    fn a_singular_system_has_no_step() {
        let mut system = System::new(0.0);
        system.add(&[(0, 1.0)], &V3::x(), &Matrix3::identity());
        assert!(system.solve().is_none());
    }
}
