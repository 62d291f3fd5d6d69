//! The influence graph of the key nodes (`path.graph`): two nodes are neighbours where they move a
//! vertex together.

use kn_deform::Influence;

/// Neighbours of every node, as one row of bits for each node. 4096 nodes take 2 MiB.
pub(crate) struct NodeGraph {
    words: usize,
    rows: Vec<u64>,
}

impl NodeGraph {
    /// The graph of `count` nodes.
    pub(crate) fn new(count: usize, influence: &Influence) -> Self {
        let words = count.div_ceil(64);
        let mut graph = Self { words, rows: vec![0; words * count] };
        let mut last: &[u16] = &[];
        for slots in influence.nodes.chunks_exact(influence.nodes_per_vertex) {
            // Vertices that follow one another are mostly moved by the same nodes.
            if slots != last {
                graph.connect_all(slots);
                last = slots;
            }
        }
        graph
    }

    fn connect_all(&mut self, nodes: &[u16]) {
        for (slot, &one) in nodes.iter().enumerate() {
            for &other in &nodes[..slot] {
                self.connect(one, other);
                self.connect(other, one);
            }
        }
    }

    fn connect(&mut self, from: u16, to: u16) {
        let row = usize::from(from) * self.words;
        self.rows[row + usize::from(to) / 64] |= 1 << (to % 64);
    }

    /// Neighbours of a node by rising index; a node may be its own neighbour.
    pub(crate) fn neighbours(&self, node: u16) -> impl Iterator<Item = u16> {
        let row = &self.rows[usize::from(node) * self.words..][..self.words];
        (0_u16..).zip(row).flat_map(|(word, &bits)| {
            (0..64_u16).filter(move |bit| bits >> bit & 1 == 1).map(move |bit| 64 * word + bit)
        })
    }

    /// The sets of nodes that hang together, each by rising index, by their first nodes.
    pub(crate) fn components(&self) -> Vec<Vec<u16>> {
        let count = self.rows.len() / self.words.max(1);
        let mut seen = vec![false; count];
        let mut components = Vec::new();
        for first in 0..count {
            if std::mem::replace(&mut seen[first], true) {
                continue;
            }
            let mut component = vec![first as u16];
            let mut next = 0;
            while let Some(&node) = component.get(next) {
                let new = |&other: &u16| !std::mem::replace(&mut seen[usize::from(other)], true);
                component.extend(self.neighbours(node).filter(new));
                next += 1;
            }
            component.sort_unstable();
            components.push(component);
        }
        components
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_of_a_vertex_are_neighbours() {
        let nodes = vec![0, 1, 70, 70, 2, 2, 1, 3];
        let influence = Influence { nodes_per_vertex: 2, weights: vec![0.5; nodes.len()], nodes };
        let graph = NodeGraph::new(71, &influence);
        assert_eq!(graph.neighbours(1).collect::<Vec<_>>(), [0, 3]);
        assert_eq!(graph.neighbours(70).collect::<Vec<_>>(), [70]);
        let components = graph.components();
        assert_eq!(components.len(), 71 - 2);
        assert_eq!(components[0], [0, 1, 3]);
        assert_eq!(components.last(), Some(&vec![70]));
    }
}
