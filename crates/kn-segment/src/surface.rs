//! The scan as the segmentation uses it: upright, in template metres, with smooth normals and
//! neighbours, and with the samples that the body is fitted to.

use super::V3;
use super::error::SegmentError;
use kn_bitstream::params::UpAxis;
use kn_mesh::adjacency::{Components, Rows, vertex_neighbours};

/// A scan in template units.
pub(super) struct Surface {
    /// `#V × 3`, y up, template metres.
    pub(super) points: Vec<V3>,
    /// `#V × 3`, unit, smoothed; zero where a vertex has no face.
    pub(super) normals: Vec<V3>,
    /// `#V`, a third of the area of the faces around each vertex.
    pub(super) areas: Vec<f64>,
    /// `#V` rows: the neighbours of each vertex, ascending.
    neighbours: Rows,
    components: Components,
    /// Area of each component.
    component_areas: Vec<f64>,
}

impl Surface {
    /// # Errors
    /// A mesh without area, a position that is not finite, a face index out of range.
    pub(super) fn new(
        positions: &[[f64; 3]],
        faces: &[[u32; 3]],
        up: UpAxis,
    ) -> Result<Self, SegmentError> {
        check(positions, faces)?;
        let points: Vec<V3> = positions.iter().map(|p| upright(*p, up.index())).collect();
        let mut surface = Self {
            normals: vec![V3::zeros(); points.len()],
            areas: vec![0.0; points.len()],
            neighbours: vertex_neighbours(points.len(), faces),
            components: Components::new(points.len(), faces),
            component_areas: Vec::new(),
            points,
        };
        surface.measure(faces);
        // Below or above this, squares and cubes of lengths leave the range of binary64.
        if !(1e-60..1e60).contains(&surface.area()) {
            return Err(SegmentError::NoArea);
        }
        surface.measure_components();
        surface.smooth_normals(4);
        Ok(surface)
    }

    /// Neighbours of vertex `v`, ascending.
    pub(super) fn around(&self, v: usize) -> &[u32] {
        self.neighbours.row(v)
    }

    /// Area of the whole surface.
    pub(super) fn area(&self) -> f64 {
        self.areas.iter().sum()
    }

    /// Extent along the up axis.
    pub(super) fn height(&self) -> f64 {
        let heights = self.points.iter().map(|p| p.y);
        let (low, high) =
            heights.fold((f64::MAX, f64::MIN), |(low, high), y| (low.min(y), high.max(y)));
        (high - low).max(1e-300)
    }

    /// Multiplies all lengths.
    pub(super) fn rescale(&mut self, factor: f64) {
        self.points.iter_mut().for_each(|p| *p *= factor);
        self.areas.iter_mut().for_each(|a| *a *= factor * factor);
        self.component_areas.iter_mut().for_each(|a| *a *= factor * factor);
    }

    fn measure(&mut self, faces: &[[u32; 3]]) {
        for face in faces {
            let [a, b, c] = face.map(|i| self.points[i as usize]);
            let normal = (b - a).cross(&(c - a));
            for &i in face {
                self.normals[i as usize] += normal;
                self.areas[i as usize] += normal.norm() / 6.0;
            }
        }
    }

    fn smooth_normals(&mut self, rounds: usize) {
        let unit = |n: &V3| n.try_normalize(1e-300).unwrap_or_else(V3::zeros);
        let mut normals: Vec<V3> = self.normals.iter().map(unit).collect();
        for _ in 0..rounds {
            let mean = |v: usize| {
                let sum =
                    self.around(v).iter().fold(normals[v], |sum, &u| sum + normals[u as usize]);
                unit(&sum)
            };
            normals = (0..normals.len()).map(mean).collect();
        }
        self.normals = normals;
    }

    fn measure_components(&mut self) {
        self.component_areas = vec![0.0; self.components.count];
        for (&component, area) in self.components.of_vertex.iter().zip(&self.areas) {
            if component != Components::ISOLATED {
                self.component_areas[component as usize] += area;
            }
        }
    }

    /// Whether vertex `v` belongs to a component of at least 1 % of the area: smaller ones are taken
    /// for dirt.
    fn is_clean(&self, v: usize, total: f64) -> bool {
        match self.components.of_vertex[v] {
            Components::ISOLATED => false,
            component => self.component_areas[component as usize] >= 0.01 * total,
        }
    }

    /// Share of the area that is not taken for dirt.
    pub(super) fn clean_share(&self) -> f64 {
        let total = self.area();
        let clean = (0..self.points.len()).filter(|&v| self.is_clean(v, total));
        clean.map(|v| self.areas[v]).sum::<f64>() / total
    }

    /// About `count` vertices, one for every equal piece of area, in vertex order. Dirt is skipped.
    pub(super) fn samples(&self, count: usize) -> Samples {
        let total = self.area();
        let step = total / count as f64;
        let (mut sum, mut next) = (0.0, 0.5 * step);
        let mut samples = Samples::default();
        for v in (0..self.points.len()).filter(|&v| self.is_clean(v, total)) {
            sum += self.areas[v];
            if sum >= next {
                samples.points.push(self.points[v]);
                samples.normals.push(self.normals[v]);
                next = (next + step).max(sum);
            }
        }
        samples
    }
}

/// Points of the surface, each standing for the same area.
#[derive(Default)]
pub(super) struct Samples {
    pub(super) points: Vec<V3>,
    pub(super) normals: Vec<V3>,
}

impl Samples {
    /// The samples whose index `keep` accepts.
    pub(super) fn filtered(&self, keep: impl Fn(usize) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.points.len()).filter(|&i| keep(i)).collect();
        Self {
            points: kept.iter().map(|&i| self.points[i]).collect(),
            normals: kept.iter().map(|&i| self.normals[i]).collect(),
        }
    }
}

fn check(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<(), SegmentError> {
    if positions.is_empty() || faces.is_empty() {
        return Err(SegmentError::Empty);
    }
    if let Some(vertex) = positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(SegmentError::NotFinite { vertex });
    }
    let outside = |f: &[u32; 3]| f.iter().any(|&i| i as usize >= positions.len());
    match faces.iter().position(outside) {
        Some(face) => Err(SegmentError::FaceIndex { face }),
        None => Ok(()),
    }
}

/// Turns the up axis into y and keeps the handedness.
fn upright(p: [f64; 3], up: usize) -> V3 {
    V3::new(p[(up + 2) % 3], p[up], p[(up + 1) % 3])
}
