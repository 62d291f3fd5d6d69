//! Faces and neighbours of vertices.

use super::Rows;

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

/// For every vertex the other two corners of each of its faces, into `links`. The numbers of a row,
/// flattened, ascend. A neighbour stands as often as faces share the edge to it; a vertex that a face
/// repeats is its own neighbour.
pub fn vertex_links(vertex_count: usize, faces: &[[u32; 3]], links: &mut Rows<[u32; 2]>) {
    let pairs = faces.iter().flat_map(|&[a, b, c]| [(a, [b, c]), (b, [c, a]), (c, [a, b])]);
    links.fill(vertex_count, pairs);
    for vertex in 0..vertex_count {
        links.row_mut(vertex).as_flattened_mut().sort_unstable();
    }
}

/// The vertices that share an edge with every vertex, ascending, each once.
pub fn vertex_neighbours(vertex_count: usize, faces: &[[u32; 3]]) -> Rows {
    let mut links = Rows::default();
    vertex_links(vertex_count, faces, &mut links);
    let mut neighbours = Rows::default();
    neighbours.restart();
    neighbours.offsets.reserve(vertex_count);
    neighbours.values.reserve(links.values.len());
    for (own, row) in (0u32..).zip(links.iter()) {
        let others = row.as_flattened().chunk_by(|a, b| a == b).map(|run| run[0]);
        neighbours.values.extend(others.filter(|&other| other != own));
        neighbours.end_row();
    }
    neighbours
}

#[cfg(test)]
mod tests {
    use super::super::tests::faces;
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        #[test]
        fn rows_agree_with_sets(faces in faces()) {
            let mut around = vec![BTreeSet::new(); 12];
            let mut corners = vec![Vec::new(); 12];
            for (index, face) in (0u32..).zip(&faces) {
                for k in 0..3 {
                    around[face[k] as usize].insert(index);
                    corners[face[k] as usize].extend([face[(k + 1) % 3], face[(k + 2) % 3]]);
                }
            }
            let mut links = Rows::default();
            vertex_links(12, &faces, &mut links);
            let (vertex_faces, rings) = (vertex_faces(12, &faces), vertex_neighbours(12, &faces));
            for vertex in 0..12 {
                let expected: Vec<u32> = around[vertex].iter().copied().collect();
                prop_assert_eq!(vertex_faces.row(vertex), &expected[..]);
                corners[vertex].sort_unstable();
                prop_assert_eq!(links.row(vertex).as_flattened(), &corners[vertex][..]);
                corners[vertex].dedup();
                corners[vertex].retain(|&other| other as usize != vertex);
                prop_assert_eq!(rings.row(vertex), &corners[vertex][..]);
            }
        }
    }
}
