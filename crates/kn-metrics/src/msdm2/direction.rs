//! One direction of MSDM2: every vertex of the distorted mesh against its match.

use rayon::prelude::*;

use super::flood::{Flood, Spheres, Step};
use super::matching::opposite_areas;
use super::statistics::{Moments, Samples, Weights};
use super::{Interpolation, Msdm2Direction, Msdm2Surface, radii};
use crate::tree::Closest;
use crate::vec3::{Vec3, distance_squared, length_squared, mul_add, sub};

/// Radius of the statistics' neighbourhood over that of the curvature's sphere.
const NEIGHBOURHOOD: f64 = 5.0;

/// Vertices that a thread takes at a time.
const CHUNK: usize = 128;

/// A distorted mesh, matched with its original.
pub(super) struct Direction<'a> {
    distorted: &'a Msdm2Surface,
    levels: usize,
    /// Squared radii of the neighbourhoods.
    spheres: Spheres,
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
        Self { distorted, levels, spheres, records }
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
        self.collect(vertex, scratch);
        let centre = self.record(vertex);
        let mut sum = 0.0;
        for (level, radius_squared) in self.spheres.radii_squared.iter().enumerate() {
            let moments = scratch.moments(level, *radius_squared);
            sum += moments.distance(centre.own[level], centre.other[level]);
        }
        sum / self.levels as f64
    }

    /// The samples of all levels around a vertex.
    fn collect(&self, vertex: usize, scratch: &mut Scratch) {
        scratch.clear();
        let Msdm2Surface { topology, positions, .. } = self.distorted;
        let centre = self.record(vertex);
        let Scratch { flood, inside, crossing, .. } = scratch;
        let reached = flood.run(topology, positions, vertex as u32, &self.spheres, |step| {
            for level in step.from.level..step.to_level {
                let level = level as usize;
                self.push_crossing(step, level, &centre, &mut crossing[level]);
            }
        });
        for first_level in 0..self.levels {
            for reached in reached.iter().filter(|reached| reached.level as usize == first_level) {
                let record = self.record(reached.vertex as usize);
                inside.own_distance.push(reached.distance_squared);
                inside.other_distance.push(distance_squared(record.matched, centre.matched));
                for level in first_level..self.levels {
                    let own = record.own[level] - centre.own[level];
                    inside.samples[level].push(own, record.other[level] - centre.other[level]);
                }
            }
            inside.counts[first_level] = inside.own_distance.len();
        }
    }

    /// The sample where an edge leaves the sphere of a level.
    #[inline]
    fn push_crossing(
        &self,
        step: &Step<'_>,
        level: usize,
        centre: &Record<'_>,
        out: &mut Crossing,
    ) {
        let t = step.clip(self.spheres.radii_squared[level]);
        let from = self.record(step.from.vertex as usize);
        let to = self.record(step.to.vertex as usize);
        let between = |a: f64, b: f64, centre: f64| a + t * (b - a) - centre;
        let offset = mul_add(step.from.offset, t, step.along);
        let matched = mul_add(from.matched, t, sub(to.matched, from.matched));
        out.own_distance.push(length_squared(offset));
        out.other_distance.push(distance_squared(matched, centre.matched));
        out.samples.push(
            between(from.own[level], to.own[level], centre.own[level]),
            between(from.other[level], to.other[level], centre.other[level]),
        );
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

/// The vertices around a vertex, ordered by the first level that holds them: the samples of a level
/// are the first ones.
struct Inside {
    own_distance: Vec<f64>,
    other_distance: Vec<f64>,
    /// Per level how many vertices it holds.
    counts: Vec<usize>,
    samples: Vec<Samples>,
}

/// The points where edges leave the sphere of a level.
#[derive(Clone, Default)]
struct Crossing {
    own_distance: Vec<f64>,
    other_distance: Vec<f64>,
    samples: Samples,
}

/// Buffers of a thread.
pub(super) struct Scratch {
    flood: Flood,
    inside: Inside,
    /// Per level.
    crossing: Vec<Crossing>,
    weights: Weights,
}

impl Scratch {
    pub(super) fn new(vertex_count: usize, levels: usize) -> Self {
        let inside = Inside {
            own_distance: Vec::new(),
            other_distance: Vec::new(),
            counts: vec![0; levels],
            samples: vec![Samples::default(); levels],
        };
        let crossing = vec![Crossing::default(); levels];
        let flood = Flood::new(vertex_count);
        Self { flood, inside, crossing, weights: Weights::default() }
    }

    fn clear(&mut self) {
        self.inside.own_distance.clear();
        self.inside.other_distance.clear();
        self.inside.samples.iter_mut().for_each(Samples::clear);
        for crossing in &mut self.crossing {
            crossing.own_distance.clear();
            crossing.other_distance.clear();
            crossing.samples.clear();
        }
    }

    /// Weighted sums over the samples of a level.
    fn moments(&mut self, level: usize, radius_squared: f64) -> Moments {
        let Self { inside, crossing, weights, .. } = self;
        let mut moments = Moments::default();
        let (own, other) = (&inside.own_distance, &inside.other_distance);
        let count = inside.counts[level];
        weights.evaluate(radius_squared, &own[..count], &other[..count]);
        moments.add(&mut inside.samples[level], weights);
        let crossing = &mut crossing[level];
        weights.evaluate(radius_squared, &crossing.own_distance, &crossing.other_distance);
        moments.add(&mut crossing.samples, weights);
        moments
    }

    /// How many samples a level has.
    #[cfg(test)]
    pub(super) fn count(&self, level: usize) -> usize {
        self.inside.counts[level] + self.crossing[level].own_distance.len()
    }
}
