//! Correspondences between the deformed source and the target.

use crate::group::{Group, Levers};
use crate::quadratic::{Metric, Observations};
use crate::sample::Sample;
use crate::source::FitSource;
use crate::target::{FitTarget, on_boundary, smooth_normal};
use crate::vec3::{Vec3, add, dot, norm, sub, unit};
use kn_metrics::TriangleTree;
use rayon::prelude::*;

/// Points per unit of parallel work.
const CHUNK: usize = 256;

/// The deformed source.
#[derive(Debug, Default)]
pub(crate) struct Deformed {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) normals: Vec<Vec3>,
}

/// A point that found a partner on the other mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Match {
    /// Where it is on the source: face and barycentric weights, or a vertex in all three corners.
    corners: [u32; 3],
    barycentric: Vec3,
    /// The point of the target.
    point: Vec3,
    /// The unit normal along which the distance counts fully.
    normal: Vec3,
    pub(crate) distance: f64,
}

/// The matches of the points of one sample; `None` where normal or border speak against one.
pub(crate) type Matches = Vec<Option<Match>>;

/// From vertices of the deformed source to the closest points of the target's surface.
pub(crate) fn to_target(
    sample: &Sample,
    deformed: &Deformed,
    target: &FitTarget,
    least_cosine: f64,
) -> Matches {
    let find = |&vertex: &u32| {
        let position = deformed.positions[vertex as usize];
        let own = deformed.normals[vertex as usize];
        let closest = target.tree.closest(position);
        let face = target.faces[closest.face as usize];
        let normal = smooth_normal(&target.normals, face, closest.barycentric);
        let rejected = dot(normal, own) < least_cosine
            || on_boundary(&target.boundary, face, closest.barycentric);
        (!rejected).then(|| Match {
            corners: [vertex; 3],
            barycentric: [1.0, 0.0, 0.0],
            point: closest.point,
            normal: unit(add(normal, own)),
            distance: norm(sub(position, closest.point)),
        })
    };
    sample.vertices.par_iter().with_min_len(CHUNK).map(find).collect()
}

/// From vertices of the target to the closest points of the deformed source's surface.
pub(crate) fn to_source(
    sample: &Sample,
    deformed: &Deformed,
    faces: &[[u32; 3]],
    boundary: &[bool],
    target: &FitTarget,
    least_cosine: f64,
) -> Matches {
    let Ok(tree) = TriangleTree::new(&deformed.positions, faces) else {
        // A source that was torn to infinity matches nothing.
        return vec![None; target.sample.vertices.len()];
    };
    let find = |&vertex: &u32| {
        let position = target.positions[vertex as usize];
        let own = target.normals[vertex as usize];
        let closest = tree.closest(position);
        let face = faces[closest.face as usize];
        let normal = smooth_normal(&deformed.normals, face, closest.barycentric);
        let rejected =
            dot(normal, own) < least_cosine || on_boundary(boundary, face, closest.barycentric);
        (!rejected).then(|| Match {
            corners: face,
            barycentric: closest.barycentric,
            point: position,
            normal: unit(add(normal, own)),
            distance: norm(sub(position, closest.point)),
        })
    };
    sample.vertices.par_iter().with_min_len(CHUNK).map(find).collect()
}

/// The distance that a share `quantile` of the matches does not exceed; 0 without matches.
pub(crate) fn quantile(matches: &Matches, quantile: f64) -> f64 {
    let mut distances: Vec<f64> = matches.iter().flatten().map(|m| m.distance).collect();
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
    sample: &Sample,
    matches: &Matches,
    width: f64,
    tangential: f64,
    observations: &mut Observations,
) {
    let mut levers = Levers::default();
    for (found, &share) in matches.iter().zip(&sample.weights) {
        let Some(found) = found else { continue };
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

/// Moves all vertices and finds their normals.
pub(crate) fn deform(
    source: &FitSource,
    matrices: &[crate::affine::Affine],
    deformed: &mut Deformed,
) {
    let q = source.influence.nodes_per_vertex;
    deformed.positions.resize(source.positions.len(), [0.0; 3]);
    deformed.positions.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, out)| {
        for (offset, out) in out.iter_mut().enumerate() {
            let vertex = chunk * CHUNK + offset;
            let x = source.positions[vertex];
            let mut sum = [0.0; 3];
            for slot in vertex * q..(vertex + 1) * q {
                let node = usize::from(source.influence.nodes[slot]);
                let (weight, origin, m) =
                    (source.influence.weights[slot], source.nodes[node], &matrices[node]);
                let d = sub(x, origin);
                for (axis, sum) in sum.iter_mut().enumerate() {
                    let row = &m[axis];
                    let moved = row[0] * d[0] + row[1] * d[1] + row[2] * d[2] + row[3];
                    *sum += weight * (moved + origin[axis]);
                }
            }
            *out = sum;
        }
    });
    crate::surface::vertex_normals(&deformed.positions, source.faces, &mut deformed.normals);
}

/// Both directions at once.
pub(crate) struct Correspondences {
    pub(crate) forward: Matches,
    pub(crate) backward: Matches,
}

/// Matches both ways; `full` takes every vertex of the source instead of its sample.
pub(crate) fn correspond(
    group: &Group,
    source: &FitSource,
    deformed: &Deformed,
    target: &FitTarget,
    full: bool,
    least_cosine: f64,
) -> Correspondences {
    let sample = if full { &group.all } else { &group.sample };
    let (forward, backward) = rayon::join(
        || to_target(sample, deformed, target, least_cosine),
        || {
            to_source(
                &target.sample,
                deformed,
                source.faces,
                &group.boundary,
                target,
                least_cosine,
            )
        },
    );
    Correspondences { forward, backward }
}
