//! 5.6: labels.

use kn_bitstream::Rule;
use std::collections::VecDeque;

use super::intra::Walk;
use super::range::{Model, Section};

/// r[intra.labels.order]
#[derive(Clone, Copy, PartialEq)]
enum State {
    Unseen,
    Uniform(u8),
    Mixed,
    Known(u8),
}

struct Models {
    uniform: [Model; 5],
    mixed: [Model; 17],
    is_second: Model,
    tree: [Model; 256],
}

/// A label and the votes for it.
type Candidate = (u8, i64);

struct Labels<'l> {
    walk: &'l Walk<'l>,
    /// As coded: ranks where there is a lattice.
    positions: &'l [[i32; 3]],
    states: Vec<State>,
    mixed: VecDeque<usize>,
    uniform: VecDeque<usize>,
}

/// The label section: a label for each vertex.
pub(super) fn labels(
    bytes: &[u8],
    walk: &Walk<'_>,
    positions: &[[i32; 3]],
) -> Result<Vec<u8>, Rule> {
    let mut section = Section::new(bytes);
    let mut models = Models {
        uniform: Default::default(),
        mixed: Default::default(),
        is_second: Model::default(),
        tree: [Model::default(); 256],
    };
    let states = vec![State::Unseen; walk.conquest.vertices.len()];
    let mut labels =
        Labels { walk, positions, states, mixed: VecDeque::new(), uniform: VecDeque::new() };
    let mut decoded = vec![0; walk.vertices];
    let mut last = 0;
    while let Some(vertex) = labels.next_vertex() {
        last = labels.label(vertex, last, &mut models, &mut section);
        decoded[walk.conquest.vertices[vertex].number] = last;
        for twin in walk.conquest.twins(vertex) {
            labels.settle(twin, last);
        }
    }
    for label in &mut decoded[walk.vertices - walk.isolated as usize..] {
        last = code(&[], 8, last, &mut models, &mut section);
        *label = last;
    }
    section.finish()?;
    Ok(decoded)
}

impl Labels<'_> {
    fn known(&self, vertex: usize) -> Option<u8> {
        match self.states[vertex] {
            State::Known(label) => Some(label),
            _ => None,
        }
    }

    fn next_vertex(&mut self) -> Option<usize> {
        while let Some(vertex) = self.mixed.pop_front().or_else(|| self.uniform.pop_front()) {
            if self.known(vertex).is_none() {
                return Some(vertex);
            }
        }
        let dummy = |vertex: usize| self.walk.conquest.vertices[vertex].dummy;
        (0..self.states.len()).find(|&v| self.known(v).is_none() && !dummy(v))
    }

    fn settle(&mut self, vertex: usize, label: u8) {
        self.states[vertex] = State::Known(label);
        for &h in &self.walk.around[vertex] {
            let end = self.walk.conquest.end(h);
            if self.walk.conquest.vertices[end].dummy {
                continue;
            }
            match self.states[end] {
                State::Unseen => {
                    self.states[end] = State::Uniform(label);
                    self.uniform.push_back(end);
                }
                State::Uniform(other) if other != label => {
                    self.states[end] = State::Mixed;
                    self.mixed.push_back(end);
                }
                _ => {}
            }
        }
    }

    /// r[intra.labels.border]
    fn lean(&self, vertex: usize, first: u8, second: u8) -> usize {
        let conquest = self.walk.conquest;
        let ends = |v: usize| {
            let around = self.walk.around[v].iter().take(32);
            around.map(|&h| conquest.end(h)).filter(|&end| !conquest.vertices[end].dummy)
        };
        let mut met = vec![vertex];
        let mut ring = 0..1;
        for _ in 0..4 {
            let begin = met.len();
            for at in ring {
                for end in ends(met[at]) {
                    if met.len() < 256 && !met.contains(&end) {
                        met.push(end);
                    }
                }
            }
            ring = begin..met.len();
        }
        let place = |v: usize| self.positions[conquest.vertices[v].number].map(f64::from);
        let origin = place(vertex);
        let mut samples = Vec::new();
        for v in met {
            let Some(label) = self.known(v).filter(|&label| label == first || label == second)
            else {
                continue;
            };
            if ends(v).any(|end| self.known(end).is_some_and(|other| other != label)) {
                let at = place(v);
                let d = [0, 1, 2].map(|axis| at[axis] - origin[axis]);
                samples.push((d, if label == first { 1.0 } else { -1.0 }));
            }
        }
        fitted(&samples)
    }

    /// r[intra.labels.vote]
    fn label(&self, vertex: usize, last: u8, models: &mut Models, section: &mut Section<'_>) -> u8 {
        let (walk, conquest) = (self.walk, self.walk.conquest);
        let mut candidates: Vec<Candidate> = Vec::new();
        for &h in &walk.around[vertex] {
            let Some(label) = self.known(conquest.end(h)) else { continue };
            match candidates.iter().position(|&(candidate, _)| candidate == label) {
                Some(place) => candidates[place].1 += 1,
                None if candidates.len() < 2 => candidates.push((label, 1)),
                None => {}
            }
            if candidates.len() == 2 && candidates[1].1 > candidates[0].1 {
                candidates.swap(0, 1);
            }
        }
        let lean = match candidates[..] {
            [(first, _), (second, _)] => self.lean(vertex, first, second),
            _ => 8,
        };
        code(&candidates, lean, last, models, section)
    }
}

/// r[intra.labels.border]: the fit, from samples' places relative to the vertex, and their ±1.
fn fitted(samples: &[([f64; 3], f64)]) -> usize {
    if samples.is_empty() {
        return 8;
    }
    let squared = |d: &[f64; 3]| (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
    let mut sum = 0.0;
    for (d, _) in samples {
        sum += squared(d);
    }
    let scale = f64::max(sum / samples.len() as f64, 1.0);
    let mut weights = 0.0;
    let mut n = [[0.0; 5]; 4];
    for (d, t) in samples {
        let w = 1.0 / (squared(d) / scale + 1.0 / 4.0);
        weights += w;
        let row = [d[0], d[1], d[2], 1.0, *t];
        for i in 0..4 {
            for j in i..5 {
                n[i][j] += (w * row[i]) * row[j];
            }
        }
    }
    for i in 0..3 {
        n[i][i] += (1.0 / 256.0 * weights) * scale;
    }
    for i in 0..3 {
        for j in i + 1..4 {
            let f = n[i][j] / n[i][i];
            for k in j..5 {
                n[j][k] -= f * n[i][k];
            }
        }
    }
    let value = (3.0 * (n[3][4] / n[3][3]) + 1.0 / 2.0).floor();
    (value.clamp(-8.0, 8.0) + 8.0) as usize
}

/// r[intra.labels.code]
fn code(
    candidates: &[Candidate],
    lean: usize,
    last: u8,
    models: &mut Models,
    section: &mut Section<'_>,
) -> u8 {
    let (first, for_first) = candidates.first().copied().unwrap_or((last, 0));
    let (second, for_second) = candidates.get(1).copied().unwrap_or((0, 0));
    let model = if for_second == 0 {
        &mut models.uniform[for_first.min(4) as usize]
    } else {
        &mut models.mixed[lean]
    };
    if section.decision(model) {
        return first;
    }
    if for_second > 0 && section.decision(&mut models.is_second) {
        return second;
    }
    let mut node = 1;
    for _ in 0..8 {
        node = 2 * node + usize::from(section.decision(&mut models.tree[node]));
    }
    (node - 256) as u8
}
