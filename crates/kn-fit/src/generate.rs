//! The key-node generator: nodes where the motion needs them (bi-modal paper, section on the
//! bi-modal key node generator).
//!
//! A dense set is fitted to the key frame once; then nodes are removed and inserted between
//! continued fits, so that refinement happens inside the deformation loop.

use crate::error::FitError;
use crate::fitter::Fitter;
use crate::options::FitOptions;
use crate::place::place_farthest;
use crate::source::{FitSource, check_length};
use crate::surface::vertex_areas;
use crate::target::FitTarget;
use crate::vec3::{Vec3, distance, dot, sub};
use kn_deform::{Influence, NodeTransform};

/// The reference mesh that nodes are chosen on.
pub struct NodeSource<'a> {
    /// `#V × 3`, in the unit of the target.
    pub positions: &'a [[f64; 3]],
    /// `#F × 3` indices into `positions`.
    pub faces: &'a [[u32; 3]],
    /// `#V` regions of influence, where there are any: each keeps a node.
    pub regions: Option<&'a [u8]>,
    /// `#V`, whether a node at this vertex is affine.
    pub affine: &'a [bool],
    /// Binds every vertex to nodes at the given vertices, as the decoder will.
    pub bind: &'a dyn Fn(&[u32]) -> Result<Influence, FitError>,
}

/// How many nodes there are to be, and how frames are fitted.
#[derive(Clone, Copy, Debug)]
pub struct GenerateOptions {
    /// The number of nodes; `None` removes nodes for as long as they do not pay.
    pub count: Option<usize>,
    /// How the key frame is fitted.
    pub fit: FitOptions,
}

/// The dense set has this many nodes for each one that is wanted.
const DENSITY: f64 = 1.15;
/// Without a wanted number the dense set has one node for this many vertices.
const VERTICES_PER_NODE: usize = 64;
/// One round removes at most this share of the nodes.
const REMOVED_SHARE: f64 = 0.3;
/// Two nodes with more than this weight on one vertex are never removed together (the paper's).
const CONTROL: f64 = 0.01;
/// A node pays while its removal raises the squared error by this share of the mean per node.
const PAYS: f64 = 0.25;
/// A change of a vertex costs at least this many times the mean squared error, so that where nothing
/// moves in the key frame the nodes stay evenly spread.
const PRIOR: f64 = 5.0;
/// Rounds after the number is reached, in which the nodes that matter least move to where the
/// error is highest.
const MOVING_ROUNDS: usize = 4;
/// The share of the nodes that move in such a round.
const MOVED_SHARE: f64 = 0.08;
/// Inserted nodes keep this share of the node spacing from all others.
const DISTANCE: f64 = 0.35;
/// Bound on all rounds.
const MAX_ROUNDS: usize = 8;

/// Chooses nodes (`#N` vertex indices, rising) such that their motion explains `key`, a frame of
/// the group with much motion.
///
/// # Errors
/// As [`place_farthest`] and [`Fitter::new`]; what `bind` returns.
pub fn generate_nodes(
    source: &NodeSource,
    key: &FitTarget,
    options: &GenerateOptions,
) -> Result<Vec<u32>, FitError> {
    check_length("affine", source.affine.len(), source.positions.len())?;
    let dense = match options.count {
        Some(count) => (DENSITY * count as f64).ceil() as usize,
        None => source.positions.len() / VERTICES_PER_NODE,
    };
    let dense = dense.clamp(1, crate::MAX_NODES);
    let mut nodes = place_farthest(source.positions, source.faces, source.regions, dense)?;
    let areas = vertex_areas(source.positions, source.faces);
    let mut motion: Option<Vec<NodeTransform>> = None;
    let mut moving_rounds = 0;
    for _ in 0..MAX_ROUNDS {
        let trial = Trial::fit(source, key, options, &nodes, motion.take())?;
        let costs = trial.removal_costs(source, &areas);
        let wanted = options.count.unwrap_or_else(|| trial.paying(&costs, &areas));
        let (removed, inserted) = if nodes.len() > wanted {
            let most = (REMOVED_SHARE * nodes.len() as f64).ceil() as usize;
            (trial.removable(source, &costs, most.min(nodes.len() - wanted)), Vec::new())
        } else if moving_rounds < MOVING_ROUNDS {
            moving_rounds += 1;
            let most = (MOVED_SHARE * nodes.len() as f64) as usize;
            let removed = trial.removable(source, &costs, most);
            let spare = wanted.saturating_sub(nodes.len() - removed.len());
            (removed, trial.insertable(source, &areas, spare))
        } else {
            break;
        };
        if removed.is_empty() && inserted.is_empty() {
            break;
        }
        (nodes, motion) = trial.changed(source, &removed, &inserted);
    }
    nodes.sort_unstable();
    Ok(nodes)
}

