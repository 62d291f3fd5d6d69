//! The neighbourhood of a vertex inside a sphere, along edges that lead away from it.

use super::MAX_LEVELS;
use super::list::List;
use super::machine::{Machine, Quad, Task, dispatch};
use super::topology::{Block, Topology};
use crate::lanes::lanes;
use kn_mesh::vec3::{Vec3, dot, norm_squared, sub};

/// Concentric spheres around each vertex, one a level, the smallest first.
///
/// One flood serves all levels. Every edge that it uses leads away from the centre, so that
/// whatever is reached inside the large sphere over a path that leaves the small one is itself
/// outside the small one: the vertices that a small sphere reaches are the reached ones in it.
pub(super) struct Spheres {
    pub(super) radii_squared: Vec<f64>,
    /// A bit below and above the squares, in the topology's units.
    in_units: Vec<[f64; 2]>,
}

/// A vertex that the flood has reached.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reached {
    pub(super) vertex: u32,
    /// From the centre.
    pub(super) distance_squared: f64,
}

/// The edges that the flood uses from a vertex to the neighbours of one block.
pub(super) struct Step<'a> {
    pub(super) from: u32,
    /// `from` as seen from the centre.
    pub(super) offset: Vec3,
    /// The first level whose sphere holds `from`, and with it all levels above.
    pub(super) level: usize,
    /// The block's, in the topology.
    pub(super) index: usize,
    pub(super) block: &'a Block,
    pub(super) ahead: Ahead,
}

/// Sets of a block's neighbours.
#[derive(Clone, Copy, Default)]
pub(super) struct Ahead {
    /// Those whose edge leads away from the centre.
    pub(super) used: u8,
    /// Of these, those outside the sphere of a level; none at levels whose sphere does not hold
    /// the edge's start.
    pub(super) leaving: [u8; MAX_LEVELS],
}

/// Buffers of a flood, reused from vertex to vertex.
pub(super) struct Flood {
    /// Per vertex the round that touched it last.
    seen: Vec<u32>,
    round: u32,
    /// Vertices as many edges away from the centre as the flood has come.
    wave: List<u32>,
    /// Those at the ends of the wave's edges, some more than once.
    found: List<u32>,
    /// Per level the vertices of its sphere that no smaller sphere holds.
    reached: Vec<List<Reached>>,
}

/// The mesh that a flood runs over.
#[derive(Clone, Copy)]
pub(super) struct Graph<'a> {
    pub(super) topology: &'a Topology,
    /// `#V × 3`.
    pub(super) positions: &'a [Vec3],
}

/// The extent of a flood.
#[derive(Clone, Copy)]
pub(super) struct Bounded<'a> {
    pub(super) spheres: &'a Spheres,
    /// The number of vertices that end it.
    pub(super) most: usize,
}

/// Floods that are looked at to see how many vertices they reach.
const PROBES: usize = 64;

/// The mean number of vertices that a flood reaches, of some evenly chosen centres.
pub(super) fn mean_reached(graph: Graph<'_>, spheres: &Spheres) -> usize {
    dispatch(Probes { graph, spheres })
}

struct Probes<'a> {
    graph: Graph<'a>,
    spheres: &'a Spheres,
}

impl Task for Probes<'_> {
    type Output = usize;

    #[inline(always)]
    fn run<M: Machine>(self, machine: M) -> usize {
        let (count, levels) = (self.graph.positions.len(), self.spheres.last() + 1);
        let mut flood = Flood::new(count, levels);
        let all = Bounded { spheres: self.spheres, most: usize::MAX };
        let (mut reached, mut probes) = (0, 0);
        for centre in (0..count).step_by(count.div_ceil(PROBES).max(1)) {
            flood.run(machine, self.graph, centre as u32, all, |_| ());
            reached += (0..levels).map(|level| flood.reached(level).len()).sum::<usize>();
            probes += 1;
        }
        reached / probes.max(1)
    }
}

impl Flood {
    pub(super) fn new(vertex_count: usize, levels: usize) -> Self {
        Self {
            seen: vec![0; vertex_count],
            round: 0,
            wave: List::new(),
            found: List::new(),
            reached: vec![List::new(); levels],
        }
    }

