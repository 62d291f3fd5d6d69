//! The conquest: closed surfaces grow triangle by triangle from a seed, along the active loops
//! that separate what is known from what is not (`spec/05-intra.md`). Encoder and decoder both
//! run it; the symbols say what the triangle behind the gate meets.

use kn_bitstream::rule::{self, Rule};

/// No half-edge, or no vertex.
pub(super) const NONE: u32 = u32::MAX;
/// Number of classes of lacking triangles in the choice of the next gate.
const URGENCIES: usize = 16;

/// The half-edge after `h` in its triangle.
#[inline]
pub(super) fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The half-edge before `h` in its triangle.
#[inline]
pub(super) fn prev(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

/// The third corner, the tip, of the triangle behind the gate a → b.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Symbol {
    /// A new vertex, with its number of triangles in all. A dummy stands for a hole.
    New { dummy: bool, valence: u32 },
    /// The end of the loop's next edge, which is closed with it.
    Right,
    /// The start of the loop's previous edge, which is closed with it.
    Left,
    /// Both: the loop has three edges and is gone.
    Close,
    /// The start of another edge of the same loop: so many edges on (or back, where negative).
    Split { steps: i32 },
    /// The start of any open half-edge, named by its number.
    Merge { edge: u32 },
}

/// Half-edge `3t + k` runs from corner `k` of triangle `t` to the next corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfEdge {
    /// Vertex that it starts from.
    pub(super) origin: u32,
    /// Half-edge on the other side; [`NONE`] on an active loop.
    pub(super) mate: u32,
    /// Neighbours on the active loop, for half-edges on one.
    after: u32,
    before: u32,
}

/// A vertex of the surfaces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    /// Triangles that it has in all.
    pub(super) valence: u32,
    /// Triangles that it still lacks.
    lacking: u32,
    /// The first half-edge that started from it.
    pub(super) corner: u32,
    /// Whether it stands for a hole.
    pub(super) dummy: bool,
}

/// The known part of the surfaces, and its active loops.
#[derive(Clone, Debug, Default)]
pub(super) struct Conquest {
    /// `3#T`
    pub(super) edges: Vec<HalfEdge>,
    /// `#M`
    pub(super) vertices: Vec<Vertex>,
    /// Open half-edges by how few triangles their end lacks; entries may be out of date.
    waiting: [Vec<u32>; URGENCIES],
    /// No bucket of `waiting` below this one has entries.
    first_waiting: usize,
    /// Edges that splits have walked over, and triangles without a dummy.
    walked: u64,
    real_triangles: usize,
    /// Whether a vertex got more triangles than its valence.
    overfull: bool,
}

impl Conquest {
    /// Empties it and keeps the buffers.
    pub(super) fn clear(&mut self) {
        self.edges.clear();
        self.vertices.clear();
        self.waiting.iter_mut().for_each(Vec::clear);
        self.first_waiting = URGENCIES;
        self.walked = 0;
        self.real_triangles = 0;
        self.overfull = false;
    }

    /// Number of triangles, those of dummies included.
    #[inline]
    pub(super) fn triangles(&self) -> usize {
        self.edges.len() / 3
    }

    /// Number of triangles without a dummy.
    #[inline]
    pub(super) fn real_triangles(&self) -> usize {
        self.real_triangles
    }

    /// Whether every vertex has got exactly the triangles that its valence announced.
    pub(super) fn is_complete(&self) -> bool {
        !self.overfull && self.vertices.iter().all(|vertex| vertex.lacking == 0)
    }

    /// Starts a component with a triangle of three new vertices; every number is a valence.
    pub(super) fn seed(&mut self, valences: [u32; 3]) {
        let corners = valences.map(|valence| self.add_vertex(false, valence));
        let first = self.add_triangle(corners);
        for k in 0..3 {
            self.vertices[corners[k] as usize].corner = first + k as u32;
            self.link(first + k as u32, next(first + k as u32));
        }
        (first..first + 3).for_each(|h| self.wait(h));
    }

