//! The source as the current transforms deform it, in floating point.
//!
//! The encoder's reference comes from `kn_deform::Deformer`, which rounds; a fit needs the smooth
//! function.

use crate::affine::{Affine, affine};
use crate::source::FitSource;
use crate::surface::vertex_normals;
use kn_deform::NodeTransform;
use kn_mesh::vec3::{Vec3, distance, sub};
use rayon::prelude::*;

/// Vertices per unit of parallel work.
const CHUNK: usize = 1024;

/// Positions and normals of the deformed source.
#[derive(Debug, Default)]
pub(crate) struct Deformed {
    /// `#V × 3`.
    pub(crate) positions: Vec<Vec3>,
    /// `#V × 3`, unit length or zero.
    pub(crate) normals: Vec<Vec3>,
    before: Vec<Vec3>,
    matrices: Vec<Affine>,
}

impl Deformed {
    /// x' = Σ_j w_j [A_j (x − n_j) + t_j + n_j] for every vertex (bi-modal paper, eq. (1)).
    pub(crate) fn update(&mut self, source: &FitSource, transforms: &[NodeTransform]) {
        self.matrices.clear();
        self.matrices.extend(transforms.iter().map(affine));
        std::mem::swap(&mut self.before, &mut self.positions);
        self.positions.resize(source.positions.len(), [0.0; 3]);
        let matrices = &self.matrices;
        self.positions.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, out)| {
            for (offset, out) in out.iter_mut().enumerate() {
                *out = blend(source, matrices, chunk * CHUNK + offset);
            }
        });
        vertex_normals(&self.positions, source.faces, &mut self.normals);
    }

    /// The root mean square of what the last update moved.
    pub(crate) fn moved(&self) -> f64 {
        let pairs = self.before.iter().zip(&self.positions);
        let sum: f64 = pairs.map(|(&a, &b)| distance(a, b).powi(2)).sum();
        (sum / self.positions.len().max(1) as f64).sqrt()
    }
}

fn blend(source: &FitSource, matrices: &[Affine], vertex: usize) -> Vec3 {
    let q = source.influence.nodes_per_vertex;
    let mut sum = [0.0; 3];
    for slot in vertex * q..(vertex + 1) * q {
        let node = usize::from(source.influence.nodes[slot]);
        let weight = source.influence.weights[slot];
        let origin = source.nodes[node];
        let [x, y, z] = sub(source.positions[vertex], origin);
        for (axis, row) in matrices[node].iter().enumerate() {
            let moved = row[0] * x + row[1] * y + row[2] * z + row[3];
            sum[axis] += weight * (moved + origin[axis]);
        }
    }
    sum
}
