//! One set of nodes in the deformation loop: what each is worth, and where one is missing.

use super::{GenerateOptions, NodeSource};
use crate::constants::generator::{CONTROL, DISTANCE, PRIOR, SMOOTHING};
use crate::error::{FitError, Side};
use crate::fitter::Fitter;
use crate::place::place_farthest;
use crate::source::FitSource;
use crate::surface::vertex_areas;
use crate::target::FitTarget;
use kn_deform::{Influence, NodeTransform};
use kn_mesh::vec3::{Vec3, distance, dot, sub};
use kn_metrics::{
    DEFAULT_LEVELS, Interpolation, Msdm2Error, Msdm2Surface, TriangleTree, msdm2_one_way,
};

/// The data that all trials of a GoF share.
pub(super) struct Setting<'a> {
    source: &'a NodeSource<'a>,
    key: &'a FitTarget,
    options: &'a GenerateOptions<'a>,
    /// `#V`.
    areas: Vec<f64>,
    area: f64,
    /// The key frame as MSDM2's original, where it ranks.
    original: Option<Msdm2Surface>,
}

impl<'a> Setting<'a> {
    pub(super) fn new(
        source: &'a NodeSource<'a>,
        key: &'a FitTarget,
        options: &'a GenerateOptions<'a>,
    ) -> Self {
        let areas = vertex_areas(source.positions, source.faces);
        Self { area: areas.iter().sum(), areas, source, key, options, original: None }
    }

    /// Number of regions that have a vertex.
    pub(super) fn regions(&self) -> usize {
        let mut present = [false; 256];
        self.source.regions.unwrap_or(&[0]).iter().for_each(|&r| present[usize::from(r)] = true);
        present.iter().filter(|&&present| present).count()
    }

    /// Prepares ranks by MSDM2.
    pub(super) fn with_msdm2(mut self) -> Result<Self, FitError> {
        let original = Msdm2Surface::new(&self.key.positions, &self.key.faces, DEFAULT_LEVELS);
        self.original = Some(original.map_err(|error| refused(error, Side::Target))?);
        Ok(self)
    }
}

fn refused(error: Msdm2Error, mesh: Side) -> FitError {
    match error {
        Msdm2Error::Mesh(source) => FitError::Tree { mesh, source },
        _ => FitError::NoSurface { mesh },
    }
}

/// A fitted set of nodes.
pub(super) struct Trial<'a> {
    setting: &'a Setting<'a>,
    /// `#N` vertices.
    pub(super) nodes: Vec<u32>,
    influence: Influence,
    transforms: Vec<NodeTransform>,
    /// `#V × 3`.
    deformed: Vec<Vec3>,
    /// `#V` squared distances to the key frame.
    errors: Vec<f64>,
    /// Whether the key frame is not explained.
    pub(super) failed: bool,
}

impl<'a> Trial<'a> {
    /// About `count` farthest points, fitted from rest.
    pub(super) fn dense(setting: &'a Setting<'a>, count: usize) -> Result<Self, FitError> {
        let NodeSource { positions, faces, regions, affine, .. } = *setting.source;
        let count = count.clamp(1, crate::MAX_NODES);
        Self::fit(setting, place_farthest(positions, faces, regions, Some(affine), count)?, None)
    }

    /// The number of nodes that make a share of all, at least one.
    pub(super) fn share(&self, share: f64) -> usize {
        (share * self.nodes.len() as f64).ceil() as usize
    }

    /// Fits from `motion`, or from rest where it is `None`.
    fn fit(
        setting: &'a Setting<'a>,
        nodes: Vec<u32>,
        motion: Option<Vec<NodeTransform>>,
    ) -> Result<Self, FitError> {
        let Setting { source, key, options, .. } = setting;
        let influence = (source.bind)(&nodes)?;
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
        let (transforms, failed) = match motion {
            Some(motion) => (fitter.continue_frame(&mesh, key, &options.fit, motion)?, false),
            None => {
                let found = fitter.fit_frame(&mesh, key, &options.fit)?;
                let failed = !(options.explains)(&found.report);
                (found.transforms, failed)
            }
        };
        let deformed = fitter.deformed().to_vec();
        let nearest = key.tree.closest_all(&deformed);
        let errors = nearest.iter().map(|closest| closest.distance_squared).collect();
        Ok(Self { setting, nodes, influence, transforms, deformed, errors, failed })
    }

    /// Nodes and weights of a vertex.
    fn slots(&self, vertex: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let q = self.influence.nodes_per_vertex;
        let range = vertex * q..(vertex + 1) * q;
        let nodes = self.influence.nodes[range.clone()].iter().map(|&node| usize::from(node));
        nodes.zip(self.influence.weights[range].iter().copied())
    }