    /// Visits each used edge once, from its nearer end. The flood ends with the wave in which it has
    /// come to `most` vertices.
    #[inline(always)]
    pub(super) fn run<M: Machine>(
        &mut self,
        machine: M,
        Graph { topology, positions }: Graph,
        centre: u32,
        Bounded { spheres, most }: Bounded,
        mut visit: impl FnMut(&Step),
    ) {
        let origin = positions[centre as usize];
        self.start(centre);
        let mut count = 0;
        while !self.wave.as_slice().is_empty() && count < most {
            count += self.wave.as_slice().len();
            self.found.clear();
            for &vertex in self.wave.as_slice() {
                let offset = sub(positions[vertex as usize], origin);
                let distance_squared = norm_squared(offset);
                let level = spheres.level_of(distance_squared);
                self.reached[level].push_if(true, Reached { vertex, distance_squared });
                let start = Start { vertex, origin, offset, distance_squared, level };
                for (index, block) in topology.blocks(vertex as usize) {
                    let ahead = start.ahead(machine, block, topology.to_unit, positions, spheres);
                    let inside = ahead.used & !ahead.leaving[spheres.last()];
                    self.found.push_some(inside, machine.compress(inside, &block.vertices));
                    visit(&Step { from: vertex, offset, level, index, block, ahead });
                }
            }
            self.next_wave();
        }
    }

    fn start(&mut self, centre: u32) {
        self.round += 1;
        self.seen[centre as usize] = self.round;
        self.reached.iter_mut().for_each(List::clear);
        self.wave.clear();
        self.wave.push_if(true, centre);
    }

    /// Makes the vertices that were found the wave, each once.
    #[inline(always)]
    fn next_wave(&mut self) {
        self.wave.clear();
        for &vertex in self.found.as_slice() {
            let seen = &mut self.seen[vertex as usize];
            self.wave.push_if(*seen != self.round, vertex);
            *seen = self.round;
        }
    }

    /// The vertices that the last run reached whose first level this is. The centre comes first.
    #[inline]
    pub(super) fn reached(&self, level: usize) -> &[Reached] {
        self.reached[level].as_slice()
    }
}

/// A vertex inside the spheres of `level` and above.
struct Start {
    vertex: u32,
    origin: Vec3,
    /// From the centre.
    offset: Vec3,
    distance_squared: f64,
    level: usize,
}

impl Start {
    /// The edges that lead away, and where to.
    #[inline(always)]
    fn ahead<M: Machine>(
        &self,
        machine: M,
        block: &Block,
        to_unit: f64,
        positions: &[Vec3],
        spheres: &Spheres,
    ) -> Ahead {
        let offset = self.offset.map(|x| (x * to_unit) as f32);
        let (products, slack) = block.products(machine, offset);
        // All edges of the centre itself are used, and only it is at no distance.
        let (used, maybe_used) = if self.distance_squared == 0.0 {
            (block.apart(machine), block.present)
        } else {
            (machine.above(products, slack), machine.above(products, -slack))
        };
        let mut ahead = Ahead { used, ..Ahead::default() };
        let mut unsure = used ^ maybe_used;
        let gains = block.gains(machine, products);
        let distance_squared = self.distance_squared * to_unit * to_unit;
        // For all levels, since a loop of changing length is mispredicted.
        for (level, [less, more]) in spheres.in_units.iter().enumerate() {
            let less = machine.above(gains, (less - distance_squared) as f32);
            let more = machine.above(gains, (more - distance_squared) as f32);
            let holds = if level >= self.level { used } else { 0 };
            unsure |= (less ^ more) & holds;
            ahead.leaving[level] = more & holds;
        }
        if unsure == 0 { ahead } else { self.exactly_ahead(block, positions, spheres) }
    }

