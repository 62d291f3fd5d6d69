//! L_orth: how far the columns of a node's matrix are from orthonormal.

use crate::affine::Affine;

/// Value of L_orth for one node; `gradient` grows by `weight` times its gradient (bi-modal paper,
/// equation of L_orth; it is Sumner's E_rot).
pub(crate) fn value_and_gradient(m: &Affine, weight: f64, gradient: &mut Affine) -> f64 {
    let column = |i: usize| [m[0][i], m[1][i], m[2][i]];
    let mut value = 0.0;
    for i in 0..3 {
        for j in i..3 {
            let (a, b) = (column(i), column(j));
            let expected = f64::from(u8::from(i == j));
            let error = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] - expected;
            value += error * error;
            // For i = j both lines add the same, which is the derivative of the square.
            for row in 0..3 {
                gradient[row][i] += 2.0 * weight * error * b[row];
                gradient[row][j] += 2.0 * weight * error * a[row];
            }
        }
    }
    weight * value
}

/// The derivatives of the six residuals of L_orth in the direction `d`: what its Gauss–Newton
/// matrix is made of.
pub(crate) fn residual_slopes(m: &Affine, d: &Affine) -> [f64; 6] {
    let mut slopes = [0.0; 6];
    let mut next = 0;
    for i in 0..3 {
        for j in i..3 {
            slopes[next] = (0..3).map(|row| d[row][i] * m[row][j] + m[row][i] * d[row][j]).sum();
            next += 1;
        }
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    const M: Affine = [[1.1, 0.2, -0.1, 5.0], [0.3, 0.9, 0.4, 6.0], [-0.2, 0.1, 1.3, 7.0]];

    #[test]
    fn gradient_matches_finite_differences() {
        let mut gradient = [[0.0; 4]; 3];
        value_and_gradient(&M, 0.7, &mut gradient);
        for i in 0..3 {
            for j in 0..4 {
                let at = |delta: f64| {
                    let mut moved = M;
                    moved[i][j] += delta;
                    value_and_gradient(&moved, 0.7, &mut [[0.0; 4]; 3])
                };
                let slope = (at(1e-6) - at(-1e-6)) / 2e-6;
                assert!((slope - gradient[i][j]).abs() < 1e-8, "{i} {j}");
            }
        }
    }

    #[test]
    fn a_rotation_costs_nothing() {
        let rotation = [[0.0, -1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 2.0], [0.0, 0.0, 1.0, 3.0]];
        assert_eq!(value_and_gradient(&rotation, 1.0, &mut [[0.0; 4]; 3]), 0.0);
    }

    #[test]
    fn slopes_match_finite_differences() {
        let d: Affine = [[0.3, -0.2, 0.5, 0.0], [0.1, 0.4, 0.0, 1.0], [0.2, 0.2, -0.7, 0.0]];
        let residuals = |t: f64| {
            let m: Affine = std::array::from_fn(|i| std::array::from_fn(|j| M[i][j] + t * d[i][j]));
            let mut list = Vec::new();
            for i in 0..3 {
                for j in i..3 {
                    list.push((0..3).map(|row| m[row][i] * m[row][j]).sum::<f64>());
                }
            }
            list
        };
        let (plus, minus) = (residuals(1e-6), residuals(-1e-6));
        for (slope, (p, m)) in residual_slopes(&M, &d).iter().zip(plus.iter().zip(minus)) {
            assert!((slope - (p - m) / 2e-6).abs() < 1e-8);
        }
    }
}
