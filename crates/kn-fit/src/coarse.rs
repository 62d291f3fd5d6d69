//! Matches for the first steps, while the surfaces are far apart.

use crate::deformed::Deformed;
use crate::group::Group;
use crate::matching::{Correspondences, Match};
use crate::sample::Sample;
use crate::target::FitTarget;
use crate::vec3::{Vec3, add, distance, dot, unit};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::prelude::*;

/// Opposite normals count as far apart as this many node spacings times two.
const NORMAL_SCALE: f64 = 1.5;
/// Points per unit of parallel work.
const CHUNK: usize = 256;

/// A position and a scaled normal.
type Feature = [f64; 6];

/// The nearest samples in position and normal together, both ways: the front of a limb looks for
/// a front, also where the back of another one is nearer.
pub(crate) fn correspond(
    group: &Group,
    deformed: &Deformed,
    target: &FitTarget,
) -> Correspondences {
    let scale = NORMAL_SCALE * group.spacing;
    let (own, other) = (&group.sample, &target.sample);
    let own_features = features(own, &deformed.positions, &deformed.normals, scale);
    let other_features = features(other, &target.positions, &target.normals, scale);
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

fn features(sample: &Sample, positions: &[Vec3], normals: &[Vec3], scale: f64) -> Vec<Feature> {
    let feature = |&v: &u32| {
        let (p, n) = (positions[v as usize], normals[v as usize]);
        [p[0], p[1], p[2], scale * n[0], scale * n[1], scale * n[2]]
    };
    sample.vertices.iter().map(feature).collect()
}

/// For every feature of `from` the index of the nearest of `to`.
fn nearest(from: &[Feature], to: &[Feature]) -> Vec<usize> {
    // The tree refuses only what a sample never is: empty.
    let Ok(tree) = ImmutableKdTree::<f64, 6>::new_from_slice(to) else {
        return Vec::new();
    };
    let find = |feature: &Feature| {
        tree.query(feature).nearest_one::<SquaredEuclidean<f64>>().execute().item as usize
    };
    from.par_iter().with_min_len(CHUNK).map(find).collect()
}
