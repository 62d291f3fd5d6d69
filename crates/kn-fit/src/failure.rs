//! Frames that the motion does not explain.

use crate::deformed::Deformed;
use crate::group::Group;
use crate::matching::{Correspondences, Match};
use crate::report::FitReport;
use crate::sample::Sample;
use crate::target::FitTarget;
use kn_mesh::vec3::{Vec3, add, distance, scale};

/// A point is far when its distance exceeds this share of the diagonal of the target's box; far
/// points that are nearer than that to one another belong together ...
const FAR: f64 = 0.025;
/// ... and a frame is not explained when one such region stands for this share of the area.
const UNEXPLAINED: f64 = 0.004;
/// ... and for that of so many vertices: on a coarse mesh the scanner's holes are that large.
const FEW: f64 = 16.0;
/// More far points than this are one region without a closer look.
const MANY: usize = 4000;
/// An edge is torn when it has grown to this many times its length in the group's first frame ...
const STRETCHED: f64 = 3.0;
/// ... and by this share of the diagonal, with its middle farther from the target than this share
/// of its length: cloth stretches along the surface, a tear gapes.
const GAP: f64 = 0.01;
const GAPING: f64 = 0.25;
/// A frame is not explained when the torn edges span this share of the diagonal's square. They cross
/// a tear: its length is the sum of theirs before, and what each has grown by is its width there. A
/// hem that leaves the thighs had 0.005 and was not worth an I-frame, a ball that is let go 0.018.
const TORN: f64 = 0.01;
/// ... or when this share of the area of either mesh found no partner,
const UNMATCHED: f64 = 0.05;
/// (of a coarse mesh, that of so many vertices: more of its surface lies near a border)
const MANY_UNMATCHED: f64 = 150.0;
/// ... or this part of that, and so many times the share of any earlier frame of the group,
const UNMATCHED_ANEW: f64 = 0.7;
const MORE_UNMATCHED: f64 = 1.75;
/// ... or when the 95th percentile of the distances is this many times that of any earlier frame
/// of the group,
const WORSE: f64 = 3.0;
/// ... and this share of the diagonal.
const NOTABLE: f64 = 0.005;

/// Why the encoder should begin a new group of frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FitFailure {
    /// A part of the source has no target near it: a lost limb, a ball let go.
    SourceUnexplained {
        /// Its share of the source's area.
        share: f64,
        /// The source's vertex that is farthest from the target.
        vertex: u32,
    },
    /// A part of the target has no source near it: something new, or a limb that the source did
    /// not follow.
    TargetUnexplained {
        /// Its share of the target's area.
        share: f64,
        /// The target's vertex that is farthest from the source.
        vertex: u32,
    },
    /// Edges of the source had to stretch: what was one surface comes apart, a ball leaves its
    /// hand or two people part.
    Torn {
        /// The length of the tear as a share of the diagonal of the target's box.
        length: f64,
        /// The area that gapes as a share of the diagonal's square; what decides.
        area: f64,
        /// A source vertex at its longest edge.
        vertex: u32,
    },
    /// Much of a surface faces the other way or a border than what is nearest to it.
    Unmatched {
        /// The share of the area, of the mesh where it is larger.
        share: f64,
    },
    /// The distances are far beyond those of the frames before.
    Worse {
        /// 95th percentile relative to the largest of the earlier frames of the group.
        ratio: f64,
    },
}

/// What frames of a group are judged by.
#[derive(Debug)]
pub(crate) struct Watch {
    /// Edges and their lengths in the group's first frame.
    edges: Vec<(u32, u32, f64)>,
    /// The largest of the frames so far.
    worst: Option<Worst>,
}

/// The largest values of the frames of a group.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    /// 95th percentile of the distances.
    p95: f64,
    /// Share of the area without a partner.
    unmatched: f64,
}

/// A fitted frame, measured.
pub(crate) struct Outcome<'a> {
    pub(crate) group: &'a Group,
    pub(crate) deformed: &'a Deformed,
    pub(crate) target: &'a FitTarget,
    pub(crate) matches: &'a Correspondences,
    pub(crate) report: &'a FitReport,
}

impl Watch {
    /// Begins a group; `edges` of its first frame, `positions` of the same.
    pub(crate) fn new(edges: &[(u32, u32, u32)], positions: &[Vec3]) -> Self {
        let length = |a: u32, b: u32| distance(positions[a as usize], positions[b as usize]);
        Self { edges: edges.iter().map(|&(a, b, _)| (a, b, length(a, b))).collect(), worst: None }
    }

    /// The frame becomes one that later ones are compared with.
    pub(crate) fn remember(&mut self, report: &FitReport) {
        let worst = self.worst.unwrap_or_default();
        self.worst = Some(Worst {
            p95: worst.p95.max(p95(report)),
            unmatched: worst.unmatched.max(unmatched(report)),
        });
    }

    /// What the motion does not explain, the plainest reason first.
    pub(crate) fn judge(&self, outcome: &Outcome) -> Option<FitFailure> {
        unexplained(outcome).or_else(|| self.torn(outcome)).or_else(|| self.unusual(outcome))
    }

