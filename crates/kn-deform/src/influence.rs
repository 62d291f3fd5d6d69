//! Influence: which Q nodes move a vertex, and with which weights. Bound once per group of frames
//! on the decoded I-frame.

use crate::weights::{Distances, WeightScheme, normalised_weights};
use rayon::prelude::*;

/// Nodes and weights of every vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Influence {
    /// Q, the number of nodes per vertex.
    pub nodes_per_vertex: usize,
    /// `#V × Q` node indices, nearest first, replicas of the nearest in front.
    pub nodes: Vec<u16>,
    /// `#V × Q` weights; those of one vertex sum to 1.
    pub weights: Vec<f64>,
}

impl Influence {
    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.nodes.len().checked_div(self.nodes_per_vertex).unwrap_or(0)
    }
}

/// What happens where a vertex's region has no node (`deform.influence.mode`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InfluenceMode {
    /// The paper's manual mode: an error.
    Strict,
    /// The paper's auto mode: the Q nearest nodes of any region.
    Fallback,
}

/// How influence is bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BindOptions {
    /// Q, 1 to 8.
    pub nodes_per_vertex: usize,
    /// Distance to weight.
    pub weights: WeightScheme,
    /// Strict or fallback.
    pub mode: InfluenceMode,
}

/// Why influence cannot be bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BindError {
    /// No node at all.
    #[error("there are no key nodes")]
    NoNodes,
    /// Strict mode, and a region with vertices has no node (`deform.influence.strict`).
    #[error("region {region} has vertices (the first is {vertex}) but no key node")]
    RegionWithoutNodes {
        /// The region.
        region: u8,
        /// Its first vertex.
        vertex: usize,
    },
    /// Array lengths disagree or Q is not 1 to 8.
    #[error("inconsistent arguments: {0}")]
    Arguments(&'static str),
}

/// The largest Q.
const MAX_Q: usize = 8;
/// Vertices per unit of parallel work.
const CHUNK: usize = 1024;

/// Binds every vertex to its Q nearest allowed nodes (bi-modal paper, eq. (1)–(2);
/// `deform.influence.*`).
///
/// `positions` `#V × 3` and `nodes` `#N × 3` in grid steps, magnitudes below 2^20;
/// `vertex_regions` `#V` and `node_regions` `#N`. Squared distances are exact; ties go to the lower
/// node index. The result reuses the buffers of `influence`.
///
/// # Errors
/// No node; strict mode and a region without one; array lengths that disagree.
pub fn bind(
    positions: &[[i32; 3]],
    vertex_regions: &[u8],
    nodes: &[[i32; 3]],
    node_regions: &[u8],
    options: &BindOptions,
    influence: &mut Influence,
) -> Result<(), BindError> {
    let q = options.nodes_per_vertex;
    if q == 0 || q > MAX_Q {
        return Err(BindError::Arguments("nodes_per_vertex is not 1 to 8"));
    }
    if positions.len() != vertex_regions.len() || nodes.len() != node_regions.len() {
        return Err(BindError::Arguments("one region per vertex and per node"));
    }
    if nodes.is_empty() {
        return Err(BindError::NoNodes);
    }
    let candidates = Candidates::new(nodes, node_regions);
    candidates.check_strict(vertex_regions, options.mode)?;
    influence.nodes_per_vertex = q;
    influence.nodes.resize(positions.len() * q, 0);
    influence.weights.resize(positions.len() * q, 0.0);
    influence
        .nodes
        .par_chunks_mut(CHUNK * q)
        .zip(influence.weights.par_chunks_mut(CHUNK * q))
        .enumerate()
        .for_each(|(chunk, (nodes, weights))| {
            let slots = nodes.chunks_exact_mut(q).zip(weights.chunks_exact_mut(q));
            for (offset, (nodes, weights)) in slots.enumerate() {
                let vertex = chunk * CHUNK + offset;
                let list = candidates.of_region(vertex_regions[vertex]);
                bind_vertex(positions[vertex], list, options.weights, nodes, weights);
            }
        });
    Ok(())
}

/// Nodes sorted into the lists that vertices choose from.
struct Candidates {
    /// By region: its nodes by rising index; empty where it has none.
    by_region: Vec<NodeList>,
    /// All nodes.
    all: NodeList,
}

/// Node positions as coordinate arrays, so that distances are computed in lanes.
#[derive(Clone, Default)]
struct NodeList {
    index: Vec<u16>,
    coordinates: Vec<[f64; 3]>,
}

impl NodeList {
    fn push(&mut self, index: usize, node: [i32; 3]) {
        self.index.push(index as u16);
        self.coordinates.push(node.map(f64::from));
    }
}

impl Candidates {
    fn new(nodes: &[[i32; 3]], regions: &[u8]) -> Self {
        let mut by_region = vec![NodeList::default(); 256];
        let mut all = NodeList::default();
        for (index, (&node, &region)) in nodes.iter().zip(regions).enumerate() {
            by_region[usize::from(region)].push(index, node);
            all.push(index, node);
        }
        Self { by_region, all }
    }

    fn of_region(&self, region: u8) -> &NodeList {
        let list = &self.by_region[usize::from(region)];
        if list.index.is_empty() { &self.all } else { list }
    }

