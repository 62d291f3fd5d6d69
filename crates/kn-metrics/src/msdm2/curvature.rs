//! Mean absolute curvature of every vertex at every level.

use std::f64::consts::PI;

use rayon::prelude::*;

use super::eigenvalues::mean_absolute;
use super::flood::{
    Bounded, Flood, Graph, SMALLEST_PART, Spheres, Step, clip_special, mean_reached, parts,
};
use super::machine::{Machine, QUAD, Quad, Task, dispatch, dot};
use super::topology::{Symmetric, Topology};
use crate::lanes::lanes;
use kn_mesh::vec3::{Vec3, norm, sub};

/// Vertices that a thread takes at a time.
const CHUNK: usize = 256;

/// Where spheres hold more than this part of the mesh in the mean, because it is tiny beside the
/// other one for example, a sphere's flood ends early. Spheres of scans hold a five thousandth.
const LARGE_PART: usize = 256;

/// Vertices that all floods together reach then, but for the last wave of each.
const MOST_REACHED: usize = 1 << 22;

/// Vertices that a flood reaches at least.
const LEAST_REACHED: usize = 32;

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
    let mut rings = vec![Ring { shortest_edge: 0.0, curvature: 0.0 }; positions.len()];
    rings.par_chunks_mut(CHUNK).enumerate().for_each_init(Vec::new, |tensors, (chunk, out)| {
        dispatch(Rings { topology, positions, tensors, first: chunk * CHUNK, out });
    });
    rings
}

/// A chunk of rings.
struct Rings<'a> {
    topology: &'a Topology,
    positions: &'a [Vec3],
    tensors: &'a mut Vec<Symmetric>,
    first: usize,
    out: &'a mut [Ring],
}

impl Task for Rings<'_> {
    type Output = ();

    #[inline(always)]
    fn run<M: Machine>(self, machine: M) {
        let Self { topology, positions, tensors, first, out } = self;
        tensors.clear();
        for (vertex, ring) in (first..).zip(out.iter_mut()) {
            let (mut sum, mut shortest_edge) = ([[0.0; 4]; 2], f64::INFINITY);
            for to in topology.neighbours(vertex) {
                let length = norm(sub(positions[to.vertex as usize], positions[vertex]));
                shortest_edge = length.min(shortest_edge);
                add(&mut sum, 1.0 / length, &topology.tensors[to.edge as usize]);
            }
            ring.shortest_edge = shortest_edge;
            tensors.push(finite(sum));
        }
        for (four, out) in tensors.chunks(QUAD).zip(out.chunks_mut(QUAD)) {
            let curvatures = mean_absolute(machine, fill(four));
            out.iter_mut().zip(curvatures).for_each(|(ring, value)| ring.curvature = value);
        }
    }
}

/// Up to four tensors, filled up with the first one.
#[inline(always)]
fn fill(tensors: &[Symmetric]) -> [&Symmetric; QUAD] {
    let mut four = [&tensors[0]; QUAD];
    for (place, tensor) in four.iter_mut().zip(tensors) {
        *place = tensor;
    }
    four
}

/// A tensor that is not finite counts as flat.
#[inline(always)]
fn finite(tensor: Symmetric) -> Symmetric {
    if tensor.as_flattened().iter().all(|x| x.is_finite()) { tensor } else { [[0.0; 4]; 2] }
}

#[inline(always)]
fn add(sum: &mut Symmetric, part: f64, tensor: &Symmetric) {
    for (sum, row) in sum.iter_mut().zip(tensor) {
        for (sum, entry) in sum.iter_mut().zip(row) {
            *sum += part * entry;
        }
    }
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
    let mean = mean_reached(Graph { topology, positions }, &spheres);
    let most = most_reached(mean, positions.len());
    let kernel = Kernel { topology, rings, positions, side, radii, spheres, most };
    let mut curvature = vec![0.0; positions.len() * levels];
    curvature.par_chunks_mut(CHUNK * levels).enumerate().for_each_init(
        || Scratch::new(positions.len(), levels),
        |scratch, (chunk, out)| {
            dispatch(Chunk { of: &kernel, scratch, first: chunk * CHUNK, out });
        },
    );
    curvature
}

