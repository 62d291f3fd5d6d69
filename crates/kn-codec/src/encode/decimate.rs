//! Decimation of I-frames for low rates: edges collapse onto one of their ends by quadric error, so
//! that vertices stay where they are and keep their labels. Not normative.

use crate::encode::choices::Decimation;
use crate::encode::tuning::DecimationTuning;
use kn_mesh::{Mesh, VertexMap};
use kn_metrics::{TriangleTree, distances_to_surface};
use meshopt::SimplifyOptions;

/// A decimated mesh and its distance from the scan.
pub(crate) struct Decimated {
    pub(crate) mesh: Mesh,
    /// `#V` vertex of `mesh` for each vertex of the input, or [`kn_mesh::DROPPED`].
    pub(crate) vertex_map: Vec<u32>,
    /// Largest distance from a vertex of the input to the coarser surface, world units.
    pub(crate) error: f64,
}

/// Decimates `mesh` (faces in range, coordinates finite) as far as `decimation` says. Topology can
/// stop it above the number of faces asked for. `None` where no face would go.
pub(crate) fn decimate(
    mesh: &Mesh,
    decimation: Decimation,
    tuning: &DecimationTuning,
) -> Option<Decimated> {
    let faces = mesh.faces.len();
    let weight = tuning.label_weight;
    let within =
        |target: usize| (target < faces).then(|| collapse(mesh, target, Bound::None, weight));
    match decimation {
        Decimation::Faces(target) => within(target as usize)?.measured(mesh),
        Decimation::Share(share) => within((faces as f64 * share) as usize)?.measured(mesh),
        Decimation::Error(limit) => up_to(mesh, limit, tuning),
    }
}

/// The quadric error is a mean over planes: its bound is lowered until the largest distance, as
/// measured, is within `limit`.
fn up_to(mesh: &Mesh, limit: f64, tuning: &DecimationTuning) -> Option<Decimated> {
    let mut bound = limit;
    for _ in 0..tuning.attempts {
        let bounded = collapse(mesh, 0, Bound::Absolute(bound as f32), tuning.label_weight);
        let decimated = bounded.measured(mesh)?;
        if decimated.error <= limit {
            return Some(decimated);
        }
        bound *= (limit / decimated.error).clamp(0.1, 0.8);
    }
    None
}

enum Bound {
    None,
    Absolute(f32),
}

/// The faces that are left, as indices of the input's vertices.
struct Collapsed(Vec<[u32; 3]>);

fn collapse(mesh: &Mesh, target: usize, bound: Bound, label_weight: f32) -> Collapsed {
    let (error, options) = match bound {
        Bound::None => (f32::MAX, SimplifyOptions::None),
        Bound::Absolute(error) => (error, SimplifyOptions::ErrorAbsolute),
    };
    let (labels, weights) = label_attributes(&mesh.labels, label_weight);
    let positions = mesh.centred();
    let unlocked = vec![false; mesh.positions.len()];
    let corners = meshopt::simplify_with_attributes_and_locks_decoder(
        mesh.faces.as_flattened(),
        &positions,
        &labels,
        &weights,
        weights.len() * size_of::<f32>(),
        &unlocked,
        3 * target.max(1),
        error,
        options,
        None,
    );
    Collapsed(corners.chunks_exact(3).map(|face| [face[0], face[1], face[2]]).collect())
}

/// `#V × #L` for each label that occurs whether a vertex has it, and `#L` what that weighs.
fn label_attributes(labels: &[u8], weight: f32) -> (Vec<f32>, Vec<f32>) {
    let mut present = labels.to_vec();
    present.sort_unstable();
    present.dedup();
    let row = |label: &u8| {
        let own = *label;
        present.iter().map(move |&one| if one == own { 1.0 } else { 0.0 })
    };
    (labels.iter().flat_map(row).collect(), vec![weight; present.len()])
}