    /// `#N`: by how much the mean squared error would rise if the other nodes of each vertex had
    /// to do without this one.
    pub(super) fn removal_costs(&self, prior: f64) -> Vec<f64> {
        let Setting { source, areas, area, .. } = self.setting;
        let matrices: Vec<[[f64; 3]; 3]> = self.transforms.iter().map(|t| t.matrix()).collect();
        let noise = prior * self.squared_error();
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
                let share = areas[vertex] / area;
                costs[node] += share * (change * change + noise * weight * weight);
            }
        }
        costs
    }

    /// The mean squared distance to the key frame.
    fn squared_error(&self) -> f64 {
        let Setting { areas, area, .. } = self.setting;
        self.errors.iter().zip(areas).map(|(error, share)| share * error).sum::<f64>() / area
    }

    /// Number of nodes that are worth `price`, a share of the mean squared distance.
    pub(super) fn paying(&self, price: f64) -> usize {
        let price = price * self.squared_error();
        self.removal_costs(0.0).iter().filter(|&&cost| cost > price).count().max(1)
    }

    /// Up to `most` nodes of the lowest cost, no two of which control the same vertex, and not the
    /// last one of a region.
    pub(super) fn removable(&self, most: usize) -> Vec<usize> {
        let costs = self.removal_costs(PRIOR);
        let mut left = [0usize; 256];
        (0..self.nodes.len()).for_each(|node| left[self.region(node)] += 1);
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
            if removed.len() < most && free && left[self.region(node)] > 1 {
                controlled[node].iter().for_each(|&vertex| touched[vertex] = true);
                left[self.region(node)] -= 1;
                removed.push(node);
            }
        }
        removed.sort_unstable();
        removed
    }

    fn region(&self, node: usize) -> usize {
        let regions = self.setting.source.regions;
        regions.map_or(0, |regions| usize::from(regions[self.nodes[node] as usize]))
    }

    /// `#V`: how much a node is missing at each vertex.
    fn ranks(&self) -> Result<Vec<f64>, FitError> {
        let faces = self.setting.source.faces;
        let Some(original) = &self.setting.original else { return self.ranks_by_distance() };
        let distorted = Msdm2Surface::new(&self.deformed, faces, DEFAULT_LEVELS)
            .map_err(|error| refused(error, Side::Source))?;
        Ok(msdm2_one_way(original, &distorted, Interpolation::default()).local)
    }

    /// Squared distances both ways, averaged over the neighbourhood: one vertex beside a hole
    /// needs no node.
    fn ranks_by_distance(&self) -> Result<Vec<f64>, FitError> {
        let Setting { source, key, areas, area, .. } = self.setting;
        let tree = TriangleTree::new(&self.deformed, source.faces)
            .map_err(|source| FitError::Tree { mesh: Side::Source, source })?;
        let mut ranks = self.errors.clone();
        for (&vertex, &share) in key.sample.vertices.iter().zip(&key.sample.weights) {
            let closest = tree.closest(key.positions[vertex as usize]);
            let energy = share * area * closest.distance_squared;
            for (corner, &v) in source.faces[closest.face as usize].iter().enumerate() {
                if areas[v as usize] > 0.0 {
                    ranks[v as usize] += energy * closest.barycentric[corner] / areas[v as usize];
                }
            }
        }
        for _ in 0..SMOOTHING {
            self.smooth(&mut ranks);
        }
        Ok(ranks)
    }

    /// Every value becomes the mean of its neighbourhood, weighted by area.
    fn smooth(&self, values: &mut [f64]) {
        let Setting { source, areas, .. } = self.setting;
        let mut sums = vec![(0.0, 0.0); values.len()];
        for face in source.faces {
            let terms = face.map(|v| (areas[v as usize] * values[v as usize], areas[v as usize]));
            let sum = terms.iter().fold((0.0, 0.0), |sum, term| (sum.0 + term.0, sum.1 + term.1));
            for v in face {
                let total = &mut sums[*v as usize];
                *total = (total.0 + sum.0, total.1 + sum.1);
            }
        }
        for (value, (sum, weight)) in values.iter_mut().zip(sums) {
            if weight > 0.0 {
                *value = sum / weight;
            }
        }
    }

    /// Up to `most` vertices where nodes are missed most, which keep their distance from all nodes
    /// and from each other.
    pub(super) fn insertable(&self, most: usize) -> Result<Vec<u32>, FitError> {
        let Setting { source, areas, area, .. } = self.setting;
        let apart = DISTANCE * (area / self.nodes.len() as f64).sqrt();
        let ranks = self.ranks()?;
        let mut taken: Vec<Vec3> =
            self.nodes.iter().map(|&v| source.positions[v as usize]).collect();
        let mut order: Vec<u32> =
            (0..ranks.len() as u32).filter(|&v| areas[v as usize] > 0.0).collect();
        let rank = |v: u32| ranks[v as usize];
        order.sort_by(|&a, &b| rank(b).total_cmp(&rank(a)).then(a.cmp(&b)));
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
        Ok(inserted)
    }

    /// The nodes after a change, fitted on: a new node turns like the nearest old one and goes
    /// where its vertex went.
    pub(super) fn changed(&self, removed: &[usize], inserted: &[u32]) -> Result<Self, FitError> {
        let positions = self.setting.source.positions;
        let kept = (0..self.nodes.len()).filter(|node| removed.binary_search(node).is_err());
        let (mut nodes, mut motion): (Vec<u32>, Vec<NodeTransform>) =
            kept.map(|node| (self.nodes[node], self.transforms[node])).unzip();
        for &vertex in inserted {
            if let Some((nearest, _)) = self.slots(vertex as usize).next() {
                let translation = sub(self.deformed[vertex as usize], positions[vertex as usize]);
                nodes.push(vertex);
                motion.push(NodeTransform { translation, ..self.transforms[nearest] });
            }
        }
        Self::fit(self.setting, nodes, Some(motion))
    }
}