    /// The half-edge behind which the next triangle lies: one whose end lacked the fewest triangles
    /// when it came to wait, the last of these; `None` between components.
    #[inline]
    pub(super) fn gate(&mut self) -> Option<u32> {
        while self.first_waiting < URGENCIES {
            let Some(edge) = self.waiting[self.first_waiting].pop() else {
                self.first_waiting += 1;
                continue;
            };
            if self.edges[edge as usize].mate == NONE {
                return Some(edge);
            }
        }
        None
    }

    #[inline]
    fn urgency(&self, edge: u32) -> usize {
        (self.lacking(self.end(edge)) as usize).min(URGENCIES - 1)
    }

    #[inline]
    fn wait(&mut self, edge: u32) {
        let urgency = self.urgency(edge);
        self.waiting[urgency].push(edge);
        self.first_waiting = self.first_waiting.min(urgency);
    }

    /// Edge of the active loop after `edge`.
    #[inline]
    pub(super) fn after(&self, edge: u32) -> u32 {
        self.edges[edge as usize].after
    }

    /// Edge of the active loop before `edge`.
    #[inline]
    pub(super) fn before(&self, edge: u32) -> u32 {
        self.edges[edge as usize].before
    }

    /// Vertex that a half-edge starts from.
    #[inline]
    pub(super) fn start(&self, edge: u32) -> u32 {
        self.edges[edge as usize].origin
    }

    /// Vertex that a half-edge ends at.
    #[inline]
    pub(super) fn end(&self, edge: u32) -> u32 {
        self.edges[next(edge) as usize].origin
    }

    /// Triangles that the vertex still lacks.
    #[inline]
    pub(super) fn lacking(&self, vertex: u32) -> u32 {
        self.vertices[vertex as usize].lacking
    }

    /// Whether the loop of `edge` has three edges.
    #[inline]
    pub(super) fn is_short(&self, edge: u32) -> bool {
        self.after(self.after(edge)) == self.before(edge)
    }

    /// Steps that splits may still walk. Where an encoder always goes the shorter way round, a
    /// split costs no more than its smaller part, and this is never short but for many handles.
    pub(super) fn walk_left(&self) -> u64 {
        (1024 + 64 * self.triangles() as u64).saturating_sub(self.walked)
    }

    /// Adds the triangle behind the gate. `Err` names the rule that the symbol breaks.
    pub(super) fn apply(&mut self, gate: u32, symbol: Symbol) -> Result<(), Rule> {
        match symbol {
            Symbol::New { dummy, valence } => self.apply_new(gate, dummy, valence),
            Symbol::Right => self.apply_right(gate)?,
            Symbol::Left => self.apply_left(gate)?,
            Symbol::Close => self.apply_close(gate)?,
            Symbol::Split { steps } => {
                let target = self.walk(gate, steps)?;
                self.apply_jump(gate, target)?;
            }
            Symbol::Merge { edge } => self.apply_jump(gate, edge)?,
        }
        Ok(())
    }

    fn apply_new(&mut self, gate: u32, dummy: bool, valence: u32) {
        let (before, after) = (self.before(gate), self.after(gate));
        let tip = self.add_vertex(dummy, valence);
        let triangle = self.add_behind(gate, tip);
        self.vertices[tip as usize].corner = triangle + 2;
        self.link(before, triangle + 1);
        self.link(triangle + 1, triangle + 2);
        self.link(triangle + 2, after);
        self.wait(before);
        self.wait(triangle + 1);
        self.wait(triangle + 2);
    }

    fn apply_right(&mut self, gate: u32) -> Result<(), Rule> {
        let (before, closed) = (self.before(gate), self.after(gate));
        let after = self.after(closed);
        let tip = self.end(closed);
        self.require_corner(gate, tip)?;
        let triangle = self.add_behind(gate, tip);
        self.pair(triangle + 2, closed);
        self.link(before, triangle + 1);
        self.link(triangle + 1, after);
        self.wait(before);
        self.wait(triangle + 1);
        Ok(())
    }

