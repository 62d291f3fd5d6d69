//! Deformation: the new position of a vertex is the weighted sum of its positions under the
//! transforms of its key nodes.

use crate::influence::Influence;
use crate::parallel::*;
use crate::transform::NodeTransform;

/// The error for a decoded position outside the coordinate range (`deform.position.range`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("vertex {vertex} leaves the coordinate range")]
pub struct DeformError {
    /// The first such vertex.
    pub vertex: usize,
}

/// Adding this to a number below 2^51 in magnitude leaves its nearest integer, ties to even, in
/// the low bits of the sum.
const ROUNDING: f64 = 6_755_399_441_055_744.0;
/// Vertices per unit of parallel work.
const CHUNK: usize = 4096;
/// A 3-vector in four lanes; the last is zero.
type Lanes = [f64; 4];

/// Deforms references. It keeps the buffer of the nodes' matrices between calls.
#[derive(Clone, Debug, Default)]
pub struct Deformer {
    /// Per node: the columns of A, then b = (n + t) − A n.
    columns: Vec<[Lanes; 4]>,
}

impl Deformer {
    /// Deforms `reference` into `deformed`: x' = Σ_j w_j (A_j x + b_j), rounded to integers
    /// (bi-modal paper, eq. (1); `deform.blend`, `deform.round`).
    ///
    /// `reference` and `deformed` `#V × 3`, `nodes` `#N × 3` and the translations are integers in
    /// reference units (fractions of a grid step). A position of magnitude `limit` or more is an
    /// error. Does not allocate after the first call.
    ///
    /// # Errors
    /// A vertex leaves the range; the error has the first one.
    ///
    /// # Panics
    /// Where the lengths of the arrays disagree or an influence names a node beyond `nodes`.
    pub fn deform(
        &mut self,
        reference: &[[i32; 3]],
        influence: &Influence,
        nodes: &[[i32; 3]],
        transforms: &[NodeTransform],
        limit: i32,
        deformed: &mut Vec<[i32; 3]>,
    ) -> Result<(), DeformError> {
        assert_eq!(nodes.len(), transforms.len());
        assert_eq!(reference.len(), influence.vertex_count());
        assert_eq!(influence.nodes.len(), influence.weights.len());
        self.columns.clear();
        self.columns.extend(nodes.iter().zip(transforms).map(|(&n, t)| node_columns(n, t)));
        deformed.resize(reference.len(), [0; 3]);
        if reference.is_empty() {
            return Ok(());
        }
        match influence.nodes_per_vertex {
            // The default Q is known to the compiler, so that its loop unrolls.
            4 => self.deform_all::<4>(reference, influence, limit, deformed),
            _ => self.deform_all::<0>(reference, influence, limit, deformed),
        }
    }

    /// `Q` is the number of nodes per vertex, or 0 where it is only known at run time.
    fn deform_all<const Q: usize>(
        &self,
        reference: &[[i32; 3]],
        influence: &Influence,
        limit: i32,
        deformed: &mut [[i32; 3]],
    ) -> Result<(), DeformError> {
        let q = if Q == 0 { influence.nodes_per_vertex } else { Q };
        let inside = deformed
            .par_chunks_mut(CHUNK)
            .zip(reference.par_chunks(CHUNK))
            .zip(influence.nodes.par_chunks(CHUNK * q).zip(influence.weights.par_chunks(CHUNK * q)))
            .map(|((deformed, reference), (nodes, weights))| {
                let slots = nodes.chunks_exact(q).zip(weights.chunks_exact(q));
                let mut inside = true;
                for ((out, &x), (nodes, weights)) in deformed.iter_mut().zip(reference).zip(slots) {
                    let blended = blend(&self.columns, x.map(f64::from), nodes, weights);
                    inside &= blended[..3].iter().all(|v| v.abs() < f64::from(limit) - 0.5);
                    *out = std::array::from_fn(|axis| round(blended[axis]));
                }
                inside
            })
            // The least of all is whether all are inside.
            .min();
        if inside != Some(false) {
            Ok(())
        } else {
            Err(first_outside(self, reference, influence, limit))
        }
    }
}

/// A by columns and b = (n + t) − A n (`deform.node`).
fn node_columns(node: [i32; 3], transform: &NodeTransform) -> [Lanes; 4] {
    let a = transform.matrix();
    let n = node.map(f64::from);
    let t = transform.translation;
    let column = |k: usize| [a[0][k], a[1][k], a[2][k], 0.0];
    let b = |i: usize| (n[i] + t[i]) - ((a[i][0] * n[0] + a[i][1] * n[1]) + a[i][2] * n[2]);
    [column(0), column(1), column(2), [b(0), b(1), b(2), 0.0]]
}

