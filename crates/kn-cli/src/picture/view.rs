//! The view of a picture: a parallel projection, turned about the up axis.

use kn_bitstream::params::UpAxis;
use kn_mesh::BoundingBox;

/// A parallel projection that shows a whole box.
#[derive(Clone, Debug)]
pub(crate) struct View {
    /// Unit vectors of the picture: to the right, upwards, towards the viewer.
    axes: [[f32; 3]; 3],
    /// Middle of the box.
    centre: [f64; 3],
    /// Half of the box's extent to the right and upwards in the picture.
    half: [f32; 2],
}

/// Share of the picture left free around the box.
const MARGIN: f32 = 0.03;
/// Angle by which the camera looks down, so that the tops of shoulders and feet are visible.
const PITCH_DEGREES: f32 = 8.0;

impl View {
    /// Looks at `bounds` from the front, turned by `yaw_degrees` about the up axis.
    pub(crate) fn new(bounds: &BoundingBox, up_axis: UpAxis, yaw_degrees: f32) -> Self {
        let axes = camera_axes(up_axis, yaw_degrees);
        let middle = |axis: usize| (bounds.min[axis] + bounds.max[axis]) / 2.0;
        let extent = |axis: usize| ((bounds.max[axis] - bounds.min[axis]) / 2.0) as f32;
        // The box's shadow on a picture axis is the sum of its sides' shadows.
        let shadow = |axis: [f32; 3]| (0..3).map(|i| axis[i].abs() * extent(i)).sum();
        Self { axes, centre: std::array::from_fn(middle), half: [shadow(axes[0]), shadow(axes[1])] }
    }

    /// Width and height of a picture of that height which the box fills.
    pub(crate) fn size_of_height(&self, height: usize) -> [usize; 2] {
        let width = height as f32 * self.half[0] / self.half[1].max(1e-20);
        [(width.round() as usize).clamp(height / 4, 3 * height), height]
    }

    /// Pixels per world unit in a picture of this size.
    pub(super) fn scale(&self, width: usize, height: usize) -> f32 {
        let room = |pixels: usize, half: f32| pixels as f32 * (0.5 - MARGIN) / half.max(1e-20);
        room(width, self.half[0]).min(room(height, self.half[1]))
    }

    /// Pixel coordinates (right, down) and depth (towards the viewer, in pixels).
    pub(super) fn project(&self, p: [f64; 3], width: usize, height: usize) -> [f32; 3] {
        let scale = self.scale(width, height);
        let q = self.turn(std::array::from_fn(|i| (p[i] - self.centre[i]) as f32));
        [width as f32 / 2.0 + q[0] * scale, height as f32 / 2.0 - q[1] * scale, q[2] * scale]
    }

    /// A direction in the camera's axes.
    pub(super) fn turn(&self, v: [f32; 3]) -> [f32; 3] {
        self.axes.map(|axis| axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2])
    }
}

fn camera_axes(up_axis: UpAxis, yaw_degrees: f32) -> [[f32; 3]; 3] {
    let (sin_yaw, cos_yaw) = yaw_degrees.to_radians().sin_cos();
    let (sin_pitch, cos_pitch) = PITCH_DEGREES.to_radians().sin_cos();
    // For y up these are right = x, up = y, towards = z; other up axes permute cyclically.
    let up = up_axis.index();
    let (right, toward) = ((up + 2) % 3, (up + 1) % 3);
    let axis = |r: f32, u: f32, t: f32| {
        let mut v = [0.0; 3];
        (v[right], v[up], v[toward]) = (r, u, t);
        v
    };
    [
        axis(cos_yaw, 0.0, -sin_yaw),
        axis(-sin_yaw * sin_pitch, cos_pitch, -cos_yaw * sin_pitch),
        axis(sin_yaw * cos_pitch, sin_pitch, cos_yaw * cos_pitch),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use kn_bitstream::params::Named;

    #[test]
    fn the_whole_box_is_in_the_picture() {
        let bounds = BoundingBox { min: [-1.0, 0.0, 2.0], max: [3.0, 9.0, 4.0] };
        for up_axis in UpAxis::all() {
            for yaw in [0.0, 33.0, 90.0, 210.0] {
                let view = View::new(&bounds, up_axis, yaw);
                for corner in 0..8 {
                    let pick = |i: usize| [bounds.min, bounds.max][corner >> i & 1][i];
                    let [x, y, _] = view.project([pick(0), pick(1), pick(2)], 200, 300);
                    assert!((0.0..=200.0).contains(&x) && (0.0..=300.0).contains(&y));
                }
            }
        }
    }

    #[test]
    fn axes_are_right_handed_and_up_is_up() {
        for up_axis in UpAxis::all() {
            let [r, u, t] = camera_axes(up_axis, 20.0);
            let cross: [f32; 3] = std::array::from_fn(|i| {
                r[(i + 1) % 3] * u[(i + 2) % 3] - r[(i + 2) % 3] * u[(i + 1) % 3]
            });
            assert!((0..3).all(|i| (cross[i] - t[i]).abs() < 1e-6), "up axis {up_axis}");
            assert!(u[up_axis.index()] > 0.9);
        }
    }
}
