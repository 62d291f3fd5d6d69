//! Influence: the Q key nodes that move a vertex, and their weights. It is bound once for each GoF,
//! on the decoded I-frame.

use crate::parallel::*;
use crate::weights::{Distances, normalised_weights};
use kn_bitstream::params::{InfluenceMode, Weights};

/// The key nodes of every vertex, and their weights.
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

/// Options of the binding of influence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BindOptions {
    /// Q, the number of nodes per vertex, 1 to 8.
    pub nodes_per_vertex: usize,
    /// Weights of nodes by their distance.
    pub weights: Weights,
    /// Treatment of regions without nodes.
    pub mode: InfluenceMode,
}

/// The reason why influence cannot be bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BindError {
    /// There are no key nodes.
    #[error("there are no key nodes")]
    NoNodes,
    /// The mode is strict, and a region with vertices has no node (`deform.influence.strict`).
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
/// No node, more than 65,536; Q not 1 to 8; strict mode and a region without a node; array lengths
/// that disagree.
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
    if u16::try_from(nodes.len() - 1).is_err() {
        return Err(BindError::Arguments("more than 65536 nodes"));
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
            let mut found = Nearest::default();
            let mut found_in = None;
            for (offset, (nodes, weights)) in slots.enumerate() {
                let vertex = chunk * CHUNK + offset;
                let region = vertex_regions[vertex];
                let list = candidates.of_region(region);
                // Neighbours in the order of vertices are near each other, and so are their nodes.
                let bound = if found_in == Some(region) { Some(&found) } else { None };
                found = nearest(positions[vertex].map(f64::from), list, q + 1, bound);
                found_in = Some(region);
                fill_slots(&found, list, options.weights, nodes, weights);
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

/// Number of nodes whose distances are computed at once.
const LANES: usize = 8;

/// Nodes by rising index, their coordinates in lanes. What fills the last lanes is infinitely far.
#[derive(Clone, Default)]
struct NodeList {
    index: Vec<u16>,
    blocks: Vec<[[f64; LANES]; 3]>,
}

impl NodeList {
    fn push(&mut self, index: usize, node: [i32; 3]) {
        let lane = self.index.len() % LANES;
        if lane == 0 {
            self.blocks.push([[f64::INFINITY; LANES]; 3]);
        }
        self.index.push(index as u16);
        if let Some(block) = self.blocks.last_mut() {
            for axis in 0..3 {
                block[axis][lane] = f64::from(node[axis]);
            }
        }
    }

    /// Squared distances of a block's nodes. Differences are integers below 2^21, so squares and
    /// their sum are exact in binary64.
    #[inline(always)]
    fn squared(block: &[[f64; LANES]; 3], position: [f64; 3]) -> [f64; LANES] {
        std::array::from_fn(|lane| {
            let d = [0, 1, 2].map(|axis| block[axis][lane] - position[axis]);
            d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
        })
    }

    fn squared_of(&self, place: u16, position: [f64; 3]) -> f64 {
        let place = usize::from(place);
        Self::squared(&self.blocks[place / LANES], position)[place % LANES]
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
#[derive(Default)]
struct Nearest {
    squared: [f64; MAX_Q + 1],
    /// Places in the list of candidates.
    place: [u16; MAX_Q + 1],
    count: usize,
}

/// The `wanted` nearest nodes of `list`. `hint` is what another vertex found there: its nodes
/// bound the distance, whichever they are, so it changes the time and not the result.
fn nearest(position: [f64; 3], list: &NodeList, wanted: usize, hint: Option<&Nearest>) -> Nearest {
    let mut found = Nearest::default();
    let mut limit = f64::INFINITY;
    if let Some(hint) = hint.filter(|hint| hint.count == wanted) {
        let places = hint.place[..wanted].iter();
        let farthest = places.map(|&p| list.squared_of(p, position)).fold(0.0, f64::max);
        // Squared distances are integers: below the next one is the same as not above this one.
        limit = farthest + 1.0;
    }
    for (number, block) in list.blocks.iter().enumerate() {
        let squared = NodeList::squared(block, position);
        if !squared.iter().fold(false, |any, &squared| any | (squared < limit)) {
            continue;
        }
        for lane in 0..LANES {
            // Candidates come by rising index, so an equal distance never displaces an earlier one.
            if squared[lane] < limit {
                found.insert(wanted, squared[lane], (number * LANES + lane) as u16);
                if found.count == wanted {
                    limit = found.squared[wanted - 1];
                }
            }
        }
    }
    found
}

impl Nearest {
    /// Inserts behind all entries that are not farther.
    fn insert(&mut self, wanted: usize, squared: f64, place: u16) {
        let mut slot = self.count.min(wanted - 1);
        while slot > 0 && self.squared[slot - 1] > squared {
            self.squared[slot] = self.squared[slot - 1];
            self.place[slot] = self.place[slot - 1];
            slot -= 1;
        }
        self.squared[slot] = squared;
        self.place[slot] = place;
        self.count = (self.count + 1).min(wanted);
    }
}

/// Fills the Q slots of one vertex; where nodes are short the nearest is replicated in front
/// (bi-modal paper, manual segmentation; `deform.influence.replication`).
fn fill_slots(
    found: &Nearest,
    list: &NodeList,
    how: Weights,
    nodes: &mut [u16],
    weights: &mut [f64],
) {
    let q = nodes.len();
    let used = found.count.min(q);
    let mut squared = [0.0; MAX_Q];
    for slot in 0..q {
        let rank = slot.saturating_sub(q - used);
        nodes[slot] = list.index[usize::from(found.place[rank])];
        squared[slot] = found.squared[rank];
    }
    let next_squared = (found.count > q).then(|| found.squared[q]);
    normalised_weights(how, &Distances { squared: &squared[..q], next_squared }, weights);
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPTIONS: BindOptions = BindOptions {
        nodes_per_vertex: 4,
        weights: Weights::INVERSE_SQUARE,
        mode: InfluenceMode::Strict,
    };

    #[test]
    fn nothing_bound_is_of_no_vertices() {
        assert_eq!(Influence::default().vertex_count(), 0);
    }

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

    proptest::proptest! {
        /// The literal reading of the rules: sort all candidates, take the first.
        #[test]
        fn ranks_are_those_of_a_full_sort(
            vertices in proptest::collection::vec([-40..40_i32, -40..40, -40..40], 1..40),
            nodes in proptest::collection::vec(([-40..40_i32, -40..40, -40..40], 0..3_u8), 1..40),
            q in 1..=8_usize,
        ) {
            let (nodes, regions): (Vec<_>, Vec<_>) = nodes.into_iter().unzip();
            let vertex_regions: Vec<u8> = (0..vertices.len()).map(|v| (v / 5 % 4) as u8).collect();
            let options = BindOptions {
                nodes_per_vertex: q,
                mode: InfluenceMode::Fallback,
                ..OPTIONS
            };
            let mut influence = Influence::default();
            bind(&vertices, &vertex_regions, &nodes, &regions, &options, &mut influence).unwrap();
            for (vertex, position) in vertices.iter().enumerate() {
                let region = vertex_regions[vertex];
                let own = regions.contains(&region);
                let squared = |node: &[i32; 3]| -> i64 {
                    (0..3).map(|k| i64::from(node[k] - position[k])).map(|d| d * d).sum()
                };
                let mut ranked: Vec<_> = (0..nodes.len())
                    .filter(|&node| !own || regions[node] == region)
                    .map(|node| (squared(&nodes[node]), node as u16))
                    .collect();
                ranked.sort_unstable();
                ranked.truncate(q);
                let replicas = vec![ranked[0].1; q - ranked.len()];
                let expected: Vec<u16> =
                    replicas.into_iter().chain(ranked.iter().map(|&(_, node)| node)).collect();
                proptest::prop_assert_eq!(&influence.nodes[vertex * q..(vertex + 1) * q], expected);
            }
        }
    }
}
