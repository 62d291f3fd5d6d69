//! One direction of MSDM2: every vertex of the distorted mesh against its match.

use rayon::prelude::*;

use super::flood::{Bounded, Flood, Graph, Reached, Spheres, mean_reached};
use super::list::List;
use super::machine::{LANES, Machine, Task, dispatch};
use super::matching::opposite_areas;
use super::sphere::{Record, Sphere};
use super::statistics::Moments;
use super::{Interpolation, Msdm2Direction, Msdm2Surface, radii};
use crate::tree::Closest;
use kn_mesh::vec3::Vec3;

/// Radius of the statistics' neighbourhood over that of the curvature's sphere.
const NEIGHBOURHOOD: f64 = 5.0;

/// Vertices that a thread takes at a time.
const CHUNK: usize = 128;

/// Where neighbourhoods hold more than this part of the mesh in the mean, for example because of a
/// stray triangle far away, the score is the mean over some of the vertices: nearly equal
/// neighbourhoods have nearly equal values. Neighbourhoods of scans hold a two hundredth.
const LARGE_PART: usize = 64;

/// Vertices that all measured neighbourhoods together hold then.
const MOST_REACHED: usize = 1 << 23;

/// A distorted mesh, matched with its original.
pub(super) struct Direction<'a> {
    distorted: &'a Msdm2Surface,
    levels: usize,
    /// Squared radii of the neighbourhoods.
    spheres: Spheres,
    /// Times a squared distance: the exponent of the Gaussian weight, −1 / 2σ² with σ = h / 2.
    exponents: Vec<f64>,
    /// `interpolations × levels × #V`.
    records: Vec<Vec<Vec<Record>>>,
}

impl<'a> Direction<'a> {
    pub(super) fn new(
        distorted: &'a Msdm2Surface,
        original: &Msdm2Surface,
        matches: &[Closest],
        levels: usize,
        interpolations: &[Interpolation],
    ) -> Self {
        let own = distorted.curvature(distorted.side, levels);
        let other = original.curvature(distorted.side, levels);
        let record = |weights: &[Vec3], vertex: usize, level: usize| {
            let (closest, weights) = (&matches[vertex], &weights[vertex]);
            let corners = original.faces[closest.face as usize];
            let at_corner = |i: usize| weights[i] * other[corners[i] as usize * levels + level];
            let with = |[x, y, z]: Vec3, curvature| [x, y, z, curvature];
            Record {
                own: with(distorted.positions[vertex], own[vertex * levels + level]),
                other: with(closest.point, (0..3).map(at_corner).sum()),
            }
        };
        let records_at = |weights: &[Vec3], level| {
            (0..matches.len()).map(|vertex| record(weights, vertex, level)).collect()
        };
        let records_of = |&interpolation: &Interpolation| {
            let weights = weights(distorted, original, matches, interpolation);
            (0..levels).into_par_iter().map(|level| records_at(&weights, level)).collect()
        };
        let records = interpolations.iter().map(records_of).collect();
        let radii = radii(distorted.side, levels).into_iter().map(|radius| NEIGHBOURHOOD * radius);
        let spheres = Spheres::new(radii, &distorted.topology);
        let exponents = spheres.radii_squared.iter().map(|square| -2.0 / square).collect();
        Self { distorted, levels, spheres, exponents, records }
    }

    /// The result of each interpolation.
    pub(super) fn evaluate(&self) -> Vec<Msdm2Direction> {
        let topology = &self.distorted.topology;
        let vertex_count = self.distorted.positions.len();
        let connected: Vec<u32> = (0..vertex_count as u32)
            .filter(|&vertex| !topology.is_isolated(vertex as usize))
            .collect();
        let Msdm2Surface { topology, positions, .. } = self.distorted;
        let mean = mean_reached(Graph { topology, positions }, &self.spheres);
        self.evaluate_each(stride(mean, connected.len()), &connected)
    }

