//! The stacked matrix [A|t] of a node, and how it depends on the parameters of the node.

use kn_bitstream::params::Combination;
use kn_deform::{NodeTransform, sin_cos};
use kn_mesh::vec3::Vec3;

/// [A|t], 3 rows of 4.
pub(crate) type Affine = [[f64; 4]; 3];

pub(crate) const ZERO: Affine = [[0.0; 4]; 3];

/// The most parameters that a node can have.
pub(crate) const MAX_PARAMETERS: usize = 12;

/// Number of parameters of a node with this combination.
pub(crate) fn parameter_count(combination: Combination) -> usize {
    let switch = |on: bool| 3 * usize::from(on);
    3 + switch(combination.rotation) + switch(combination.scale) + switch(combination.shear)
}

pub(crate) fn dot(a: &Affine, b: &Affine) -> f64 {
    let row = |i: usize| (0..4).map(|j| a[i][j] * b[i][j]).sum::<f64>();
    row(0) + row(1) + row(2)
}

/// Parameters in the order t, θ, s, h; only the enabled ones.
pub(crate) fn write_parameters(
    transform: &NodeTransform,
    combination: Combination,
    parameters: &mut [f64],
) {
    let mut next = 0;
    let mut put = |values: Vec3, on: bool| {
        if on {
            parameters[next..next + 3].copy_from_slice(&values);
            next += 3;
        }
    };
    put(transform.translation, true);
    put(transform.rotation, combination.rotation);
    put(transform.scale, combination.scale);
    put(transform.shear, combination.shear);
}

/// The inverse of [`write_parameters`]; what is not enabled is neutral.
pub(crate) fn read_parameters(parameters: &[f64], combination: Combination) -> NodeTransform {
    let mut next = 0;
    let mut take = |neutral: f64, on: bool| {
        if !on {
            return [neutral; 3];
        }
        next += 3;
        [parameters[next - 3], parameters[next - 2], parameters[next - 1]]
    };
    NodeTransform {
        translation: take(0.0, true),
        rotation: take(0.0, combination.rotation),
        scale: take(1.0, combination.scale),
        shear: take(0.0, combination.shear),
    }
}

/// [A|t] with A = R·S·H.
pub(crate) fn affine(transform: &NodeTransform) -> Affine {
    let a = transform.matrix();
    std::array::from_fn(|i| [a[i][0], a[i][1], a[i][2], transform.translation[i]])
}

type Matrix = [[f64; 3]; 3];

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j])
    })
}

/// A rotation about one axis, or its derivative by the angle.
fn axis_rotation(axis: usize, angle: f64, derivative: bool) -> Matrix {
    let (sin, cos) = sin_cos(angle);
    let (diagonal, off, keep) = if derivative { (-sin, cos, 0.0) } else { (cos, sin, 1.0) };
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut matrix = [[0.0; 3]; 3];
    matrix[axis][axis] = keep;
    matrix[u][u] = diagonal;
    matrix[v][v] = diagonal;
    matrix[u][v] = -off;
    matrix[v][u] = off;
    matrix
}

/// R = Rz Ry Rx, with the factor of axis `derived` replaced by its derivative.
fn rotation(angles: Vec3, derived: Option<usize>) -> Matrix {
    let factor = |axis| axis_rotation(axis, angles[axis], derived == Some(axis));
    product(&product(&factor(2), &factor(1)), &factor(0))
}

/// The derivatives of [A|t] by the enabled parameters, in the order of [`write_parameters`].
pub(crate) fn derivatives(
    transform: &NodeTransform,
    combination: Combination,
) -> ([Affine; MAX_PARAMETERS], usize) {
    let mut columns = [ZERO; MAX_PARAMETERS];
    let mut count = 0;
    let mut put = |column: Affine| {
        columns[count] = column;
        count += 1;
    };
    for axis in 0..3 {
        let mut column = ZERO;
        column[axis][3] = 1.0;
        put(column);
    }
    let linear = |m: Matrix| -> Affine { m.map(|[x, y, z]| [x, y, z, 0.0]) };
    let [sx, sy, sz] = transform.scale;
    let [xy, xz, yz] = transform.shear;
    let stretch = [[sx, sx * xy, sx * xz], [0.0, sy, sy * yz], [0.0, 0.0, sz]];
    if combination.rotation {
        for axis in 0..3 {
            put(linear(product(&rotation(transform.rotation, Some(axis)), &stretch)));
        }
    }
    let r = rotation(transform.rotation, None);
    if combination.scale {
        let shear = [[1.0, xy, xz], [0.0, 1.0, yz], [0.0, 0.0, 1.0]];
        for axis in 0..3 {
            let mut row = [[0.0; 3]; 3];
            row[axis] = shear[axis];
            put(linear(product(&r, &row)));
        }
    }
    if combination.shear {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let mut entry = [[0.0; 3]; 3];
            entry[i][j] = transform.scale[i];
            put(linear(product(&r, &entry)));
        }
    }
    (columns, count)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BENT: NodeTransform = NodeTransform {
        rotation: [0.4, -0.9, 2.1],
        scale: [1.2, 0.8, 1.1],
        shear: [0.1, -0.3, 0.2],
        translation: [3.0, -1.0, 7.0],
    };

    #[test]
    fn parameters_come_back() {
        for combination in Combination::ALL {
            let mut parameters = vec![0.0; parameter_count(combination)];
            write_parameters(&BENT, combination, &mut parameters);
            let back = read_parameters(&parameters, combination);
            assert_eq!(back.translation, BENT.translation);
            assert_eq!(back.rotation == BENT.rotation, combination.rotation);
            assert_eq!(back.scale == BENT.scale, combination.scale);
            assert_eq!(back.shear == BENT.shear, combination.shear);
        }
    }

    #[test]
    fn derivatives_match_finite_differences() {
        let combination = Combination::RTSH;
        let (columns, count) = derivatives(&BENT, combination);
        assert_eq!(count, 12);
        let mut parameters = [0.0; 12];
        write_parameters(&BENT, combination, &mut parameters);
        for p in 0..count {
            let at = |delta: f64| {
                let mut moved = parameters;
                moved[p] += delta;
                affine(&read_parameters(&moved, combination))
            };
            let (plus, minus) = (at(1e-6), at(-1e-6));
            for i in 0..3 {
                for j in 0..4 {
                    let slope = (plus[i][j] - minus[i][j]) / 2e-6;
                    assert!((slope - columns[p][i][j]).abs() < 1e-8, "parameter {p}");
                }
            }
        }
    }
}
