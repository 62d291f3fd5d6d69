//! Adjacency in a triangle mesh: faces and neighbours of a vertex, edges, connected components.
//!
//! Everything is built by counting sort, in time linear in `#V + #F` (but for sorting the few
//! values of a row), and comes in an order that depends on the mesh alone. Faces must index inside
//! `0..vertex_count` (see [`Mesh::check`](crate::Mesh::check)).
//!
//! Two users keep another structure beside these: the intra coder's conquest and quadric decimation
//! change connectivity as they go, which takes mates of half-edges instead of rows.

mod components;
mod edges;
mod rows;
mod vertices;

pub use components::Components;
pub use edges::{EdgeTable, half_edge_ends};
pub use rows::Rows;
pub use vertices::{vertex_faces, vertex_links, vertex_neighbours};

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];

    #[test]
    fn a_tetrahedron_is_closed() {
        let table = EdgeTable::new(4, &TETRAHEDRON);
        assert_eq!(table.edges, [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]);
        assert_eq!((table.boundary_count(), table.non_manifold_count()), (0, 0));
        assert_eq!(vertex_faces(4, &TETRAHEDRON).row(3), [1, 2, 3]);
        assert_eq!(vertex_neighbours(4, &TETRAHEDRON).row(1), [0, 2, 3]);
    }

    /// Faces on twelve vertices, with repeated vertices and repeated faces among them.
    pub(super) fn faces() -> impl Strategy<Value = Vec<[u32; 3]>> {
        prop::collection::vec([0u32..12, 0..12, 0..12], 0..40)
    }
}
