//! The rings of neighbours around all vertices, which the coding of positions and labels walks
//! over. They are built once the connectivity is known, with cut vertices joined.

use super::conquest::{Conquest, next, prev};
use kn_mesh::adjacency::Rows;

/// Largest valence that is stored; larger ones count as this one.
const MOST_VALENCE: u32 = 64;

/// A neighbour on a vertex's ring, and the vertex behind the triangle between it and the next one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Spoke {
    pub(super) neighbour: u32,
    /// The tip of the triangle across the edge from this neighbour to the next.
    pub(super) across: u32,
}

/// The connectivity, as the coding of positions and labels uses it.
#[derive(Clone, Debug, Default)]
pub(super) struct Surface {
    /// `#M` rows: the ring of each vertex. Dummies have none.
    spokes: Rows<Spoke>,
    /// `#M` valence, 64 where it is larger; 0 for a dummy.
    valence: Vec<u8>,
    /// `#M` the next vertex that is the same point; itself where none is.
    pub(super) twin: Vec<u32>,
}

impl Surface {
    /// Starts over with the vertices of `conquest`, none of them tied to another.
    pub(super) fn restart(&mut self, conquest: &Conquest) {
        self.spokes.restart();
        self.valence.clear();
        self.twin.clear();
        self.spokes.offsets.reserve(conquest.vertices.len());
        self.spokes.values.reserve(conquest.edges.len());
        self.twin.extend(0..conquest.vertices.len() as u32);
        for vertex in &conquest.vertices {
            if !vertex.dummy {
                self.lay_ring(conquest, vertex.corner);
            }
            self.spokes.end_row();
            let valence = if vertex.dummy { 0 } else { vertex.valence.min(MOST_VALENCE) };
            self.valence.push(valence as u8);
        }
    }

    /// Half-edges that start from a vertex of a closed surface, from `first` once around.
    fn lay_ring(&mut self, conquest: &Conquest, first: u32) {
        let edges = &conquest.edges;
        let mut h = first;
        loop {
            let far = edges[next(h) as usize];
            let across = edges[prev(far.mate) as usize].origin;
            self.spokes.values.push(Spoke { neighbour: far.origin, across });
            h = edges[prev(h) as usize].mate;
            if h == first {
                break;
            }
        }
    }

    /// Number of vertices, dummies and copies included.
    #[inline]
    pub(super) fn vertices(&self) -> usize {
        self.valence.len()
    }

    /// The neighbours of a vertex, once around it.
    #[inline]
    pub(super) fn ring(&self, vertex: u32) -> &[Spoke] {
        self.spokes.row(vertex as usize)
    }

    /// Number of triangles around a vertex, at most 64.
    #[inline]
    pub(super) fn valence(&self, vertex: u32) -> u8 {
        self.valence[vertex as usize]
    }

    /// Whether the vertex stands for a hole.
    #[inline]
    pub(super) fn is_dummy(&self, vertex: u32) -> bool {
        self.valence[vertex as usize] == 0
    }
}
