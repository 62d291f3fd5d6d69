//! Points where the lines of a regular grid meet a mesh.

use super::PointError;
use super::cloud::Sample;
use kn_mesh::vec3::{Vec3, cross, norm, scale, sub};

/// The largest number of hits; 1024 lines give about a million on a scanned person.
const MOST_POINTS: usize = 1 << 24;

/// A regular grid over a box, usually the box of a whole sequence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    origin: Vec3,
    step: f64,
}

impl Grid {
    /// Makes a grid of `lines` lines (1024 in MPEG's common test conditions) from end to end of the
    /// longest side of the box from `min` to `max`.
    ///
    /// # Errors
    /// The box has no extent or a coordinate that is not finite, or there are fewer than two lines.
    pub fn new(min: [f64; 3], max: [f64; 3], lines: usize) -> Result<Self, PointError> {
        let side = (0..3).map(|axis| max[axis] - min[axis]).fold(0.0, f64::max);
        let step = side / lines.saturating_sub(1) as f64;
        if !(step > 0.0 && step.is_finite() && min.iter().all(|x| x.is_finite())) {
            return Err(PointError::BadGrid);
        }
        Ok(Self { origin: min, step })
    }

    /// Each hit with the index of its face. Faces without area are not hit.
    pub(super) fn hits(
        &self,
        positions: &[Vec3],
        faces: &[[u32; 3]],
    ) -> Result<Vec<Sample>, PointError> {
        let faces = || {
            let corners = |face: &[u32; 3]| face.map(|vertex| positions[vertex as usize]);
            let flat = move |face| Flat::new(self, corners(face));
            faces.iter().enumerate().filter_map(move |(index, face)| Some((index, flat(face)?)))
        };
        let expected: f64 = faces().map(|(_, face)| face.expected_hits()).sum();
        if expected > MOST_POINTS as f64 {
            return Err(PointError::TooManyPoints { limit: MOST_POINTS });
        }
        let mut hits = Vec::new();
        faces().for_each(|(index, face)| face.hit(self, |hit| hits.push(Sample::new(hit, index))));
        Ok(hits)
    }
}

/// A face, seen along the axis of its normal's largest component. Lines run along this axis; on
/// the other two they stand at whole grid steps.
struct Flat {
    corner: Vec3,
    normal: Vec3,
    along: usize,
    /// The corners on the other two axes, in grid steps.
    corners: [[f64; 2]; 3],
}

impl Flat {
    /// `None` for a face without area.
    fn new(grid: &Grid, corners: [Vec3; 3]) -> Option<Self> {
        let normal = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]));
        let length = norm(normal);
        if length == 0.0 {
            return None;
        }
        let normal = scale(normal, 1.0 / length);
        let along =
            (1..3).fold(
                0,
                |best, axis| {
                    if normal[axis].abs() > normal[best].abs() { axis } else { best }
                },
            );
        let flat = corners.map(|corner| {
            [1, 2].map(|next| {
                let axis = (along + next) % 3;
                (corner[axis] - grid.origin[axis]) / grid.step
            })
        });
        Some(Self { corner: corners[0], normal, along, corners: flat })
    }

    /// The area in grid cells and the number of lines that may meet it.
    fn expected_hits(&self) -> f64 {
        let [a, b, c] = self.corners;
        let doubled = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let (low, high) = (a[0].min(b[0]).min(c[0]), a[0].max(b[0]).max(c[0]));
        0.5 * doubled.abs() + (high - low)
    }

    fn hit(&self, grid: &Grid, mut found: impl FnMut(Vec3)) {
        let (along, u, v) = (self.along, (self.along + 1) % 3, (self.along + 2) % 3);
        for i in whole_numbers(self.corners.map(|corner| corner[0])) {
            let Some(ends) = cross_section(&self.corners, i) else { continue };
            for j in whole_numbers([ends.0, ends.1, ends.1]) {
                let mut hit = [0.0; 3];
                hit[u] = grid.origin[u] + i * grid.step;
                hit[v] = grid.origin[v] + j * grid.step;
                let rise = (hit[u] - self.corner[u]) * self.normal[u]
                    + (hit[v] - self.corner[v]) * self.normal[v];
                hit[along] = self.corner[along] - rise / self.normal[along];
                found(hit);
            }
        }
    }
}

/// The whole numbers between the smallest and the largest of three.
fn whole_numbers(values: [f64; 3]) -> impl Iterator<Item = f64> {
    let first = values.into_iter().fold(f64::INFINITY, f64::min).ceil();
    let last = values.into_iter().fold(f64::NEG_INFINITY, f64::max).floor();
    std::iter::successors(Some(first), |i| Some(i + 1.0))
        // Stops also where the numbers are too large to be counted in steps of one.
        .take_while(move |&i| i <= last && i < 1e15)
}

/// The two places on the second axis where the line at `i` on the first enters and leaves the
/// triangle.
fn cross_section(corners: &[[f64; 2]; 3], i: f64) -> Option<(f64, f64)> {
    let mut ends: Option<(f64, f64)> = None;
    for side in 0..3 {
        // From the lower corner, so that both faces of a side compute the same.
        let (mut a, mut b) = (corners[side], corners[(side + 1) % 3]);
        if (b[0], b[1]) < (a[0], a[1]) {
            (a, b) = (b, a);
        }
        if i < a[0] || i > b[0] {
            continue;
        }
        let at = if b[0] > a[0] { a[1] + (i - a[0]) / (b[0] - a[0]) * (b[1] - a[1]) } else { a[1] };
        let also = if b[0] > a[0] { at } else { b[1] };
        let (low, high) = ends.unwrap_or((at, at));
        ends = Some((low.min(at).min(also), high.max(at).max(also)));
    }
    ends
}