/// A fitted set of nodes.
struct Trial {
    nodes: Vec<u32>,
    influence: Influence,
    transforms: Vec<NodeTransform>,
    /// `#V × 3`.
    deformed: Vec<Vec3>,
    /// `#V` distances to the key frame.
    errors: Vec<f64>,
}

impl Trial {
    /// Fits from `motion`, or from nothing where it is `None`.
    fn fit(
        source: &NodeSource,
        key: &FitTarget,
        options: &GenerateOptions,
        nodes: &[u32],
        motion: Option<Vec<NodeTransform>>,
    ) -> Result<Self, FitError> {
        let influence = (source.bind)(nodes)?;
        let places: Vec<Vec3> = nodes.iter().map(|&v| source.positions[v as usize]).collect();
        let affine: Vec<bool> = nodes.iter().map(|&v| source.affine[v as usize]).collect();
        let mesh = FitSource {
            positions: source.positions,
            faces: source.faces,
            influence: &influence,
            nodes: &places,
            affine: &affine,
            labels: None,
        };
        let mut fitter = Fitter::new(&mesh)?;
        let transforms = match motion {
            Some(motion) => fitter.continue_frame(&mesh, key, &options.fit, motion)?,
            None => fitter.fit_frame(&mesh, key, &options.fit)?.transforms,
        };
        let deformed = fitter.deformed().to_vec();
        let nearest = key.tree.closest_all(&deformed);
        let errors = nearest.iter().map(|closest| closest.distance_squared.sqrt()).collect();
        Ok(Self { nodes: nodes.to_vec(), influence, transforms, deformed, errors })
    }

    /// Nodes and weights of a vertex.
    fn slots(&self, vertex: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let q = self.influence.nodes_per_vertex;
        let range = vertex * q..(vertex + 1) * q;
        let nodes = self.influence.nodes[range.clone()].iter().map(|&node| usize::from(node));
        nodes.zip(self.influence.weights[range].iter().copied())
    }

    /// `#N`: by how much the squared, area-weighted error of the vertices would rise if the other
    /// nodes of each had to do without this one.
    fn removal_costs(&self, source: &NodeSource, areas: &[f64]) -> Vec<f64> {
        let matrices: Vec<[[f64; 3]; 3]> = self.transforms.iter().map(|t| t.matrix()).collect();
        let total: f64 = areas.iter().sum();
        let noise = PRIOR * self.squared_error(areas) / total;
        let mut costs = vec![0.0; self.nodes.len()];
        for vertex in 0..self.deformed.len() {
            for (node, weight) in self.slots(vertex) {
                if weight < CONTROL {
                    continue;
                }
                let origin = source.positions[self.nodes[node] as usize];
                let offset = sub(source.positions[vertex], origin);
                let (matrix, t) = (&matrices[node], self.transforms[node].translation);
                let alone: Vec3 =
                    std::array::from_fn(|i| dot(matrix[i], offset) + t[i] + origin[i]);
                // x' moves by w (own − others), and own − x' = (1 − w) (own − others).
                let others = weight / (1.0 - weight).max(CONTROL);
                let change = others * distance(alone, self.deformed[vertex]);
                costs[node] += areas[vertex] * (change * change + noise * weight * weight);
            }
        }
        costs
    }