    /// The result of each interpolation over one of `stride` of the vertices with an edge.
    pub(super) fn evaluate_each(&self, stride: usize, connected: &[u32]) -> Vec<Msdm2Direction> {
        let vertex_count = self.distorted.positions.len();
        let centres: Vec<u32> = connected.iter().copied().step_by(stride).collect();
        let values = self.values(&centres);
        let isolated = vertex_count - connected.len();
        let result = |values: Vec<f64>| {
            let cubes: f64 = values.iter().map(|local| local * local * local).sum();
            let score = libm::cbrt(cubes / values.len() as f64);
            let mut local = vec![0.0; vertex_count];
            for (place, &vertex) in connected.iter().enumerate() {
                local[vertex as usize] = values[place / stride];
            }
            Msdm2Direction { score, local, isolated, measured: centres.len() }
        };
        values.into_iter().map(result).collect()
    }

    /// `interpolations × centres` means over the levels.
    fn values(&self, centres: &[u32]) -> Vec<Vec<f64>> {
        let sets = self.records.len();
        let mut values = vec![0.0; centres.len() * sets];
        let chunks = values.par_chunks_mut(CHUNK * sets).zip(centres.par_chunks(CHUNK));
        chunks.for_each_init(
            || Scratch::new(self.distorted.positions.len(), self.levels),
            |scratch, (out, centres)| {
                dispatch(Locals { direction: self, scratch, centres, out });
            },
        );
        (0..sets).map(|set| values.iter().skip(set).step_by(sets).copied().collect()).collect()
    }

    /// The mean over the levels at one vertex, for each interpolation.
    #[inline(always)]
    pub(super) fn local<M: Machine>(
        &self,
        machine: M,
        vertex: usize,
        scratch: &mut Scratch,
        out: &mut [f64],
    ) {
        self.flood(machine, vertex, scratch);
        for (records, out) in self.records.iter().zip(out) {
            let mut sum = 0.0;
            for level in 0..self.levels {
                let records = &records[level][..];
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
            *out = sum / self.levels as f64;
        }
    }

    /// The vertices of the largest sphere, and the edges that leave each of the spheres.
    #[inline(always)]
    fn flood<M: Machine>(&self, machine: M, vertex: usize, scratch: &mut Scratch) {
        let Msdm2Surface { topology, positions, .. } = self.distorted;
        let Scratch { flood, leaving, inside, ends } = scratch;
        leaving.iter_mut().for_each(List::clear);
        let graph = Graph { topology, positions };
        let all = Bounded { spheres: &self.spheres, most: usize::MAX };
        flood.run(machine, graph, vertex as u32, all, |step| {
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
        &self.records[0][level][vertex]
    }
}

/// One of how many vertices is measured, where a neighbourhood holds `mean` of `count` vertices.
pub(super) fn stride(mean: usize, count: usize) -> usize {
    let is_large = mean > count / LARGE_PART;
    if is_large { (mean * count).div_ceil(MOST_REACHED).max(1) } else { 1 }
}

/// `#V` weights of the matched faces' corners.
fn weights(
    distorted: &Msdm2Surface,
    original: &Msdm2Surface,
    matches: &[Closest],
    interpolation: Interpolation,
) -> Vec<Vec3> {
    let weights = |(closest, &position): (&Closest, &Vec3)| match interpolation {
        Interpolation::AtVertex => opposite_areas(original, closest, position),
        Interpolation::Projected => closest.barycentric,
    };
    matches.par_iter().zip(&distorted.positions).with_min_len(CHUNK).map(weights).collect()
}

/// A chunk of vertices.
struct Locals<'a> {
    direction: &'a Direction<'a>,
    scratch: &'a mut Scratch,
    centres: &'a [u32],
    /// `centres × interpolations`.
    out: &'a mut [f64],
}

impl Task for Locals<'_> {
    type Output = ();

    #[inline(always)]
    fn run<M: Machine>(self, machine: M) {
        let rows = self.out.chunks_exact_mut(self.direction.records.len());
        for (&vertex, out) in self.centres.iter().zip(rows) {
            self.direction.local(machine, vertex as usize, self.scratch, out);
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
