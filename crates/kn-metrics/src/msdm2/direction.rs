//! One direction of MSDM2: every vertex of the distorted mesh against its match.

use rayon::prelude::*;

use super::exp::exp_of_negative;
use super::flood::{Flood, Graph, Reached, SMALLEST_PART, Spheres, clip_special, parts};
use super::list::List;
use super::machine::{LANES, Machine, QUAD, Quad, Task, columns, dispatch, dot};
use super::matching::opposite_areas;
use super::statistics::{Moments, Samples};
use super::topology::Topology;
use super::{Interpolation, Msdm2Direction, Msdm2Surface, radii};
use crate::lanes::lanes;
use crate::tree::Closest;
use kn_mesh::vec3::{Vec3, mul_add, norm_squared, sub};

/// Radius of the statistics' neighbourhood over that of the curvature's sphere.
const NEIGHBOURHOOD: f64 = 5.0;

/// Vertices that a thread takes at a time.
const CHUNK: usize = 128;

/// The Gaussian weight at the sphere's radius, which is 2σ: e⁻².
const ON_SPHERE: f64 = 0.135_335_283_236_612_7;

/// A distorted mesh, matched with its original.
pub(super) struct Direction<'a> {
    distorted: &'a Msdm2Surface,
    levels: usize,
    /// Squared radii of the neighbourhoods.
    spheres: Spheres,
    /// Times a squared distance: the exponent of the Gaussian weight, −1 / 2σ² with σ = h / 2.
    exponents: Vec<f64>,
    /// `levels × #V`.
    records: Vec<Vec<Record>>,
}

/// The data of a vertex of the distorted mesh at one level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Record {
    /// Its position and its own curvature.
    own: [f64; 4],
    /// The closest point on the original and the curvature there.
    other: [f64; 4],
}

impl<'a> Direction<'a> {
    pub(super) fn new(
        distorted: &'a Msdm2Surface,
        original: &Msdm2Surface,
        matches: &[Closest],
        levels: usize,
        interpolation: Interpolation,
    ) -> Self {
        let own = distorted.curvature(distorted.side, levels);
        let other = original.curvature(distorted.side, levels);
        let weights: Vec<Vec3> = matches
            .par_iter()
            .zip(&distorted.positions)
            .with_min_len(CHUNK)
            .map(|(closest, &position)| match interpolation {
                Interpolation::AtVertex => opposite_areas(original, closest, position),
                Interpolation::Projected => closest.barycentric,
            })
            .collect();
        let record = |vertex: usize, level: usize| {
            let (closest, weights) = (&matches[vertex], &weights[vertex]);
            let corners = original.faces[closest.face as usize];
            let at_corner = |i: usize| weights[i] * other[corners[i] as usize * levels + level];
            let with = |[x, y, z]: Vec3, curvature| [x, y, z, curvature];
            Record {
                own: with(distorted.positions[vertex], own[vertex * levels + level]),
                other: with(closest.point, (0..3).map(at_corner).sum()),
            }
        };
        let records = (0..levels)
            .into_par_iter()
            .map(|level| (0..matches.len()).map(|vertex| record(vertex, level)).collect())
            .collect();
        let radii = radii(distorted.side, levels).into_iter().map(|radius| NEIGHBOURHOOD * radius);
        let spheres = Spheres::new(radii, &distorted.topology);
        let exponents = spheres.radii_squared.iter().map(|square| -2.0 / square).collect();
        Self { distorted, levels, spheres, exponents, records }
    }

    pub(super) fn evaluate(&self) -> Msdm2Direction {
        let vertex_count = self.distorted.positions.len();
        let mut local = vec![0.0; vertex_count];
        local.par_chunks_mut(CHUNK).enumerate().for_each_init(
            || Scratch::new(vertex_count, self.levels),
            |scratch, (chunk, out)| {
                dispatch(Locals { direction: self, scratch, first: chunk * CHUNK, out });
            },
        );
        let topology = &self.distorted.topology;
        let isolated = (0..vertex_count).filter(|&vertex| topology.is_isolated(vertex)).count();
        let cubes: f64 = local.iter().map(|local| local * local * local).sum();
        let score = libm::cbrt(cubes / (vertex_count - isolated) as f64);
        Msdm2Direction { score, local, isolated }
    }

