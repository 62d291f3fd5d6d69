//! Mean absolute curvature of every vertex at every level.

use rayon::prelude::*;

use super::eigenvalues::eigenvalues;
use super::flood::{Flood, Spheres, Step};
use super::topology::{Symmetric, Topology};
use crate::vec3::Vec3;

/// Vertices that a thread takes at a time.
const CHUNK: usize = 256;

/// `#V × levels` curvatures (kmax + |kmin|) / 2 in units of 1 / `side`: Lavoué 2011, section 3.
///
/// The sphere of level l has the radius `radii[l]`. A tensor that is not finite counts as flat.
pub(super) fn curvature(
    topology: &Topology,
    positions: &[Vec3],
    side: f64,
    radii: &[f64],
) -> Vec<f64> {
    let levels = radii.len();
    let spheres = Spheres::new(radii.iter().copied());
    let mut curvature = vec![0.0; positions.len() * levels];
    let scratch = || (Flood::new(positions.len()), vec![[0.0; 6]; levels]);
    curvature.par_chunks_mut(CHUNK * levels).enumerate().for_each_init(
        scratch,
        |(flood, tensors), (chunk, out)| {
            for (i, out) in out.chunks_exact_mut(levels).enumerate() {
                let vertex = (chunk * CHUNK + i) as u32;
                tensors.fill([0.0; 6]);
                flood.run(topology, positions, vertex, &spheres, |step| {
                    add_edge(tensors, step, &topology.tensors, &spheres);
                });
                for (out, (tensor, radius)) in out.iter_mut().zip(tensors.iter().zip(radii)) {
                    *out = side * mean_absolute(tensor, radius);
                }
            }
        },
    );
    curvature
}

/// Adds the part of an edge that is inside each sphere.
#[inline]
fn add_edge(tensors: &mut [Symmetric], step: &Step, edges: &[Symmetric], spheres: &Spheres) {
    let whole = &edges[step.to.edge as usize];
    for level in step.from.level as usize..tensors.len() {
        let leaves = level < step.to_level as usize;
        let part = if leaves { step.clip(spheres.radii_squared[level]) } else { 1.0 };
        for (sum, entry) in tensors[level].iter_mut().zip(whole) {
            *sum += part * entry;
        }
    }
}

fn mean_absolute(tensor: &Symmetric, radius: &f64) -> f64 {
    let area = std::f64::consts::PI * radius * radius;
    if !tensor.iter().all(|entry| entry.is_finite()) {
        return 0.0;
    }
    let [a, b, c] = eigenvalues(&tensor.map(|entry| entry / area)).map(f64::abs);
    // kmax and kmin are the two of largest absolute value; the third belongs to the normal.
    0.5 * (a + b + c - a.min(b).min(c))
}
