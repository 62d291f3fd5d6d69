//! Part-wise starts: each labelled part is first aligned rigidly (the paper's segmentation-enhanced
//! correspondence estimation).

use crate::constants::starts::{ELONGATED, LEAST_AREA, LEAST_COSINE};
use crate::group::Group;
use crate::sample::Sample;
use crate::source::FitSource;
use crate::target::FitTarget;
use kn_bitstream::params::Combination;
use kn_deform::NodeTransform;
use kn_mesh::vec3::{Vec3, add, cross, distance, dot, norm, scale, sub};
use nalgebra::{Matrix3, SymmetricEigen};

/// The position and the direction of a part.
struct Moments {
    area: f64,
    centroid: Vec3,
    /// Unit direction of the longest moment, where the part is elongated.
    axis: Option<Vec3>,
}

/// Node transforms that carry each labelled part of the source onto the same part of the target;
/// `None` where either mesh has no labels or no part can be aligned. A part moves only if that
/// brings its samples nearer to the target's samples of the same label.
pub(crate) fn align(
    group: &Group,
    source: &FitSource,
    target: &FitTarget,
    combinations: &[Combination],
) -> Option<Vec<NodeTransform>> {
    let (source_labels, target_labels) = (source.labels?, target.labels.as_ref()?);
    let mut transforms = vec![NodeTransform::IDENTITY; source.nodes.len()];
    let node_labels: Vec<u8> = source
        .nodes
        .iter()
        .map(|&node| label_at(source, source_labels, &group.sample, node))
        .collect();
    let mut any = false;
    for label in 0..=u8::MAX {
        let own = part(&group.sample, source.positions, source_labels, label);
        let other = part(&target.sample, &target.positions, target_labels, label);
        let (Some(from), Some(to)) = (moments(&own), moments(&other)) else { continue };
        if from.area < LEAST_AREA || to.area < LEAST_AREA {
            continue;
        }
        let motion = Motion::between(&from, &to);
        if motion.gap(&own, &other) >= Motion::NONE.gap(&own, &other) {
            continue;
        }
        any = true;
        for (node, transform) in transforms.iter_mut().enumerate() {
            if node_labels[node] == label {
                *transform = motion.transform(source.nodes[node], combinations[node]);
            }
        }
    }
    any.then_some(transforms)
}

/// Samples of one part with their areas.
fn part(sample: &Sample, positions: &[Vec3], labels: &[u8], label: u8) -> Vec<(Vec3, f64)> {
    let members = sample.vertices.iter().zip(&sample.weights);
    let members = members.filter(|&(&v, _)| labels[v as usize] == label);
    members.map(|(&v, &weight)| (positions[v as usize], weight)).collect()
}

/// The label of the sample nearest to a node.
fn label_at(source: &FitSource, labels: &[u8], sample: &Sample, node: Vec3) -> u8 {
    let mut best = (f64::INFINITY, 0);
    for &v in &sample.vertices {
        let candidate = distance(source.positions[v as usize], node);
        if candidate < best.0 {
            best = (candidate, labels[v as usize]);
        }
    }
    best.1
}

fn moments(part: &[(Vec3, f64)]) -> Option<Moments> {
    let area: f64 = part.iter().map(|&(_, w)| w).sum();
    if area <= 0.0 {
        return None;
    }
    let sum = part.iter().fold([0.0; 3], |sum, &(p, w)| add(sum, scale(p, w)));
    let centroid = scale(sum, 1.0 / area);
    let mut spread = Matrix3::zeros();
    for &(p, w) in part {
        let d = nalgebra::Vector3::from(sub(p, centroid));
        spread += d * d.transpose() * w;
    }
    let eigen = SymmetricEigen::new(spread);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let elongated = eigen.eigenvalues[order[0]] >= ELONGATED * eigen.eigenvalues[order[1]];
    let axis = elongated.then(|| eigen.eigenvectors.column(order[0]).into_owned().into());
    Some(Moments { area, centroid, axis })
}