    /// The mean over the levels at one vertex.
    #[inline(always)]
    pub(super) fn local<M: Machine>(
        &self,
        machine: M,
        vertex: usize,
        scratch: &mut Scratch,
    ) -> f64 {
        if self.distorted.topology.is_isolated(vertex) {
            return 0.0;
        }
        self.flood(machine, vertex, scratch);
        let mut sum = 0.0;
        for level in 0..self.levels {
            let records = &self.records[level][..];
            let sphere = Sphere {
                centre: records[vertex],
                exponent: self.exponents[level],
                radius_squared: self.spheres.radii_squared[level],
            };
            let mut moments = Moments::new(machine);
            sphere.add_inside(machine, records, scratch.inside(level), &mut moments);
            let edges = scratch.leaving[level].as_slice();
            sphere.add_leaving(machine, records, &self.distorted.topology, edges, &mut moments);
            let [own, other] = sphere.centre.curvatures();
            sum += moments.distance(own, other);
        }
        sum / self.levels as f64
    }

    /// The vertices of the largest sphere, and the edges that leave each of the spheres.
    #[inline(always)]
    fn flood<M: Machine>(&self, machine: M, vertex: usize, scratch: &mut Scratch) {
        let Msdm2Surface { topology, positions, .. } = self.distorted;
        let Scratch { flood, leaving, inside, ends } = scratch;
        leaving.iter_mut().for_each(List::clear);
        let graph = Graph { topology, positions };
        flood.run(machine, graph, vertex as u32, &self.spheres, |step| {
            for (leaving, &bits) in leaving.iter_mut().zip(&step.ahead.leaving) {
                leaving.push_some(bits, machine.lanes_from(bits, (step.index * LANES) as u32));
            }
        });
        inside.clear();
        for (level, end) in ends.iter_mut().enumerate() {
            inside.extend_from_slice(flood.reached(level));
            *end = inside.len();
        }
    }

    #[cfg(test)]
    pub(super) fn record(&self, vertex: usize, level: usize) -> &Record {
        &self.records[level][vertex]
    }
}

impl Record {
    /// The vertex's own curvature and the matched one.
    #[inline(always)]
    pub(super) fn curvatures(&self) -> [f64; 2] {
        [self.own[3], self.other[3]]
    }
}

/// The sphere of a level around a vertex.
struct Sphere {
    centre: Record,
    /// Times a squared distance: the exponent of the Gaussian weight.
    exponent: f64,
    radius_squared: f64,
}

// Loops and not closures: see `machine`.
impl Sphere {
    /// Adds the samples at the vertices inside.
    #[inline(always)]
    fn add_inside<M: Machine>(
        &self,
        machine: M,
        records: &[Record],
        inside: &[Reached],
        moments: &mut Moments<M>,
    ) {
        for four in inside.chunks(QUAD) {
            // The last ones are filled up with their first vertex.
            let (mut distances, mut at) = ([0.0; QUAD], [&self.centre; QUAD]);
            for lane in 0..QUAD {
                let reached = four.get(lane).unwrap_or(&four[0]);
                distances[lane] = reached.distance_squared;
                at[lane] = &records[reached.vertex as usize];
            }
            let own = self.relative(machine, own(machine, at), &self.centre.own);
            let other = self.relative(machine, other(machine, at), &self.centre.other);
            let [x, y, z, b] = other;
            let w1 = exp_of_negative(machine, Quad::new(machine, &distances) * self.exponent);
            let w2 = exp_of_negative(machine, dot([x, y, z], [x, y, z]) * self.exponent);
            let mut samples = Samples { weights: [w1, w2], a: own[3], b };
            if four.len() < QUAD {
                samples.keep(machine, four.len());
            }
            moments.add(&samples);
        }
    }

    /// Adds the samples where edges leave the sphere.
    #[inline(always)]
    fn add_leaving<M: Machine>(
        &self,
        machine: M,
        records: &[Record],
        topology: &Topology,
        edges: &[u32],
        moments: &mut Moments<M>,
    ) {
        for four in edges.chunks(QUAD) {
            let (mut from, mut to) = ([&self.centre; QUAD], [&self.centre; QUAD]);
            for lane in 0..QUAD {
                let ends = topology.ends(*four.get(lane).unwrap_or(&four[0]));
                (from[lane], to[lane]) = (&records[ends[0]], &records[ends[1]]);
            }
            let mut samples = self.on_edges(machine, from, to);
            if four.len() < QUAD {
                samples.keep(machine, four.len());
            }
            moments.add(&samples);
        }
    }

