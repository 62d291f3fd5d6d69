//! Labels of the last frame, as evidence for this one: the last frame's vertices move with the
//! bones, and a vertex close to one of them prefers its label.

use super::V3;
use super::body::{self, CAPSULES, HIP, NECK, Pose};
use super::fit::{Fit, Posed};
use super::surface::Surface;
use nalgebra::Matrix3;

/// Carried vertices farther away than this say nothing, metres.
const REACH: f64 = 0.02;

/// Labelled points of a frame, each on its capsule.
#[derive(Clone, Debug)]
pub(super) struct Memory {
    points: Vec<V3>,
    capsules: Vec<u8>,
    labels: Vec<u8>,
}

impl Memory {
    /// `capsules` (`#V`) is the closest capsule of each vertex.
    pub(super) fn new(surface: &Surface, capsules: Vec<u8>, labels: &[u8]) -> Self {
        Self { points: surface.points.clone(), capsules, labels: labels.to_vec() }
    }

    /// The label of the last frame at each point of this one, where there is one within reach.
    pub(super) fn recall(&self, from: &Fit, to: &Fit, surface: &Surface) -> Vec<Option<u8>> {
        let moves = Moves::between(from, to);
        let carried: Vec<V3> = self
            .points
            .iter()
            .zip(&self.capsules)
            .map(|(p, &k)| moves.carry(p, usize::from(k)))
            .collect();
        let cells = Cells::new(&carried);
        let nearest = |p: &V3| cells.nearest(&carried, p).map(|i| self.labels[i]);
        surface.points.iter().map(nearest).collect()
    }
}

/// The motion of every capsule between two poses.
struct Moves {
    turns: [Matrix3<f64>; CAPSULES],
    from: [Posed; CAPSULES],
    to: [Posed; CAPSULES],
}

impl Moves {
    fn between(from: &Fit, to: &Fit) -> Self {
        let trunk = trunk(&to.pose) * trunk(&from.pose).transpose();
        let (a, b) = (from.capsules(), to.capsules());
        let turns = std::array::from_fn(|k| {
            let way = |c: &Posed| (c.b - c.a).try_normalize(1e-9).unwrap_or_else(V3::y);
            shortest_turn(&(trunk * way(&a[k])), &way(&b[k])) * trunk
        });
        Self { turns, from: a, to: b }
    }

    fn carry(&self, point: &V3, k: usize) -> V3 {
        let (from, to) = (&self.from[k], &self.to[k]);
        let (t, away) = from.project(point);
        to.a + (to.b - to.a) * t + self.turns[k] * away
    }
}

/// Axes of the trunk: left, up, front.
fn trunk(pose: &Pose) -> Matrix3<f64> {
    let left = body::leftwards(pose);
    let up = pose[NECK] - (pose[HIP[0]] + pose[HIP[1]]) * 0.5;
    let front = left.cross(&up).try_normalize(1e-9).unwrap_or_else(V3::z);
    Matrix3::from_columns(&[left, front.cross(&left), front])
}

/// The rotation by the smallest angle that turns one unit vector into another.
fn shortest_turn(from: &V3, to: &V3) -> Matrix3<f64> {
    let (axis, cosine) = (from.cross(to), from.dot(to));
    let cross = axis.cross_matrix();
    if cosine < -0.999 {
        return Matrix3::identity();
    }
    Matrix3::identity() + cross + cross * cross / (1.0 + cosine)
}

/// Points sorted by the cell they are in.
struct Cells(Vec<([i32; 3], u32)>);

fn cell(point: &V3) -> [i32; 3] {
    [0, 1, 2].map(|axis| (point[axis] / REACH).floor() as i32)
}

impl Cells {
    fn new(points: &[V3]) -> Self {
        let mut cells: Vec<_> =
            points.iter().enumerate().map(|(i, p)| (cell(p), i as u32)).collect();
        cells.sort_unstable();
        Self(cells)
    }

    /// The closest point within [`REACH`], the first of equals.
    fn nearest(&self, points: &[V3], at: &V3) -> Option<usize> {
        let [x, y, z] = cell(at);
        let mut best = (REACH * REACH, None);
        for dx in -1..=1 {
            for dy in -1..=1 {
                let column = [x.saturating_add(dx), y.saturating_add(dy)];
                let first = [column[0], column[1], z.saturating_sub(1)];
                let last = [column[0], column[1], z.saturating_add(1)];
                let start = self.0.partition_point(|(c, _)| *c < first);
                for (_, i) in self.0[start..].iter().take_while(|(c, _)| *c <= last) {
                    let distance = (points[*i as usize] - at).norm_squared();
                    if distance < best.0 {
                        best = (distance, Some(*i as usize));
                    }
                }
            }
        }
        best.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn shortest_turn_is_a_rotation_between_its_arguments() {
        let (from, to) = (V3::new(0.6, 0.8, 0.0), V3::new(0.0, 0.28, 0.96));
        let turn = shortest_turn(&from, &to);
        assert!((turn * from - to).norm() < 1e-12);
        assert!((turn * turn.transpose() - Matrix3::identity()).norm() < 1e-12);
        assert!((turn.determinant() - 1.0).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn cells_find_what_a_full_search_finds(
            points in prop::collection::vec(prop::array::uniform3(-0.05f64..0.05), 1..60),
            at in prop::array::uniform3(-0.06f64..0.06),
        ) {
            let points: Vec<V3> = points.into_iter().map(V3::from).collect();
            let at = V3::from(at);
            let far = |i: &usize| (points[*i] - at).norm_squared();
            let all = (0..points.len()).filter(|i| far(i) < REACH * REACH);
            let expected = all.min_by(|a, b| far(a).total_cmp(&far(b)));
            let found = Cells::new(&points).nearest(&points, &at);
            prop_assert_eq!(found.map(|i| far(&i)), expected.map(|i| far(&i)));
        }
    }
}
