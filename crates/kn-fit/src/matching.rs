//! Correspondences between the deformed source and the target.

use crate::constants::matches::LEAST_COSINE;
use crate::deformed::Deformed;
use crate::group::{Group, Levers};
use crate::quadratic::{Metric, Observations};
use crate::sample::Sample;
use crate::source::FitSource;
use crate::target::{FitTarget, on_boundary, smooth_normal};
use kn_mesh::vec3::{Vec3, add, dot, sub, unit};
use kn_metrics::{TreeError, TriangleTree};
use rayon::prelude::*;

/// Points per unit of parallel work.
const CHUNK: usize = 256;

/// A point and the closest one of the other mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Match {
    /// The point on the source: face and barycentric weights, or one vertex in all three corners.
    pub(crate) corners: [u32; 3],
    pub(crate) barycentric: Vec3,
    /// The point of the target.
    pub(crate) point: Vec3,
    /// The unit normal along which the distance counts fully.
    pub(crate) normal: Vec3,
    pub(crate) distance: f64,
    /// Whether normals and borders let it count.
    pub(crate) accepted: bool,
}

/// The face that each point was matched to last: the next search starts there.
#[derive(Debug, Default)]
pub(crate) struct Hints {
    /// By vertex of the source.
    forward: Vec<u32>,
    /// By sample of the target.
    backward: Vec<u32>,
}

impl Hints {
    /// Forgets another frame's faces.
    pub(crate) fn reset(&mut self, vertex_count: usize, target_samples: usize) {
        self.forward.clear();
        self.forward.resize(vertex_count, u32::MAX);
        self.backward.clear();
        self.backward.resize(target_samples, u32::MAX);
    }
}

/// The matches of the points of one sample.
pub(crate) type Matches = Vec<Match>;

/// From vertices of the deformed source to the closest points of the target's surface.
pub(crate) fn to_target(
    sample: &Sample,
    deformed: &Deformed,
    target: &FitTarget,
    hints: &mut [u32],
) -> Matches {
    let find = |&vertex: &u32| {
        let position = deformed.positions[vertex as usize];
        let own = deformed.normals[vertex as usize];
        let closest = target.tree.closest_from(position, hints[vertex as usize]);
        let face = target.faces[closest.face as usize];
        let normal = smooth_normal(&target.normals, face, closest.barycentric);
        let found = Match {
            corners: [vertex; 3],
            barycentric: [1.0, 0.0, 0.0],
            point: closest.point,
            normal: unit(add(normal, own)),
            distance: closest.distance_squared.sqrt(),
            accepted: dot(normal, own) >= LEAST_COSINE
                && !on_boundary(&target.boundary, face, closest.barycentric),
        };
        (found, closest.face)
    };
    let (matches, faces): (Matches, Vec<u32>) =
        sample.vertices.par_iter().with_min_len(CHUNK).map(find).unzip();
    sample.vertices.iter().zip(faces).for_each(|(&vertex, face)| hints[vertex as usize] = face);
    matches
}

/// From vertices of the target to the closest points of the deformed source's surface.
pub(crate) fn to_source(
    target: &FitTarget,
    deformed: &Deformed,
    faces: &[[u32; 3]],
    boundary: &[bool],
    hints: &mut [u32],
) -> Result<Matches, TreeError> {
    let tree = TriangleTree::new(&deformed.positions, faces)?;
    let find = |(&vertex, hint): (&u32, &mut u32)| {
        let position = target.positions[vertex as usize];
        let own = target.normals[vertex as usize];
        let closest = tree.closest_from(position, *hint);
        *hint = closest.face;
        let face = faces[closest.face as usize];
        let normal = smooth_normal(&deformed.normals, face, closest.barycentric);
        Match {
            corners: face,
            barycentric: closest.barycentric,
            point: position,
            normal: unit(add(normal, own)),
            distance: closest.distance_squared.sqrt(),
            accepted: dot(normal, own) >= LEAST_COSINE
                && !on_boundary(boundary, face, closest.barycentric),
        }
    };
    let vertices = &target.sample.vertices;
    Ok(vertices.par_iter().zip(hints).with_min_len(CHUNK).map(find).collect())
}

/// Both directions.
#[derive(Debug)]
pub(crate) struct Correspondences {
    pub(crate) forward: Matches,
    pub(crate) backward: Matches,
}