/// Σ_j w_j (((A_j0 x + A_j1 y) + A_j2 z) + b_j), from 0 by rising rank (`deform.blend`).
#[inline(always)]
fn blend(columns: &[[Lanes; 4]], x: [f64; 3], nodes: &[u16], weights: &[f64]) -> Lanes {
    let mut sum = [0.0; 4];
    for (&node, &weight) in nodes.iter().zip(weights) {
        let [c0, c1, c2, b] = &columns[usize::from(node)];
        for lane in 0..4 {
            let moved = ((c0[lane] * x[0] + c1[lane] * x[1]) + c2[lane] * x[2]) + b[lane];
            sum[lane] += weight * moved;
        }
    }
    sum
}

/// The nearest integer, ties to even; exact for magnitudes below 2^31.
#[inline(always)]
fn round(value: f64) -> i32 {
    (value + ROUNDING).to_bits() as i32
}

#[cold]
fn first_outside(
    deformer: &Deformer,
    reference: &[[i32; 3]],
    influence: &Influence,
    limit: i32,
) -> DeformError {
    let q = influence.nodes_per_vertex;
    let outside = |vertex: &usize| {
        let slots = vertex * q..(vertex + 1) * q;
        let (nodes, weights) = (&influence.nodes[slots.clone()], &influence.weights[slots]);
        let blended = blend(&deformer.columns, reference[*vertex].map(f64::from), nodes, weights);
        !blended[..3].iter().all(|v| v.abs() < f64::from(limit) - 0.5)
    };
    DeformError { vertex: (0..reference.len()).find(outside).unwrap_or(0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::influence::{BindOptions, bind};
    use kn_bitstream::params::{InfluenceMode, Weights};

    fn bound(positions: &[[i32; 3]], nodes: &[[i32; 3]], q: usize) -> Influence {
        let options = BindOptions {
            nodes_per_vertex: q,
            weights: Weights::INVERSE_SQUARE,
            mode: InfluenceMode::Strict,
        };
        let mut influence = Influence::default();
        let (v, n) = (vec![0; positions.len()], vec![0; nodes.len()]);
        bind(positions, &v, nodes, &n, &options, &mut influence).unwrap();
        influence
    }

    fn shifted(x: f64) -> NodeTransform {
        NodeTransform { translation: [x, 0.0, 0.0], ..NodeTransform::IDENTITY }
    }

    #[test]
    fn no_motion_gives_the_reference_back() {
        let reference = [[100, -250, 7], [0, 0, 0], [-9000, 12, 260_000]];
        let nodes = [[10, 20, 30], [400, 0, -77], [0, 1, 2], [5, 5, 5]];
        let mut deformed = Vec::new();
        let transforms = [NodeTransform::IDENTITY; 4];
        for q in [1, 3, 4] {
            Deformer::default()
                .deform(
                    &reference,
                    &bound(&reference, &nodes, q),
                    &nodes,
                    &transforms,
                    1 << 28,
                    &mut deformed,
                )
                .unwrap();
            assert_eq!(deformed, reference);
        }
    }

    #[test]
    fn translations_blend_by_weight() {
        let (reference, nodes) = ([[1, 0, 0]], [[0, 0, 0], [3, 0, 0]]);
        let influence = bound(&reference, &nodes, 2);
        let mut deformed = Vec::new();
        let transforms = [shifted(0.0), shifted(100.0)];
        Deformer::default()
            .deform(&reference, &influence, &nodes, &transforms, 1 << 28, &mut deformed)
            .unwrap();
        assert_eq!(deformed, [[21, 0, 0]]);
    }

    #[test]
    fn halves_round_to_even() {
        assert_eq!([0.5, 1.5, -0.5, -2.5, 2.4999].map(round), [0, 2, 0, -2, 2]);
    }

    #[test]
    fn a_vertex_that_leaves_the_range_is_named() {
        let (reference, nodes) = ([[0, 0, 0], [90, 0, 0]], [[0, 0, 0]]);
        let influence = bound(&reference, &nodes, 1);
        let mut deformed = Vec::new();
        let mut deformer = Deformer::default();
        let mut run = |t: f64| {
            deformer.deform(&reference, &influence, &nodes, &[shifted(t)], 100, &mut deformed)
        };
        assert_eq!(run(9.0), Ok(()));
        assert_eq!(run(10.0), Err(DeformError { vertex: 1 }));
        assert_eq!(run(f64::NAN), Err(DeformError { vertex: 0 }));
    }

    #[test]
    fn the_range_ends_where_rounding_would_reach_the_limit() {
        let (reference, nodes) = ([[89, 0, 0], [90, 0, 0]], [[0, 0, 0]]);
        let influence = bound(&reference, &nodes, 1);
        let mut deformed = Vec::new();
        let mut deformer = Deformer::default();
        let mut run = |t: f64| {
            deformer.deform(&reference, &influence, &nodes, &[shifted(t)], 100, &mut deformed)
        };
        assert_eq!(run(9.45), Ok(()));
        assert_eq!(run(9.5), Err(DeformError { vertex: 1 }));
        assert_eq!(run(10.45), Err(DeformError { vertex: 1 }));
    }
}
