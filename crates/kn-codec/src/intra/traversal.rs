//! The order in which vertices are coded. The vertex that most triangles predict comes first
//! (`spec/05-intra.md`).

use super::surface::Surface;

/// Number of classes of vertices by their predicting triangles.
const RANKS: usize = 4;
/// The highest support; in place of support: the position is known; there is none.
const SUPPORTED: u8 = RANKS as u8 - 1;
const KNOWN: u8 = RANKS as u8;
const DUMMY: u8 = KNOWN + 1;

/// `#M` parallelograms that predict each vertex, [`KNOWN`] or [`DUMMY`].
#[derive(Clone, Debug, Default)]
pub(super) struct Known {
    state: Vec<u8>,
}

impl Known {
    /// Whether the vertex's position is known.
    #[inline]
    pub(super) fn contains(&self, vertex: u32) -> bool {
        self.state[vertex as usize] == KNOWN
    }
}

/// Progress through the vertices of a surface.
#[derive(Clone, Debug, Default)]
pub(super) struct Traversal {
    pub(super) known: Known,
    /// Vertices by support, first come first served; entries may be out of date.
    queues: [Queue; RANKS],
    /// The first vertex that may be the seed of the next component.
    seed_vertex: u32,
}

#[derive(Clone, Debug, Default)]
struct Queue {
    entries: Vec<u32>,
    taken: usize,
}

impl Traversal {
    /// Starts over with the vertices of `surface` unknown.
    pub(super) fn restart(&mut self, surface: &Surface) {
        let state = |vertex| if surface.is_dummy(vertex) { DUMMY } else { 0 };
        self.known.state.clear();
        self.known.state.extend((0..surface.vertices() as u32).map(state));
        for queue in &mut self.queues {
            queue.entries.clear();
            queue.taken = 0;
        }
        self.seed_vertex = 0;
    }

    /// The next vertex to code: of those with the highest support, the first that reached it;
    /// without any, the lowest that is unknown. `None` when all but dummies are known.
    #[inline]
    pub(super) fn next_vertex(&mut self) -> Option<u32> {
        for rank in (1..RANKS).rev() {
            let queue = &mut self.queues[rank];
            while let Some(&vertex) = queue.entries.get(queue.taken) {
                queue.taken += 1;
                if self.known.state[vertex as usize] < KNOWN {
                    return Some(vertex);
                }
            }
        }
        self.next_seed()
    }

    fn next_seed(&mut self) -> Option<u32> {
        let seed = self.seed_vertex as usize;
        let from_seed = self.known.state.get(seed..)?;
        self.seed_vertex += from_seed.iter().position(|&state| state < KNOWN)? as u32;
        Some(self.seed_vertex)
    }

    /// Notes that `vertex` is known, and which vertices its completed triangles now predict.
    #[inline]
    pub(super) fn settle(&mut self, surface: &Surface, vertex: u32) {
        self.known.state[vertex as usize] = KNOWN;
        let ring = surface.ring(vertex);
        let Some(mut before) = ring.last() else { return };
        let turn = |place| ring.get(place).unwrap_or_else(|| &ring[place - ring.len()]);
        for (place, spoke) in ring.iter().enumerate() {
            let next = turn(place + 1);
            if self.known.contains(spoke.neighbour) && self.known.contains(next.neighbour) {
                for tip in [before.neighbour, spoke.across, turn(place + 2).neighbour] {
                    self.support(tip);
                }
            }
            before = spoke;
        }
    }

    /// One triangle more predicts `tip`. What has all the support that counts waits already.
    #[inline]
    fn support(&mut self, tip: u32) {
        let support = &mut self.known.state[tip as usize];
        if *support < SUPPORTED {
            *support += 1;
            self.queues[usize::from(*support)].entries.push(tip);
        }
    }
}
