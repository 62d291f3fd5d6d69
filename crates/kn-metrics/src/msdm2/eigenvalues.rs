//! Eigenvalues of a symmetric 3 × 3 matrix to full accuracy, without iteration to convergence.

use super::topology::Symmetric;
use crate::vec3::{Vec3, cross, dot, length_squared, scale};

/// Newton steps for the outer root: from the start below, the error is 2e-3, then its square times
/// one half, and so on: after three steps it is below rounding.
const NEWTON_STEPS: usize = 4;

/// The eigenvalues in no order. Their error is a few roundings of the largest one.
pub(super) fn eigenvalues(matrix: &Symmetric) -> Vec3 {
    let [xx, xy, xz, yy, yz, zz] = *matrix;
    let mean = (xx + yy + zz) / 3.0;
    let (xx, yy, zz) = (xx - mean, yy - mean, zz - mean);
    let spread = ((xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + xz * xz + yz * yz)) / 6.0).sqrt();
    if spread == 0.0 {
        return [mean; 3];
    }
    let b = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(|row| scale(row, 1.0 / spread));
    let half_determinant = (0.5 * dot(b[0], cross(b[1], b[2]))).clamp(-1.0, 1.0);
    // The roots of x³ − 3x = 2r; the outer one, on the side of r, stands alone.
    let outer = outer_root(half_determinant.abs()).copysign(half_determinant);
    let [low, high] = remaining(&b, outer);
    [outer, low, high].map(|root| mean + spread * root)
}

/// The root of x³ − 3x = 2r in √3..=2, for 0 ≤ r ≤ 1.
fn outer_root(r: f64) -> f64 {
    let sqrt_3 = 1.732_050_807_568_877_2;
    let mut x = sqrt_3 + r * (2.0 - sqrt_3);
    for _ in 0..NEWTON_STEPS {
        x -= (x * (x * x - 3.0) - 2.0 * r) / (3.0 * (x * x - 1.0));
    }
    x
}

/// The other two eigenvalues, from the plane across the outer root's eigenvector: a quadratic
/// equation of the trace alone would lose half of the digits where they are equal.
fn remaining(b: &[Vec3; 3], outer: f64) -> [f64; 2] {
    let mut shifted = *b;
    (0..3).for_each(|i| shifted[i][i] -= outer);
    let candidates = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| cross(shifted[i], shifted[j]));
    let longest = candidates
        .into_iter()
        .reduce(|a, b| if length_squared(b) > length_squared(a) { b } else { a })
        .unwrap_or_default();
    let vector = scale(longest, 1.0 / length_squared(longest).sqrt());
    let (u, w) = across(vector);
    let apply = |v: Vec3| b.map(|row| dot(row, v));
    let (bu, bw) = (apply(u), apply(w));
    let (uu, uw, ww) = (dot(u, bu), dot(u, bw), dot(w, bw));
    let middle = 0.5 * (uu + ww);
    let half_gap = (0.25 * (uu - ww) * (uu - ww) + uw * uw).sqrt();
    [middle - half_gap, middle + half_gap]
}

/// Two unit vectors at right angles to a unit vector and to each other.
fn across(vector: Vec3) -> (Vec3, Vec3) {
    let [x, y, z] = vector;
    let u = if x.abs() > y.abs() { [-z, 0.0, x] } else { [0.0, z, -y] };
    let u = scale(u, 1.0 / length_squared(u).sqrt());
    (u, cross(vector, u))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Cyclic Jacobi rotations until nothing is left beside the diagonal.
    fn jacobi(matrix: &Symmetric) -> Vec3 {
        let [xx, xy, xz, yy, yz, zz] = *matrix;
        let mut a = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        for (p, q) in [(0, 1), (0, 2), (1, 2)].into_iter().cycle().take(60) {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = 0.5 * (2.0 * a[p][q]).atan2(a[q][q] - a[p][p]);
            let (s, c) = theta.sin_cos();
            for row in &mut a {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            for i in 0..3 {
                (a[p][i], a[q][i]) = (c * a[p][i] - s * a[q][i], s * a[p][i] + c * a[q][i]);
            }
        }
        [a[0][0], a[1][1], a[2][2]]
    }

    fn assert_like_jacobi(matrix: &Symmetric) {
        let (mut found, mut expected) = (eigenvalues(matrix), jacobi(matrix));
        found.sort_by(f64::total_cmp);
        expected.sort_by(f64::total_cmp);
        let size = expected[0].abs().max(expected[2].abs());
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() <= 1e-14 * size, "{matrix:?}: {found} {expected}");
        }
    }

    proptest! {
        #[test]
        fn agrees_with_jacobi(entries in prop::array::uniform6(-1.0..1.0f64), exponent in -6i32..7) {
            let size = 10f64.powi(exponent);
            assert_like_jacobi(&entries.map(|x| x * size));
        }

        #[test]
        fn agrees_with_jacobi_near_double_roots(
            v in prop::array::uniform3(-1.0..1.0f64), shift in -1.0..1.0f64, noise in prop::array::uniform6(-1e-9..1e-9f64),
        ) {
            let [x, y, z] = v;
            let outer = [x * x + shift, x * y, x * z, y * y + shift, y * z, z * z + shift];
            assert_like_jacobi(&std::array::from_fn(|i| outer[i] + noise[i]));
        }
    }

    #[test]
    fn diagonal_matrices_are_read_off() {
        for diagonal in [[3.0, 3.0, 3.0], [0.0, 0.0, 0.0], [5.0, -2.0, -2.0], [1.0, 1.0, -7.0]] {
            let [x, y, z] = diagonal;
            assert_like_jacobi(&[x, 0.0, 0.0, y, 0.0, z]);
        }
    }
}
