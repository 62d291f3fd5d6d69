//! The order in which vertices are coded: those that most triangles predict come first
//! (`spec/05-intra.md`).

use super::conquest::{next, prev};
use super::surface::Surface;

/// Numbers of predicting triangles that are told apart.
const RANKS: usize = 4;

/// Progress through the vertices of a surface.
#[derive(Clone, Debug, Default)]
pub(super) struct Traversal {
    /// `#M` whether a vertex's position is known.
    pub(super) known: Vec<bool>,
    /// `#M` parallelograms that predict each vertex.
    support: Vec<u8>,
    /// Vertices by support, first come first served; entries may be out of date.
    queues: [Queue; RANKS],
    /// Where to look for the next component's seed.
    seed_vertex: u32,
}

#[derive(Clone, Debug, Default)]
struct Queue {
    entries: Vec<u32>,
    taken: usize,
}

impl Traversal {
    /// Starts over with `vertices` unknown vertices.
    pub(super) fn restart(&mut self, vertices: usize) {
        self.known.clear();
        self.known.resize(vertices, false);
        self.support.clear();
        self.support.resize(vertices, 0);
        for queue in &mut self.queues {
            queue.entries.clear();
            queue.taken = 0;
        }
        self.seed_vertex = 0;
    }

    /// The next vertex to code: of those with the highest support, the first that reached it;
    /// without any, the lowest that is unknown. `None` when all but dummies are known.
    #[inline]
    pub(super) fn next_vertex(&mut self, surface: &Surface) -> Option<u32> {
        for rank in (0..RANKS).rev() {
            let queue = &mut self.queues[rank];
            while let Some(&vertex) = queue.entries.get(queue.taken) {
                queue.taken += 1;
                let current = usize::from(self.support[vertex as usize]).min(RANKS - 1);
                if !self.known[vertex as usize] && current == rank {
                    return Some(vertex);
                }
            }
        }
        self.next_seed(surface)
    }

    fn next_seed(&mut self, surface: &Surface) -> Option<u32> {
        while let Some(&known) = self.known.get(self.seed_vertex as usize) {
            let vertex = self.seed_vertex;
            if !known && !surface.conquest.dummy[vertex as usize] {
                return Some(vertex);
            }
            self.seed_vertex += 1;
        }
        None
    }

    /// Notes that `vertex` is known, and which vertices its completed triangles now predict.
    #[inline]
    pub(super) fn settle(&mut self, surface: &Surface, vertex: u32) {
        self.known[vertex as usize] = true;
        let origin = &surface.conquest.origin;
        for h in surface.fan(vertex) {
            let (a, b) = (origin[next(h) as usize], origin[prev(h) as usize]);
            if self.known[a as usize] && self.known[b as usize] {
                for side in [h, next(h), prev(h)] {
                    self.support_tip(surface, side);
                }
            }
        }
    }

    #[inline]
    fn support_tip(&mut self, surface: &Surface, side: u32) {
        let tip = surface.across(side);
        if self.known[tip as usize] || surface.conquest.dummy[tip as usize] {
            return;
        }
        let support = &mut self.support[tip as usize];
        *support = support.saturating_add(1);
        self.queues[usize::from(*support).min(RANKS - 1)].entries.push(tip);
    }
}
