//! Selection of vertices and faces of a mesh with all its attributes. Welding, cleaning and
//! decimation use these functions, so that no other function of theirs has to know the attributes.

use crate::TriangleMesh;

/// The entry of a vertex map for a vertex that was dropped.
pub const DROPPED: u32 = u32::MAX;

/// The vertices of a mesh that are kept, and the number that each gets.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VertexMap {
    /// `#V of the input`: the vertex that each becomes, or [`DROPPED`].
    targets: Vec<u32>,
    /// `#V of the result`: the input vertex that each takes its position and attributes from.
    sources: Vec<u32>,
}

impl VertexMap {
    /// Keeps the vertices that `faces` use, in their order.
    ///
    /// # Panics
    /// Where a face uses a vertex that is not below `vertex_count`.
    pub fn of_used(vertex_count: usize, faces: &[[u32; 3]]) -> Self {
        let mut targets = vec![DROPPED; vertex_count];
        faces.as_flattened().iter().for_each(|&vertex| targets[vertex as usize] = 0);
        let mut sources = Vec::with_capacity(vertex_count);
        for (vertex, target) in targets.iter_mut().enumerate().filter(|(_, at)| **at != DROPPED) {
            *target = sources.len() as u32;
            sources.push(vertex as u32);
        }
        Self { targets, sources }
    }

    /// Merges vertices at exactly the same position (−0 equals +0) into the first of them and keeps
    /// the order of these.
    pub fn of_welded(positions: &[[f64; 3]]) -> Self {
        let mut targets = first_at_position(positions);
        let mut sources = Vec::with_capacity(positions.len());
        for vertex in 0..targets.len() {
            let first = targets[vertex] as usize;
            if first == vertex {
                targets[vertex] = sources.len() as u32;
                sources.push(vertex as u32);
            } else {
                targets[vertex] = targets[first];
            }
        }
        Self { targets, sources }
    }

    /// `#V of the input`: the vertex that each becomes, or [`DROPPED`].
    pub fn targets(&self) -> &[u32] {
        &self.targets
    }

    /// Returns [`targets`](Self::targets) as a vector.
    pub fn into_targets(self) -> Vec<u32> {
        self.targets
    }

    /// `#V of the result`: the input vertex that each takes its position and attributes from.
    pub fn sources(&self) -> &[u32] {
        &self.sources
    }

    /// Selects `values`, one for each input vertex, for the vertices of the result. An empty list
    /// stays empty.
    pub fn gather<T: Copy>(&self, values: &[T]) -> Vec<T> {
        if values.is_empty() {
            return Vec::new();
        }
        self.sources.iter().map(|&vertex| values[vertex as usize]).collect()
    }

    /// Changes the indices of `faces` from input vertices to vertices of the result.
    pub fn renumber(&self, faces: &mut [[u32; 3]]) {
        for vertex in faces.as_flattened_mut() {
            *vertex = self.targets[*vertex as usize];
        }
    }
}

/// Composes two vertex maps: `second` maps the result of `first`. Both hold the vertex that each
/// vertex becomes, or [`DROPPED`].
pub fn compose(first: &[u32], second: &[u32]) -> Vec<u32> {
    let follow = |&vertex: &u32| second.get(vertex as usize).copied().unwrap_or(DROPPED);
    first.iter().map(follow).collect()
}

impl<C: Copy> TriangleMesh<C> {
    /// Maps the vertices by `map`, with all attributes. No face may use a vertex that `map` drops.
    pub fn map_vertices(&self, map: &VertexMap) -> Self {
        let mut faces = self.faces.clone();
        map.renumber(&mut faces);
        Self { positions: map.gather(&self.positions), faces, labels: map.gather(&self.labels) }
    }

    /// Keeps the faces for which `keep` holds, in their order, with the attributes of faces and
    /// corners. Vertices stay.
    pub fn retain_faces(&mut self, keep: impl FnMut(&[u32; 3]) -> bool) {
        self.faces.retain(keep);
    }

    /// Replaces the faces (`#F × 3`) and keeps the vertices. The attributes of vertices stay. Those
    /// of faces and corners do not: a new face comes from none of the old ones.
    pub fn replace_faces(self, faces: Vec<[u32; 3]>) -> Self {
        Self { faces, ..self }
    }
}

/// For every vertex the lowest vertex at the same position.
fn first_at_position(positions: &[[f64; 3]]) -> Vec<u32> {
    // Adding +0 turns −0 into +0 and leaves every other number: equal bits, equal position.
    let bits = |vertex: u32| positions[vertex as usize].map(|c| (c + 0.0).to_bits());
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(|&vertex| (bits(vertex), vertex));
    let mut first_of = vec![0; positions.len()];
    for run in order.chunk_by(|&a, &b| bits(a) == bits(b)) {
        for &vertex in run {
            first_of[vertex as usize] = run[0];
        }
    }
    first_of
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mesh;

    #[test]
    fn vertices_take_their_attributes_along() {
        let positions = vec![[0.0; 3], [1.0; 3], [2.0; 3], [1.0; 3]];
        let mesh = Mesh::new(positions, vec![[3, 1, 2]]).with_labels(vec![4, 5, 6, 7]);
        let welded = VertexMap::of_welded(&mesh.positions);
        assert_eq!((welded.targets(), welded.sources()), (&[0, 1, 2, 1][..], &[0, 1, 2][..]));
        let mesh = mesh.map_vertices(&welded);
        assert_eq!((&mesh.faces[..], &mesh.labels[..]), (&[[1, 1, 2]][..], &[4, 5, 6][..]));
        let used = VertexMap::of_used(3, &mesh.faces);
        let used_mesh = mesh.map_vertices(&used);
        assert_eq!(used_mesh.positions, [[1.0; 3], [2.0; 3]]);
        assert_eq!((&used_mesh.faces[..], &used_mesh.labels[..]), (&[[0, 0, 1]][..], &[5, 6][..]));
        assert_eq!(compose(welded.targets(), used.targets()), [DROPPED, 0, 1, 0]);
        let bare = mesh.with_labels(Vec::new()).map_vertices(&used);
        assert!(bare.labels.is_empty());
    }

    #[test]
    fn faces_are_kept_or_replaced_on_the_same_vertices() {
        let mut mesh = Mesh::new(vec![[0.0; 3]; 4], vec![[0, 1, 2], [1, 1, 2], [1, 3, 2]]);
        mesh.retain_faces(|&[a, b, _]| a != b);
        assert_eq!(mesh.faces, [[0, 1, 2], [1, 3, 2]]);
        let replaced = mesh.with_labels(vec![1; 4]).replace_faces(vec![[3, 2, 1]]);
        assert_eq!((replaced.faces.len(), replaced.labels.len()), (1, 4));
    }
}
