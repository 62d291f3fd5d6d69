//! Matches for the first steps, while the surfaces are far apart.

use crate::constants::matches::NORMAL_SCALE;
use crate::deformed::Deformed;
use crate::group::Group;
use crate::matching::{Correspondences, Match};
use crate::sample::Sample;
use crate::target::FitTarget;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use kn_mesh::vec3::{Vec3, add, distance, dot, scale as scaled, unit};
use rayon::prelude::*;

/// Points per unit of parallel work.
const CHUNK: usize = 256;

/// A position, a scaled normal and a scaled reach.
type Feature = [f64; 7];

/// The nearest samples in position, normal and reach together, both ways: the front of a limb
/// looks for a front, also where the back of another one is nearer, and a hand for a hand. Two
/// points whose reach differs count as `reach_weight` of the difference farther apart.
pub(crate) fn correspond(
    group: &Group,
    deformed: &Deformed,
    target: &FitTarget,
    reach_weight: f64,
) -> Correspondences {
    let scale = NORMAL_SCALE * group.spacing;
    let (own, other) = (&group.sample, &target.sample);
    let own_features = features(own, &deformed.positions, |v| {
        (scaled(deformed.normals[v], scale), reach_weight * group.reach[v])
    });
    let other_features = features(other, &target.positions, |v| {
        (scaled(target.normals[v], scale), reach_weight * target.reach[v])
    });
    let pair = |from: u32, to: u32| {
        let (position, point) = (deformed.positions[from as usize], target.positions[to as usize]);
        let (own, other) = (deformed.normals[from as usize], target.normals[to as usize]);
        Match {
            corners: [from; 3],
            barycentric: [1.0, 0.0, 0.0],
            point,
            normal: unit(add(own, other)),
            distance: distance(position, point),
            accepted: dot(own, other) > 0.0,
        }
    };
    let (forward, backward) = rayon::join(
        || nearest(&own_features, &other_features),
        || nearest(&other_features, &own_features),
    );
    let forward = own.vertices.iter().zip(forward).map(|(&v, i)| pair(v, other.vertices[i]));
    let backward = other.vertices.iter().zip(backward).map(|(&v, i)| pair(own.vertices[i], v));
    Correspondences { forward: forward.collect(), backward: backward.collect() }
}

/// `what` gives the scaled normal and reach of a vertex.
fn features(
    sample: &Sample,
    positions: &[Vec3],
    what: impl Fn(usize) -> (Vec3, f64),
) -> Vec<Feature> {
    let feature = |&v: &u32| {
        let (p, (n, reach)) = (positions[v as usize], what(v as usize));
        [p[0], p[1], p[2], n[0], n[1], n[2], reach]
    };
    sample.vertices.iter().map(feature).collect()
}

/// For every feature of `from` the index of the nearest of `to`.
fn nearest(from: &[Feature], to: &[Feature]) -> Vec<usize> {
    // The tree refuses only what a sample never is: empty.
    let Ok(tree) = ImmutableKdTree::<f64, 7>::new_from_slice(to) else {
        return Vec::new();
    };
    let find = |feature: &Feature| {
        tree.query(feature).nearest_one::<SquaredEuclidean<f64>>().execute().item as usize
    };
    from.par_iter().with_min_len(CHUNK).map(find).collect()
}
