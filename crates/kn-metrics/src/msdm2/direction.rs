//! One direction of MSDM2: every vertex of the distorted mesh against its match.

use rayon::prelude::*;

use super::flood::{Flood, SMALLEST_PART, Spheres, clip_special};
use super::list::List;
use super::machine::{LANES, Machine, QUAD, Task, dispatch};
use super::matching::opposite_areas;
use super::statistics::{NO_EDGE, Sample, SampleBlock, Samples, set};
use super::{Interpolation, Msdm2Direction, Msdm2Surface, radii};
use crate::lanes::lanes;
use crate::tree::Closest;
use crate::vec3::{Vec3, length_squared, sub};

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

/// What a level knows of a vertex of the distorted mesh.
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
        let record = |vertex: usize, level: usize| {
            let (closest, position) = (&matches[vertex], distorted.positions[vertex]);
            let weights = match interpolation {
                Interpolation::AtVertex => opposite_areas(original, closest, position),
                Interpolation::Projected => closest.barycentric,
            };
            let corners = original.faces[closest.face as usize];
            let at_corner = |i: usize| weights[i] * other[corners[i] as usize * levels + level];
            let with = |[x, y, z]: Vec3, curvature| [x, y, z, curvature];
            Record {
                own: with(position, own[vertex * levels + level]),
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
    pub(super) fn local<M: Machine>(&self, machine: M, vertex: usize, scratch: &mut Scratch) -> f64 {
        if self.distorted.topology.is_isolated(vertex) {
            return 0.0;
        }
        self.flood(machine, vertex, scratch);
        self.sample_inside(vertex, scratch);
        let mut sum = 0.0;
        for level in 0..self.levels {
            self.sample_leaving(machine, vertex, level, scratch);
            let [own, other] = self.records[level][vertex].curvatures();
            sum += scratch.samples[level].moments().distance(own, other);
        }
        sum / self.levels as f64
    }

    /// The vertices of the largest sphere, and the edges that leave each of the spheres.
    #[inline(always)]
    fn flood<M: Machine>(&self, machine: M, vertex: usize, scratch: &mut Scratch) {
        let Msdm2Surface { topology, positions, .. } = self.distorted;
        let Scratch { flood, leaving, .. } = scratch;
        leaving.iter_mut().for_each(List::clear);
        flood.run(machine, topology, positions, vertex as u32, &self.spheres, |step| {
            for (leaving, &bits) in leaving.iter_mut().zip(&step.ahead.leaving) {
                leaving.push_some(bits, machine.lanes_from(bits, (step.index * LANES) as u32));
            }
        });
    }

    /// The samples at the vertices of all spheres, after the flood.
    #[inline(always)]
    fn sample_inside(&self, vertex: usize, scratch: &mut Scratch) {
        let Scratch { flood, samples, .. } = scratch;
        let mut count = 0;
        for (level, samples) in samples.iter_mut().enumerate() {
            count += flood.reached(level).len();
            samples.start(count);
        }
        let mut index = 0;
        for first_level in 0..self.levels {
            for reached in flood.reached(first_level) {
                for level in first_level..self.levels {
                    let records = &self.records[level];
                    let (record, centre) = (&records[reached.vertex as usize], &records[vertex]);
                    let sample =
                        record.sample(centre, self.exponents[level], reached.distance_squared);
                    samples[level].set_inside(index, sample);
                }
                index += 1;
            }
        }
    }

    /// The samples where edges leave the sphere of a level, after the flood.
    #[inline(always)]
    fn sample_leaving<M: Machine>(
        &self,
        machine: M,
        vertex: usize,
        level: usize,
        scratch: &mut Scratch,
    ) {
        let Scratch { leaving, samples, .. } = scratch;
        let records = &self.records[level][..];
        let edges = leaving[level].as_slice();
        let kernel = OnSphere {
            centre: &records[vertex],
            exponent: self.exponents[level],
            radius_squared: self.spheres.radii_squared[level],
        };
        let blocks = samples[level].leaving(edges.len());
        for (block, edges) in blocks.iter_mut().zip(edges.chunks(QUAD)) {
            // The last block is filled up with its first edge.
            let (mut from, mut to) = ([&records[vertex]; QUAD], [&records[vertex]; QUAD]);
            for lane in 0..QUAD {
                let slot = *edges.get(lane).unwrap_or(&edges[0]);
                let ends = self.distorted.topology.ends(slot);
                (from[lane], to[lane]) = (&records[ends[0]], &records[ends[1]]);
            }
            kernel.samples(machine, from, to, block);
            if edges.len() < QUAD {
                (edges.len()..QUAD).for_each(|lane| set(block, lane, NO_EDGE));
            }
        }
    }

    #[cfg(test)]
    pub(super) fn record(&self, vertex: usize, level: usize) -> &Record {
        &self.records[level][vertex]
    }
}

impl Record {
    #[inline(always)]
    fn own(&self) -> &[f64; 4] {
        &self.own
    }

    #[inline(always)]
    fn other(&self) -> &[f64; 4] {
        &self.other
    }

    /// The vertex's own curvature and the matched one.
    #[inline(always)]
    pub(super) fn curvatures(&self) -> [f64; 2] {
        [self.own[3], self.other[3]]
    }

    #[inline(always)]
    fn sample(&self, centre: &Self, exponent: f64, own_distance: f64) -> Sample {
        let from_centre: [f64; 4] = std::array::from_fn(|i| self.other[i] - centre.other[i]);
        let [x, y, z, other] = from_centre;
        [
            exponent * own_distance,
            exponent * length_squared([x, y, z]),
            self.own[3] - centre.own[3],
            other,
        ]
    }
}

/// Each number of four records in a quad of its own.
#[inline(always)]
fn columns<M: Machine>(
    machine: M,
    [a, b, c, d]: [&Record; QUAD],
    of: impl Fn(&Record) -> &[f64; 4],
) -> [M::Quad; 4] {
    machine.columns([of(a), of(b), of(c), of(d)])
}

/// The sphere of a level around a vertex, where edges are cut.
struct OnSphere<'a> {
    centre: &'a Record,
    exponent: f64,
    radius_squared: f64,
}

