//! Coding of vertex labels along the positions' traversal (`spec/05-intra.md`). One function is
//! encoder and decoder.

use super::border::{LEANS, Neighbourhood, lean, near_ring};
use super::predict::Point;
use super::surface::{Spoke, Surface};
use kn_bitstream::range::{BinaryCoder, BitModel};

/// Adaptive models of labels.
#[derive(Clone, Debug)]
pub(super) struct LabelModels {
    /// Whether a label is that of all labelled neighbours, by their number.
    uniform: [BitModel; 5],
    /// Whether a label is the commonest of several, by where the border runs.
    mixed: [BitModel; LEANS],
    is_second: BitModel,
    /// A binary tree over the eight bits of a label that is neither.
    tree: [BitModel; 256],
}

impl Default for LabelModels {
    fn default() -> Self {
        let model = BitModel::default();
        Self { uniform: [model; 5], mixed: [model; LEANS], is_second: model, tree: [model; 256] }
    }
}

/// The two most frequent labels among a vertex's neighbours, with their counts.
#[derive(Clone, Copy, Debug, Default)]
struct Vote {
    first: (u8, usize),
    second: (u8, usize),
    voters: usize,
}

impl Vote {
    /// Counts `label`; of equal counts the label that came first stays ahead.
    fn add(&mut self, label: u8) {
        self.voters += 1;
        if self.first.1 == 0 || self.first.0 == label {
            self.first = (label, self.first.1 + 1);
        } else if self.second.1 == 0 || self.second.0 == label {
            self.second = (label, self.second.1 + 1);
            if self.second.1 > self.first.1 {
                std::mem::swap(&mut self.first, &mut self.second);
            }
        }
    }
}

/// Progress of the labels over a surface. Vertices between different labels come first, so that
/// a border, once found, is followed to its end.
#[derive(Clone, Debug, Default)]
pub(super) struct LabelTraversal {
    /// `#M` what is known of each vertex.
    state: Vec<State>,
    /// Vertices that saw two labels, and that saw one: first come, first served.
    mixed: Vec<u32>,
    uniform: Vec<u32>,
    mixed_taken: usize,
    uniform_taken: usize,
    seed_vertex: u32,
    neighbourhood: Neighbourhood,
    /// Known vertices along a border, 1 for its expected side and −1 for the other.
    samples: Vec<(Point, f64)>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum State {
    #[default]
    Unseen,
    /// All labelled neighbours have this label.
    Uniform(u8),
    Mixed,
    Known,
}

impl LabelTraversal {
    fn restart(&mut self, vertices: usize) {
        self.state.clear();
        self.state.resize(vertices, State::Unseen);
        self.mixed.clear();
        self.uniform.clear();
        self.neighbourhood.restart(vertices);
        (self.mixed_taken, self.uniform_taken, self.seed_vertex) = (0, 0, 0);
    }

    fn next_vertex(&mut self, surface: &Surface) -> Option<u32> {
        while let Some(&vertex) = self.mixed.get(self.mixed_taken) {
            self.mixed_taken += 1;
            if self.state[vertex as usize] != State::Known {
                return Some(vertex);
            }
        }
        while let Some(&vertex) = self.uniform.get(self.uniform_taken) {
            self.uniform_taken += 1;
            if self.state[vertex as usize] != State::Known {
                return Some(vertex);
            }
        }
        while let Some(&state) = self.state.get(self.seed_vertex as usize) {
            let vertex = self.seed_vertex;
            if state != State::Known && !surface.is_dummy(vertex) {
                return Some(vertex);
            }
            self.seed_vertex += 1;
        }
        None
    }

    /// Notes that `vertex` has `label`, and who its neighbours are.
    fn settle(&mut self, surface: &Surface, vertex: u32, label: u8) {
        self.state[vertex as usize] = State::Known;
        for &Spoke { neighbour, .. } in surface.ring(vertex) {
            if surface.is_dummy(neighbour) {
                continue;
            }
            let state = &mut self.state[neighbour as usize];
            match *state {
                State::Unseen => {
                    *state = State::Uniform(label);
                    self.uniform.push(neighbour);
                }
                State::Uniform(other) if other != label => {
                    *state = State::Mixed;
                    self.mixed.push(neighbour);
                }
                _ => {}
            }
        }
    }

