//! Node transforms: A = R·S·H and a translation.

use crate::elementary::sin_cos;

/// The transform of one key node in one frame: x ↦ A (x − n) + n + t with A = R·S·H.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeTransform {
    /// Euler angles θx, θy, θz in radians; R = Rz Ry Rx (paper, section on affine decomposition).
    pub rotation: [f64; 3],
    /// Factors sx, sy, sz; all positive, so that a reflection never occurs.
    pub scale: [f64; 3],
    /// Shears hxy, hxz, hyz of the unit upper triangular H.
    pub shear: [f64; 3],
    /// Translation t, in the unit of the positions that the transform is applied to.
    pub translation: [f64; 3],
}

impl NodeTransform {
    /// The transform without motion.
    pub const IDENTITY: Self =
        Self { rotation: [0.0; 3], scale: [1.0; 3], shear: [0.0; 3], translation: [0.0; 3] };

    /// A = R·S·H by rows, in the specification's order of operations (`deform.matrix`).
    pub fn matrix(&self) -> [[f64; 3]; 3] {
        let rotation = rotation_matrix(self.rotation);
        let [xy, xz, yz] = self.shear;
        let [sx, sy, sz] = self.scale;
        rotation.map(|[r0, r1, r2]| {
            let (c0, c1, c2) = (r0 * sx, r1 * sy, r2 * sz);
            [c0, c0 * xy + c1, (c0 * xz + c1 * yz) + c2]
        })
    }
}

/// R = Rz Ry Rx by rows (paper, equations of R; `deform.rotation`).
fn rotation_matrix([x, y, z]: [f64; 3]) -> [[f64; 3]; 3] {
    let (sx, cx) = sin_cos(x);
    let (sy, cy) = sin_cos(y);
    let (sz, cz) = sin_cos(z);
    let (szsy, czsy) = (sz * sy, cz * sy);
    [
        [cz * cy, czsy * sx - sz * cx, czsy * cx + sz * sx],
        [sz * cy, szsy * sx + cz * cx, szsy * cx - cz * sx],
        [-sy, cy * sx, cy * cx],
    ]
}

impl Default for NodeTransform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

#[cfg(test)]
// The expected matrices come from the platform's functions.
#[allow(clippy::disallowed_methods)]
mod tests {
    use super::*;

    fn product(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
        std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum::<f64>())
        })
    }

    #[test]
    fn the_matrix_is_rotation_times_scale_times_shear() {
        let (x, y, z) = (0.3_f64, -0.7_f64, 1.9_f64);
        let rx = [[1.0, 0.0, 0.0], [0.0, x.cos(), -x.sin()], [0.0, x.sin(), x.cos()]];
        let ry = [[y.cos(), 0.0, y.sin()], [0.0, 1.0, 0.0], [-y.sin(), 0.0, y.cos()]];
        let rz = [[z.cos(), -z.sin(), 0.0], [z.sin(), z.cos(), 0.0], [0.0, 0.0, 1.0]];
        let s = [[1.1, 0.0, 0.0], [0.0, 0.8, 0.0], [0.0, 0.0, 1.3]];
        let h = [[1.0, 0.2, -0.1], [0.0, 1.0, 0.4], [0.0, 0.0, 1.0]];
        let expected = product(product(product(rz, product(ry, rx)), s), h);
        let transform = NodeTransform {
            rotation: [x, y, z],
            scale: [1.1, 0.8, 1.3],
            shear: [0.2, -0.1, 0.4],
            translation: [0.0; 3],
        };
        for (row, expected) in transform.matrix().iter().zip(expected) {
            for axis in 0..3 {
                assert!((row[axis] - expected[axis]).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn no_motion_is_the_exact_identity() {
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(NodeTransform::IDENTITY.matrix(), identity);
    }
}
