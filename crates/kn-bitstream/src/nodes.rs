//! The key nodes of a GoF (chapter 3.6).

use crate::error::Error;
use crate::level::COORDINATE_LIMIT;
use crate::params::WeightScheme;
use crate::reader::BitReader;
use crate::rule;
use crate::writer::{BitWriter, best_rice, zigzag};

/// The values that the reader of key nodes depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KeyNodesContext {
    /// Number of labels of the sequence.
    pub label_count: u32,
    /// Weight scheme of the sequence.
    pub weight_scheme: WeightScheme,
    /// Number of vertices of the GoF's I-frame.
    pub vertex_count: u32,
    /// Largest number of nodes that the level allows.
    pub max_nodes: u32,
}

/// The key nodes of a GoF, in node order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyNodes {
    /// Places of the nodes.
    pub sites: NodeSites,
    /// Affine nodes.
    pub affine: AffineNodes,
    /// σ of the Gaussian weights in grid steps, 1 to 2^20 − 1; present with that scheme only.
    pub weight_sigma: Option<u32>,
}

/// The places of key nodes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NodeSites {
    /// Indices of I-frame vertices, strictly rising.
    Vertices(Vec<u32>),
    /// #N × 3 grid points.
    Points(Vec<[i32; 3]>),
}

/// The affine key nodes. The others are rigid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AffineNodes {
    /// No node.
    None,
    /// The nodes with these labels; one flag per label of the sequence.
    Labels(Vec<bool>),
    /// Every node.
    All,
    /// One flag per node.
    Nodes(Vec<bool>),
}

impl KeyNodes {
    /// Number of nodes.
    pub fn count(&self) -> u32 {
        match &self.sites {
            NodeSites::Vertices(vertices) => vertices.len() as u32,
            NodeSites::Points(points) => points.len() as u32,
        }
    }

    /// Reads the nodes from a unit's payload; the caller calls [`BitReader::finish`].
    ///
    /// Allocates no more than `max_nodes` nodes.
    pub fn read(bits: &mut BitReader<'_, '_>, context: &KeyNodesContext) -> Result<Self, Error> {
        let node_count = bits.uleb("node_count")?;
        let in_range = (1..=context.max_nodes).contains(&node_count);
        bits.require(in_range, rule::NODES_COUNT_RANGE)?;
        let node_coding = bits.u("node_coding", 1)?;
        let affine_mode = bits.u("affine_mode", 2)?;
        let weight_sigma = read_sigma(bits, context.weight_scheme)?;
        let mut affine = match affine_mode {
            0 => AffineNodes::None,
            1 => AffineNodes::Labels(read_flags(bits, "affine_label", context.label_count)?),
            2 => AffineNodes::All,
            _ => AffineNodes::Nodes(Vec::new()),
        };
        let sites = if node_coding == 0 {
            NodeSites::Vertices(read_vertices(bits, node_count, context.vertex_count)?)
        } else {
            NodeSites::Points(read_points(bits, node_count)?)
        };
        if let AffineNodes::Nodes(flags) = &mut affine {
            *flags = read_flags(bits, "affine_node", node_count)?;
        }
        Ok(Self { sites, affine, weight_sigma })
    }

    /// Writes the nodes with the best Rice parameter; the mirror of [`Self::read`].
    pub fn write(&self, bits: &mut BitWriter) {
        bits.uleb(self.count());
        bits.flag(matches!(self.sites, NodeSites::Points(_)));
        bits.u(self.affine.mode(), 2);
        if let Some(sigma) = self.weight_sigma {
            bits.uleb(sigma);
        }
        if let AffineNodes::Labels(flags) = &self.affine {
            flags.iter().for_each(|&flag| bits.flag(flag));
        }
        match &self.sites {
            NodeSites::Vertices(vertices) => write_vertices(bits, vertices),
            NodeSites::Points(points) => write_points(bits, points),
        }
        if let AffineNodes::Nodes(flags) = &self.affine {
            flags.iter().for_each(|&flag| bits.flag(flag));
        }
    }
}

impl AffineNodes {
    fn mode(&self) -> u64 {
        match self {
            Self::None => 0,
            Self::Labels(_) => 1,
            Self::All => 2,
            Self::Nodes(_) => 3,
        }
    }
}

fn read_sigma(bits: &mut BitReader<'_, '_>, scheme: WeightScheme) -> Result<Option<u32>, Error> {
    if scheme != WeightScheme::Gaussian {
        return Ok(None);
    }
    let sigma = bits.uleb("weight_sigma")?;
    bits.require((1..COORDINATE_LIMIT as u32).contains(&sigma), rule::NODES_SIGMA_RANGE)?;
    Ok(Some(sigma))
}

fn read_flags(
    bits: &mut BitReader<'_, '_>,
    name: &'static str,
    count: u32,
) -> Result<Vec<bool>, Error> {
    (0..count).map(|index| bits.flag((name, index))).collect()
}

fn read_vertices(
    bits: &mut BitReader<'_, '_>,
    node_count: u32,
    vertex_count: u32,
) -> Result<Vec<u32>, Error> {
    let k = bits.u("node_vertex_rice", 5)? as u32;
    let mut vertices = Vec::with_capacity(node_count as usize);
    let mut next = 0_u64;
    for node in 0..node_count {
        let gap = bits.rice(("node_vertex_gap", node), k)?;
        let vertex = next + u64::from(gap);
        bits.require(vertex < u64::from(vertex_count), rule::NODES_VERTEX_RANGE)?;
        vertices.push(vertex as u32);
        next = vertex + 1;
    }
    Ok(vertices)
}