    fn is_known(&self, vertex: u32) -> bool {
        self.state[vertex as usize] == State::Known
    }

    fn vote(&self, surface: &Surface, labels: &[u8], vertex: u32) -> Vote {
        let mut vote = Vote::default();
        for &Spoke { neighbour, .. } in surface.ring(vertex) {
            if self.is_known(neighbour) {
                vote.add(labels[neighbour as usize]);
            }
        }
        vote
    }

    /// The context of a vertex that a border passes: on which side of it the known vertices on both
    /// sides near by put the vertex.
    fn border(
        &mut self,
        surface: &Surface,
        labels: &[u8],
        points: &[Point],
        vertex: u32,
        vote: &Vote,
    ) -> usize {
        let Self { state, neighbourhood, samples, .. } = self;
        let is_known = |v: u32| state[v as usize] == State::Known;
        samples.clear();
        for &near in neighbourhood.gather(surface, vertex) {
            let label = labels[near as usize];
            let differs = |spoke: &Spoke| {
                is_known(spoke.neighbour) && labels[spoke.neighbour as usize] != label
            };
            if !is_known(near) || !near_ring(surface, near).iter().any(differs) {
                continue;
            }
            if label == vote.first.0 {
                samples.push((points[near as usize], 1.0));
            } else if label == vote.second.0 {
                samples.push((points[near as usize], -1.0));
            }
        }
        lean(&points[vertex as usize], samples)
    }
}

/// Codes `labels` (`#M`) of all vertices of `surface` except dummies, and returns the last. An
/// encoder passes them in `labels`; a decoder gets them there. `points` (`#M`) are known.
pub(super) fn code_labels<C: BinaryCoder>(
    coder: &mut C,
    models: &mut LabelModels,
    surface: &Surface,
    traversal: &mut LabelTraversal,
    labels: &mut [u8],
    points: &[Point],
) -> u8 {
    let mut last = 0;
    traversal.restart(labels.len());
    while let Some(vertex) = traversal.next_vertex(surface) {
        let vote = traversal.vote(surface, labels, vertex);
        let lean = match vote.second.1 {
            0 => None,
            _ => Some(traversal.border(surface, labels, points, vertex, &vote)),
        };
        last = models.code(coder, vote, lean, last, labels[vertex as usize]);
        let mut twin = vertex;
        loop {
            labels[twin as usize] = last;
            traversal.settle(surface, twin, last);
            twin = surface.twin[twin as usize];
            if twin == vertex {
                break;
            }
        }
    }
    last
}

impl LabelModels {
    /// Codes the label of a vertex without faces, expected to be `last`.
    pub(super) fn code_isolated<C: BinaryCoder>(&mut self, coder: &mut C, last: u8, own: u8) -> u8 {
        self.code(coder, Vote::default(), None, last, own)
    }

    fn code<C: BinaryCoder>(
        &mut self,
        coder: &mut C,
        vote: Vote,
        lean: Option<usize>,
        last: u8,
        own: u8,
    ) -> u8 {
        let first = if vote.voters == 0 { last } else { vote.first.0 };
        let model = match lean {
            None => &mut self.uniform[vote.first.1.min(4)],
            Some(lean) => &mut self.mixed[lean],
        };
        if coder.bit(model, own == first) {
            return first;
        }
        let (second, count) = vote.second;
        if count > 0 && coder.bit(&mut self.is_second, own == second) {
            return second;
        }
        let mut node = 1;
        for place in (0..8).rev() {
            node = node << 1 | usize::from(coder.bit(&mut self.tree[node], own >> place & 1 != 0));
        }
        node as u8
    }
}
