//! The scan as the segmentation sees it: upright, in template metres, with smooth normals and
//! neighbours; and the few samples of it that the body is fitted to.

use super::V3;
use super::error::SegmentError;
use kn_bitstream::params::UpAxis;

/// A scan in template units.
pub(super) struct Surface {
    /// `#V × 3`, y up, template metres.
    pub(super) points: Vec<V3>,
    /// `#V × 3`, unit, smoothed; zero where a vertex has no face.
    pub(super) normals: Vec<V3>,
    /// `#V`, a third of the area of the faces around each vertex.
    pub(super) areas: Vec<f64>,
    /// `#V + 1` offsets into `list`.
    starts: Vec<u32>,
    list: Vec<u32>,
    /// `#V` index of the connected component.
    pub(super) component: Vec<u32>,
    /// Area of each component.
    pub(super) component_areas: Vec<f64>,
}

impl Surface {
    /// # Errors
    /// A mesh without area, a position that is not finite, a face index out of range.
    pub(super) fn new(
        positions: &[[f32; 3]],
        faces: &[[u32; 3]],
        up: UpAxis,
    ) -> Result<Self, SegmentError> {
        check(positions, faces)?;
        let points: Vec<V3> = positions.iter().map(|p| upright(*p, up.index())).collect();
        let (starts, list) = neighbours(points.len(), faces);
        let mut surface = Self {
            normals: vec![V3::zeros(); points.len()],
            areas: vec![0.0; points.len()],
            component: Vec::new(),
            component_areas: Vec::new(),
            points,
            starts,
            list,
        };
        surface.measure(faces);
        // Below or above this, squares and cubes of lengths leave the range of binary64.
        if !(1e-60..1e60).contains(&surface.area()) {
            return Err(SegmentError::NoArea);
        }
        surface.split();
        surface.smooth_normals(4);
        Ok(surface)
    }

    /// Neighbours of vertex `v`, ascending.
    pub(super) fn around(&self, v: usize) -> &[u32] {
        &self.list[self.starts[v] as usize..self.starts[v + 1] as usize]
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

    fn split(&mut self) {
        let none = u32::MAX;
        self.component = vec![none; self.points.len()];
        let mut stack = Vec::new();
        for seed in 0..self.points.len() {
            if self.component[seed] != none {
                continue;
            }
            let index = self.component_areas.len() as u32;
            let mut area = 0.0;
            self.component[seed] = index;
            stack.push(seed);
            while let Some(v) = stack.pop() {
                area += self.areas[v];
                for i in self.starts[v]..self.starts[v + 1] {
                    let u = self.list[i as usize] as usize;
                    if self.component[u] == none {
                        self.component[u] = index;
                        stack.push(u);
                    }
                }
            }
            self.component_areas.push(area);
        }
    }

    /// About `count` vertices, one for every equal piece of area, in vertex order; components
    /// below 1 % of the area are taken for dirt and skipped.
    pub(super) fn samples(&self, count: usize) -> Samples {
        let total = self.area();
        let clean = |v: usize| self.component_areas[self.component[v] as usize] >= 0.01 * total;
        let step = total / count as f64;
        let (mut sum, mut next) = (0.0, 0.5 * step);
        let mut samples = Samples::default();
        for v in (0..self.points.len()).filter(|&v| clean(v)) {
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

fn check(positions: &[[f32; 3]], faces: &[[u32; 3]]) -> Result<(), SegmentError> {
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
fn upright(p: [f32; 3], up: usize) -> V3 {
    let p = p.map(f64::from);
    V3::new(p[(up + 2) % 3], p[up], p[(up + 1) % 3])
}

/// Vertex neighbours in compressed rows, each row ascending and without repeats.
fn neighbours(count: usize, faces: &[[u32; 3]]) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0u32; count + 1];
    for face in faces {
        face.iter().for_each(|&i| starts[i as usize + 1] += 2);
    }
    for v in 0..count {
        starts[v + 1] += starts[v];
    }
    let mut next = starts.clone();
    let mut full = vec![0u32; starts[count] as usize];
    for face in faces {
        for k in 0..3 {
            let v = face[k] as usize;
            for other in [face[(k + 1) % 3], face[(k + 2) % 3]] {
                full[next[v] as usize] = other;
                next[v] += 1;
            }
        }
    }
    let mut list = Vec::with_capacity(full.len() / 2);
    let mut packed = vec![0u32; count + 1];
    for v in 0..count {
        let row = &mut full[starts[v] as usize..starts[v + 1] as usize];
        row.sort_unstable();
        let first = list.len();
        for &u in row.iter() {
            if u as usize != v && (list.len() == first || list.last() != Some(&u)) {
                list.push(u);
            }
        }
        packed[v + 1] = list.len() as u32;
    }
    (packed, list)
}