    fn apply_left(&mut self, gate: u32) -> Result<(), Rule> {
        let (closed, after) = (self.before(gate), self.after(gate));
        let before = self.before(closed);
        let tip = self.start(closed);
        self.require_corner(gate, tip)?;
        let triangle = self.add_behind(gate, tip);
        self.pair(triangle + 1, closed);
        self.link(before, triangle + 2);
        self.link(triangle + 2, after);
        self.wait(before);
        self.wait(triangle + 2);
        Ok(())
    }

    fn apply_close(&mut self, gate: u32) -> Result<(), Rule> {
        if !self.is_short(gate) {
            return Err(rule::INTRA_CONNECTIVITY_CLOSE);
        }
        let (before, after) = (self.before(gate), self.after(gate));
        let tip = self.start(before);
        self.require_corner(gate, tip)?;
        let triangle = self.add_behind(gate, tip);
        self.pair(triangle + 1, before);
        self.pair(triangle + 2, after);
        Ok(())
    }

    /// The tip is the start of open half-edge `target`: on the gate's own loop, this becomes two;
    /// on another, the two become one.
    fn apply_jump(&mut self, gate: u32, target: u32) -> Result<(), Rule> {
        if self.edges.get(target as usize).map(|edge| edge.mate) != Some(NONE) {
            return Err(rule::INTRA_CONNECTIVITY_MERGE);
        }
        let tip = self.start(target);
        self.require_corner(gate, tip)?;
        let (before, after, last) = (self.before(gate), self.after(gate), self.before(target));
        let triangle = self.add_behind(gate, tip);
        self.link(triangle + 1, target);
        self.link(before, triangle + 1);
        self.link(triangle + 2, after);
        self.link(last, triangle + 2);
        self.wait(before);
        self.wait(last);
        self.wait(triangle + 1);
        self.wait(triangle + 2);
        Ok(())
    }

    /// A triangle has three different vertices, and a tip at the gate's own ends would not do.
    fn require_corner(&self, gate: u32, tip: u32) -> Result<(), Rule> {
        let free = tip != self.start(gate) && tip != self.end(gate);
        if free { Ok(()) } else { Err(rule::INTRA_CONNECTIVITY_TIP) }
    }

    fn walk(&mut self, gate: u32, steps: i32) -> Result<u32, Rule> {
        let length = u64::from(steps.unsigned_abs());
        if length > self.walk_left() {
            return Err(rule::INTRA_CONNECTIVITY_SPLIT);
        }
        self.walked += length;
        let mut edge = gate;
        for _ in 0..length {
            edge = if steps > 0 { self.after(edge) } else { self.before(edge) };
        }
        Ok(edge)
    }

    fn add_vertex(&mut self, dummy: bool, valence: u32) -> u32 {
        self.vertices.push(Vertex { valence, lacking: valence, corner: NONE, dummy });
        self.vertices.len() as u32 - 1
    }

    /// The triangle (b, a, tip) behind gate a → b: half-edges b → a, a → tip, tip → b.
    #[inline]
    fn add_behind(&mut self, gate: u32, tip: u32) -> u32 {
        let triangle = self.add_triangle([self.end(gate), self.start(gate), tip]);
        self.pair(triangle, gate);
        triangle
    }

    #[inline]
    fn add_triangle(&mut self, corners: [u32; 3]) -> u32 {
        let first = self.edges.len() as u32;
        let open = |origin| HalfEdge { origin, mate: NONE, after: NONE, before: NONE };
        self.edges.extend_from_slice(&corners.map(open));
        let mut real = true;
        for corner in corners {
            let vertex = &mut self.vertices[corner as usize];
            self.overfull |= vertex.lacking == 0;
            vertex.lacking = vertex.lacking.saturating_sub(1);
            real &= !vertex.dummy;
        }
        self.real_triangles += usize::from(real);
        first
    }

    #[inline]
    fn pair(&mut self, g: u32, h: u32) {
        self.edges[g as usize].mate = h;
        self.edges[h as usize].mate = g;
    }

    #[inline]
    fn link(&mut self, edge: u32, after: u32) {
        self.edges[edge as usize].after = after;
        self.edges[after as usize].before = edge;
    }
}
