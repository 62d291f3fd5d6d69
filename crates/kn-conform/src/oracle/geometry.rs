//! 5.5: positions.

use kn_bitstream::rule::{self, Rule};
use std::collections::VecDeque;

use super::conquest::{next, prev};
use super::intra::Walk;
use super::range::{Gamma, Model, Section};
use super::spread::{Frame, Means, Ring, blended};

const LIMIT: i64 = 1 << 20;
const RANGE: Rule = rule::INTRA_GEOMETRY_RANGE;

/// #V × 3.
type Points = Vec<[i32; 3]>;

/// r[intra.geometry.error]
#[derive(Clone, Default)]
struct ErrorModels {
    is_zero: Model,
    is_negative: [Model; 3],
    longer: [Model; 22],
    second: [Model; 23],
    third: [[Model; 2]; 23],
}

/// The state of a vertex of the conquest.
#[derive(Clone, Default)]
struct State {
    position: Option<[i64; 3]>,
    support: usize,
    error: i64,
}

struct Geometry<'g, 'b> {
    walk: &'g Walk<'g>,
    section: Section<'b>,
    states: Vec<State>,
    queues: [VecDeque<usize>; 4],
    means: Means,
    /// By place and context.
    coordinates: Vec<ErrorModels>,
    unsupported: ErrorModels,
    /// The position coded last.
    last: [i64; 3],
}

/// The geometry section: `#V × 3` positions as coded, and on the grid.
pub(super) fn geometry(
    bytes: &[u8],
    walk: &Walk<'_>,
    has_lattice: bool,
) -> Result<(Points, Points), Rule> {
    let mut section = Section::new(bytes);
    let lattice = if has_lattice { Some(read_lattice(&mut section, walk.vertices)?) } else { None };
    let mut geometry = Geometry {
        walk,
        section,
        states: vec![State::default(); walk.conquest.vertices.len()],
        queues: Default::default(),
        means: Means::default(),
        coordinates: vec![ErrorModels::default(); 3 * 48],
        unsupported: ErrorModels::default(),
        last: [0; 3],
    };
    let in_list = |p: &[i64; 3]| match &lattice {
        Some(values) => (0..3).all(|axis| (0..values[axis].len() as i64).contains(&p[axis])),
        None => true,
    };
    let mut positions = vec![[0; 3]; walk.vertices];
    while let Some(vertex) = geometry.next_vertex() {
        let position = geometry.vertex(vertex)?;
        if !in_list(&position) {
            return Err(rule::INTRA_GEOMETRY_LATTICE);
        }
        positions[walk.conquest.vertices[vertex].number] = position;
    }
    for position in &mut positions[walk.vertices - walk.isolated as usize..] {
        *position = geometry.alone(geometry.last)?;
        if !in_list(position) {
            return Err(rule::INTRA_GEOMETRY_LATTICE);
        }
    }
    geometry.section.finish()?;
    let value = |axis: usize, c: i64| lattice.as_ref().map_or(c, |list| list[axis][c as usize]);
    let on_grid = |p: [i64; 3]| [0, 1, 2].map(|axis| value(axis, p[axis]) as i32);
    let coded = positions.iter().map(|p| p.map(|c| c as i32)).collect();
    Ok((coded, positions.into_iter().map(on_grid).collect()))
}

/// r[intra.geometry.lattice]
fn read_lattice(section: &mut Section<'_>, vertices: usize) -> Result<[Vec<i64>; 3], Rule> {
    const LATTICE: Rule = rule::INTRA_GEOMETRY_LATTICE;
    let mut longer = [[[Model::default(); 8]; 9]; 9];
    let (mut counts, mut escaped) = (Gamma::default(), Gamma::default());
    let mut lists = [const { Vec::new() }; 3];
    for list in &mut lists {
        let count = section.gamma(&mut counts);
        if count == 0 || count > vertices as i64 {
            return Err(LATTICE);
        }
        let mut value = (section.raw(5) << 16) + section.raw(16) - LIMIT;
        if value <= -LIMIT {
            return Err(LATTICE);
        }
        let (mut near, mut far) = (0, 0);
        list.push(value);
        for _ in 1..count {
            let mut gap = 1;
            while gap <= 8 && section.decision(&mut longer[near][far][gap as usize - 1]) {
                gap += 1;
            }
            if gap == 9 {
                gap += section.gamma(&mut escaped);
            }
            value += gap;
            list.push(value);
            (near, far) = (gap.min(8) as usize, near);
        }
        if list.iter().any(|&value| value >= LIMIT) {
            return Err(LATTICE);
        }
    }
    Ok(lists)
}

impl Geometry<'_, '_> {
    fn position(&self, vertex: usize) -> Option<[i64; 3]> {
        self.states[vertex].position
    }

    fn is_open(&self, vertex: usize) -> bool {
        self.position(vertex).is_none() && !self.walk.conquest.vertices[vertex].dummy
    }