impl Correspondences {
    /// Closest points of the surfaces, from `sample` of the source and from the target's sample.
    /// `kept` are earlier matches from the target, which save building a tree over the source.
    pub(crate) fn on_surfaces(
        group: &Group,
        sample: &Sample,
        frame: (&FitSource, &FitTarget),
        deformed: &Deformed,
        hints: &mut Hints,
        kept: Option<Matches>,
    ) -> Result<Self, TreeError> {
        let (source, target) = frame;
        let Hints { forward, backward } = hints;
        let (forward, backward) = rayon::join(
            || to_target(sample, deformed, target, forward),
            || match kept {
                Some(kept) => Ok(kept),
                None => to_source(target, deformed, source.faces, &group.boundary, backward),
            },
        );
        Ok(Self { forward, backward: backward? })
    }

    /// The sum of both root mean squares of all distances, accepted or not.
    pub(crate) fn gap(&self) -> f64 {
        let mean = |matches: &[Match]| {
            let sum: f64 = matches.iter().map(|m| m.distance * m.distance).sum();
            (sum / matches.len().max(1) as f64).sqrt()
        };
        mean(&self.forward) + mean(&self.backward)
    }

    /// The sum of both root mean squares of the accepted distances.
    pub(crate) fn residual(&self) -> f64 {
        root_mean_square(&self.forward) + root_mean_square(&self.backward)
    }
}

fn root_mean_square(matches: &[Match]) -> f64 {
    let sum: f64 = matches.iter().filter(|m| m.accepted).map(|m| m.distance * m.distance).sum();
    (sum / matches.len().max(1) as f64).sqrt()
}

/// The distance that a share `quantile` of the accepted matches does not exceed; 0 without any.
pub(crate) fn quantile(matches: &[Match], quantile: f64) -> f64 {
    let accepted = matches.iter().filter(|m| m.accepted);
    let mut distances: Vec<f64> = accepted.map(|m| m.distance).collect();
    if distances.is_empty() {
        return 0.0;
    }
    let rank = ((distances.len() - 1) as f64 * quantile) as usize;
    *distances.select_nth_unstable_by(rank, f64::total_cmp).1
}

/// The weight of Geman and McClure of a residual, 1 at 0, for a given width.
fn robust_weight(distance: f64, width: f64) -> f64 {
    let ratio = distance / width;
    (1.0 / (1.0 + ratio * ratio)).powi(2)
}

/// w (n nᵀ + τ (I − n nᵀ)): full weight along the normal, a little across.
fn metric(normal: Vec3, tangential: f64, weight: f64) -> Metric {
    let (along, across) = (weight * (1.0 - tangential), weight * tangential);
    let [x, y, z] = normal;
    [
        along * x * x + across,
        along * y * y + across,
        along * z * z + across,
        along * x * y,
        along * x * z,
        along * y * z,
    ]
}

/// Adds L_data of one direction: every match as an observation of its point's nodes.
pub(crate) fn push_matches(
    source: &FitSource,
    matches: &[Match],
    shares: &[f64],
    width: f64,
    tangential: f64,
    observations: &mut Observations,
) {
    let mut levers = Levers::default();
    for (found, &share) in matches.iter().zip(shares).filter(|(found, _)| found.accepted) {
        levers.clear();
        for corner in 0..3 {
            if found.barycentric[corner] > 0.0 {
                levers.add_vertex(source, found.corners[corner], found.barycentric[corner]);
            }
        }
        let weight = share * robust_weight(found.distance, width);
        let metric = metric(found.normal, tangential, weight);
        observations.push(&levers.terms, metric, sub(found.point, levers.constant));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_metric_counts_a_little_across_the_normal() {
        let [xx, yy, zz, xy, xz, yz] = metric([0.6, 0.0, 0.8], 0.1, 2.0);
        let along = 0.36 * xx + 0.64 * zz + 2.0 * 0.48 * xz;
        assert!((along - 2.0).abs() < 1e-12);
        assert!((yy - 0.2).abs() < 1e-12);
        assert_eq!((xy, yz), (0.0, 0.0));
    }

    #[test]
    fn far_matches_count_little() {
        assert_eq!(robust_weight(0.0, 1.0), 1.0);
        assert_eq!(robust_weight(1.0, 1.0), 0.25);
        assert!(robust_weight(3.0, 1.0) < 0.011);
    }
}
