//! Who touches whom in a triangle mesh: faces and neighbours of a vertex, edges, components,
//! boundary loops. Everything is built by counting sort, in time linear in `#V + #F`, and comes
//! in an order that depends on the mesh alone.
//!
//! Faces must index inside `0..vertex_count` (see [`Mesh::check`](crate::Mesh::check)).

/// Lists of indices, one per row, in one allocation (compressed sparse rows).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rows {
    /// `#rows + 1` starts into `values`, ascending; the first is 0.
    pub offsets: Vec<u32>,
    /// The rows one after the other.
    pub values: Vec<u32>,
}

impl Rows {
    /// The indices of one row.
    pub fn row(&self, row: usize) -> &[u32] {
        &self.values[self.offsets[row] as usize..self.offsets[row + 1] as usize]
    }

    /// The number of rows.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Whether there is no row at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All rows in order.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> + Clone {
        (0..self.len()).map(|row| self.row(row))
    }

    /// Sorts `(row, value)` pairs into rows; the pairs keep their order inside a row.
    pub(crate) fn collect(
        row_count: usize,
        pairs: impl Iterator<Item = (u32, u32)> + Clone,
    ) -> Self {
        let mut offsets = vec![0u32; row_count + 1];
        for (row, _) in pairs.clone() {
            offsets[row as usize + 1] += 1;
        }
        for row in 0..row_count {
            offsets[row + 1] += offsets[row];
        }
        let mut next = offsets.clone();
        let mut values = vec![0; offsets[row_count] as usize];
        for (row, value) in pairs {
            values[next[row as usize] as usize] = value;
            next[row as usize] += 1;
        }
        Self { offsets, values }
    }

    /// The same rows, each sorted and without repeated values.
    fn sorted_and_deduped(mut self) -> Self {
        let mut unique =
            Self { offsets: vec![0], values: Vec::with_capacity(self.values.len() / 2 + 1) };
        for row in 0..self.len() {
            let range = self.offsets[row] as usize..self.offsets[row + 1] as usize;
            self.values[range.clone()].sort_unstable();
            let start = unique.values.len();
            for &value in &self.values[range] {
                if unique.values[start..].last() != Some(&value) {
                    unique.values.push(value);
                }
            }
            unique.offsets.push(unique.values.len() as u32);
        }
        unique
    }
}

/// The faces around every vertex, ascending; a face that repeats a vertex is listed once.
pub fn vertex_faces(vertex_count: usize, faces: &[[u32; 3]]) -> Rows {
    let corners = faces.iter().zip(0u32..).flat_map(|(&[a, b, c], face)| {
        [Some(a), (b != a).then_some(b), (c != a && c != b).then_some(c)]
            .into_iter()
            .flatten()
            .map(move |vertex| (vertex, face))
    });
    Rows::collect(vertex_count, corners)
}

/// The vertices that share an edge with every vertex, ascending, each once.
pub fn vertex_neighbours(vertex_count: usize, faces: &[[u32; 3]]) -> Rows {
    let pairs = faces
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, a), (b, c), (c, b), (c, a), (a, c)])
        .filter(|(from, to)| from != to);
    Rows::collect(vertex_count, pairs).sorted_and_deduped()
}

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
        let ends = |half_edge: u32| half_edge_of(faces, half_edge);
        let all = (0..3 * faces.len() as u32).filter(|&half_edge| {
            let [from, to] = ends(half_edge);
            from != to
        });
        // Two stable passes of counting sort order the half-edges by (lower, higher) vertex.
        let by_high = Rows::collect(vertex_count, all.map(|h| (higher(ends(h)), h)));
        let order = by_high.values.iter().map(|&h| (lower(ends(h)), h));
        let sorted = Rows::collect(vertex_count, order).values;

        let mut table = Self::default();
        table.half_edges.offsets.push(0);
        for (at, &half_edge) in sorted.iter().enumerate() {
            let [from, to] = ends(half_edge);
            let edge = [from.min(to), from.max(to)];
            if table.edges.last() != Some(&edge) {
                table.edges.push(edge);
                table.half_edges.offsets.push(0);
            }
            if let Some(end) = table.half_edges.offsets.last_mut() {
                *end = at as u32 + 1;
            }
        }
        table.half_edges.values = sorted;
        table
    }

    /// The half-edges without a partner, ascending by edge.
    pub fn boundary(&self) -> impl Iterator<Item = u32> + Clone {
        self.half_edges.iter().filter(|on_edge| on_edge.len() == 1).map(|on_edge| on_edge[0])
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
pub fn half_edge_of(faces: &[[u32; 3]], half_edge: u32) -> [u32; 2] {
    let face = faces[half_edge as usize / 3];
    let corner = half_edge as usize % 3;
    [face[corner], face[(corner + 1) % 3]]
}

fn lower([from, to]: [u32; 2]) -> u32 {
    from.min(to)
}

fn higher([from, to]: [u32; 2]) -> u32 {
    from.max(to)
}

/// The connected components of a mesh; two faces that share a vertex are connected.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Components {
    /// `#V` component numbers, in the order of their lowest vertex; [`Components::ISOLATED`] for
    /// vertices without a face.
    pub of_vertex: Vec<u32>,
    /// The number of components; isolated vertices are not counted.
    pub count: usize,
}

