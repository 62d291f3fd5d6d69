//! Coding of vertex labels along the positions' traversal (`spec/05-intra.md`). One function is
//! encoder and decoder.

use super::conquest::next;
use super::surface::Surface;
use kn_bitstream::range::{BinaryCoder, BitModel};

/// Adaptive models of labels.
#[derive(Clone, Debug)]
pub(super) struct LabelModels {
    /// Whether a label is the commonest around it, by how many neighbours have it and have not.
    is_first: [[BitModel; 5]; 5],
    is_second: BitModel,
    /// A binary tree over the eight bits of a label that is neither.
    tree: [BitModel; 256],
}

impl Default for LabelModels {
    fn default() -> Self {
        let model = BitModel::default();
        Self { is_first: [[model; 5]; 5], is_second: model, tree: [model; 256] }
    }
}

/// The two commonest labels among a vertex's neighbours, and how often they occur.
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

/// Codes `labels` (`#M`) of all vertices of `surface` but dummies in the given `order`. An encoder
/// brings them; a decoder brings anything. `known` (`#M`) is scratch, all false.
pub(super) fn code_labels<C: BinaryCoder>(
    coder: &mut C,
    models: &mut LabelModels,
    surface: &Surface,
    order: &[u32],
    known: &mut [bool],
    labels: &mut [u8],
) -> u8 {
    let mut last = 0;
    for &vertex in order {
        if known[vertex as usize] {
            continue;
        }
        let mut vote = Vote::default();
        for h in surface.fan(vertex) {
            let neighbour = surface.conquest.origin[next(h) as usize] as usize;
            if known[neighbour] {
                vote.add(labels[neighbour]);
            }
        }
        last = models.code(coder, vote, last, labels[vertex as usize]);
        let mut twin = vertex;
        loop {
            known[twin as usize] = true;
            labels[twin as usize] = last;
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
        self.code(coder, Vote::default(), last, own)
    }

    fn code<C: BinaryCoder>(&mut self, coder: &mut C, vote: Vote, last: u8, own: u8) -> u8 {
        let (first, count) = if vote.voters == 0 { (last, 0) } else { vote.first };
        let model = &mut self.is_first[count.min(4)][(vote.voters - count).min(4)];
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