impl OnSphere<'_> {
    /// The samples where four edges leave the sphere.
    #[inline(always)]
    fn samples<M: Machine>(
        &self,
        m: M,
        from: [&Record; QUAD],
        to: [&Record; QUAD],
        out: &mut SampleBlock,
    ) {
        // Loops and not closures: in a closure of its own nothing is compiled for this machine.
        let (start, end) = (columns(m, from, Record::own), columns(m, to, Record::own));
        let (mut offset, mut along) = (start, end);
        for i in 0..4 {
            offset[i] = m.minus(start[i], m.quad(self.centre.own[i]));
            along[i] = m.minus(end[i], start[i]);
        }
        let [x, y, z, own] = offset;
        let [dx, dy, dz, d_own] = along;
        let t = self.parts(m, [x, y, z], [dx, dy, dz]);
        let special = m.not_from(t, SMALLEST_PART);
        let t = m.least(t, m.quad(1.0));
        let own = m.plus(own, m.times(t, d_own));

        let (start, end) = (columns(m, from, Record::other), columns(m, to, Record::other));
        let mut matched = start;
        for i in 0..4 {
            let offset = m.minus(start[i], m.quad(self.centre.other[i]));
            matched[i] = m.plus(offset, m.times(t, m.minus(end[i], start[i])));
        }
        let [x, y, z, other] = matched;
        let exponent = m.times(m.quad(self.exponent), m.product([x, y, z], [x, y, z]));
        *out = [[ON_SPHERE; QUAD], m.array(exponent), m.array(own), m.array(other)];
        for lane in lanes(special) {
            set(out, lane, self.special(from[lane], to[lane]));
        }
    }

    /// Which part of each edge lies inside.
    #[inline(always)]
    fn parts<M: Machine>(&self, m: M, offset: [M::Quad; 3], along: [M::Quad; 3]) -> M::Quad {
        let a = m.product(along, along);
        let b = m.product(offset, along);
        let c = m.minus(m.product(offset, offset), m.quad(self.radius_squared));
        let root = m.root(m.minus(m.times(b, b), m.times(a, c)));
        m.over(m.minus(root, b), a)
    }

    /// The sample of an edge whose part inside has no end on the sphere.
    #[cold]
    fn special(&self, from: &Record, to: &Record) -> Sample {
        let [start, end] = [from, to].map(|record| [record.own[0], record.own[1], record.own[2]]);
        let t = clip_special(sub(end, start));
        let at_end = |from: &[f64; 4], to: &[f64; 4], centre: &[f64; 4]| -> [f64; 4] {
            std::array::from_fn(|i| from[i] - centre[i] + t * (to[i] - from[i]))
        };
        let [x, y, z, own] = at_end(&from.own, &to.own, &self.centre.own);
        let own_weight = libm::exp(self.exponent * length_squared([x, y, z]));
        let [x, y, z, other] = at_end(&from.other, &to.other, &self.centre.other);
        [own_weight, self.exponent * length_squared([x, y, z]), own, other]
    }
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
    samples: Vec<Samples>,
}

impl Scratch {
    pub(super) fn new(vertex_count: usize, levels: usize) -> Self {
        Self {
            flood: Flood::new(vertex_count, levels),
            leaving: vec![List::new(); levels],
            samples: vec![Samples::default(); levels],
        }
    }

    /// How many samples a level has.
    #[cfg(test)]
    pub(super) fn count(&self, level: usize) -> usize {
        let inside: usize = (0..=level).map(|level| self.flood.reached(level).len()).sum();
        inside + self.leaving[level].as_slice().len()
    }
}