impl Components {
    /// The component number of a vertex that no face uses.
    pub const ISOLATED: u32 = u32::MAX;

    /// Finds the components of `faces` (`#F × 3`).
    pub fn new(vertex_count: usize, faces: &[[u32; 3]]) -> Self {
        let mut parent: Vec<u32> = (0..vertex_count as u32).collect();
        let mut of_vertex = vec![Self::ISOLATED; vertex_count];
        for &[a, b, c] in faces {
            union(&mut parent, a, b);
            union(&mut parent, a, c);
            for vertex in [a, b, c] {
                of_vertex[vertex as usize] = 0;
            }
        }
        let mut count = 0;
        for vertex in 0..vertex_count {
            if of_vertex[vertex] == Self::ISOLATED {
                continue;
            }
            // The root is the lowest vertex of its component, so it has its number already.
            let root = find(&mut parent, vertex as u32) as usize;
            if root == vertex {
                of_vertex[vertex] = count;
                count += 1;
            } else {
                of_vertex[vertex] = of_vertex[root];
            }
        }
        Self { of_vertex, count: count as usize }
    }

    /// The number of vertices that no face uses.
    pub fn isolated_count(&self) -> usize {
        self.of_vertex.iter().filter(|&&component| component == Self::ISOLATED).count()
    }
}

/// The lowest vertex of the set of `vertex`; halves the path on the way.
fn find(parent: &mut [u32], mut vertex: u32) -> u32 {
    while parent[vertex as usize] != vertex {
        parent[vertex as usize] = parent[parent[vertex as usize] as usize];
        vertex = parent[vertex as usize];
    }
    vertex
}

fn union(parent: &mut [u32], a: u32, b: u32) {
    let (a, b) = (find(parent, a), find(parent, b));
    parent[a.max(b) as usize] = a.min(b);
}

/// A chain of boundary edges.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BoundaryLoop {
    /// The vertices in the direction of the faces beside them.
    pub vertices: Vec<u32>,
    /// Whether the last vertex leads back to the first. Only non-manifold or inconsistently
    /// oriented meshes have chains that do not close.
    pub closed: bool,
}

/// The boundary of a mesh as chains of vertices; every boundary edge belongs to exactly one.
///
/// Where several boundary edges leave a vertex (a pinched boundary) the one to the lowest
/// vertex is taken first.
pub fn boundary_loops(
    vertex_count: usize,
    faces: &[[u32; 3]],
    edges: &EdgeTable,
) -> Vec<BoundaryLoop> {
    let directed = edges.boundary().map(|half_edge| {
        let [from, to] = half_edge_of(faces, half_edge);
        (from, to)
    });
    let mut leaving = Rows::collect(vertex_count, directed.clone());
    let arriving = Rows::collect(vertex_count, directed.map(|(from, to)| (to, from)));
    for row in 0..vertex_count {
        let range = leaving.offsets[row] as usize..leaving.offsets[row + 1] as usize;
        leaving.values[range].sort_unstable();
    }

    let mut used = vec![0u32; vertex_count];
    let mut loops = Vec::new();
    // Chains that do not close start where more edges leave than arrive; they are walked first,
    // so that the rest is all closed loops.
    let surplus = |v: usize| leaving.row(v).len().saturating_sub(arriving.row(v).len());
    for start in 0..vertex_count {
        for _ in 0..surplus(start) {
            loops.push(walk(start as u32, &leaving, &mut used, false));
        }
    }
    for start in 0..vertex_count {
        while (used[start] as usize) < leaving.row(start).len() {
            loops.push(walk(start as u32, &leaving, &mut used, true));
        }
    }
    loops
}