    fn torn(&self, outcome: &Outcome) -> Option<FitFailure> {
        let positions = &outcome.deformed.positions;
        let diagonal = outcome.target.diagonal;
        let (mut sum, mut area, mut longest) = (0.0, 0.0, (0.0, 0));
        for &(a, b, before) in &self.edges {
            let (from, to) = (positions[a as usize], positions[b as usize]);
            let now = distance(from, to);
            let stretched = now > STRETCHED * before && now - before > GAP * diagonal;
            if stretched && gap(outcome.target, scale(add(from, to), 0.5)) > GAPING * now {
                sum += before;
                area += before * (now - before);
                if now > longest.0 {
                    longest = (now, a);
                }
            }
        }
        let (length, area) = (sum / diagonal, area / (diagonal * diagonal));
        (area > TORN).then_some(FitFailure::Torn { length, area, vertex: longest.1 })
    }

    fn unusual(&self, outcome: &Outcome) -> Option<FitFailure> {
        let report = outcome.report;
        let share = unmatched(report);
        let vertices = outcome.deformed.positions.len().min(outcome.target.positions.len());
        let limit = UNMATCHED.max(MANY_UNMATCHED / vertices as f64);
        let anew =
            |worst: Worst| share > (MORE_UNMATCHED * worst.unmatched).max(UNMATCHED_ANEW * limit);
        if share > limit || self.worst.is_some_and(anew) {
            return Some(FitFailure::Unmatched { share });
        }
        let (now, worst) = (p95(report), self.worst?.p95);
        let worse = now > WORSE * worst && now > NOTABLE * outcome.target.diagonal;
        worse.then(|| FitFailure::Worse { ratio: now / worst })
    }
}

/// How far a point is from the target.
fn gap(target: &FitTarget, point: Vec3) -> f64 {
    target.tree.closest(point).distance_squared.sqrt()
}

/// The larger 95th percentile of both directions.
fn p95(report: &FitReport) -> f64 {
    report.source_to_target.p95.max(report.target_to_source.p95)
}

/// The larger share without a partner of both directions.
fn unmatched(report: &FitReport) -> f64 {
    report.source_to_target.unmatched.max(report.target_to_source.unmatched)
}

/// The larger of the largest far regions of both meshes, where it is large enough.
fn unexplained(outcome: &Outcome) -> Option<FitFailure> {
    let Outcome { group, deformed, target, matches, .. } = outcome;
    let limit = FAR * target.diagonal;
    let lost = far_region(&matches.forward, &group.all, &deformed.positions, limit);
    let new = far_region(&matches.backward, &target.sample, &target.positions, limit);
    let notable = |vertices: usize| UNEXPLAINED.max(FEW / vertices as f64);
    let is_lost = lost.0 >= notable(deformed.positions.len());
    let is_new = new.0 >= notable(target.positions.len());
    if is_lost && (!is_new || lost.0 >= new.0) {
        Some(FitFailure::SourceUnexplained { share: lost.0, vertex: lost.1 })
    } else if is_new {
        Some(FitFailure::TargetUnexplained { share: new.0, vertex: new.1 })
    } else {
        None
    }
}

/// A point that is far from the other mesh.
struct FarPoint {
    position: Vec3,
    distance: f64,
    share: f64,
    vertex: u32,
}

/// The largest region of far points: its share of the area, and its farthest vertex.
fn far_region(matches: &[Match], sample: &Sample, positions: &[Vec3], limit: f64) -> (f64, u32) {
    let points = matches.iter().zip(&sample.vertices).zip(&sample.weights);
    let far = points.filter(|((found, _), _)| found.distance > limit);
    let mut left: Vec<FarPoint> = far
        .map(|((found, &vertex), &share)| {
            let position = positions[vertex as usize];
            FarPoint { position, distance: found.distance, share, vertex }
        })
        .collect();
    // Specks that are too small together are too small one by one.
    if left.iter().map(|point| point.share).sum::<f64>() < UNEXPLAINED {
        return (0.0, 0);
    }
    if left.len() > MANY {
        return measure(&left);
    }
    let mut largest = (0.0, 0);
    while let Some(seed) = left.pop() {
        let found = measure(&grow(seed, &mut left, limit));
        if found.0 > largest.0 {
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

fn measure(region: &[FarPoint]) -> (f64, u32) {
    let (mut share, mut farthest) = (0.0, (0.0, 0));
    for point in region {
        share += point.share;
        if point.distance > farthest.0 {
            farthest = (point.distance, point.vertex);
        }
    }
    (share, farthest.1)
}

impl std::fmt::Display for FitFailure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let percent = |share: &f64| 100.0 * share;
        match self {
            Self::SourceUnexplained { share, vertex } => write!(
                f,
                "{:.1} % of the reference, around its vertex {vertex}, is not in the frame",
                percent(share)
            ),
            Self::TargetUnexplained { share, vertex } => write!(
                f,
                "{:.1} % of the frame, around its vertex {vertex}, is not explained by the reference",
                percent(share)
            ),
            Self::Torn { length, area, vertex } => write!(
                f,
                "the reference comes apart around its vertex {vertex}, along {:.1} % of the diagonal \
                 and by {:.1} % of its square",
                percent(length),
                percent(area)
            ),
            Self::Unmatched { share } => {
                write!(f, "{:.1} % of the surface has no partner", percent(share))
            }
            Self::Worse { ratio } => {
                write!(f, "distances are {ratio:.1} times those of the frames before")
            }
        }
    }
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
        let (share, vertex) = far_region(&matches(&distances), &sample, &line(0.5), 1.0);
        assert!((share - 0.1).abs() < 1e-12);
        assert_eq!(vertex, 9);
        let (share, _) = far_region(&matches(&distances), &sample, &line(2.0), 1.0);
        assert!((share - 0.01).abs() < 1e-12, "specks are not one region");
    }
}