    /// r[intra.geometry.order]
    fn next_vertex(&mut self) -> Option<usize> {
        for queue in (0..4).rev() {
            while let Some(vertex) = self.queues[queue].pop_front() {
                if self.is_open(vertex) {
                    return Some(vertex);
                }
            }
        }
        (0..self.states.len()).find(|&vertex| self.is_open(vertex))
    }

    fn settle(&mut self, vertex: usize) {
        let (walk, conquest) = (self.walk, self.walk.conquest);
        for &h in &walk.around[vertex] {
            let others = [conquest.end(h), conquest.start(prev(h))];
            if others.iter().any(|&other| self.position(other).is_none()) {
                continue;
            }
            for side in [h, next(h), prev(h)] {
                let tip = conquest.across(side);
                if self.is_open(tip) {
                    self.states[tip].support += 1;
                    self.queues[self.states[tip].support.min(3)].push_back(tip);
                }
            }
        }
    }

    /// Decodes a vertex and settles it with its twins.
    fn vertex(&mut self, vertex: usize) -> Result<[i64; 3], Rule> {
        let ring = self.ring(vertex);
        let (position, error) = if ring.triples > 0 {
            let valence = self.walk.conquest.vertices[vertex].valence;
            self.supported(&ring, valence)?
        } else {
            let expected = match ring.base {
                Some(base) => ring.centre(base),
                None => self.last,
            };
            (self.alone(expected)?, 0)
        };
        self.last = position;
        for twin in self.walk.conquest.twins(vertex) {
            self.states[twin].position = Some(position);
            self.states[twin].error = error;
            self.settle(twin);
        }
        Ok(position)
    }

    /// r[intra.geometry.ring]
    fn ring(&self, vertex: usize) -> Ring {
        let (walk, conquest) = (self.walk, self.walk.conquest);
        let mut ring = Ring::default();
        for &h in walk.around[vertex].iter().take(32) {
            let [a, b, c] = [conquest.end(h), conquest.start(prev(h)), conquest.across(next(h))];
            let Some(at_a) = self.position(a) else { continue };
            ring.add_neighbour(at_a, self.states[a].error);
            if let (Some(at_b), Some(at_c)) = (self.position(b), self.position(c)) {
                let valence = |v: usize| conquest.vertices[v].valence.min(64);
                ring.add_triple([at_a, at_b, at_c], valence(a) - valence(b));
            }
        }
        ring
    }

    /// r[intra.geometry.coordinate], r[intra.geometry.learn]: a position and its stored error.
    fn supported(&mut self, ring: &Ring, valence: i64) -> Result<([i64; 3], i64), Rule> {
        let base = ring.base.unwrap_or_default();
        let offset = blended(ring, valence);
        let frame = Frame::new(ring, valence, &self.means);
        let mut position = [0; 3];
        let mut errors = [0; 3];
        for place in 0..3 {
            let axis = frame.axes[place];
            let (mean, context) = frame.expect(place, errors);
            let exact = offset[axis] + mean;
            let near = (exact + 32) >> 6;
            let lean = (3 * (exact - 64 * near + 32)) >> 6;
            let models = &mut self.coordinates[48 * place + context];
            let error = error_value(&mut self.section, models, lean as usize);
            position[axis] = (base[axis] + near).clamp(-LIMIT, LIMIT) + error;
            if position[axis].abs() >= LIMIT {
                return Err(RANGE);
            }
            errors[axis] = 64 * (position[axis] - base[axis]) - offset[axis];
        }
        Ok((position, frame.learn(errors, &mut self.means)))
    }

    /// r[intra.geometry.unsupported], r[intra.geometry.isolated]
    fn alone(&mut self, expected: [i64; 3]) -> Result<[i64; 3], Rule> {
        let mut position = [0; 3];
        for axis in 0..3 {
            let error = error_value(&mut self.section, &mut self.unsupported, 1);
            position[axis] = expected[axis] + error;
            if position[axis].abs() >= LIMIT {
                return Err(RANGE);
            }
        }
        self.last = position;
        Ok(position)
    }
}

fn error_value(section: &mut Section<'_>, models: &mut ErrorModels, lean: usize) -> i64 {
    if section.decision(&mut models.is_zero) {
        return 0;
    }
    let negative = section.decision(&mut models.is_negative[lean]);
    let mut n = 0;
    while n < 22 && section.decision(&mut models.longer[n]) {
        n += 1;
    }
    let mut value = 1;
    if n >= 1 {
        let s = section.decision(&mut models.second[n]);
        value = 2 * value + i64::from(s);
        if n >= 2 {
            value = 2 * value + i64::from(section.decision(&mut models.third[n][usize::from(s)]));
        }
    }
    let r = n.saturating_sub(2) as u32;
    let k = r.saturating_sub(16);
    value = (value << k) + section.raw(k);
    value = (value << (r - k)) + section.raw(r - k);
    if negative { -value } else { value }
}