/// Follows unused boundary edges from `start` until they end or, if `close`, come back.
fn walk(start: u32, leaving: &Rows, used: &mut [u32], close: bool) -> BoundaryLoop {
    let mut vertices = vec![start];
    let mut at = start;
    while let Some(&next) = leaving.row(at as usize).get(used[at as usize] as usize) {
        used[at as usize] += 1;
        at = next;
        if close && at == start {
            return BoundaryLoop { vertices, closed: true };
        }
        vertices.push(at);
    }
    BoundaryLoop { vertices, closed: false }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::{BTreeMap, BTreeSet};

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];

    #[test]
    fn a_tetrahedron_is_closed() {
        let table = EdgeTable::new(4, &TETRAHEDRON);
        assert_eq!(table.edges, [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]);
        assert_eq!((table.boundary_count(), table.non_manifold_count()), (0, 0));
        assert_eq!(vertex_faces(4, &TETRAHEDRON).row(3), [1, 2, 3]);
        assert_eq!(vertex_neighbours(4, &TETRAHEDRON).row(1), [0, 2, 3]);
        assert!(boundary_loops(4, &TETRAHEDRON, &table).is_empty());
    }

    #[test]
    fn components_are_numbered_by_their_lowest_vertex() {
        let components = Components::new(8, &[[7, 5, 6], [0, 3, 1]]);
        let lone = Components::ISOLATED;
        assert_eq!(components.of_vertex, [0, 0, lone, 0, lone, 1, 1, 1]);
        assert_eq!((components.count, components.isolated_count()), (2, 2));
    }

    #[test]
    fn a_pinched_boundary_splits_into_closed_loops() {
        let faces = [[0, 1, 2], [0, 3, 4]];
        let loops = boundary_loops(5, &faces, &EdgeTable::new(5, &faces));
        let closed = |vertices: &[u32]| BoundaryLoop { vertices: vertices.to_vec(), closed: true };
        assert_eq!(loops, [closed(&[0, 1, 2]), closed(&[0, 3, 4])]);
    }

    #[test]
    fn inconsistent_faces_leave_open_chains() {
        let faces = [[0, 1, 2], [1, 0, 3], [0, 1, 4]];
        let table = EdgeTable::new(5, &faces);
        assert_eq!((table.boundary_count(), table.non_manifold_count()), (6, 1));
        let loops = boundary_loops(5, &faces, &table);
        let edges: usize = loops.iter().map(|l| l.vertices.len() - usize::from(!l.closed)).sum();
        assert_eq!(edges, 6, "every boundary edge once: {loops:?}");
    }

    fn faces() -> impl Strategy<Value = Vec<[u32; 3]>> {
        prop::collection::vec([0u32..12, 0..12, 0..12], 0..40)
    }

    proptest! {
        #[test]
        fn tables_agree_with_sets(faces in faces()) {
            let mut by_edge = BTreeMap::<[u32; 2], Vec<u32>>::new();
            let mut around = vec![BTreeSet::new(); 12];
            let mut neighbours = vec![BTreeSet::new(); 12];
            for half_edge in 0..3 * faces.len() as u32 {
                let [a, b] = half_edge_of(&faces, half_edge);
                around[a as usize].insert(half_edge / 3);
                if a != b {
                    by_edge.entry([a.min(b), a.max(b)]).or_default().push(half_edge);
                    neighbours[a as usize].insert(b);
                    neighbours[b as usize].insert(a);
                }
            }
            let table = EdgeTable::new(12, &faces);
            prop_assert_eq!(&table.edges, &by_edge.keys().copied().collect::<Vec<_>>());
            for (row, half_edges) in by_edge.values().enumerate() {
                prop_assert_eq!(table.half_edges.row(row), &half_edges[..]);
            }
            let (vertex_faces, rings) = (vertex_faces(12, &faces), vertex_neighbours(12, &faces));
            for vertex in 0..12 {
                let expected: Vec<u32> = around[vertex].iter().copied().collect();
                prop_assert_eq!(vertex_faces.row(vertex), &expected[..]);
                let expected: Vec<u32> = neighbours[vertex].iter().copied().collect();
                prop_assert_eq!(rings.row(vertex), &expected[..]);
            }
        }

        #[test]
        fn loops_use_every_boundary_edge_once(faces in faces()) {
            let table = EdgeTable::new(12, &faces);
            let mut expected: Vec<[u32; 2]> =
                table.boundary().map(|half_edge| half_edge_of(&faces, half_edge)).collect();
            let mut walked = Vec::new();
            for chain in boundary_loops(12, &faces, &table) {
                walked.extend(chain.vertices.windows(2).map(|pair| [pair[0], pair[1]]));
                if let (true, Some(&last)) = (chain.closed, chain.vertices.last()) {
                    walked.push([last, chain.vertices[0]]);
                }
            }
            expected.sort_unstable();
            walked.sort_unstable();
            prop_assert_eq!(walked, expected);
        }
    }
}
