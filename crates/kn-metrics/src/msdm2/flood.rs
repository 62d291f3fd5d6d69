//! The neighbourhood of a vertex inside a sphere, along edges that lead away from it.

use super::topology::{Neighbour, Topology};
use crate::vec3::{Vec3, dot, length_squared, scale, sub};

/// Concentric spheres around each vertex, one a level, the smallest first.
///
/// One flood serves all levels. Every edge that it uses leads away from the centre, so that
/// whatever is reached inside the large sphere over a path that leaves the small one is itself
/// outside the small one: the vertices that a small sphere reaches are the reached ones in it.
pub(super) struct Spheres {
    pub(super) radii_squared: Vec<f64>,
    /// Brings an offset inside the largest sphere to about 1.
    to_unit: f64,
}

/// A vertex that the flood has reached.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reached {
    pub(super) vertex: u32,
    /// The first level whose sphere holds it, and with it all levels above.
    pub(super) level: u32,
    /// From the centre.
    pub(super) offset: Vec3,
    pub(super) distance_squared: f64,
}

/// An edge that the flood uses.
pub(super) struct Step<'a> {
    pub(super) from: &'a Reached,
    pub(super) to: Neighbour,
    /// The first level at which the edge does not leave the sphere; may be the number of levels.
    pub(super) to_level: u32,
    /// From `from` to `to`.
    pub(super) along: Vec3,
}

/// Buffers of a flood, reused from vertex to vertex.
pub(super) struct Flood {
    /// Per vertex the round that reached it last.
    seen: Vec<u32>,
    round: u32,
    reached: Vec<Reached>,
}

impl Flood {
    pub(super) fn new(vertex_count: usize) -> Self {
        Self { seen: vec![0; vertex_count], round: 0, reached: Vec::new() }
    }

    /// Visits each used edge once, from its nearer end, and returns the reached vertices: the
    /// centre first, each once.
    #[inline]
    pub(super) fn run(
        &mut self,
        topology: &Topology,
        positions: &[Vec3],
        centre: u32,
        spheres: &Spheres,
        mut visit: impl FnMut(&Step),
    ) -> &[Reached] {
        let origin = positions[centre as usize];
        let levels = spheres.radii_squared.len() as u32;
        self.round += 1;
        self.seen[centre as usize] = self.round;
        self.reached.clear();
        let offset = [0.0; 3];
        self.reached.push(Reached { vertex: centre, level: 0, offset, distance_squared: 0.0 });
        let mut next = 0;
        while let Some(&from) = self.reached.get(next) {
            let start = positions[from.vertex as usize];
            let direction = scale(from.offset, spheres.to_unit);
            for block in topology.blocks(from.vertex as usize) {
                let mut lanes = block.ahead(direction);
                while lanes != 0 {
                    let to = block.neighbour(lanes.trailing_zeros());
                    lanes &= lanes - 1;
                    let end = positions[to.vertex as usize];
                    let along = sub(end, start);
                    if dot(along, from.offset) <= 0.0 && next > 0 {
                        continue;
                    }
                    let offset = sub(end, origin);
                    let distance_squared = length_squared(offset);
                    let level = spheres.level_of(distance_squared);
                    visit(&Step { from: &from, to, to_level: level, along });
                    let seen = &mut self.seen[to.vertex as usize];
                    if level < levels && *seen != self.round {
                        *seen = self.round;
                        let vertex = to.vertex;
                        self.reached.push(Reached { vertex, level, offset, distance_squared });
                    }
                }
            }
            next += 1;
        }
        &self.reached
    }
}

impl Spheres {
    /// `radii` must ascend; there is at least one.
    pub(super) fn new(radii: impl Iterator<Item = f64>) -> Self {
        let radii_squared: Vec<f64> = radii.map(|radius| radius * radius).collect();
        let to_unit = radii_squared.last().map_or(1.0, |largest| largest.sqrt().recip());
        Self { radii_squared, to_unit }
    }

    /// The first level whose sphere holds a neighbour at this distance. An edge without length
    /// leaves every sphere, as in the reference.
    #[inline]
    fn level_of(&self, distance_squared: f64) -> u32 {
        if distance_squared == 0.0 {
            return self.radii_squared.len() as u32;
        }
        self.radii_squared.iter().map(|&radius| u32::from(distance_squared > radius)).sum()
    }
}

impl Step<'_> {
    /// Which part of the edge lies inside a sphere that it leaves: 0 < t ≤ 1.
    #[inline]
    pub(super) fn clip(&self, radius_squared: f64) -> f64 {
        let a = length_squared(self.along);
        let b = 2.0 * dot(self.from.offset, self.along);
        let c = self.from.distance_squared - radius_squared;
        if a == 0.0 {
            return 1.0;
        }
        // c ≤ 0, since the edge starts inside: the root is real and not negative.
        let t = (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
        // The reference's way out where an edge starts on the sphere.
        if t < 1e-16 { 0.01 } else { t.min(1.0) }
    }
}