/// How many vertices end a flood, where one reaches `mean` of `count` vertices.
fn most_reached(mean: usize, count: usize) -> usize {
    let is_large = mean > count / LARGE_PART && mean * count > MOST_REACHED;
    if is_large { (MOST_REACHED / count).max(LEAST_REACHED) } else { usize::MAX }
}

/// Buffers of a thread.
struct Scratch {
    flood: Flood,
    /// Per level.
    sums: Vec<Symmetric>,
    /// Tensors whose eigenvalues are still to be found, and which values of the chunk they are.
    tensors: Vec<Symmetric>,
    places: Vec<usize>,
}

impl Scratch {
    fn new(vertex_count: usize, levels: usize) -> Self {
        Self {
            flood: Flood::new(vertex_count, levels),
            sums: vec![[[0.0; 4]; 2]; levels],
            tensors: Vec::new(),
            places: Vec::new(),
        }
    }
}

/// The data that the curvature of a vertex depends on.
struct Kernel<'a> {
    topology: &'a Topology,
    rings: &'a [Ring],
    positions: &'a [Vec3],
    side: f64,
    radii: &'a [f64],
    spheres: Spheres,
    /// The number of vertices that end a flood.
    most: usize,
}

/// A chunk of vertices.
struct Chunk<'a> {
    of: &'a Kernel<'a>,
    scratch: &'a mut Scratch,
    first: usize,
    out: &'a mut [f64],
}

impl Task for Chunk<'_> {
    type Output = ();

    #[inline(always)]
    fn run<M: Machine>(self, machine: M) {
        let Self { of, scratch, first, out } = self;
        let levels = of.radii.len();
        scratch.tensors.clear();
        scratch.places.clear();
        for (i, out) in out.chunks_exact_mut(levels).enumerate() {
            of.vertex(machine, (first, i), scratch, out);
        }
        let Scratch { tensors, places, .. } = scratch;
        for (four, places) in tensors.chunks(QUAD).zip(places.chunks(QUAD)) {
            let curvatures = mean_absolute(machine, fill(four));
            for (&place, curvature) in places.iter().zip(curvatures) {
                let radius = of.radii[place % levels];
                out[place] = of.side * curvature / (PI * radius * radius);
            }
        }
    }
}

impl Kernel<'_> {
    /// Curvature of a vertex at the levels that its ring decides, and the tensors of the others.
    #[inline(always)]
    fn vertex<M: Machine>(
        &self,
        machine: M,
        (first, i): (usize, usize),
        scratch: &mut Scratch,
        out: &mut [f64],
    ) {
        let Self { topology, positions, side, radii, spheres, .. } = self;
        let vertex = first + i;
        let ring = &self.rings[vertex];
        // Spheres that every edge leaves.
        let small = radii.iter().take_while(|&&radius| radius < ring.shortest_edge).count();
        for (out, radius) in out.iter_mut().zip(&radii[..small]) {
            *out = side * ring.curvature / (PI * radius);
        }
        if small == radii.len() {
            return;
        }
        let Scratch { flood, sums, tensors, places } = scratch;
        sums.fill([[0.0; 4]; 2]);
        let graph = Graph { topology, positions };
        let bounded = Bounded { spheres, most: self.most };
        flood.run(machine, graph, vertex as u32, bounded, |step| {
            let step = Step { level: step.level.max(small), ..*step };
            add_edges(machine, sums, &step, topology, positions, spheres);
        });
        for level in small..radii.len() {
            tensors.push(finite(sums[level]));
            places.push(i * radii.len() + level);
        }
    }
}