/// A rigid motion x ↦ R (x − from) + to, R turning about `axis` (length: sine) with `cosine`.
struct Motion {
    from: Vec3,
    to: Vec3,
    axis: Vec3,
    cosine: f64,
}

impl Motion {
    const NONE: Self = Self { from: [0.0; 3], to: [0.0; 3], axis: [0.0; 3], cosine: 1.0 };

    /// Centroid onto centroid and, where both parts have one, axis onto axis by the smallest turn.
    fn between(from: &Moments, to: &Moments) -> Self {
        let still = Self { from: from.centroid, to: to.centroid, ..Self::NONE };
        let (Some(a), Some(b)) = (from.axis, to.axis) else { return still };
        // An axis has no sign: take the end that is nearer.
        let b = if dot(a, b) < 0.0 { scale(b, -1.0) } else { b };
        let cosine = dot(a, b);
        if cosine < LEAST_COSINE {
            return still;
        }
        Self { axis: cross(a, b), cosine, ..still }
    }

    /// Rodrigues' formula with the axis at the length of the sine.
    fn rotate(&self, v: Vec3) -> Vec3 {
        let along = dot(self.axis, v) / (1.0 + self.cosine);
        add(add(scale(v, self.cosine), cross(self.axis, v)), scale(self.axis, along))
    }

    fn apply(&self, p: Vec3) -> Vec3 {
        add(self.rotate(sub(p, self.from)), self.to)
    }

    /// The mean distance of the moved samples of `own` to the nearest of `other`.
    fn gap(&self, own: &[(Vec3, f64)], other: &[(Vec3, f64)]) -> f64 {
        let nearest =
            |p: Vec3| other.iter().map(|&(q, _)| distance(p, q)).fold(f64::INFINITY, f64::min);
        own.iter().map(|&(p, w)| w * nearest(self.apply(p))).sum()
    }

    /// The same motion about a node; a node that may not rotate only moves.
    fn transform(&self, node: Vec3, combination: Combination) -> NodeTransform {
        let translation = sub(self.apply(node), node);
        let rotation = if combination.rotation { self.euler_angles() } else { [0.0; 3] };
        NodeTransform { rotation, translation, ..NodeTransform::IDENTITY }
    }

    /// θx, θy, θz of R = Rz Ry Rx.
    fn euler_angles(&self) -> Vec3 {
        let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|e| self.rotate(e));
        let [[r00, r10, r20], [_, _, r21], [_, _, r22]] = columns;
        let level = norm([r21, r22, 0.0]);
        [libm::atan2(r21, r22), libm::atan2(-r20, level), libm::atan2(r10, r00)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_limb_is_found() {
        let limb: Vec<(Vec3, f64)> =
            (0..50).map(|i| ([f64::from(i), f64::from(i % 3), 0.0], 1.0)).collect();
        let truth = Motion {
            from: [25.0, 1.0, 0.0],
            to: [30.0, -4.0, 2.0],
            axis: [0.0, 0.6, 0.0],
            cosine: 0.8,
        };
        let moved: Vec<(Vec3, f64)> = limb.iter().map(|&(p, w)| (truth.apply(p), w)).collect();
        let (from, to) = (moments(&limb).expect("area"), moments(&moved).expect("area"));
        let found = Motion::between(&from, &to);
        for &(p, _) in &limb {
            assert!(distance(found.apply(p), truth.apply(p)) < 0.5);
        }
        let node = [10.0, 1.0, 0.0];
        let transform = found.transform(node, Combination::RT);
        let matrix = transform.matrix();
        let offset = sub(limb[40].0, node);
        let turned = matrix.map(|row| dot(row, offset));
        let by_node = add(add(turned, node), transform.translation);
        assert!(distance(by_node, found.apply(limb[40].0)) < 1e-9);
    }
}
