//! Connected components.

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_are_numbered_by_their_lowest_vertex() {
        let components = Components::new(8, &[[7, 5, 6], [0, 3, 1]]);
        let lone = Components::ISOLATED;
        assert_eq!(components.of_vertex, [0, 0, lone, 0, lone, 1, 1, 1]);
        assert_eq!((components.count, components.isolated_count()), (2, 2));
    }
}