    fn squared_error(&self, areas: &[f64]) -> f64 {
        self.errors.iter().zip(areas).map(|(error, area)| area * error * error).sum()
    }

    /// How many nodes pay for themselves.
    fn paying(&self, costs: &[f64], areas: &[f64]) -> usize {
        let least = PAYS * self.squared_error(areas) / self.nodes.len() as f64;
        costs.iter().filter(|&&cost| cost >= least).count().max(1)
    }

    /// Up to `most` nodes of the lowest cost, no two of which control the same vertex, and not the
    /// last one of a region.
    fn removable(&self, source: &NodeSource, costs: &[f64], most: usize) -> Vec<usize> {
        let region = |node: usize| {
            source.regions.map_or(0, |regions| usize::from(regions[self.nodes[node] as usize]))
        };
        let mut left = [0usize; 256];
        (0..self.nodes.len()).for_each(|node| left[region(node)] += 1);
        let mut controlled = vec![Vec::new(); self.nodes.len()];
        for vertex in 0..self.deformed.len() {
            for (node, weight) in self.slots(vertex) {
                if weight > CONTROL {
                    controlled[node].push(vertex);
                }
            }
        }
        let mut order: Vec<usize> = (0..self.nodes.len()).collect();
        order.sort_by(|&a, &b| costs[a].total_cmp(&costs[b]).then(a.cmp(&b)));
        let mut touched = vec![false; self.deformed.len()];
        let mut removed = Vec::new();
        for node in order {
            let free = controlled[node].iter().all(|&vertex| !touched[vertex]);
            if removed.len() < most && free && left[region(node)] > 1 {
                controlled[node].iter().for_each(|&vertex| touched[vertex] = true);
                left[region(node)] -= 1;
                removed.push(node);
            }
        }
        removed.sort_unstable();
        removed
    }

    /// Up to `most` vertices of the highest error that keep their distance from all nodes and from
    /// each other.
    fn insertable(&self, source: &NodeSource, areas: &[f64], most: usize) -> Vec<u32> {
        let area: f64 = areas.iter().sum();
        let apart = DISTANCE * (area / self.nodes.len() as f64).sqrt();
        let mut taken: Vec<Vec3> =
            self.nodes.iter().map(|&v| source.positions[v as usize]).collect();
        let mut order: Vec<u32> =
            (0..self.errors.len() as u32).filter(|&v| areas[v as usize] > 0.0).collect();
        let error = |v: u32| self.errors[v as usize];
        order.sort_by(|&a, &b| error(b).total_cmp(&error(a)).then(a.cmp(&b)));
        let mut inserted = Vec::new();
        for vertex in order {
            if inserted.len() == most {
                break;
            }
            let place = source.positions[vertex as usize];
            if taken.iter().all(|&other| distance(other, place) >= apart) {
                taken.push(place);
                inserted.push(vertex);
            }
        }
        inserted
    }

    /// The nodes after a change, with the motion to continue from: a new node turns like the
    /// nearest old one and goes where its vertex went.
    fn changed(
        &self,
        source: &NodeSource,
        removed: &[usize],
        inserted: &[u32],
    ) -> (Vec<u32>, Option<Vec<NodeTransform>>) {
        let kept = (0..self.nodes.len()).filter(|node| removed.binary_search(node).is_err());
        let (mut nodes, mut motion): (Vec<u32>, Vec<NodeTransform>) =
            kept.map(|node| (self.nodes[node], self.transforms[node])).unzip();
        for &vertex in inserted {
            if let Some((nearest, _)) = self.slots(vertex as usize).next() {
                let place = source.positions[vertex as usize];
                let translation = sub(self.deformed[vertex as usize], place);
                nodes.push(vertex);
                motion.push(NodeTransform { translation, ..self.transforms[nearest] });
            }
        }
        (nodes, Some(motion))
    }
}