/// Adds the parts of some edges that are inside each sphere.
#[inline(always)]
fn add_edges<M: Machine>(
    machine: M,
    sums: &mut [Symmetric],
    step: &Step<'_>,
    topology: &Topology,
    positions: &[Vec3],
    spheres: &Spheres,
) {
    let used = step.ahead.used;
    let ends = machine.compress(used, &step.block.vertices);
    let edges = machine.compress(used, &step.block.edges);
    for first in (0..used.count_ones() as usize).step_by(QUAD) {
        let edges = &edges[first..used.count_ones() as usize];
        let ends = &ends[first..first + QUAD];
        let mut along = [[0.0; QUAD]; 3];
        for lane in 0..QUAD {
            let edge = sub(positions[ends[lane] as usize], positions[step.from as usize]);
            (along[0][lane], along[1][lane], along[2][lane]) = (edge[0], edge[1], edge[2]);
        }
        let cut = Cut::new(machine, step.offset, &along);
        for level in step.level..sums.len() {
            let parts = cut.parts(machine, spheres.radii_squared[level]);
            for (part, &edge) in parts.into_iter().zip(edges) {
                add(&mut sums[level], part, &topology.tensors[edge as usize]);
            }
        }
    }
}

/// Four edges from one point, to be cut at spheres: see [`parts`].
struct Cut<M: Machine> {
    along: [Quad<M>; 3],
    a: Quad<M>,
    b: Quad<M>,
    /// The squared distance of the start from the centre.
    start: Quad<M>,
}

impl<M: Machine> Cut<M> {
    #[inline(always)]
    fn new(machine: M, offset: Vec3, [x, y, z]: &[[f64; QUAD]; 3]) -> Self {
        let along = [Quad::new(machine, x), Quad::new(machine, y), Quad::new(machine, z)];
        let [x, y, z] = offset;
        let [x, y, z] = [Quad::splat(machine, x), Quad::splat(machine, y), Quad::splat(machine, z)];
        Self {
            along,
            a: dot(along, along),
            b: dot([x, y, z], along),
            start: dot([x, y, z], [x, y, z]),
        }
    }

    /// The parts of the edges that lie inside a sphere that holds their start.
    #[inline(always)]
    fn parts(&self, machine: M, radius_squared: f64) -> [f64; QUAD] {
        let square = Quad::splat(machine, radius_squared);
        let t = parts(self.a, self.b, self.start - square);
        let special = t.not_from(SMALLEST_PART);
        // An end that is inside is at t > 1.
        let mut parts = t.least(Quad::splat(machine, 1.0)).array();
        for lane in lanes(special) {
            parts[lane] = clip_special(self.along.map(|along| along.array()[lane]));
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::super::machine::Baseline;
    use super::super::{MAX_LEVELS, radii, tests::hard};
    use super::*;

    #[test]
    fn the_machine_does_not_matter() {
        let (positions, faces) = hard();
        // Spheres of up to three edges.
        let (side, radii) = (2.9, radii(8.0, MAX_LEVELS));
        let topology = &Topology::new(&positions, &faces, side);
        let found = rings(topology, &positions);
        let mut baseline = vec![Ring { shortest_edge: 0.0, curvature: 0.0 }; positions.len()];
        let (tensors, out) = (&mut Vec::new(), &mut baseline[..]);
        Rings { topology, positions: &positions, tensors, first: 0, out }.run(Baseline);
        for (a, b) in found.iter().zip(&baseline) {
            assert!(a.shortest_edge == b.shortest_edge && a.curvature == b.curvature);
        }
        let curvature = curvature(topology, &found, &positions, side, &radii);
        let spheres = Spheres::new(radii.iter().copied(), topology);
        let positions = &positions[..];
        let (rings, most) = (&found[..], usize::MAX);
        let kernel = Kernel { topology, rings, positions, side, radii: &radii, spheres, most };
        let mut scratch = Scratch::new(positions.len(), MAX_LEVELS);
        let mut baseline = vec![0.0; curvature.len()];
        Chunk { of: &kernel, scratch: &mut scratch, first: 0, out: &mut baseline }.run(Baseline);
        assert!(curvature == baseline && scratch.tensors.len() > positions.len(), "floods ran");
    }
}
