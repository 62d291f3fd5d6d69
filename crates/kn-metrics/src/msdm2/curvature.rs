//! Mean absolute curvature of every vertex at every level.

use std::f64::consts::PI;

use rayon::prelude::*;

use super::eigenvalues::eigenvalues;
use super::flood::{Flood, Spheres, Step, clip, clip_special};
use super::machine::{Machine, Task, dispatch};
use super::topology::{Symmetric, Topology};
use crate::lanes::lanes;
use crate::vec3::{Vec3, length, length_squared, sub};

/// Vertices that a thread takes at a time.
const CHUNK: usize = 256;

/// A vertex's edges on their own: inside a sphere that every edge leaves, the tensor grows with
/// the radius, and one set of eigenvalues serves all radii. That is most vertices of a scan.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ring {
    shortest_edge: f64,
    /// (kmax + |kmin|) / 2 of the sum of the edges' tensors, each for a unit of length.
    curvature: f64,
}

/// `#V` rings.
pub(super) fn rings(topology: &Topology, positions: &[Vec3]) -> Vec<Ring> {
    let ring = |vertex: usize| {
        let (mut sum, mut shortest_edge) = ([0.0; 6], f64::INFINITY);
        for to in topology.neighbours(vertex) {
            let length = length(sub(positions[to.vertex as usize], positions[vertex]));
            shortest_edge = length.min(shortest_edge);
            for (sum, entry) in sum.iter_mut().zip(&topology.tensors[to.edge as usize]) {
                *sum += entry / length;
            }
        }
        Ring { shortest_edge, curvature: mean_absolute(&sum) }
    };
    (0..positions.len()).into_par_iter().with_min_len(CHUNK).map(ring).collect()
}

/// `#V × levels` curvatures (kmax + |kmin|) / 2 in units of 1 / `side`: Lavoué 2011, section 3.
///
/// The sphere of level l has the radius `radii[l]`, ascending. A tensor that is not finite counts
/// as flat.
pub(super) fn curvature(
    topology: &Topology,
    rings: &[Ring],
    positions: &[Vec3],
    side: f64,
    radii: &[f64],
) -> Vec<f64> {
    let levels = radii.len();
    let spheres = Spheres::new(radii.iter().copied(), topology);
    let kernel = Kernel { topology, rings, positions, side, radii, spheres };
    let mut curvature = vec![0.0; positions.len() * levels];
    let scratch = || (Flood::new(positions.len(), levels), vec![[0.0; 6]; levels]);
    curvature.par_chunks_mut(CHUNK * levels).enumerate().for_each_init(
        scratch,
        |(flood, tensors), (chunk, out)| {
            let chunk = Chunk { of: &kernel, flood, tensors, first: chunk * CHUNK, out };
            dispatch(chunk);
        },
    );
    curvature
}

/// What the curvature of a vertex depends on.
struct Kernel<'a> {
    topology: &'a Topology,
    rings: &'a [Ring],
    positions: &'a [Vec3],
    side: f64,
    radii: &'a [f64],
    spheres: Spheres,
}

/// A chunk of vertices.
struct Chunk<'a> {
    of: &'a Kernel<'a>,
    flood: &'a mut Flood,
    tensors: &'a mut [Symmetric],
    first: usize,
    out: &'a mut [f64],
}

impl Task for Chunk<'_> {
    type Output = ();

    #[inline(always)]
    fn run<M: Machine>(self, machine: M) {
        let Self { of, flood, tensors, first, out } = self;
        for (vertex, out) in (first..).zip(out.chunks_exact_mut(of.radii.len())) {
            of.vertex(machine, vertex, flood, tensors, out);
        }
    }
}

impl Kernel<'_> {
    /// Curvature of a vertex at all levels.
    #[inline(always)]
    fn vertex<M: Machine>(
        &self,
        machine: M,
        vertex: usize,
        flood: &mut Flood,
        tensors: &mut [Symmetric],
        out: &mut [f64],
    ) {
        let Self { topology, positions, side, radii, spheres, .. } = self;
        let ring = &self.rings[vertex];
        // Spheres that every edge leaves.
        let small = radii.iter().take_while(|&&radius| radius < ring.shortest_edge).count();
        for (out, radius) in out.iter_mut().zip(&radii[..small]) {
            *out = side * ring.curvature / (PI * radius);
        }
        if small == radii.len() {
            return;
        }
        tensors.fill([0.0; 6]);
        flood.run(machine, topology, positions, vertex as u32, spheres, |step| {
            let step = Step { level: step.level.max(small), ..*step };
            add_edges(tensors, &step, topology, (positions, vertex), spheres);
        });
        for level in small..radii.len() {
            let area = PI * radii[level] * radii[level];
            out[level] = side * mean_absolute(&tensors[level]) / area;
        }
    }
}

/// Adds the parts of some edges that are inside each sphere.
#[inline]
fn add_edges(
    tensors: &mut [Symmetric],
    step: &Step<'_>,
    topology: &Topology,
    (positions, centre): (&[Vec3], usize),
    spheres: &Spheres,
) {
    let start = positions[step.from as usize];
    for lane in lanes(step.ahead.used) {
        let to = step.block.neighbour(lane);
        let along = sub(positions[to.vertex as usize], start);
        let end_squared = length_squared(sub(positions[to.vertex as usize], positions[centre]));
        let whole = &topology.tensors[to.edge as usize];
        for level in step.level..tensors.len() {
            let radius_squared = spheres.radii_squared[level];
            let part = if end_squared > radius_squared || end_squared == 0.0 {
                clip(step.offset, along, radius_squared).unwrap_or_else(|| clip_special(along))
            } else {
                1.0
            };
            for (sum, entry) in tensors[level].iter_mut().zip(whole) {
                *sum += part * entry;
            }
        }
    }
}

/// kmax and kmin are the two eigenvalues of largest absolute value; the third belongs to the normal.
fn mean_absolute(tensor: &Symmetric) -> f64 {
    if !tensor.iter().all(|entry| entry.is_finite()) {
        return 0.0;
    }
    let [a, b, c] = eigenvalues(tensor).map(f64::abs);
    0.5 * (a + b + c - a.min(b).min(c))
}
