//! The quadratic form that a correspondence step leaves of the data and smoothness terms.
//!
//! Every term is an observation Σ_j M_j y_j ≈ d of the stacked matrices M_j = [A_j|t_j], measured
//! with a symmetric 3 × 3 metric. Their sum is mᵀHm − 2bᵀm + c, and H has a block only where two
//! nodes share an observation. It is assembled in one pass; after that nothing loops over
//! vertices.

use crate::affine::{Affine, ZERO, dot};
use crate::pattern::BlockPattern;
use kn_mesh::adjacency::Rows;
use kn_mesh::vec3::Vec3;
use rayon::prelude::*;

/// A symmetric 3 × 3 matrix: xx, yy, zz, xy, xz, yz.
pub(crate) type Metric = [f64; 6];

/// The place of each entry of a 3 × 3 matrix in a [`Metric`].
const ENTRY: [[usize; 3]; 3] = [[0, 3, 4], [3, 1, 5], [4, 5, 2]];

/// The block of two nodes: for each entry of the metric the sum of `W y zᵀ`, by columns: entry
/// `[w][l][i]` belongs to z_l y_i.
type Block = [[[f64; 4]; 4]; 6];

const EMPTY: Block = [[[0.0; 4]; 4]; 6];

/// The observations of one correspondence step, in compressed rows.
#[derive(Debug, Default)]
pub(crate) struct Observations {
    starts: Vec<u32>,
    nodes: Vec<u16>,
    /// y_j of each entry.
    levers: Vec<[f64; 4]>,
    metrics: Vec<Metric>,
    /// d of each observation.
    offsets: Vec<Vec3>,
}

impl Observations {
    pub(crate) fn clear(&mut self) {
        self.starts.clear();
        self.nodes.clear();
        self.levers.clear();
        self.metrics.clear();
        self.offsets.clear();
    }

    /// Adds Σ_j M_j y_j ≈ `offset`; no node may occur twice in `terms`.
    pub(crate) fn push(&mut self, terms: &[(u16, [f64; 4])], metric: Metric, offset: Vec3) {
        self.starts.push(self.nodes.len() as u32);
        for &(node, lever) in terms {
            self.nodes.push(node);
            self.levers.push(lever);
        }
        self.metrics.push(metric);
        self.offsets.push(offset);
    }

    fn len(&self) -> usize {
        self.metrics.len()
    }

    fn range(&self, observation: usize) -> std::ops::Range<usize> {
        let end = self.starts.get(observation + 1).map_or(self.nodes.len(), |&end| end as usize);
        self.starts[observation] as usize..end
    }

    /// By node: the observations that have it, and the entry in which.
    fn by_node(&self, node_count: usize) -> Rows<(u32, u32)> {
        let entries = (0..self.len()).flat_map(|observation| {
            let member = move |entry| (observation as u32, entry as u32);
            self.range(observation).map(move |e| (u32::from(self.nodes[e]), member(e)))
        });
        Rows::collect(node_count, entries)
    }
}

/// mᵀHm − 2bᵀm + c.
#[derive(Debug)]
pub(crate) struct QuadraticForm {
    blocks: Vec<Block>,
    linear: Vec<Affine>,
    constant: f64,
}

impl QuadraticForm {
    pub(crate) fn new(pattern: &BlockPattern) -> Self {
        Self {
            blocks: vec![EMPTY; pattern.block_count()],
            linear: vec![ZERO; pattern.node_count()],
            constant: 0.0,
        }
    }

    /// Sums up the observations. Every node gathers its own row, so that the result does not
    /// depend on the number of threads. Pairs of nodes that `pattern` lacks may not occur.
    pub(crate) fn assemble(&mut self, pattern: &BlockPattern, observations: &Observations) {
        let node_count = pattern.node_count();
        let by_node = observations.by_node(node_count);
        let rows = pattern.rows_mut(&mut self.blocks);
        rows.into_par_iter().zip(&mut self.linear).enumerate().with_min_len(8).for_each_init(
            || vec![0u16; node_count],
            |slot_of, (node, (row, linear))| {
                for (slot, &column) in pattern.columns(node).iter().enumerate() {
                    slot_of[usize::from(column)] = slot as u16;
                }
                let members = by_node.row(node);
                assemble_row(node, row, linear, observations, members, slot_of);
            },
        );
        let energy = |(metric, offset): (&Metric, &Vec3)| dot3(apply(metric, *offset), *offset);
        self.constant = observations.metrics.iter().zip(&observations.offsets).map(energy).sum();
    }

    /// Value and gradient at the stacked matrices `m` (`#N`); `gradient` is overwritten.
    pub(crate) fn value_and_gradient(
        &self,
        pattern: &BlockPattern,
        m: &[Affine],
        gradient: &mut [Affine],
    ) -> f64 {
        gradient.fill(ZERO);
        for node in 0..pattern.node_count() {
            let mut own = ZERO;
            for (block, &column) in
                self.blocks[pattern.range(node)].iter().zip(pattern.columns(node))
            {
                let column = usize::from(column);
                multiply(block, &m[column], &mut own);
                if column != node {
                    multiply_transposed(block, &m[node], &mut gradient[column]);
                }
            }
            add(&mut gradient[node], &own, 1.0);
        }
        let mut value = self.constant;
        for ((gradient, linear), m) in gradient.iter_mut().zip(&self.linear).zip(m) {
            value += dot(gradient, m) - 2.0 * dot(linear, m);
            for (gradient, linear) in gradient.iter_mut().zip(linear) {
                for (g, l) in gradient.iter_mut().zip(linear) {
                    *g = 2.0 * (*g - l);
                }
            }
        }
        value
    }

