//! The data of a fit that are the same in all frames of a GoF.

use crate::cholesky::Elimination;
use crate::constants::sampling::SAMPLES;
use crate::error::{FitError, Side};
use crate::geodesic::EdgeGraph;
use crate::node_graph::neighbours;
use crate::pattern::{BlockPattern, PairSet};
use crate::quadratic::Observations;
use crate::reach::reach;
use crate::sample::Sample;
use crate::source::FitSource;
use crate::surface::vertex_areas;
use kn_mesh::adjacency::EdgeTable;
use kn_mesh::vec3::{Vec3, add, distance, scale, sub};

/// The structure of the fits of one GoF.
#[derive(Debug)]
pub(crate) struct Group {
    pub(crate) pattern: BlockPattern,
    pub(crate) elimination: Elimination,
    /// Neighbours in the smoothness term.
    pub(crate) pairs: Vec<(u16, u16)>,
    /// `#E × 2`.
    pub(crate) edges: Vec<[u32; 2]>,
    /// `#E` lengths of the edges in the first reference.
    pub(crate) edge_lengths: Vec<f64>,
    pub(crate) boundary: Vec<bool>,
    /// `#V` of the first reference, see [`reach`].
    pub(crate) reach: Vec<f64>,
    pub(crate) sample: Sample,
    pub(crate) all: Sample,
    /// Root of the area per node.
    pub(crate) spacing: f64,
}

impl Group {
    pub(crate) fn new(source: &FitSource) -> Result<Self, FitError> {
        source.check()?;
        let areas = vertex_areas(source.positions, source.faces);
        let total: f64 = areas.iter().sum();
        if total <= 0.0 {
            return Err(FitError::NoSurface { mesh: Side::Source });
        }
        let vertex_count = source.positions.len();
        let table = EdgeTable::new(vertex_count, source.faces);
        let graph = EdgeGraph::new(source.positions, &table.edges, |_, _| true);
        let pairs = neighbours(source.positions, &graph, source.nodes);
        let mut together = PairSet::new(source.nodes.len());
        for &(a, b) in &pairs {
            together.add_clique(&[a, b]);
        }
        let mut nodes = Vec::new();
        for face in source.faces {
            nodes.clear();
            face.iter().for_each(|&v| nodes.extend_from_slice(influence_of(source, v).0));
            nodes.sort_unstable();
            nodes.dedup();
            together.add_clique(&nodes);
        }
        let pattern = BlockPattern::new(&together, source.nodes.len());
        let length = |edge: &[u32; 2]| {
            let [a, b] = edge.map(|v| source.positions[v as usize]);
            distance(a, b)
        };
        Ok(Self {
            edge_lengths: table.edges.iter().map(length).collect(),
            elimination: Elimination::new(&pattern),
            pattern,
            pairs,
            boundary: table.boundary_vertices(vertex_count),
            reach: reach(source.positions, &areas, &graph),
            edges: table.edges,
            sample: Sample::spread(source.positions, &areas, SAMPLES),
            all: Sample::all(&areas),
            spacing: (total / source.nodes.len() as f64).sqrt(),
        })
    }

    /// L_reg (Sumner 2007): Σ_j Σ_k∈N(j) ‖A_j (n_k − n_j) + n_j + t_j − (n_k + t_k)‖², as
    /// observations whose weights sum to `weight`.
    pub(crate) fn push_smoothness(
        &self,
        nodes: &[Vec3],
        weight: f64,
        observations: &mut Observations,
    ) {
        let share = weight / (2 * self.pairs.len()).max(1) as f64;
        let metric = [share, share, share, 0.0, 0.0, 0.0];
        for &(a, b) in &self.pairs {
            for (j, k) in [(a, b), (b, a)] {
                let [x, y, z] = sub(nodes[usize::from(k)], nodes[usize::from(j)]);
                let terms = [(j, [x, y, z, 1.0]), (k, [0.0, 0.0, 0.0, -1.0])];
                observations.push(&terms, metric, [x, y, z]);
            }
        }
    }
}

/// Nodes and weights of a vertex.
pub(crate) fn influence_of<'a>(source: &FitSource<'a>, vertex: u32) -> (&'a [u16], &'a [f64]) {
    let q = source.influence.nodes_per_vertex;
    let range = vertex as usize * q..(vertex as usize + 1) * q;
    (&source.influence.nodes[range.clone()], &source.influence.weights[range])
}

/// The terms that make Σ_j M_j y_j the deformed position of a point of the surface: the
/// levers of its nodes, and the constant Σ_j w_j n_j that is to be added.
#[derive(Debug, Default)]
pub(crate) struct Levers {
    pub(crate) terms: Vec<(u16, [f64; 4])>,
    pub(crate) constant: Vec3,
}

impl Levers {
    pub(crate) fn clear(&mut self) {
        self.terms.clear();
        self.constant = [0.0; 3];
    }

    /// Adds a vertex with a share of the point.
    pub(crate) fn add_vertex(&mut self, source: &FitSource, vertex: u32, share: f64) {
        let (nodes, weights) = influence_of(source, vertex);
        for (&node, &weight) in nodes.iter().zip(weights) {
            let origin = source.nodes[usize::from(node)];
            let [x, y, z] = sub(source.positions[vertex as usize], origin);
            let w = share * weight;
            self.constant = add(self.constant, scale(origin, w));
            let lever = [w * x, w * y, w * z, w];
            match self.terms.iter_mut().find(|term| term.0 == node) {
                Some(term) => (0..4).for_each(|i| term.1[i] += lever[i]),
                None => self.terms.push((node, lever)),
            }
        }
    }
}

/// The mean length of the edges of a mesh.
pub(crate) fn mean_edge(positions: &[Vec3], faces: &[[u32; 3]]) -> f64 {
    let sides = faces.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let length = |(a, b): (u32, u32)| distance(positions[a as usize], positions[b as usize]);
    sides.map(length).sum::<f64>() / (3 * faces.len()).max(1) as f64
}