    /// Decided in binary64.
    #[cold]
    fn exactly_ahead(&self, block: &Block, positions: &[Vec3], spheres: &Spheres) -> Ahead {
        let mut ahead = Ahead::default();
        let start = positions[self.vertex as usize];
        for lane in lanes(block.present) {
            let to = positions[block.vertices[lane] as usize];
            if self.distance_squared != 0.0 && dot(sub(to, start), self.offset) <= 0.0 {
                continue;
            }
            ahead.used |= 1 << lane;
            let end_squared = norm_squared(sub(to, self.origin));
            for level in self.level..=spheres.last() {
                // An edge without length leaves every sphere, as in the reference.
                let leaves = end_squared > spheres.radii_squared[level] || end_squared == 0.0;
                ahead.leaving[level] |= u8::from(leaves) << lane;
            }
        }
        ahead
    }
}

impl Spheres {
    /// `radii` must ascend; there is at least one.
    pub(super) fn new(radii: impl Iterator<Item = f64>, topology: &Topology) -> Self {
        // Near a threshold, rounding moves the square of a distance by less than a fourth of this:
        // the edge starts inside, so that no coordinate is much larger than the radius.
        const SLACK: f64 = 1e-5;
        let radii_squared: Vec<f64> = radii.map(|radius| radius * radius).collect();
        let in_units = |square: &f64| {
            let square = square * topology.to_unit * topology.to_unit;
            [square * (1.0 - SLACK), square * (1.0 + SLACK)]
        };
        let in_units = radii_squared.iter().map(in_units).collect();
        Self { radii_squared, in_units }
    }

    /// The first level whose sphere holds a vertex at this distance; the last if none does.
    #[inline(always)]
    fn level_of(&self, distance_squared: f64) -> usize {
        let smaller = &self.radii_squared[..self.last()];
        smaller.iter().map(|&radius| usize::from(distance_squared > radius)).sum()
    }

    /// The largest level.
    #[inline(always)]
    fn last(&self) -> usize {
        self.radii_squared.len() - 1
    }
}

/// The least part of an edge that [`parts`] gives.
pub(super) const SMALLEST_PART: f64 = 1e-16;

/// The parts of edges that lie inside a sphere that holds their starts: above 1 where it holds the
/// whole edge. With the edge `e` that starts at `o` from the centre: a = e², b = o·e, and c = o² −
/// r², which is not positive, so that the root is real. Below [`SMALLEST_PART`] or not a number for
/// an edge without length and for one that starts on the sphere: see [`clip_special`].
#[inline(always)]
pub(super) fn parts<M: Machine>(a: Quad<M>, b: Quad<M>, c: Quad<M>) -> Quad<M> {
    ((b * b - a * c).sqrt() - b) / a
}

/// The part of an edge that [`parts`] has none for, as in the reference.
pub(super) fn clip_special(along: Vec3) -> f64 {
    if norm_squared(along) == 0.0 { 1.0 } else { 0.01 }
}

#[cfg(test)]
mod tests {
    use super::super::machine::Baseline;
    use super::super::{radii, tests::hard};
    use super::*;

    /// Floods from all vertices; how many blocks were looked at.
    struct Everywhere;

    impl Task for Everywhere {
        type Output = usize;

        fn run<M: Machine>(self, machine: M) -> usize {
            let (positions, faces) = hard();
            let topology = Topology::new(&positions, &faces, 2.9);
            let spheres = Spheres::new(radii(2.9, 16).into_iter().map(|r| 5.0 * r), &topology);
            let mut flood = Flood::new(positions.len(), 16);
            let mut blocks = 0;
            let graph = Graph { topology: &topology, positions: &positions };
            for (centre, &origin) in positions.iter().enumerate() {
                let all = Bounded { spheres: &spheres, most: usize::MAX };
                flood.run(machine, graph, centre as u32, all, |step| {
                    let start = Start {
                        vertex: step.from,
                        origin,
                        offset: step.offset,
                        distance_squared: norm_squared(step.offset),
                        level: step.level,
                    };
                    let exact = start.exactly_ahead(step.block, &positions, &spheres);
                    assert_eq!(step.ahead.used, exact.used);
                    assert_eq!(step.ahead.leaving, exact.leaving);
                    blocks += 1;
                });
            }
            blocks
        }
    }

    #[test]
    fn binary32_decides_what_binary64_would() {
        let blocks = Everywhere.run(Baseline);
        assert!(blocks > 100_000, "{blocks}");
        assert_eq!(dispatch(Everywhere), blocks);
    }
}
