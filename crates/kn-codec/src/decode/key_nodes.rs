//! Turns coded key nodes into positions, labels and kinds (`spec/07-motion.md`).

use crate::decode::nearest::Slabs;
use kn_bitstream::{AffineNodes, KeyNodes, NodeSites};
use kn_mesh::GridMesh;

/// The properties of a GoF's key nodes that do not change from frame to frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct NodeSet {
    /// `#N × 3`, on the I-frame, in grid steps.
    pub(crate) positions: Vec<[i32; 3]>,
    /// `#N` labels, each that of the nearest vertex of the I-frame.
    pub(crate) labels: Vec<u8>,
    /// `#N`, whether a node is affine.
    pub(crate) affine: Vec<bool>,
}

impl NodeSet {
    pub(crate) fn clear(&mut self) {
        self.positions.clear();
        self.labels.clear();
        self.affine.clear();
    }

    /// Number of affine nodes.
    pub(crate) fn affine_count(&self) -> u32 {
        self.affine.iter().filter(|&&affine| affine).count() as u32
    }
}

/// Places the nodes on the I-frame `intra`, which has at least one vertex and every vertex that
/// the nodes name; positions are in grid steps.
pub(crate) fn decode_key_nodes(coded: &KeyNodes, intra: &GridMesh, nodes: &mut NodeSet) {
    nodes.clear();
    match &coded.sites {
        NodeSites::Vertices(vertices) => {
            nodes.positions.extend(vertices.iter().map(|&v| intra.positions[v as usize]));
        }
        NodeSites::Points(points) => nodes.positions.extend(points),
    }
    if intra.labels.is_empty() {
        nodes.labels.resize(nodes.positions.len(), 0);
    } else {
        let slabs = Slabs::new(&intra.positions);
        let label = |node: &[i32; 3]| intra.labels[slabs.nearest(*node)];
        nodes.labels.extend(nodes.positions.iter().map(label));
    }
    match &coded.affine {
        AffineNodes::None => nodes.affine.resize(nodes.positions.len(), false),
        AffineNodes::All => nodes.affine.resize(nodes.positions.len(), true),
        AffineNodes::Labels(flags) => {
            nodes.affine.extend(nodes.labels.iter().map(|&label| flags[usize::from(label)]));
        }
        AffineNodes::Nodes(flags) => nodes.affine.extend(flags),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn intra() -> GridMesh {
        let positions = vec![[0, 0, 0], [4, 0, 0], [4, 0, 0], [9, 9, 9]];
        GridMesh::new(positions, vec![[0, 1, 3]]).with_labels(vec![5, 7, 6, 1])
    }

    #[test]
    fn a_node_takes_the_label_of_its_nearest_vertex() {
        let coded = KeyNodes {
            sites: NodeSites::Points(vec![[2, 0, 0], [3, 0, 0], [8, 9, 9]]),
            affine: AffineNodes::Labels((0..15).map(|label| label == 7).collect()),
            weight_sigma: None,
        };
        let mut nodes = NodeSet::default();
        decode_key_nodes(&coded, &intra(), &mut nodes);
        assert_eq!(nodes.labels, [5, 7, 1]);
        assert_eq!(nodes.affine, [false, true, false]);
    }

    #[test]
    fn nodes_on_vertices_stand_where_the_vertices_are() {
        let coded = KeyNodes {
            sites: NodeSites::Vertices(vec![0, 2]),
            affine: AffineNodes::Nodes(vec![true, false]),
            weight_sigma: None,
        };
        let mut nodes = NodeSet::default();
        decode_key_nodes(&coded, &intra(), &mut nodes);
        assert_eq!(nodes.positions, [[0, 0, 0], [4, 0, 0]]);
        // Vertex 1 stands on the same point and comes first.
        assert_eq!(nodes.labels, [5, 7]);
        assert_eq!(nodes.affine_count(), 1);
    }
}