    /// The samples where four edges leave the sphere.
    #[inline(always)]
    fn on_edges<M: Machine>(
        &self,
        machine: M,
        from: [&Record; QUAD],
        to: [&Record; QUAD],
    ) -> Samples<M> {
        let (start, end) = (own(machine, from), own(machine, to));
        let [x, y, z, a] = self.relative(machine, start, &self.centre.own);
        let (offset, along) =
            ([x, y, z], [end[0] - start[0], end[1] - start[1], end[2] - start[2]]);
        let c = dot(offset, offset) - Quad::splat(machine, self.radius_squared);
        let mut t = parts(dot(along, along), dot(offset, along), c);
        let mut w1 = Quad::splat(machine, ON_SPHERE);
        let special = t.not_from(SMALLEST_PART);
        t = t.least(Quad::splat(machine, 1.0));
        if special != 0 {
            let (mut parts, mut weights) = (t.array(), w1.array());
            for lane in lanes(special) {
                (parts[lane], weights[lane]) = self.special(from[lane], to[lane]);
            }
            (t, w1) = (Quad::new(machine, &parts), Quad::new(machine, &weights));
        }
        let a = a + t * (end[3] - start[3]);
        let (start, end) = (other(machine, from), other(machine, to));
        let [x, y, z, b] = self.relative(machine, start, &self.centre.other);
        let x = x + t * (end[0] - start[0]);
        let y = y + t * (end[1] - start[1]);
        let z = z + t * (end[2] - start[2]);
        let b = b + t * (end[3] - start[3]);
        let w2 = exp_of_negative(machine, dot([x, y, z], [x, y, z]) * self.exponent);
        Samples { weights: [w1, w2], a, b }
    }

    #[inline(always)]
    fn relative<M: Machine>(
        &self,
        machine: M,
        [x, y, z, curvature]: [Quad<M>; 4],
        centre: &[f64; 4],
    ) -> [Quad<M>; 4] {
        [
            x - Quad::splat(machine, centre[0]),
            y - Quad::splat(machine, centre[1]),
            z - Quad::splat(machine, centre[2]),
            curvature - Quad::splat(machine, centre[3]),
        ]
    }

    /// The part and the weight for an edge whose part inside has no end on the sphere.
    #[cold]
    fn special(&self, from: &Record, to: &Record) -> (f64, f64) {
        let position = |record: &Record| [record.own[0], record.own[1], record.own[2]];
        let along = sub(position(to), position(from));
        let t = clip_special(along);
        let offset = sub(position(from), position(&self.centre));
        (t, libm::exp(self.exponent * norm_squared(mul_add(offset, t, along))))
    }
}

/// The own positions and curvatures of four records.
#[inline(always)]
fn own<M: Machine>(machine: M, [a, b, c, d]: [&Record; QUAD]) -> [Quad<M>; 4] {
    columns(machine, [&a.own, &b.own, &c.own, &d.own])
}

/// The matched positions and curvatures of four records.
#[inline(always)]
fn other<M: Machine>(machine: M, [a, b, c, d]: [&Record; QUAD]) -> [Quad<M>; 4] {
    columns(machine, [&a.other, &b.other, &c.other, &d.other])
}

/// A chunk of vertices.
struct Locals<'a> {
    direction: &'a Direction<'a>,
    scratch: &'a mut Scratch,
    first: usize,
    out: &'a mut [f64],
}

impl Task for Locals<'_> {
    type Output = ();

    #[inline(always)]
    fn run<M: Machine>(self, machine: M) {
        for (vertex, out) in (self.first..).zip(self.out) {
            *out = self.direction.local(machine, vertex, self.scratch);
        }
    }
}

/// Buffers of a thread.
pub(super) struct Scratch {
    flood: Flood,
    /// Per level the edges that leave its sphere: eight times the index of a block, plus a lane.
    leaving: Vec<List<u32>>,
    /// The vertices of all spheres, the smallest sphere first, and where each level ends.
    inside: Vec<Reached>,
    ends: Vec<usize>,
}

impl Scratch {
    pub(super) fn new(vertex_count: usize, levels: usize) -> Self {
        Self {
            flood: Flood::new(vertex_count, levels),
            leaving: vec![List::new(); levels],
            inside: Vec::new(),
            ends: vec![0; levels],
        }
    }

    /// The vertices in the sphere of a level.
    #[inline(always)]
    fn inside(&self, level: usize) -> &[Reached] {
        &self.inside[..self.ends[level]]
    }

    /// The number of samples of a level.
    #[cfg(test)]
    pub(super) fn count(&self, level: usize) -> usize {
        self.inside(level).len() + self.leaving[level].as_slice().len()
    }
}
