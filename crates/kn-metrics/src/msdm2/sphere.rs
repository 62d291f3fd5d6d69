//! The samples of a neighbourhood at one level, four at a time.

use super::exp::exp_of_negative;
use super::flood::{Reached, SMALLEST_PART, clip_special, parts};
use super::machine::{Machine, QUAD, Quad, columns, dot};
use super::statistics::{Moments, Samples};
use super::topology::Topology;
use crate::lanes::lanes;
use kn_mesh::vec3::{mul_add, norm_squared, sub};

/// The Gaussian weight at the sphere's radius, which is 2σ: e⁻².
const ON_SPHERE: f64 = 0.135_335_283_236_612_7;

/// The data of a vertex of the distorted mesh at one level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Record {
    /// Its position and its own curvature.
    pub(super) own: [f64; 4],
    /// The closest point on the original and the curvature there.
    pub(super) other: [f64; 4],
}

impl Record {
    /// The vertex's own curvature and the matched one.
    #[inline(always)]
    pub(super) fn curvatures(&self) -> [f64; 2] {
        [self.own[3], self.other[3]]
    }
}

/// The sphere of a level around a vertex.
pub(super) struct Sphere {
    pub(super) centre: Record,
    /// Times a squared distance: the exponent of the Gaussian weight.
    pub(super) exponent: f64,
    pub(super) radius_squared: f64,
}

// Loops and not closures: see `machine`.
impl Sphere {
    /// Adds the samples at the vertices inside.
    #[inline(always)]
    pub(super) fn add_inside<M: Machine>(
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
    pub(super) fn add_leaving<M: Machine>(
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
