//! Turns any list of triangles into closed, oriented, manifold surfaces, which the coder of
//! connectivity walks over (`spec/05-intra.md`, informative: an encoder may cut in its own way).
//!
//! Two half-edges are glued where exactly these two run along an edge, in opposite directions;
//! everything else is a cut. Then every fan of triangles around a vertex becomes a vertex of its
//! own, and every boundary loop is closed with triangles to a dummy vertex.

use super::conquest::{NONE, next, prev};
use kn_mesh::adjacency::Rows;

/// Closed surfaces, as half-edges with mates: cutting and closing them changes mates one by one,
/// which the rows of [`kn_mesh::adjacency`] cannot do. Half-edge `3f + k` runs from corner `k` of
/// triangle `f` to the next corner.
#[derive(Debug, Default)]
pub(super) struct ClosedMesh {
    /// `3#T` vertex that each half-edge starts from.
    pub(super) origin: Vec<u32>,
    /// `3#T` the half-edge on the other side.
    pub(super) mate: Vec<u32>,
    /// `#M` input vertex of each vertex; [`NONE`] for a dummy.
    pub(super) source: Vec<u32>,
    /// Triangles of the input; those behind are dummy triangles.
    pub(super) real_faces: usize,
    /// Edges along which more or fewer than two opposite half-edges met and that are no plain
    /// boundary.
    pub(super) cut_edges: usize,
}

impl ClosedMesh {
    /// Cuts and closes `faces` (no index twice in one face, all < `vertex_count`).
    pub(super) fn new(faces: &[[u32; 3]], vertex_count: usize) -> Self {
        let mut mesh = Self { real_faces: faces.len(), ..Self::default() };
        mesh.origin = faces.iter().flatten().copied().collect();
        mesh.glue(vertex_count);
        mesh.split_fans();
        mesh.close_boundaries();
        mesh
    }

    /// Whether the vertex stands for a hole.
    pub(super) fn is_dummy(&self, vertex: u32) -> bool {
        self.source[vertex as usize] == NONE
    }

    fn glue(&mut self, vertex_count: usize) {
        let by_lower_end = self.by_lower_end(vertex_count);
        self.mate = vec![NONE; self.origin.len()];
        let mut met = vec![Met::default(); vertex_count];
        for (low, half_edges) in by_lower_end.iter().enumerate() {
            for &h in half_edges {
                let (a, b) = (self.origin[h as usize], self.origin[next(h) as usize]);
                let met = &mut met[a.max(b) as usize];
                if met.low != low as u32 + 1 {
                    *met = Met { low: low as u32 + 1, first: h, seen: 0 };
                }
                met.seen += 1;
                match met.seen {
                    1 => {}
                    2 if self.origin[met.first as usize] != a => self.pair(h, met.first),
                    _ => self.cut(met),
                }
            }
        }
    }

    /// Half-edges by the lower of their two vertices, `#V` rows.
    fn by_lower_end(&self, vertex_count: usize) -> Rows {
        let low = |h: u32| self.origin[h as usize].min(self.origin[next(h) as usize]);
        Rows::collect(vertex_count, (0..self.origin.len() as u32).map(|h| (low(h), h)))
    }

    fn pair(&mut self, g: u32, h: u32) {
        self.mate[g as usize] = h;
        self.mate[h as usize] = g;
    }

    /// Unglues an edge that turned out to have other half-edges than one each way.
    fn cut(&mut self, met: &mut Met) {
        if met.seen == 2 || self.mate[met.first as usize] != NONE {
            self.cut_edges += 1;
        }
        // Three is «cut»: further half-edges of the edge stay unglued too.
        met.seen = 3;
        let mate = std::mem::replace(&mut self.mate[met.first as usize], NONE);
        if mate != NONE {
            self.mate[mate as usize] = NONE;
        }
    }

    /// Gives every fan of corners a vertex of its own. Before, `origin` holds input vertices.
    fn split_fans(&mut self) {
        let mut fan = vec![NONE; self.origin.len()];
        for h in 0..self.origin.len() as u32 {
            if fan[h as usize] != NONE {
                continue;
            }
            let vertex = self.source.len() as u32;
            self.source.push(self.origin[h as usize]);
            let mut at = h;
            while at != NONE && fan[at as usize] == NONE {
                fan[at as usize] = vertex;
                at = self.mate[prev(at) as usize];
            }
            let mut at = self.mate[h as usize];
            while at != NONE && fan[next(at) as usize] == NONE {
                fan[next(at) as usize] = vertex;
                at = self.mate[next(at) as usize];
            }
        }
        self.origin = fan;
    }

    /// Closes every boundary loop with a fan of triangles around a new dummy vertex.
    fn close_boundaries(&mut self) {
        let mut leaving = vec![NONE; self.source.len()];
        let open: Vec<u32> =
            (0..self.mate.len() as u32).filter(|&h| self.mate[h as usize] == NONE).collect();
        for &h in &open {
            leaving[self.origin[h as usize] as usize] = h;
        }
        for first in open {
            if self.mate[first as usize] != NONE {
                continue;
            }
            let dummy = self.source.len() as u32;
            self.source.push(NONE);
            let (mut h, first_spoke) = (first, self.origin.len() as u32 + 1);
            while self.mate[h as usize] == NONE {
                h = self.cap(h, dummy, &leaving);
            }
            // The loop's last spoke (dummy → first vertex) meets its first (first vertex → dummy).
            self.pair(self.origin.len() as u32 - 1, first_spoke);
        }
    }

    /// Adds the triangle between open half-edge `h` = u → v and the dummy; returns the open
    /// half-edge that leaves v.
    fn cap(&mut self, h: u32, dummy: u32, leaving: &[u32]) -> u32 {
        let (u, v) = (self.origin[h as usize], self.origin[next(h) as usize]);
        let base = self.origin.len() as u32;
        self.origin.extend([v, u, dummy]);
        self.mate.extend([NONE; 3]);
        self.pair(base, h);
        if base > 3 * self.real_faces as u32 && self.mate[base as usize - 1] == NONE {
            self.pair(base - 1, base + 1);
        }
        leaving[v as usize]
    }
}

/// The half-edges of one edge that were met while half-edges are sorted by their lower vertex.
#[derive(Clone, Copy, Debug, Default)]
struct Met {
    /// Lower vertex + 1.
    low: u32,
    first: u32,
    seen: u8,
}
