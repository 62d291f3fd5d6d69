//! The neighbourhood of a vertex inside a sphere, along edges that lead away from it.

use super::list::List;
use super::topology::{Block, Neighbour, Topology};
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
    /// From the centre.
    pub(super) offset: Vec3,
    pub(super) distance_squared: f64,
}

/// An edge that the flood uses.
pub(super) struct Step<'a> {
    pub(super) from: &'a Reached,
    pub(super) to: Neighbour,
    /// The first level whose sphere holds the edge's start, and with it all levels above.
    pub(super) from_level: usize,
    /// The first level whose sphere holds its end; may be the number of levels.
    pub(super) to_level: usize,
    /// From `from` to `to`.
    pub(super) along: Vec3,
}

/// Buffers of a flood, reused from vertex to vertex.
pub(super) struct Flood {
    /// Per vertex the round that touched it last.
    seen: Vec<u32>,
    round: u32,
    /// Per level the vertices of its sphere that no smaller sphere holds; then those outside.
    reached: Vec<List<Reached>>,
}

impl Flood {
    pub(super) fn new(vertex_count: usize, levels: usize) -> Self {
        Self { seen: vec![0; vertex_count], round: 0, reached: vec![List::new(); levels + 1] }
    }

    /// Visits each used edge once, from its nearer end.
    #[inline]
    pub(super) fn run(
        &mut self,
        topology: &Topology,
        positions: &[Vec3],
        centre: u32,
        spheres: &Spheres,
        mut visit: impl FnMut(&Step),
    ) {
        self.round += 1;
        self.seen[centre as usize] = self.round;
        self.reached.iter_mut().for_each(List::clear);
        let start = Reached { vertex: centre, offset: [0.0; 3], distance_squared: 0.0 };
        self.reached[0].push_if(true, start);
        let origin = positions[centre as usize];
        // No edge leads from a large sphere back into a smaller one.
        for level in 0..spheres.radii_squared.len() {
            let mut next = 0;
            while let Some(&from) = self.reached[level].as_slice().get(next) {
                let direction = scale(from.offset, spheres.to_unit);
                for block in topology.blocks(from.vertex as usize) {
                    let lanes = block.ahead(direction);
                    self.follow(block, lanes, positions, origin, spheres, (&from, level), &mut visit);
                }
                next += 1;
            }
        }
    }

    /// The edges from a reached vertex to some of a block's neighbours.
    #[inline(always)]
    fn follow(
        &mut self,
        block: &Block,
        mut lanes: u32,
        positions: &[Vec3],
        origin: Vec3,
        spheres: &Spheres,
        (from, from_level): (&Reached, usize),
        visit: &mut impl FnMut(&Step),
    ) {
        let start = positions[from.vertex as usize];
        while lanes != 0 {
            let to = block.neighbour(lanes.trailing_zeros());
            lanes &= lanes - 1;
            let end = positions[to.vertex as usize];
            let along = sub(end, start);
            if dot(along, from.offset) <= 0.0 && from.distance_squared > 0.0 {
                continue;
            }
            let offset = sub(end, origin);
            let distance_squared = length_squared(offset);
            let to_level = spheres.level_of(distance_squared);
            visit(&Step { from, to, from_level, to_level, along });
            let seen = &mut self.seen[to.vertex as usize];
            let reached = Reached { vertex: to.vertex, offset, distance_squared };
            self.reached[to_level].push_if(*seen != self.round, reached);
            *seen = self.round;
        }
    }

    /// What the last run reached: the vertices whose first level this is. The centre comes first.
    #[inline]
    pub(super) fn reached(&self, level: usize) -> &[Reached] {
        self.reached[level].as_slice()
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
    fn level_of(&self, distance_squared: f64) -> usize {
        if distance_squared == 0.0 {
            return self.radii_squared.len();
        }
        self.radii_squared.iter().map(|&radius| usize::from(distance_squared > radius)).sum()
    }
}

/// Which part of an edge lies inside a sphere that it leaves: 0 < t ≤ 1. The edge starts inside at
/// `offset` from the centre, `distance_squared` away.
#[inline]
pub(super) fn clip(
    offset: Vec3,
    distance_squared: f64,
    along: Vec3,
    radius_squared: f64,
) -> f64 {
    let a = length_squared(along);
    let b = dot(offset, along);
    let c = distance_squared - radius_squared;
    if a == 0.0 {
        return 1.0;
    }
    // c ≤ 0, since the edge starts inside: the root is real and not negative.
    let t = ((b * b - a * c).sqrt() - b) / a;
    // The reference's way out where an edge starts on the sphere.
    if t < 1e-16 { 0.01 } else { t.min(1.0) }
}
