//! Islands: components that are small beside the whole mesh, such as a scanner's noise.

use crate::Mesh;
use crate::adjacency::Components;
use crate::select::VertexMap;
use crate::vec3::{Vec3, cross, norm, sub};

/// The areas of the components of a mesh.
#[derive(Clone, Debug, Default)]
pub struct ComponentAreas {
    components: Components,
    /// `#components`, in squares of the unit of positions.
    areas: Vec<f64>,
    total: f64,
}

/// The islands of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Islands {
    /// Number of components.
    pub count: usize,
    /// Their share of the mesh's area, 0 to 1.
    pub share: f64,
}

impl ComponentAreas {
    /// Measures the components of a mesh (`#V × 3`, `#F × 3` indices of existing vertices).
    pub fn new(positions: &[Vec3], faces: &[[u32; 3]]) -> Self {
        let components = Components::new(positions.len(), faces);
        let mut areas = vec![0.0; components.count];
        let mut total = 0.0;
        for face in faces {
            let [a, b, c] = face.map(|vertex| positions[vertex as usize]);
            let area = 0.5 * norm(cross(sub(b, a), sub(c, a)));
            areas[components.of_vertex[face[0] as usize] as usize] += area;
            total += area;
        }
        Self { components, areas, total }
    }

    /// The islands: the components with less than this share of the area. A mesh of such components
    /// alone has none: they are what it is.
    pub fn islands(&self, share: f64) -> Islands {
        let small = || self.areas.iter().filter(|&&area| self.is_small(area, share));
        let count = small().count();
        if count == self.areas.len() {
            return Islands::default();
        }
        Islands { count, share: small().sum::<f64>() / self.total.max(f64::MIN_POSITIVE) }
    }

    /// `#V`, whether a vertex is on an island.
    pub fn on_islands(&self, share: f64) -> Vec<bool> {
        let none = self.islands(share).count == 0;
        let is_island = |&component: &u32| {
            let area = self.areas.get(component as usize);
            !none && area.is_some_and(|&area| self.is_small(area, share))
        };
        self.components.of_vertex.iter().map(is_island).collect()
    }

    fn is_small(&self, area: f64, share: f64) -> bool {
        area < share * self.total
    }
}

/// A mesh without its islands, see [`ComponentAreas::islands`], and the map of its vertices; `None`
/// where there are none.
pub fn drop_islands(mesh: &Mesh, share: f64) -> Option<(Mesh, VertexMap)> {
    let measured = ComponentAreas::new(&mesh.positions, &mesh.faces);
    let islands = measured.on_islands(share);
    if !islands.contains(&true) {
        return None;
    }
    let mut kept = mesh.clone();
    kept.retain_faces(|face| !islands[face[0] as usize]);
    let used = VertexMap::of_used(kept.positions.len(), &kept.faces);
    Some((kept.map_vertices(&used), used))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DROPPED;

    /// Right triangles with legs of these lengths, apart from each other.
    fn triangles(legs: &[f64]) -> Mesh {
        let corners = |(at, &leg): (usize, &f64)| {
            let x = 100.0 * at as f64;
            [[x, 0.0, 0.0], [x + leg, 0.0, 0.0], [x, leg, 0.0]]
        };
        let positions: Vec<_> = legs.iter().enumerate().flat_map(corners).collect();
        let faces = (0..legs.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Mesh::new(positions, faces).with_labels((0..3 * legs.len() as u8).collect())
    }

    #[test]
    fn small_components_go_with_their_vertices() {
        let mesh = triangles(&[1.0, 10.0, 3.0]);
        let islands = ComponentAreas::new(&mesh.positions, &mesh.faces).islands(0.05);
        assert_eq!((islands.count, islands.share), (1, 1.0 / 110.0));
        let (kept, map) = drop_islands(&mesh, 0.05).expect("an island");
        assert_eq!((kept.faces.len(), kept.labels[0]), (2, 3));
        assert_eq!(map.targets()[..4], [DROPPED, DROPPED, DROPPED, 0]);
        // A vertex that no face uses goes too: what is left is a surface.
        assert_eq!(drop_islands(&mesh, 0.1).expect("two").0.faces, [[0, 1, 2]]);
    }

    #[test]
    fn a_mesh_of_specks_is_left_as_it_is() {
        for legs in [&[1.0; 20][..], &[2.0], &[]] {
            let mesh = triangles(legs);
            let measured = ComponentAreas::new(&mesh.positions, &mesh.faces);
            assert_eq!(measured.islands(0.06), Islands::default());
            assert_eq!(drop_islands(&mesh, 0.06), None);
        }
        assert_eq!(drop_islands(&triangles(&[1.0, 10.0]), 0.0), None);
    }
}