impl Collapsed {
    /// Keeps the vertices that faces use, in their order, and measures; `None` where the surface is
    /// gone or whole.
    fn measured(self, mesh: &Mesh) -> Option<Decimated> {
        let Self(faces) = self;
        if faces.len() == mesh.faces.len() {
            return None;
        }
        let surface = TriangleTree::new(&mesh.positions, &faces).ok()?;
        let error = distances_to_surface(&mesh.positions, None, &surface).ok()?.max;
        let used = VertexMap::of_used(mesh.positions.len(), &faces);
        let coarse = mesh.clone().replace_faces(faces).map_vertices(&used);
        let vertex_map = used.into_targets();
        Some(Decimated { mesh: coarse, vertex_map, error })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kn_mesh::DROPPED;
    use kn_mesh::adjacency::{EdgeTable, half_edge_ends};
    use kn_mesh::vec3::distance;
    use kn_performer::{Performer, PerformerConfig};

    fn figure() -> Mesh {
        let config = PerformerConfig { vertices: 4000, ..PerformerConfig::default() };
        Performer::new(config).expect("sound settings").frame(0)
    }

    fn coarser(mesh: &Mesh, decimation: Decimation) -> Option<Decimated> {
        decimate(mesh, decimation, &DecimationTuning::default())
    }

    /// Edges that only one face has, and their length in all.
    fn boundary(mesh: &Mesh) -> (usize, f64) {
        let table = EdgeTable::new(mesh.positions.len(), &mesh.faces);
        let length = |half_edge: u32| {
            let ends = half_edge_ends(&mesh.faces, half_edge);
            let [a, b] = ends.map(|v| mesh.positions[v as usize]);
            distance(a, b)
        };
        (table.boundary_count(), table.boundary().map(length).sum())
    }

    #[test]
    fn vertices_keep_their_place_and_their_label() {
        let mesh = figure();
        let coarse = coarser(&mesh, Decimation::Share(0.25)).expect("coarser");
        assert!(coarse.mesh.faces.len() * 4 <= mesh.faces.len());
        assert!(coarse.mesh.faces.len() * 5 > mesh.faces.len());
        let mut kept = 0;
        for (vertex, &target) in coarse.vertex_map.iter().enumerate() {
            if target != DROPPED {
                assert_eq!(coarse.mesh.positions[target as usize], mesh.positions[vertex]);
                assert_eq!(coarse.mesh.labels[target as usize], mesh.labels[vertex]);
                kept += 1;
            }
        }
        assert_eq!(kept, coarse.mesh.positions.len());
        let diagonal = mesh.bounding_box().expect("a box").diagonal();
        assert!(coarse.error < 0.01 * diagonal, "{} of {diagonal}", coarse.error);
    }

    #[test]
    fn boundaries_and_borders_between_labels_stay() {
        let mesh = figure();
        let coarse = coarser(&mesh, Decimation::Share(0.25)).expect("coarser").mesh;
        let (before, after) = (boundary(&mesh), boundary(&coarse));
        assert!(after.0 < before.0, "boundaries are coarser too");
        assert!((after.1 / before.1 - 1.0).abs() < 0.1, "{after:?} for {before:?}");
        let present = |labels: &[u8]| {
            let mut labels = labels.to_vec();
            labels.sort_unstable();
            labels.dedup();
            labels
        };
        assert_eq!(present(&coarse.labels), present(&mesh.labels));
        // The label of the nearest corner is the vertex' own for nearly all vertices.
        let surface = TriangleTree::new(&coarse.positions, &coarse.faces).expect("a tree");
        let closest = surface.closest_all(&mesh.positions);
        let agrees = |(closest, label): &(&kn_metrics::Closest, &u8)| {
            let corners = coarse.faces[closest.face as usize];
            corners.iter().any(|&corner| coarse.labels[corner as usize] == **label)
        };
        let agreeing = closest.iter().zip(&mesh.labels).filter(agrees).count();
        assert!(agreeing * 100 > 98 * mesh.labels.len(), "{agreeing} of {}", mesh.labels.len());
    }

    #[test]
    fn an_error_is_a_bound_on_the_largest_distance() {
        let mesh = figure();
        let limit = 1e-3 * mesh.bounding_box().expect("a box").diagonal();
        let coarse = coarser(&mesh, Decimation::Error(limit)).expect("coarser");
        assert!(coarse.error <= limit);
        assert!(coarse.mesh.faces.len() * 10 < mesh.faces.len() * 9);
    }

    #[test]
    fn nothing_to_do_is_none() {
        let mesh = figure();
        assert!(coarser(&mesh, Decimation::Faces(mesh.faces.len() as u32)).is_none());
        assert!(coarser(&mesh, Decimation::Error(1e-12)).is_none());
    }
}
