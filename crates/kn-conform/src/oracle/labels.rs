//! 5.6: labels.

use std::collections::VecDeque;

use super::conquest::{next, prev};
use super::intra::{Rule, Walk};
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
    mixed: [Model; 16],
    is_second: Model,
    tree: [Model; 256],
}

/// A label and the votes for it.
type Candidate = (u8, i64);

struct Labels<'l> {
    walk: &'l Walk<'l>,
    states: Vec<State>,
    mixed: VecDeque<usize>,
    uniform: VecDeque<usize>,
}

/// The label section: a label for each vertex.
pub(super) fn labels(bytes: &[u8], walk: &Walk<'_>) -> Result<Vec<u8>, Rule> {
    let mut section = Section::new(bytes);
    let mut models = Models {
        uniform: Default::default(),
        mixed: Default::default(),
        is_second: Model::default(),
        tree: [Model::default(); 256],
    };
    let states = vec![State::Unseen; walk.conquest.vertices.len()];
    let mut labels = Labels { walk, states, mixed: VecDeque::new(), uniform: VecDeque::new() };
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
        last = code(&[], 0, last, &mut models, &mut section);
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

    /// r[intra.labels.vote], and the z of r[intra.labels.code]
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
        let t = |label: u8| match candidates.iter().position(|&(other, _)| other == label) {
            Some(0) => 1,
            Some(_) => -1,
            None => 0,
        };
        let mut z = 0;
        for &h in &walk.around[vertex] {
            let ring = [conquest.end(h), conquest.start(prev(h)), conquest.across(next(h))];
            if let [Some(a), Some(b), Some(c)] = ring.map(|v| self.known(v)) {
                z += t(a) + t(b) - t(c);
            }
        }
        code(&candidates, z, last, models, section)
    }
}

/// r[intra.labels.code]
fn code(
    candidates: &[Candidate],
    z: i64,
    last: u8,
    models: &mut Models,
    section: &mut Section<'_>,
) -> u8 {
    let (first, for_first) = candidates.first().copied().unwrap_or((last, 0));
    let (second, for_second) = candidates.get(1).copied().unwrap_or((0, 0));
    let model = if for_second == 0 {
        &mut models.uniform[for_first.min(4) as usize]
    } else {
        &mut models.mixed[(for_first - for_second + z + 6).clamp(0, 15) as usize]
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
