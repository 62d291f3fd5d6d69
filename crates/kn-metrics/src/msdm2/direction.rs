//! One direction of MSDM2: every vertex of the distorted mesh against its match.

use rayon::prelude::*;

use super::flood::{Flood, Reached, Spheres, clip};
use super::list::List;
use super::matching::opposite_areas;
use super::statistics::{Sample, Samples};
use super::{Interpolation, Msdm2Direction, Msdm2Surface, radii};
use crate::tree::Closest;
use crate::vec3::{Vec3, distance_squared, length_squared, mul_add, sub};

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
    /// Per vertex 3 + 2 · levels numbers side by side: the matched point, the vertex's own
    /// curvature at each level, and the matched one at each level.
    records: Vec<f64>,
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
        let mut records = Vec::with_capacity(matches.len() * (3 + 2 * levels));
        for (vertex, closest) in matches.iter().enumerate() {
            records.extend(closest.point);
            records.extend(&own[vertex * levels..(vertex + 1) * levels]);
            let weights = match interpolation {
                Interpolation::AtVertex => {
                    opposite_areas(original, closest, distorted.positions[vertex])
                }
                Interpolation::Projected => closest.barycentric,
            };
            let corners =
                original.faces[closest.face as usize].map(|corner| corner as usize * levels);
            records.extend(
                (0..levels).map(|level| {
                    (0..3).map(|i| weights[i] * other[corners[i] + level]).sum::<f64>()
                }),
            );
        }
        let radii = radii(distorted.side, levels).into_iter().map(|radius| NEIGHBOURHOOD * radius);
        let spheres = Spheres::new(radii);
        let exponents = spheres.radii_squared.iter().map(|square| -2.0 / square).collect();
        Self { distorted, levels, spheres, exponents, records }
    }

    pub(super) fn evaluate(&self) -> Msdm2Direction {
        let vertex_count = self.distorted.positions.len();
        let mut local = vec![0.0; vertex_count];
        local.par_chunks_mut(CHUNK).enumerate().for_each_init(
            || Scratch::new(vertex_count, self.levels),
            |scratch, (chunk, out)| {
                for (i, out) in out.iter_mut().enumerate() {
                    *out = self.local(chunk * CHUNK + i, scratch);
                }
            },
        );
        let topology = &self.distorted.topology;
        let isolated = (0..vertex_count).filter(|&vertex| topology.is_isolated(vertex)).count();
        let cubes: f64 = local.iter().map(|local| local * local * local).sum();
        let score = libm::cbrt(cubes / (vertex_count - isolated) as f64);
        Msdm2Direction { score, local, isolated }
    }

    /// The mean over the levels at one vertex.
    pub(super) fn local(&self, vertex: usize, scratch: &mut Scratch) -> f64 {
        if self.distorted.topology.is_isolated(vertex) {
            return 0.0;
        }
        self.flood(vertex, scratch);
        let centre = self.record(vertex);
        let mut sum = 0.0;
        for level in 0..self.levels {
            self.sample(vertex, level, scratch);
            let moments = scratch.samples.moments();
            sum += moments.distance(centre.own[level], centre.other[level]);
        }
        sum / self.levels as f64
    }

    /// The vertices of the largest sphere, and the edges that leave one of the spheres.
    fn flood(&self, vertex: usize, scratch: &mut Scratch) {
        let Msdm2Surface { topology, positions, .. } = self.distorted;
        let Scratch { flood, leaving, .. } = scratch;
        leaving.iter_mut().for_each(List::clear);
        flood.run(topology, positions, vertex as u32, &self.spheres, |step| {
            let edge = Leaving {
                from: step.from.vertex,
                to: step.to.vertex,
                to_level: step.to_level as u32,
            };
            leaving[step.from_level].push_if(step.from_level < step.to_level, edge);
        });
    }

    /// The samples of a level around a vertex, after the flood.
    pub(super) fn sample(&self, vertex: usize, level: usize, scratch: &mut Scratch) {
        let centre = self.record(vertex);
        let Scratch { flood, leaving, crossing, samples } = scratch;
        crossing.clear();
        for edge in leaving[..=level].iter().flat_map(List::as_slice) {
            crossing.push_if(edge.to_level as usize > level, *edge);
        }
        let count = (0..=level).map(|level| flood.reached(level).len()).sum();
        let inside = (0..=level).flat_map(|level| flood.reached(level));
        let inside = inside.map(|reached| self.at_vertex(reached, level, &centre));
        let origin = self.distorted.positions[vertex];
        let crossing = crossing.as_slice();
        let leaving = crossing.iter().map(|edge| self.on_edge(edge, level, origin, &centre));
        samples.fill((count, inside), (crossing.len(), leaving));
    }

    #[inline]
    fn at_vertex(&self, reached: &Reached, level: usize, centre: &Record<'_>) -> Sample {
        let exponent = self.exponents[level];
        let record = self.record(reached.vertex as usize);
        [
            exponent * reached.distance_squared,
            exponent * distance_squared(record.matched, centre.matched),
            record.own[level] - centre.own[level],
            record.other[level] - centre.other[level],
        ]
    }

    /// The sample where an edge leaves the sphere of a level.
    #[inline]
    fn on_edge(&self, edge: &Leaving, level: usize, origin: Vec3, centre: &Record<'_>) -> Sample {
        let positions = &self.distorted.positions;
        let start = positions[edge.from as usize];
        let (offset, along) = (sub(start, origin), sub(positions[edge.to as usize], start));
        let t = clip(offset, length_squared(offset), along, self.spheres.radii_squared[level]);
        let (from, to) = (self.record(edge.from as usize), self.record(edge.to as usize));
        let between = |a: f64, b: f64, centre: f64| a + t * (b - a) - centre;
        let matched = mul_add(from.matched, t, sub(to.matched, from.matched));
        let exponent = self.exponents[level];
        let own = exponent * length_squared(mul_add(offset, t, along));
        [
            // On the sphere, but for edges that start on it or have no length.
            if (own + 2.0).abs() < 1e-9 { ON_SPHERE } else { libm::exp(own) },
            exponent * distance_squared(matched, centre.matched),
            between(from.own[level], to.own[level], centre.own[level]),
            between(from.other[level], to.other[level], centre.other[level]),
        ]
    }

    #[inline]
    pub(super) fn record(&self, vertex: usize) -> Record<'_> {
        let width = 3 + 2 * self.levels;
        let record = &self.records[vertex * width..(vertex + 1) * width];
        let (own, other) = record[3..].split_at(self.levels);
        Record { matched: [record[0], record[1], record[2]], own, other }
    }
}

/// A vertex of the distorted mesh.
pub(super) struct Record<'a> {
    pub(super) matched: Vec3,
    pub(super) own: &'a [f64],
    pub(super) other: &'a [f64],
}

/// An edge that leaves at least one sphere. Its start is in the sphere of the level that it is
/// filed under.
#[derive(Clone, Copy, Debug)]
struct Leaving {
    from: u32,
    to: u32,
    /// The first level whose sphere it does not leave; may be the number of levels.
    to_level: u32,
}

/// Buffers of a thread.
pub(super) struct Scratch {
    flood: Flood,
    /// Per level the edges that start in its sphere, but in no smaller one.
    leaving: Vec<List<Leaving>>,
    /// The edges that leave the sphere of one level.
    crossing: List<Leaving>,
    pub(super) samples: Samples,
}

impl Scratch {
    pub(super) fn new(vertex_count: usize, levels: usize) -> Self {
        Self {
            flood: Flood::new(vertex_count, levels),
            leaving: vec![List::new(); levels],
            crossing: List::new(),
            samples: Samples::default(),
        }
    }
}
