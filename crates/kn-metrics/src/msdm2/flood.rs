//! The neighbourhood of a vertex inside a sphere, along edges that lead away from it.

use super::list::List;
use super::topology::{Block, Topology};
use crate::lanes::{each_lane, lanes};
use crate::vec3::{Vec3, dot, length_squared, scale, sub};

/// Concentric spheres around each vertex, one a level, the smallest first.
///
/// One flood serves all levels. Every edge that it uses leads away from the centre, so that
/// whatever is reached inside the large sphere over a path that leaves the small one is itself
/// outside the small one: the vertices that a small sphere reaches are the reached ones in it.
pub(super) struct Spheres {
    pub(super) radii_squared: Vec<f64>,
    /// A bit below the squares, in the topology's units.
    less: Vec<f32>,
    /// A bit above the largest square.
    more: f32,
}

/// A vertex that the flood has reached.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reached {
    pub(super) vertex: u32,
    /// From the centre.
    pub(super) distance_squared: f64,
}

/// Some of the edges that the flood uses: those from a vertex to neighbours of one block.
pub(super) struct Step<'a> {
    pub(super) from: u32,
    /// `from` as seen from the centre.
    pub(super) offset: Vec3,
    /// The first level whose sphere holds `from`, and with it all levels above.
    pub(super) level: usize,
    pub(super) block: &'a Block,
    /// A bit for each neighbour whose edge leads away from the centre.
    pub(super) used: u8,
    /// The used edges that leave the sphere of `level`, and maybe some that do not.
    pub(super) leaving: u8,
}

/// Buffers of a flood, reused from vertex to vertex.
pub(super) struct Flood {
    /// Per vertex the round that touched it last.
    seen: Vec<u32>,
    round: u32,
    queue: List<u32>,
    /// Per level the vertices of its sphere that no smaller sphere holds.
    reached: Vec<List<Reached>>,
}

impl Flood {
    pub(super) fn new(vertex_count: usize, levels: usize) -> Self {
        Self {
            seen: vec![0; vertex_count],
            round: 0,
            queue: List::new(),
            reached: vec![List::new(); levels],
        }
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
        self.queue.clear();
        self.queue.push_if(true, centre);
        let origin = positions[centre as usize];
        let mut next = 0;
        while let Some(&vertex) = self.queue.as_slice().get(next) {
            let offset = sub(positions[vertex as usize], origin);
            let distance_squared = length_squared(offset);
            let level = spheres.level_of(distance_squared);
            // An edge without length leaves every sphere, as in the reference.
            let at_centre = distance_squared == 0.0 && next > 0;
            next += 1;
            if level == spheres.less.len() || at_centre {
                continue;
            }
            self.reached[level].push_if(true, Reached { vertex, distance_squared });
            let unit_offset = scale(offset, topology.to_unit).map(|x| x as f32);
            for block in topology.blocks(vertex as usize) {
                let (mut used, maybe_used) = block.ahead(unit_offset);
                let squares = block.distances_squared(unit_offset);
                let mut leaving = squares.above(spheres.less[level]);
                if used != maybe_used {
                    used = exactly_ahead(block, positions, vertex, offset);
                    // One of them may have no length.
                    leaving = used;
                }
                each_lane::<3>(used & !squares.above(spheres.more), |is_one, lane| {
                    let to = block.neighbour(lane).vertex;
                    let seen = &mut self.seen[to as usize];
                    let is_new = is_one && *seen != self.round;
                    self.queue.push_if(is_new, to);
                    *seen = if is_new { self.round } else { *seen };
                });
                visit(&Step { from: vertex, offset, level, block, used, leaving: used & leaving });
            }
        }
    }

    /// What the last run reached: the vertices whose first level this is. The centre comes first.
    #[inline]
    pub(super) fn reached(&self, level: usize) -> &[Reached] {
        self.reached[level].as_slice()
    }
}

/// A bit for each neighbour whose edge leads away from the centre, decided in binary64. All edges
/// of the centre itself do, and only it is at no distance.
#[cold]
fn exactly_ahead(block: &Block, positions: &[Vec3], from: u32, offset: Vec3) -> u8 {
    let is_ahead = |&lane: &usize| {
        let to = block.neighbour(lane).vertex as usize;
        offset == [0.0; 3] || dot(sub(positions[to], positions[from as usize]), offset) > 0.0
    };
    lanes(block.present()).filter(is_ahead).map(|lane| 1 << lane).sum()
}

impl Spheres {
    /// `radii` must ascend; there is at least one.
    pub(super) fn new(radii: impl Iterator<Item = f64>, topology: &Topology) -> Self {
        // Near a threshold, rounding moves the square of a distance by less than a fourth of this:
        // the edge starts inside, so that no coordinate is much larger than the radius.
        const SLACK: f64 = 1e-5;
        let radii_squared: Vec<f64> = radii.map(|radius| radius * radius).collect();
        let in_units = |square: f64| (square * topology.to_unit * topology.to_unit) as f32;
        let less = radii_squared.iter().map(|square| in_units(square * (1.0 - SLACK))).collect();
        let more = radii_squared.last().map_or(0.0, |square| in_units(square * (1.0 + SLACK)));
        Self { radii_squared, less, more }
    }

    /// The first level whose sphere holds a vertex at this distance; may be the number of levels.
    #[inline]
    fn level_of(&self, distance_squared: f64) -> usize {
        self.radii_squared.iter().map(|&radius| usize::from(distance_squared > radius)).sum()
    }
}

/// Which part of an edge lies inside a sphere that it leaves: 0 < t ≤ 1. The edge starts inside at
/// `offset` from the centre, `distance_squared` away. Nothing where the end of that part is not on
/// the sphere: for an edge without length, and for one that starts on the sphere.
#[inline]
pub(super) fn clip(offset: Vec3, along: Vec3, radius_squared: f64) -> Option<f64> {
    let a = length_squared(along);
    let b = dot(offset, along);
    let c = length_squared(offset) - radius_squared;
    // c ≤ 0, since the edge starts inside: the root is real and not negative.
    let t = ((b * b - a * c).sqrt() - b) / a;
    (t >= 1e-16).then(|| t.min(1.0))
}

/// What [`clip`] leaves open, as in the reference.
pub(super) fn clip_special(along: Vec3) -> f64 {
    if length_squared(along) == 0.0 { 1.0 } else { 0.01 }
}
