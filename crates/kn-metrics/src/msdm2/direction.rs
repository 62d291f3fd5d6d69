//! One direction of MSDM2: every vertex of the distorted mesh against its match.

use rayon::prelude::*;

use super::flood::{Flood, Spheres, clip, clip_special};
use super::list::List;
use super::matching::opposite_areas;
use super::statistics::{Sample, Samples};
use super::{Interpolation, Msdm2Direction, Msdm2Surface, radii};
use crate::lanes::each_lane;
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
    /// `levels × #V`.
    records: Vec<Vec<Record>>,
}

/// What a level knows of a vertex of the distorted mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Record {
    position: Vec3,
    /// The vertex's own curvature.
    pub(super) own: f64,
    /// The closest point on the original.
    matched: Vec3,
    /// Curvature there.
    pub(super) other: f64,
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
            Record {
                position,
                own: own[vertex * levels + level],
                matched: closest.point,
                other: (0..3).map(at_corner).sum(),
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
        let mut sum = 0.0;
        for (level, records) in self.records.iter().enumerate() {
            self.sample(vertex, level, scratch);
            let centre = &records[vertex];
            sum += scratch.samples.moments().distance(centre.own, centre.other);
        }
        sum / self.levels as f64
    }

    /// The vertices of the largest sphere, and the edges that leave each of the spheres.
    fn flood(&self, vertex: usize, scratch: &mut Scratch) {
        let Msdm2Surface { topology, positions, .. } = self.distorted;
        let Scratch { flood, candidates, leaving, .. } = scratch;
        candidates.iter_mut().for_each(List::clear);
        leaving.iter_mut().for_each(List::clear);
        flood.run(topology, positions, vertex as u32, &self.spheres, |step| {
            let candidates = &mut candidates[step.level];
            each_lane::<2>(step.leaving, |is_one, lane| {
                candidates.push_if(is_one, [step.from, step.block.neighbour(lane).vertex]);
            });
        });
        let origin = positions[vertex];
        for (first_level, candidates) in candidates.iter().enumerate() {
            for edge in candidates.as_slice() {
                let end_squared = length_squared(sub(positions[edge[1] as usize], origin));
                // An edge without length leaves every sphere, as in the reference.
                let end_squared = if end_squared == 0.0 { f64::INFINITY } else { end_squared };
                for level in first_level..self.levels {
                    let leaves = end_squared > self.spheres.radii_squared[level];
                    leaving[level].push_if(leaves, *edge);
                }
            }
        }
    }

    /// The samples of a level around a vertex, after the flood.
    pub(super) fn sample(&self, vertex: usize, level: usize, scratch: &mut Scratch) {
        let Scratch { flood, leaving, samples, .. } = scratch;
        let records = &self.records[level][..];
        let (centre, exponent) = (records[vertex], self.exponents[level]);
        samples.clear();
        let mut first = 0;
        for reached in (0..=level).map(|level| flood.reached(level)) {
            samples.extend_inside(first, reached, |reached| {
                records[reached.vertex as usize].sample(&centre, exponent, reached.distance_squared)
            });
            first += reached.len();
        }
        let radius_squared = self.spheres.radii_squared[level];
        samples.extend_leaving(leaving[level].as_slice(), |&[from, to]| {
            let (from, to) = (&records[from as usize], &records[to as usize]);
            from.sample_on_edge(to, &centre, exponent, radius_squared)
        });
    }

    #[cfg(test)]
    pub(super) fn record(&self, vertex: usize, level: usize) -> &Record {
        &self.records[level][vertex]
    }
}

impl Record {
    #[inline]
    fn sample(&self, centre: &Self, exponent: f64, own_distance: f64) -> Sample {
        [
            exponent * own_distance,
            exponent * distance_squared(self.matched, centre.matched),
            self.own - centre.own,
            self.other - centre.other,
        ]
    }

    /// The sample where the edge to another vertex leaves the sphere.
    #[inline]
    fn sample_on_edge(
        &self,
        to: &Self,
        centre: &Self,
        exponent: f64,
        radius_squared: f64,
    ) -> Sample {
        let offset = sub(self.position, centre.position);
        let along = sub(to.position, self.position);
        let (t, own_weight) = match clip(offset, along, radius_squared) {
            Some(t) => (t, ON_SPHERE),
            None => {
                let t = clip_special(along);
                (t, libm::exp(exponent * length_squared(mul_add(offset, t, along))))
            }
        };
        let matched = mul_add(self.matched, t, sub(to.matched, self.matched));
        [
            own_weight,
            exponent * distance_squared(matched, centre.matched),
            self.own + t * (to.own - self.own) - centre.own,
            self.other + t * (to.other - self.other) - centre.other,
        ]
    }
}

/// Buffers of a thread.
pub(super) struct Scratch {
    flood: Flood,
    /// Per level the edges that start in its sphere, but in no smaller one, and may leave it.
    candidates: Vec<List<[u32; 2]>>,
    /// Per level the edges that leave its sphere: from a vertex inside to another.
    leaving: Vec<List<[u32; 2]>>,
    samples: Samples,
}

impl Scratch {
    pub(super) fn new(vertex_count: usize, levels: usize) -> Self {
        Self {
            flood: Flood::new(vertex_count, levels),
            candidates: vec![List::new(); levels],
            leaving: vec![List::new(); levels],
            samples: Samples::default(),
        }
    }

    /// How many samples a level has.
    #[cfg(test)]
    pub(super) fn count(&self, level: usize) -> usize {
        let inside: usize = (0..=level).map(|level| self.flood.reached(level).len()).sum();
        inside + self.leaving[level].as_slice().len()
    }
}
