//! Edges with the half-edges on them.

use super::Rows;

/// All edges of a mesh with the half-edges on them.
///
/// Half-edge `3·f + k` runs from corner `k` of face `f` to its next corner. A face that repeats
/// a vertex contributes its half-edges between different vertices only.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EdgeTable {
    /// `#E × 2` vertices, the lower first, edges in ascending order.
    pub edges: Vec<[u32; 2]>,
    /// The half-edges on every edge, ascending: one on a boundary, two inside, more where the
    /// mesh is not a manifold.
    pub half_edges: Rows,
}

impl EdgeTable {
    /// Collects the edges of `faces` (`#F × 3`).
    pub fn new(vertex_count: usize, faces: &[[u32; 3]]) -> Self {
        // By lower vertex: the higher vertex and the half-edge in one number, which sorts fast.
        let sides = (0..).zip(faces).flat_map(|(face, &[a, b, c]): (u32, _)| {
            [[a, b], [b, c], [c, a]].into_iter().zip(3 * face..).filter_map(|([from, to], h)| {
                let key = u64::from(from.max(to)) << 32 | u64::from(h);
                (from != to).then_some((from.min(to), key))
            })
        });
        let mut sides = Rows::collect(vertex_count, sides);

        let mut table = Self::default();
        table.edges.reserve(sides.values.len() / 2);
        table.half_edges.offsets.reserve(sides.values.len() / 2 + 1);
        table.half_edges.values.reserve(sides.values.len());
        table.half_edges.restart();
        for low in 0..vertex_count {
            let sides = sides.row_mut(low);
            sides.sort_unstable();
            for on_edge in sides.chunk_by(|a, b| a >> 32 == b >> 32) {
                table.edges.push([low as u32, (on_edge[0] >> 32) as u32]);
                table.half_edges.values.extend(on_edge.iter().map(|&side| side as u32));
                table.half_edges.end_row();
            }
        }
        table
    }

    /// The edges at every vertex, in ascending order of the other vertex.
    pub fn of_vertices(&self, vertex_count: usize) -> Rows {
        let ends = self.edges.iter().zip(0u32..);
        Rows::collect(
            vertex_count,
            ends.flat_map(|(&[low, high], edge)| [(low, edge), (high, edge)]),
        )
    }

    /// The half-edges without a partner, ascending by edge.
    pub fn boundary(&self) -> impl Iterator<Item = u32> + Clone {
        self.half_edges.iter().filter(|on_edge| on_edge.len() == 1).map(|on_edge| on_edge[0])
    }

    /// `#V`, whether a vertex lies on an edge that only one face has.
    pub fn boundary_vertices(&self, vertex_count: usize) -> Vec<bool> {
        let mut boundary = vec![false; vertex_count];
        for (edge, on_edge) in self.edges.iter().zip(self.half_edges.iter()) {
            if on_edge.len() == 1 {
                edge.iter().for_each(|&vertex| boundary[vertex as usize] = true);
            }
        }
        boundary
    }

    /// The number of edges with one face.
    pub fn boundary_count(&self) -> usize {
        self.boundary().count()
    }

    /// The number of edges with three faces or more.
    pub fn non_manifold_count(&self) -> usize {
        self.half_edges.iter().filter(|on_edge| on_edge.len() > 2).count()
    }
}

/// The two ends of half-edge `3·f + k`, in the direction of its face.
#[inline]
pub fn half_edge_ends(faces: &[[u32; 3]], half_edge: u32) -> [u32; 2] {
    let face = faces[half_edge as usize / 3];
    let corner = half_edge as usize % 3;
    [face[corner], face[(corner + 1) % 3]]
}

#[cfg(test)]
mod tests {
    use super::super::tests::faces;
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    #[test]
    fn inconsistent_faces_share_a_non_manifold_edge() {
        let faces = [[0, 1, 2], [1, 0, 3], [0, 1, 4]];
        let table = EdgeTable::new(5, &faces);
        assert_eq!((table.boundary_count(), table.non_manifold_count()), (6, 1));
        assert_eq!(table.half_edges.row(0), [0, 3, 6]);
        assert_eq!(table.boundary_vertices(6), [true, true, true, true, true, false]);
    }

    proptest! {
        #[test]
        fn tables_agree_with_maps(faces in faces()) {
            let mut by_edge = BTreeMap::<[u32; 2], Vec<u32>>::new();
            for half_edge in 0..3 * faces.len() as u32 {
                let [a, b] = half_edge_ends(&faces, half_edge);
                if a != b {
                    by_edge.entry([a.min(b), a.max(b)]).or_default().push(half_edge);
                }
            }
            let table = EdgeTable::new(12, &faces);
            prop_assert_eq!(&table.edges, &by_edge.keys().copied().collect::<Vec<_>>());
            for (row, half_edges) in by_edge.values().enumerate() {
                prop_assert_eq!(table.half_edges.row(row), &half_edges[..]);
            }
            prop_assert_eq!(table.half_edges.len(), by_edge.len());
            let neighbours = super::super::vertex_neighbours(12, &faces);
            for (vertex, edges) in table.of_vertices(12).iter().enumerate() {
                let other = |&e: &u32| table.edges[e as usize].into_iter().sum::<u32>() - vertex as u32;
                let others: Vec<u32> = edges.iter().map(other).collect();
                prop_assert_eq!(&others[..], neighbours.row(vertex));
            }
        }
    }
}