    /// H_block z for one block of the pattern.
    pub(crate) fn block_product(&self, block: usize, z: &Affine) -> Affine {
        let mut out = ZERO;
        multiply(&self.blocks[block], z, &mut out);
        out
    }
}

fn assemble_row(
    node: usize,
    row: &mut [Block],
    linear: &mut Affine,
    observations: &Observations,
    members: &[(u32, u32)],
    slot_of: &[u16],
) {
    row.fill(EMPTY);
    *linear = ZERO;
    for &(observation, entry) in members {
        let metric = &observations.metrics[observation as usize];
        let y = observations.levers[entry as usize];
        let pull = apply(metric, observations.offsets[observation as usize]);
        for axis in 0..3 {
            for i in 0..4 {
                linear[axis][i] += pull[axis] * y[i];
            }
        }
        for other in observations.range(observation as usize) {
            let column = usize::from(observations.nodes[other]);
            if column >= node {
                let block = &mut row[usize::from(slot_of[column])];
                add_outer(block, metric, y, observations.levers[other]);
            }
        }
    }
}

#[inline]
fn add_outer(block: &mut Block, metric: &Metric, y: [f64; 4], z: [f64; 4]) {
    for (part, &w) in block.iter_mut().zip(metric) {
        for (column, z) in part.iter_mut().zip(z) {
            let wz = w * z;
            for (sum, y) in column.iter_mut().zip(y) {
                *sum += wz * y;
            }
        }
    }
}

/// `out += B z`.
#[inline]
fn multiply(block: &Block, z: &Affine, out: &mut Affine) {
    for a in 0..3 {
        for b in 0..3 {
            let part = &block[ENTRY[a][b]];
            for l in 0..4 {
                for i in 0..4 {
                    out[a][i] += part[l][i] * z[b][l];
                }
            }
        }
    }
}

/// `out += Bᵀ y`.
#[inline]
fn multiply_transposed(block: &Block, y: &Affine, out: &mut Affine) {
    for a in 0..3 {
        for b in 0..3 {
            let part = &block[ENTRY[a][b]];
            for l in 0..4 {
                let sum = part[l][0] * y[b][0]
                    + part[l][1] * y[b][1]
                    + part[l][2] * y[b][2]
                    + part[l][3] * y[b][3];
                out[a][l] += sum;
            }
        }
    }
}

fn apply(metric: &Metric, v: Vec3) -> Vec3 {
    std::array::from_fn(|a| (0..3).map(|b| metric[ENTRY[a][b]] * v[b]).sum())
}

fn dot3(a: Vec3, b: Vec3) -> f64 {
    kn_mesh::vec3::dot(a, b)
}

fn add(sum: &mut Affine, value: &Affine, factor: f64) {
    for (sum, value) in sum.iter_mut().zip(value) {
        for (sum, value) in sum.iter_mut().zip(value) {
            *sum += factor * value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::PairSet;

    fn example() -> (BlockPattern, Observations, Vec<Affine>) {
        let mut pairs = PairSet::new(3);
        pairs.add_clique(&[0, 1]);
        pairs.add_clique(&[1, 2]);
        let pattern = BlockPattern::new(&pairs, 3);
        let mut observations = Observations::default();
        let metric = [2.0, 1.0, 3.0, 0.4, -0.2, 0.1];
        observations.push(
            &[(1, [0.5, -1.0, 2.0, 1.0]), (0, [1.0, 0.3, 0.2, 0.7])],
            metric,
            [1.0, 2.0, 3.0],
        );
        observations.push(
            &[(1, [1.5, 0.1, -2.0, 0.6]), (2, [0.2, 0.9, 0.4, 0.4])],
            [1.0, 1.0, 0.5, 0.0, 0.3, 0.0],
            [-1.0, 0.5, 2.0],
        );
        let m = (0..3)
            .map(|n| {
                std::array::from_fn(|a| {
                    std::array::from_fn(|i| 0.3 * n as f64 - 0.2 * a as f64 + 0.1 * (i * i) as f64)
                })
            })
            .collect();
        (pattern, observations, m)
    }

    /// The energy as it is written, observation by observation.
    fn literal(observations: &Observations, m: &[Affine]) -> f64 {
        let mut energy = 0.0;
        for o in 0..observations.len() {
            let mut e = observations.offsets[o].map(|d| -d);
            for entry in observations.range(o) {
                let node = usize::from(observations.nodes[entry]);
                for a in 0..3 {
                    for i in 0..4 {
                        e[a] += m[node][a][i] * observations.levers[entry][i];
                    }
                }
            }
            energy += dot3(apply(&observations.metrics[o], e), e);
        }
        energy
    }

    #[test]
    fn the_form_is_the_sum_of_its_observations() {
        let (pattern, observations, mut m) = example();
        let mut form = QuadraticForm::new(&pattern);
        form.assemble(&pattern, &observations);
        let mut gradient = vec![ZERO; 3];
        let value = form.value_and_gradient(&pattern, &m, &mut gradient);
        assert!((value - literal(&observations, &m)).abs() < 1e-12 * value);
        for node in 0..3 {
            for a in 0..3 {
                for i in 0..4 {
                    let old = m[node][a][i];
                    m[node][a][i] = old + 1e-5;
                    let plus = literal(&observations, &m);
                    m[node][a][i] = old - 1e-5;
                    let minus = literal(&observations, &m);
                    m[node][a][i] = old;
                    let slope = (plus - minus) / 2e-5;
                    assert!((slope - gradient[node][a][i]).abs() < 1e-6, "{node} {a} {i}");
                }
            }
        }
    }
}
