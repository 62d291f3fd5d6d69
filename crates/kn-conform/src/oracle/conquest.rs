//! 5.2: connectivity. Half-edges and vertices are plain numbers, as in the text.

use super::faces::{faces_of, read_joins};
use super::intra::Payload;
use super::range::{CONSUMED, Gamma, Model, Section};
use kn_bitstream::rule::{self, Rule};

pub(super) const NONE: usize = usize::MAX;

/// The state of a vertex in the conquest.
#[derive(Clone, Debug)]
pub(super) struct Vertex {
    pub(super) valence: i64,
    lacking: i64,
    pub(super) dummy: bool,
    /// The first half-edge that ever started from it.
    first: usize,
    /// The next in the cyclic list of its twins.
    pub(super) twin: usize,
    /// Number of the decoded vertex.
    pub(super) number: usize,
}

/// The triangles so far and the loops around them.
#[derive(Default)]
pub(super) struct Conquest {
    pub(super) vertices: Vec<Vertex>,
    pub(super) corners: Vec<[usize; 3]>,
    mate: Vec<usize>,
    after: Vec<usize>,
    before: Vec<usize>,
    stacks: [Vec<usize>; 16],
    walked: u64,
}

/// r[intra.connectivity.valence.code]
#[derive(Clone, Default)]
struct ValenceModels {
    is_six: Model,
    is_less: Model,
    less_than: [Model; 6],
    more_than: [Model; 16],
    escaped: Gamma,
}

#[derive(Default)]
struct Models {
    valence: [ValenceModels; 9],
    is_new: [[Model; 4]; 4],
    is_jump: Model,
    is_merge: Model,
    is_backward: Model,
    split_steps: Gamma,
    is_close: [Model; 2],
    is_right: Model,
    is_dummy: Model,
    dummy_valence: Gamma,
}

enum Symbol {
    New,
    Right,
    Left,
    Close,
    Jump(usize),
}

