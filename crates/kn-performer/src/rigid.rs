//! Rotations and rigid transforms. Sines come from libm, so that every platform gets the same bits.

use glam::{DMat3, DVec3};
use std::f64::consts::TAU;

/// x ↦ rotation · x + origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rigid {
    pub(super) rotation: DMat3,
    pub(super) origin: DVec3,
}

impl Rigid {
    pub(super) fn apply(&self, point: DVec3) -> DVec3 {
        self.rotation * point + self.origin
    }

    /// The inverse transform of `point`.
    pub(super) fn pull(&self, point: DVec3) -> DVec3 {
        self.rotation.transpose() * (point - self.origin)
    }

    /// The frame at `origin` (in this frame's coordinates) turned by `rotation` within this frame.
    pub(super) fn child(&self, origin: DVec3, rotation: DMat3) -> Self {
        Self { rotation: self.rotation * rotation, origin: self.apply(origin) }
    }
}

pub(super) fn rotation_x(angle: f64) -> DMat3 {
    let (s, c) = (libm::sin(angle), libm::cos(angle));
    DMat3::from_cols(DVec3::X, DVec3::new(0.0, c, s), DVec3::new(0.0, -s, c))
}

pub(super) fn rotation_y(angle: f64) -> DMat3 {
    let (s, c) = (libm::sin(angle), libm::cos(angle));
    DMat3::from_cols(DVec3::new(c, 0.0, -s), DVec3::Y, DVec3::new(s, 0.0, c))
}

pub(super) fn rotation_z(angle: f64) -> DMat3 {
    let (s, c) = (libm::sin(angle), libm::cos(angle));
    DMat3::from_cols(DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0), DVec3::Z)
}

/// The same angle between −π and π. A finished turn of the dance counts as none, so that
/// differences of yaws have to be taken this way.
pub(super) fn wrapped(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// The frame whose −y axis runs along `direction` and whose z axis lies as near to `front` as
/// that allows. `front` must not be parallel to `direction`; if it is, any front is taken.
pub(super) fn along(direction: DVec3, front: DVec3) -> DMat3 {
    let y = -direction.normalize_or(DVec3::NEG_Y);
    let mut z = front - y * front.dot(y);
    if z.length_squared() < 1e-12 {
        z = y.any_orthonormal_vector();
    }
    let z = z.normalize();
    DMat3::from_cols(y.cross(z), y, z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pull_undoes_apply_and_along_points_down_the_bone() {
        let direction = DVec3::new(0.3, -0.8, 0.2);
        let frame =
            Rigid { rotation: along(direction, DVec3::Z), origin: DVec3::new(1.0, 2.0, 3.0) };
        let point = DVec3::new(-0.4, 0.1, 0.9);
        assert!((frame.pull(frame.apply(point)) - point).length() < 1e-12);
        assert!((frame.rotation * DVec3::NEG_Y - direction.normalize()).length() < 1e-12);
        assert!((frame.rotation.determinant() - 1.0).abs() < 1e-12);
        let turn = rotation_y(0.5) * rotation_x(-0.2) * rotation_z(2.0);
        assert!((turn * turn.transpose() - DMat3::IDENTITY).determinant().abs() < 1e-12);
    }
}
