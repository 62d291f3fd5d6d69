//! Measures of a fitted frame: surface that is missing on either side, and tears of the source. The
//! caller decides what they mean for the frame.

use crate::constants::measures::MANY;
use crate::deformed::Deformed;
use crate::group::Group;
use crate::matching::{Correspondences, Match};
use crate::sample::Sample;
use crate::target::FitTarget;
use kn_mesh::vec3::{Vec3, add, distance, scale};

/// Options of the measures: the distances and lengths from which a point is far or an edge is torn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasureOptions {
    /// A point is far when its distance from the other mesh exceeds this share of the diagonal of
    /// the target's box. Far points that are nearer than that to one another are one region.
    pub far: f64,
    /// An edge is torn when it has grown to this many times its length in the GoF's first frame ...
    pub stretched: f64,
    /// ... and by this share of the diagonal ...
    pub grown: f64,
    /// ... and its middle is farther from the target than this share of its length: cloth stretches
    /// along the surface, a tear gapes.
    pub gaping: f64,
}

/// Measures of what the motion of a fitted frame does not explain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FitMeasures {
    /// The largest region of the source without target near it.
    pub lost: Region,
    /// The largest region of the target without source near it.
    pub new: Region,
    /// Edges of the source that are torn.
    pub tear: Tear,
    /// Diagonal of the target's box, in the unit of the positions.
    pub diagonal: f64,
    /// Number of vertices of the source.
    pub source_vertices: usize,
    /// Number of vertices of the target.
    pub target_vertices: usize,
}

/// A region of far points of one mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Region {
    /// Its share of the mesh's area.
    pub share: f64,
    /// The vertex that is farthest from the other mesh.
    pub vertex: u32,
}

/// Torn edges. They cross a tear: its length is the sum of their lengths before, and what each has
/// grown by is its width there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tear {
    /// The length of the tear as a share of the diagonal of the target's box.
    pub length: f64,
    /// The area that gapes as a share of the diagonal's square.
    pub area: f64,
    /// A source vertex at the longest torn edge.
    pub vertex: u32,
}

/// A fitted frame, to be measured.
pub(crate) struct Outcome<'a> {
    pub(crate) group: &'a Group,
    pub(crate) deformed: &'a Deformed,
    pub(crate) target: &'a FitTarget,
    pub(crate) matches: &'a Correspondences,
}

impl Outcome<'_> {
    /// Measures the frame.
    pub(crate) fn measure(&self, options: &MeasureOptions) -> FitMeasures {
        let Outcome { group, deformed, target, matches } = *self;
        let limit = options.far * target.diagonal;
        FitMeasures {
            lost: far_region(&matches.forward, &group.all, &deformed.positions, limit),
            new: far_region(&matches.backward, &target.sample, &target.positions, limit),
            tear: self.tear(options),
            diagonal: target.diagonal,
            source_vertices: deformed.positions.len(),
            target_vertices: target.positions.len(),
        }
    }

    fn tear(&self, options: &MeasureOptions) -> Tear {
        let positions = &self.deformed.positions;
        let diagonal = self.target.diagonal;
        let (mut sum, mut area, mut longest) = (0.0, 0.0, (0.0, 0));
        for (&[a, b], &before) in self.group.edges.iter().zip(&self.group.edge_lengths) {
            let (from, to) = (positions[a as usize], positions[b as usize]);
            let now = distance(from, to);
            let stretched =
                now > options.stretched * before && now - before > options.grown * diagonal;
            if stretched && gap(self.target, scale(add(from, to), 0.5)) > options.gaping * now {
                sum += before;
                area += before * (now - before);
                if now > longest.0 {
                    longest = (now, a);
                }
            }
        }
        Tear { length: sum / diagonal, area: area / (diagonal * diagonal), vertex: longest.1 }
    }
}

/// The distance of a point from the target.
fn gap(target: &FitTarget, point: Vec3) -> f64 {
    target.tree.closest(point).distance_squared.sqrt()
}

/// A point that is far from the other mesh.
struct FarPoint {
    position: Vec3,
    distance: f64,
    share: f64,
    vertex: u32,
}

/// The largest region of far points.
fn far_region(matches: &[Match], sample: &Sample, positions: &[Vec3], limit: f64) -> Region {
    let points = matches.iter().zip(&sample.vertices).zip(&sample.weights);
    let far = points.filter(|((found, _), _)| found.distance > limit);
    let mut left: Vec<FarPoint> = far
        .map(|((found, &vertex), &share)| {
            let position = positions[vertex as usize];
            FarPoint { position, distance: found.distance, share, vertex }
        })
        .collect();
    if left.len() > MANY {
        return measure(&left);
    }
    let mut largest = Region::default();
    while let Some(seed) = left.pop() {
        let found = measure(&grow(seed, &mut left, limit));
        if found.share > largest.share {
            largest = found;
        }
    }
    largest
}

/// Takes what belongs together with `seed` out of `left`.
fn grow(seed: FarPoint, left: &mut Vec<FarPoint>, reach: f64) -> Vec<FarPoint> {
    let mut region = vec![seed];
    let mut at = 0;
    while at < region.len() {
        let middle = region[at].position;
        region.extend(left.extract_if(.., |point| distance(point.position, middle) <= reach));
        at += 1;
    }
    region
}

fn measure(region: &[FarPoint]) -> Region {
    let (mut share, mut farthest) = (0.0, (0.0, 0));
    for point in region {
        share += point.share;
        if point.distance > farthest.0 {
            farthest = (point.distance, point.vertex);
        }
    }
    Region { share, vertex: farthest.1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matches(distances: &[f64]) -> Vec<Match> {
        let found = |&distance: &f64| Match {
            corners: [0; 3],
            barycentric: [1.0, 0.0, 0.0],
            point: [0.0; 3],
            normal: [0.0; 3],
            distance,
            accepted: true,
        };
        distances.iter().map(found).collect()
    }

    #[test]
    fn far_points_count_where_they_lie_together() {
        let line = |apart: f64| -> Vec<Vec3> {
            (0..100).map(|i| [apart * f64::from(i), 0.0, 0.0]).collect()
        };
        let sample = Sample { vertices: (0..100).collect(), weights: vec![0.01; 100] };
        let distances: Vec<f64> =
            (0..100).map(|i| if i < 10 { 3.0 + f64::from(i) } else { 0.0 }).collect();
        let region = far_region(&matches(&distances), &sample, &line(0.5), 1.0);
        assert!((region.share - 0.1).abs() < 1e-12);
        assert_eq!(region.vertex, 9);
        let region = far_region(&matches(&distances), &sample, &line(2.0), 1.0);
        assert!((region.share - 0.01).abs() < 1e-12, "specks are not one region");
    }
}