pub(super) fn next(h: usize) -> usize {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

pub(super) fn prev(h: usize) -> usize {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

impl Conquest {
    pub(super) fn start(&self, h: usize) -> usize {
        self.corners[h / 3][h % 3]
    }

    pub(super) fn end(&self, h: usize) -> usize {
        self.start(next(h))
    }

    /// The vertex on the other side of a half-edge.
    pub(super) fn across(&self, h: usize) -> usize {
        self.start(prev(self.mate[h]))
    }

    /// r[intra.geometry.around]
    pub(super) fn around(&self, vertex: usize) -> Vec<usize> {
        let first = self.vertices[vertex].first;
        let mut around = vec![first];
        let mut h = self.mate[prev(first)];
        while h != first {
            around.push(h);
            h = self.mate[prev(h)];
        }
        around
    }

    /// All vertices of the list that a vertex is in, from itself on.
    pub(super) fn twins(&self, vertex: usize) -> Vec<usize> {
        let mut twins = vec![vertex];
        let mut twin = self.vertices[vertex].twin;
        while twin != vertex {
            twins.push(twin);
            twin = self.vertices[twin].twin;
        }
        twins
    }

    fn link(&mut self, chain: &[usize]) {
        for pair in chain.windows(2) {
            self.after[pair[0]] = pair[1];
            self.before[pair[1]] = pair[0];
        }
    }

    fn wait(&mut self, h: usize) {
        let lacking = self.vertices[self.end(h)].lacking;
        self.stacks[lacking.min(15) as usize].push(h);
    }

    /// r[intra.connectivity.gate]
    fn gate(&mut self) -> Option<usize> {
        loop {
            let stack = self.stacks.iter().position(|stack| !stack.is_empty())?;
            let h = self.stacks[stack].pop()?;
            if self.mate[h] == NONE {
                return Some(h);
            }
        }
    }

    fn add_vertex(&mut self, valence: i64, dummy: bool, first: usize) -> usize {
        let twin = self.vertices.len();
        self.vertices.push(Vertex { valence, lacking: valence, dummy, first, twin, number: NONE });
        twin
    }

    /// A triangle, whose corners lack one less; its half-edges are open and in no loop yet.
    fn add_triangle(&mut self, corners: [usize; 3]) -> Result<usize, Rule> {
        let h = 3 * self.corners.len();
        self.corners.push(corners);
        for list in [&mut self.mate, &mut self.after, &mut self.before] {
            list.extend([NONE; 3]);
        }
        for corner in corners {
            self.vertices[corner].lacking -= 1;
            if self.vertices[corner].lacking < 0 {
                return Err(rule::INTRA_CONNECTIVITY_VALENCE);
            }
        }
        Ok(h)
    }

    fn join(&mut self, g: usize, h: usize) {
        self.mate[g] = h;
        self.mate[h] = g;
    }

    /// r[intra.connectivity.add]
    fn apply(&mut self, gate: usize, symbol: &Symbol, tip: usize) -> Result<(), Rule> {
        let (a, b) = (self.start(gate), self.end(gate));
        if tip == a || tip == b {
            return Err(rule::INTRA_CONNECTIVITY_TIP);
        }
        let (x, y) = (self.before[gate], self.after[gate]);
        let first = self.add_triangle([b, a, tip])?;
        let (g1, g2) = (first + 1, first + 2);
        self.join(gate, first);
        let waiting = match *symbol {
            Symbol::New => {
                self.link(&[x, g1, g2, y]);
                vec![x, g1, g2]
            }
            Symbol::Right => {
                self.join(g2, y);
                self.link(&[x, g1, self.after[y]]);
                vec![x, g1]
            }
            Symbol::Left => {
                self.join(g1, x);
                let before_x = self.before[x];
                self.link(&[before_x, g2, y]);
                vec![before_x, g2]
            }
            Symbol::Close => {
                self.join(g1, x);
                self.join(g2, y);
                vec![]
            }
            Symbol::Jump(e) => {
                let before_e = self.before[e];
                self.link(&[x, g1, e]);
                self.link(&[before_e, g2, y]);
                vec![x, before_e, g1, g2]
            }
        };
        waiting.into_iter().for_each(|h| self.wait(h));
        Ok(())
    }

    /// r[intra.connectivity.symbol]
    fn symbol(
        &mut self,
        gate: usize,
        models: &mut Models,
        section: &mut Section<'_>,
    ) -> Result<Symbol, Rule> {
        let lacking = |v: usize| self.vertices[v].lacking;
        let (a, b) = (lacking(self.start(gate)), lacking(self.end(gate)));
        let short = self.after[self.after[gate]] == self.before[gate];
        let class = |n: i64| (n - 2).clamp(0, 3) as usize;
        if a == 1 || b == 1 {
            let third = lacking(self.end(self.after[gate]));
            let ones = [a, b, third].iter().filter(|&&n| n == 1).count();
            if short && (ones >= 2 || section.decision(&mut models.is_close[0])) {
                return Ok(Symbol::Close);
            }
            return Ok(if b == 1 { Symbol::Right } else { Symbol::Left });
        }
        Ok(if section.decision(&mut models.is_new[class(b)][class(a)]) {
            Symbol::New
        } else if section.decision(&mut models.is_jump) {
            Symbol::Jump(self.jump(gate, models, section)?)
        } else if section.decision(&mut models.is_close[1]) {
            if !short {
                return Err(rule::INTRA_CONNECTIVITY_CLOSE);
            }
            Symbol::Close
        } else if section.decision(&mut models.is_right) {
            Symbol::Right
        } else {
            Symbol::Left
        })
    }

    /// The half-edge that a jump goes to.
    fn jump(
        &mut self,
        gate: usize,
        models: &mut Models,
        section: &mut Section<'_>,
    ) -> Result<usize, Rule> {
        if section.decision(&mut models.is_merge) {
            let e = ((section.raw(16) << 16) + section.raw(16)) as usize;
            let open = self.mate.get(e) == Some(&NONE);
            return if open { Ok(e) } else { Err(rule::INTRA_CONNECTIVITY_MERGE) };
        }
        let steps = section.gamma(&mut models.split_steps) as u64;
        let backward = section.decision(&mut models.is_backward);
        self.walked += steps;
        if self.walked > 1024 + 64 * self.corners.len() as u64 {
            return Err(rule::INTRA_CONNECTIVITY_SPLIT);
        }
        let links = if backward { &self.before } else { &self.after };
        Ok((0..steps).fold(gate, |h, _| links[h]))
    }

    /// r[intra.connectivity.new]
    fn new_vertex(&mut self, gate: usize, models: &mut Models, section: &mut Section<'_>) -> usize {
        let [a, b] = [self.start(gate), self.end(gate)].map(|v| &self.vertices[v]);
        let context = ((a.valence + b.valence).clamp(8, 16) - 8) as usize;
        let dummy = !a.dummy && !b.dummy && section.decision(&mut models.is_dummy);
        let valence = if dummy {
            section.gamma(&mut models.dummy_valence)
        } else {
            read_valence(&mut models.valence[context], section)
        };
        let g2 = 3 * self.corners.len() + 2;
        self.add_vertex(valence, dummy, g2)
    }

    fn seed(&mut self, models: &mut Models, section: &mut Section<'_>) -> Result<(), Rule> {
        let h = 3 * self.corners.len();
        let corners = [0, 1, 2].map(|k| {
            let valence = read_valence(&mut models.valence[4], section);
            self.add_vertex(valence, false, h + k)
        });
        self.add_triangle(corners)?;
        self.link(&[h, h + 1, h + 2, h]);
        (h..h + 3).for_each(|h| self.wait(h));
        Ok(())
    }
}

fn read_valence(models: &mut ValenceModels, section: &mut Section<'_>) -> i64 {
    if section.decision(&mut models.is_six) {
        return 6;
    }
    if section.decision(&mut models.is_less) {
        let mut v = 5;
        while v > 1 && section.decision(&mut models.less_than[v]) {
            v -= 1;
        }
        return v as i64;
    }
    let mut v = 7;
    while v < 16 && section.decision(&mut models.more_than[v]) {
        v += 1;
    }
    if v < 16 { v as i64 } else { 16 + section.gamma(&mut models.escaped) }
}

/// The connectivity section: the conquest with its vertices numbered, and the faces.
pub(super) fn connectivity(
    bytes: &[u8],
    payload: &Payload<'_>,
) -> Result<(Conquest, Vec<[u32; 3]>), Rule> {
    let mut section = Section::new(bytes);
    let decoded = conquered(&mut section, payload);
    if section.overrun() {
        return Err(CONSUMED);
    }
    let decoded = decoded?;
    section.finish()?;
    Ok(decoded)
}

fn conquered(
    section: &mut Section<'_>,
    payload: &Payload<'_>,
) -> Result<(Conquest, Vec<[u32; 3]>), Rule> {
    let (mut conquest, mut models) = (Conquest::default(), Models::default());
    let (mut faces, simple) = (0, payload.conquered);
    for _ in 0..payload.components {
        conquest.seed(&mut models, section)?;
        faces += 1;
        while let Some(gate) = conquest.gate() {
            let symbol = conquest.symbol(gate, &mut models, section)?;
            let tip = match symbol {
                Symbol::New => conquest.new_vertex(gate, &mut models, section),
                Symbol::Right => conquest.end(conquest.after[gate]),
                Symbol::Left | Symbol::Close => conquest.start(conquest.before[gate]),
                Symbol::Jump(e) => conquest.start(e),
            };
            conquest.apply(gate, &symbol, tip)?;
            let dummy = |v: &usize| conquest.vertices[*v].dummy;
            faces += u64::from(!conquest.corners[conquest.corners.len() - 1].iter().any(dummy));
            if faces > simple || conquest.corners.len() as u64 > 4 * simple {
                return Err(rule::INTRA_FACES_COUNT);
            }
        }
    }
    if faces != simple {
        return Err(rule::INTRA_FACES_COUNT);
    }
    if conquest.vertices.iter().any(|vertex| vertex.lacking != 0) {
        return Err(rule::INTRA_CONNECTIVITY_VALENCE);
    }
    read_joins(&mut conquest, payload.joins, section)?;
    let faces = faces_of(&conquest, payload, section)?;
    Ok((conquest, faces))
}
