//! The reach of each point of a body: its distance from the middle along the body, which tells a
//! hand from a forearm in any pose.

use crate::constants::sampling::MIDDLE;
use crate::geodesic::{DistanceField, EdgeGraph};
use kn_mesh::vec3::{Vec3, add, distance, scale};

/// `#V` distances from the centroid, straight to the middle of the surface and along the mesh from
/// there. Bending a limb hardly changes them. A piece that the mesh does not connect with the
/// middle has its straight distances.
pub(crate) fn reach(positions: &[Vec3], areas: &[f64], graph: &EdgeGraph) -> Vec<f64> {
    let total: f64 = areas.iter().sum();
    let moment = |sum, (&p, &area): (&Vec3, &f64)| add(sum, scale(p, area));
    let centroid = scale(positions.iter().zip(areas).fold([0.0; 3], moment), 1.0 / total);
    let straight: Vec<f64> = positions.iter().map(|&p| distance(p, centroid)).collect();
    let on_surface = || straight.iter().zip(areas).enumerate().filter(|(_, (_, a))| **a > 0.0);
    let nearest = on_surface().map(|(_, (&d, _))| d).fold(f64::INFINITY, f64::min);
    let middle = on_surface().map(|(v, (&d, _))| (v as u32, d)).filter(|m| m.1 <= MIDDLE * nearest);
    let mut field = DistanceField::new(positions.len());
    field.add_sources(graph, 0, middle);
    let along = field.distance.into_iter().zip(straight);
    along.map(|(along, straight)| if along.is_finite() { along } else { straight }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::vertex_areas;
    use kn_mesh::adjacency::EdgeTable;

    /// A strip two rows wide whose columns are at `places`.
    fn strip(places: &[[f64; 2]]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let positions = places.iter().flat_map(|&[x, y]| [[x, y, 0.0], [x, y, 1.0]]).collect();
        let quads = (0..2 * (places.len() as u32 - 1)).step_by(2);
        (positions, quads.flat_map(|a| [[a, a + 1, a + 2], [a + 1, a + 3, a + 2]]).collect())
    }

    fn reach_of(positions: &[Vec3], faces: &[[u32; 3]]) -> Vec<f64> {
        let edges = EdgeTable::new(positions.len(), faces).edges;
        let graph = EdgeGraph::new(positions, &edges, |_, _| true);
        reach(positions, &vertex_areas(positions, faces), &graph)
    }

    #[test]
    fn a_bent_limb_reaches_as_far() {
        let straight: Vec<[f64; 2]> = (0..41).map(|i| [f64::from(i), 0.0]).collect();
        let mut bent = straight.clone();
        for i in 31..41 {
            bent[i] = [30.0, (i - 30) as f64];
            bent[40 - i] = [10.0, (i - 30) as f64];
        }
        let [straight, bent] = [straight, bent].map(|places| strip(&places));
        let (a, b) = (reach_of(&straight.0, &straight.1), reach_of(&bent.0, &bent.1));
        assert!((a[80] - 20.0).abs() < 2.0, "{}", a[80]);
        assert!((a[80] - b[80]).abs() < 3.0, "{} {}", a[80], b[80]);
    }

    #[test]
    fn a_loose_piece_has_its_straight_distance() {
        let places: Vec<[f64; 2]> = (0..41).map(|i| [f64::from(i), 0.0]).collect();
        let (mut positions, mut faces) = strip(&places);
        positions.extend([[20.0, 7.0, 0.5], [20.1, 7.0, 0.5], [20.0, 7.1, 0.5]]);
        faces.push([82, 83, 84]);
        let found = reach_of(&positions, &faces);
        assert!((found[82] - 7.0).abs() < 0.1, "{}", found[82]);
    }
}
