//! Eigenvalues of symmetric 3 × 3 matrices to full accuracy, without iteration to convergence.

use super::machine::{Machine, QUAD, Quad, columns, dot};
use super::topology::Symmetric;

/// Newton steps for the outer root: from the start below, the error is 2e-3, then its square times
/// one half, and so on: after three steps it is below rounding.
const NEWTON_STEPS: usize = 4;

type Vector<M> = [Quad<M>; 3];

/// Half the sum of the two eigenvalues of largest absolute value, without their signs, of four
/// symmetric matrices.
#[inline(always)]
pub(super) fn mean_absolute<M: Machine>(machine: M, matrices: [&Symmetric; QUAD]) -> [f64; QUAD] {
    let [a, b, c] = eigenvalues(machine, matrices);
    let (a, b, c) = (a.abs(), b.abs(), c.abs());
    ((a + b + c - a.least(b).least(c)) * 0.5).array()
}

/// The eigenvalues of four matrices in no order. Their error is a few roundings of the largest one.
#[inline(always)]
fn eigenvalues<M: Machine>(machine: M, [a, b, c, d]: [&Symmetric; QUAD]) -> Vector<M> {
    let [xx, xy, xz, yy] = columns(machine, [&a[0], &b[0], &c[0], &d[0]]);
    let [yz, zz, ..] = columns(machine, [&a[1], &b[1], &c[1], &d[1]]);
    let mean = (xx + yy + zz) / Quad::splat(machine, 3.0);
    let (xx, yy, zz) = (xx - mean, yy - mean, zz - mean);
    let off_diagonal = xy * xy + xz * xz + yz * yz;
    let spread = (xx * xx + yy * yy + zz * zz + off_diagonal * 2.0) / Quad::splat(machine, 6.0);
    let spread = spread.sqrt();
    let zero = Quad::splat(machine, 0.0);
    // Where there is no spread, any number will do that is not zero.
    let unit = Quad::splat(machine, 1.0) / zero.if_less(spread, spread, Quad::splat(machine, 1.0));
    let b = [
        [xx * unit, xy * unit, xz * unit],
        [xy * unit, yy * unit, yz * unit],
        [xz * unit, yz * unit, zz * unit],
    ];
    let half_determinant = dot(b[0], cross(b[1], b[2])) * 0.5;
    // The roots of x³ − 3x = 2r; the outer one, on the side of r, stands alone.
    let outer = outer_root(machine, half_determinant.abs().least(Quad::splat(machine, 1.0)));
    let outer = half_determinant.if_less(zero, -outer, outer);
    let [low, high] = remaining(machine, b, outer);
    [mean + spread * outer, mean + spread * low, mean + spread * high]
}

/// The root of x³ − 3x = 2r in √3..=2, for 0 ≤ r ≤ 1.
#[inline(always)]
fn outer_root<M: Machine>(machine: M, r: Quad<M>) -> Quad<M> {
    let [one, three] = [1.0, 3.0].map(|number| Quad::splat(machine, number));
    let sqrt_3 = 1.732_050_807_568_877_2;
    let mut x = Quad::splat(machine, sqrt_3) + r * (2.0 - sqrt_3);
    for _ in 0..NEWTON_STEPS {
        x = x - (x * (x * x - three) - r * 2.0) / ((x * x - one) * 3.0);
    }
    x
}

/// The other two eigenvalues, from the plane across the outer root's eigenvector: a quadratic
/// equation of the trace alone would lose half of the digits where they are equal.
#[inline(always)]
fn remaining<M: Machine>(machine: M, b: [Vector<M>; 3], outer: Quad<M>) -> [Quad<M>; 2] {
    let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = b;
    let shifted = [[xx - outer, xy, xz], [xy, yy - outer, yz], [xz, yz, zz - outer]];
    let first = cross(shifted[0], shifted[1]);
    let second = cross(shifted[1], shifted[2]);
    let vector = longer(longer(first, second), cross(shifted[2], shifted[0]));
    let vector = unit(machine, vector);
    let (u, w) = across(machine, vector);
    let bu = [dot(b[0], u), dot(b[1], u), dot(b[2], u)];
    let bw = [dot(b[0], w), dot(b[1], w), dot(b[2], w)];
    let (uu, uw, ww) = (dot(u, bu), dot(u, bw), dot(w, bw));
    let middle = (uu + ww) * 0.5;
    let half_gap = ((uu - ww) * (uu - ww) * 0.25 + uw * uw).sqrt();
    [middle - half_gap, middle + half_gap]
}

/// Two unit vectors at right angles to a unit vector and to each other.
#[inline(always)]
fn across<M: Machine>(machine: M, vector: Vector<M>) -> (Vector<M>, Vector<M>) {
    let [x, y, z] = vector;
    let zero = Quad::splat(machine, 0.0);
    let (small, large) = (y.abs(), x.abs());
    let u = [
        small.if_less(large, -z, zero),
        small.if_less(large, zero, z),
        small.if_less(large, x, -y),
    ];
    let u = unit(machine, u);
    (u, cross(vector, u))
}

#[inline(always)]
fn unit<M: Machine>(machine: M, [x, y, z]: Vector<M>) -> Vector<M> {
    let unit = Quad::splat(machine, 1.0) / dot([x, y, z], [x, y, z]).sqrt();
    [x * unit, y * unit, z * unit]
}

/// In each lane the longer of two vectors.
#[inline(always)]
fn longer<M: Machine>(a: Vector<M>, b: Vector<M>) -> Vector<M> {
    let (in_a, in_b) = (dot(a, a), dot(b, b));
    [in_a.if_less(in_b, b[0], a[0]), in_a.if_less(in_b, b[1], a[1]), in_a.if_less(in_b, b[2], a[2])]
}

#[inline(always)]
fn cross<M: Machine>(a: Vector<M>, b: Vector<M>) -> Vector<M> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::super::machine::Baseline;
    use super::*;
    use kn_mesh::vec3::Vec3;
    use proptest::prelude::*;

    /// xx, xy, xz, yy, yz, zz.
    type Entries = [f64; 6];

    /// Cyclic Jacobi rotations until nothing is left beside the diagonal.
    fn jacobi(matrix: &Entries) -> Vec3 {
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

    fn assert_like_jacobi(matrix: &Entries) {
        let [xx, xy, xz, yy, yz, zz] = *matrix;
        let (rows, other) = ([[xx, xy, xz, yy], [yz, zz, 0.0, 0.0]], [[1.0; 4], [2.0; 4]]);
        let found = eigenvalues(Baseline, [&other, &rows, &other, &other]);
        let (mut found, mut expected) = (found.map(|quad| quad.array()[1]), jacobi(matrix));
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