fn write_vertices(bits: &mut BitWriter, vertices: &[u32]) {
    let gap = |node: usize| match node {
        0 => vertices[0],
        _ => vertices[node] - vertices[node - 1] - 1,
    };
    let gaps = (0..vertices.len()).map(gap);
    let k = best_rice(gaps.clone());
    bits.u(u64::from(k), 5);
    gaps.for_each(|gap| bits.rice(gap, k));
}

fn read_points(bits: &mut BitReader<'_, '_>, node_count: u32) -> Result<Vec<[i32; 3]>, Error> {
    let k = bits.u("node_delta_rice", 5)? as u32;
    let mut points = Vec::with_capacity(node_count as usize);
    let mut point = [0_i32; 3];
    for node in 0..node_count {
        for axis in 0..3 {
            let delta = bits.srice(("node_delta", node, axis as u32), k)?;
            let coordinate = i64::from(point[axis]) + i64::from(delta);
            let in_range = coordinate.abs() < i64::from(COORDINATE_LIMIT);
            bits.require(in_range, rule::NODES_POSITION_RANGE)?;
            point[axis] = coordinate as i32;
        }
        points.push(point);
    }
    Ok(points)
}

fn write_points(bits: &mut BitWriter, points: &[[i32; 3]]) {
    let before = |node: usize| if node == 0 { [0; 3] } else { points[node - 1] };
    let deltas = (0..points.len())
        .flat_map(|node| (0..3).map(move |axis| points[node][axis] - before(node)[axis]));
    let k = best_rice(deltas.clone().map(zigzag));
    bits.u(u64::from(k), 5);
    deltas.for_each(|delta| bits.srice(delta, k));
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const CONTEXT: KeyNodesContext = KeyNodesContext {
        label_count: 15,
        weight_scheme: WeightScheme::Gaussian,
        vertex_count: 20_000,
        max_nodes: 512,
    };

    fn affine(count: usize) -> impl Strategy<Value = AffineNodes> {
        prop_oneof![
            Just(AffineNodes::None),
            prop::collection::vec(any::<bool>(), 15).prop_map(AffineNodes::Labels),
            Just(AffineNodes::All),
            prop::collection::vec(any::<bool>(), count).prop_map(AffineNodes::Nodes),
        ]
    }

    fn sites() -> impl Strategy<Value = NodeSites> {
        let coordinate = 1 - COORDINATE_LIMIT..COORDINATE_LIMIT;
        prop_oneof![
            prop::collection::btree_set(0..20_000_u32, 1..60)
                .prop_map(|set| NodeSites::Vertices(set.into_iter().collect())),
            prop::collection::vec(prop::array::uniform3(coordinate), 1..60)
                .prop_map(NodeSites::Points),
        ]
    }

    fn key_nodes() -> impl Strategy<Value = KeyNodes> {
        sites().prop_flat_map(|sites| {
            let nodes = KeyNodes { sites, affine: AffineNodes::None, weight_sigma: None };
            (affine(nodes.count() as usize), 1..COORDINATE_LIMIT as u32).prop_map(
                move |(affine, sigma)| KeyNodes {
                    affine,
                    weight_sigma: Some(sigma),
                    ..nodes.clone()
                },
            )
        })
    }

    fn read(bytes: &[u8], context: &KeyNodesContext) -> Result<KeyNodes, Error> {
        let mut bits = BitReader::new(bytes);
        let nodes = KeyNodes::read(&mut bits, context)?;
        bits.finish()?;
        Ok(nodes)
    }

    fn written(nodes: &KeyNodes) -> Vec<u8> {
        let mut bits = BitWriter::new();
        nodes.write(&mut bits);
        bits.into_bytes()
    }

    proptest! {
        #[test]
        fn reads_what_it_writes(nodes in key_nodes()) {
            prop_assert_eq!(read(&written(&nodes), &CONTEXT), Ok(nodes));
        }
    }

    #[test]
    fn nodes_out_of_range_are_refused() {
        let nodes = |sites| KeyNodes { sites, affine: AffineNodes::All, weight_sigma: Some(9) };
        let broken = |sites, context: &KeyNodesContext| {
            read(&written(&nodes(sites)), context).expect_err("it is broken").rule()
        };
        let beyond = NodeSites::Vertices(vec![3, 20_000]);
        assert_eq!(broken(beyond, &CONTEXT), Some(rule::NODES_VERTEX_RANGE));
        let outside = NodeSites::Points(vec![[0, COORDINATE_LIMIT, 0]]);
        assert_eq!(broken(outside, &CONTEXT), Some(rule::NODES_POSITION_RANGE));
        let none = NodeSites::Points(vec![]);
        assert_eq!(broken(none, &CONTEXT), Some(rule::NODES_COUNT_RANGE));
        let three = NodeSites::Vertices(vec![0, 1, 2]);
        let narrow = KeyNodesContext { max_nodes: 2, ..CONTEXT };
        assert_eq!(broken(three, &narrow), Some(rule::NODES_COUNT_RANGE));
    }
}
