//! From coded key nodes to positions, labels and kinds (`spec/07-motion.md`).

use kn_bitstream::{AffineMode, KeyNodes, NodeCoding, rule};
use kn_mesh::GridMesh;
use rayon::prelude::*;

/// The key nodes of a group of frames.
#[derive(Clone, Debug, Default)]
pub(crate) struct NodeSet {
    /// `#N × 3`.
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
}