    fn check_strict(&self, vertex_regions: &[u8], mode: InfluenceMode) -> Result<(), BindError> {
        if mode == InfluenceMode::Fallback {
            return Ok(());
        }
        let lacks_nodes = |region: u8| self.by_region[usize::from(region)].index.is_empty();
        match vertex_regions.iter().position(|&region| lacks_nodes(region)) {
            None => Ok(()),
            Some(vertex) => {
                Err(BindError::RegionWithoutNodes { region: vertex_regions[vertex], vertex })
            }
        }
    }
}

/// The nearest candidates of one vertex, by rising squared distance, then by rising index.
struct Nearest {
    squared: [f64; MAX_Q + 1],
    index: [u16; MAX_Q + 1],
    count: usize,
}

/// The `wanted` nearest nodes of `list`. Coordinates are integers below 2^21 in difference, so
/// squares and their sum are exact in binary64.
fn nearest(position: [f64; 3], list: &NodeList, wanted: usize) -> Nearest {
    let mut found =
        Nearest { squared: [f64::INFINITY; MAX_Q + 1], index: [0; MAX_Q + 1], count: 0 };
    let mut worst = f64::INFINITY;
    for (node, &index) in list.coordinates.iter().zip(&list.index) {
        let d = [node[0] - position[0], node[1] - position[1], node[2] - position[2]];
        let squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        // Candidates come by rising index, so an equal distance never displaces an earlier one.
        if squared < worst {
            insert(&mut found, wanted, squared, index);
            worst = found.squared[wanted - 1];
        }
    }
    found
}

/// Inserts behind all entries that are not farther.
fn insert(found: &mut Nearest, wanted: usize, squared: f64, index: u16) {
    let mut slot = found.count.min(wanted - 1);
    while slot > 0 && found.squared[slot - 1] > squared {
        found.squared[slot] = found.squared[slot - 1];
        found.index[slot] = found.index[slot - 1];
        slot -= 1;
    }
    found.squared[slot] = squared;
    found.index[slot] = index;
    found.count = (found.count + 1).min(wanted);
}

/// Fills the Q slots of one vertex; where nodes are short the nearest is replicated in front
/// (bi-modal paper, manual segmentation; `deform.influence.replication`).
fn bind_vertex(
    position: [i32; 3],
    list: &NodeList,
    scheme: WeightScheme,
    nodes: &mut [u16],
    weights: &mut [f64],
) {
    let q = nodes.len();
    let found = nearest(position.map(f64::from), list, q + 1);
    let used = found.count.min(q);
    let mut squared = [0.0; MAX_Q];
    for slot in 0..q {
        let rank = slot.saturating_sub(q - used);
        nodes[slot] = found.index[rank];
        squared[slot] = found.squared[rank];
    }
    let next_squared = (found.count > q).then(|| found.squared[q]);
    normalised_weights(scheme, &Distances { squared: &squared[..q], next_squared }, weights);
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPTIONS: BindOptions = BindOptions {
        nodes_per_vertex: 4,
        weights: WeightScheme::InverseSquare,
        mode: InfluenceMode::Strict,
    };

    fn bind_one(nodes: &[[i32; 3]], regions: &[u8], options: &BindOptions) -> Influence {
        let mut influence = Influence::default();
        bind(&[[0, 0, 0]], &[1], nodes, regions, options, &mut influence).unwrap();
        influence
    }

    #[test]
    fn the_nearest_node_fills_missing_slots() {
        let bound = bind_one(&[[2, 0, 0], [1, 0, 0], [0, 0, 1]], &[1, 1, 0], &OPTIONS);
        assert_eq!(bound.nodes, [1, 1, 1, 0]);
        let sum = 3.0 + 0.25;
        assert_eq!(bound.weights, [1.0 / sum, 1.0 / sum, 1.0 / sum, 0.25 / sum]);
    }

    #[test]
    fn ties_go_to_the_lower_index() {
        let nodes = [[0, 3, 0], [3, 0, 0], [0, 0, -3], [0, -3, 0], [-3, 0, 0]];
        assert_eq!(bind_one(&nodes, &[1; 5], &OPTIONS).nodes, [0, 1, 2, 3]);
    }

    #[test]
    fn strict_mode_refuses_a_region_without_nodes() {
        let mut influence = Influence::default();
        let result = bind(&[[0; 3]; 2], &[0, 5], &[[1; 3]], &[0], &OPTIONS, &mut influence);
        assert_eq!(result, Err(BindError::RegionWithoutNodes { region: 5, vertex: 1 }));
    }

    #[test]
    fn fallback_mode_takes_nodes_of_any_region() {
        let options = BindOptions { mode: InfluenceMode::Fallback, ..OPTIONS };
        let bound = bind_one(&[[2, 0, 0], [1, 0, 0]], &[3, 4], &options);
        assert_eq!(bound.nodes, [1, 1, 1, 0]);
    }

    #[test]
    fn no_nodes_is_an_error() {
        let mut influence = Influence::default();
        let result = bind(&[[0; 3]], &[0], &[], &[], &OPTIONS, &mut influence);
        assert_eq!(result, Err(BindError::NoNodes));
    }
}
