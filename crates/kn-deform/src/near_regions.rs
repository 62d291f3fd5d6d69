//! The other regions that the surface leads to from a vertex, and how far they are.

use crate::influence::Placed;
use kn_mesh::adjacency::{Rows, vertex_neighbours};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A region that the surface leads to from a vertex of another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NearRegion {
    pub(crate) region: u8,
    /// Length of the shortest path of edges to a vertex of the region, in grid steps.
    pub(crate) distance: u32,
}

impl NearRegion {
    /// The squared way, an exact integer.
    pub(crate) fn squared(self) -> f64 {
        let distance = f64::from(self.distance);
        distance * distance
    }
}

/// Paths are shorter than this, in grid steps.
const LIMIT: u32 = 1 << 21;
/// Number of other regions of a vertex.
const MOST: usize = 2;

/// For every vertex of an I-frame the two nearest of the other regions, measured along the surface
/// (`deform.influence.near`). Without vertices, no vertex has one.
#[derive(Clone, Debug, Default)]
pub struct NearRegions {
    /// `#V`, the nearest first, equally near ones by rising region.
    of_vertex: Vec<[Option<NearRegion>; MOST]>,
    /// Ends of paths that are not looked at yet, the shortest first, then by region, then by
    /// vertex.
    waiting: BinaryHeap<Reverse<(u32, u8, u32)>>,
}

impl NearRegions {
    /// Forgets all vertices.
    pub fn clear(&mut self) {
        self.of_vertex.clear();
    }

    /// Finds the near regions of the vertices of a mesh with these faces (`#F × 3` indices). Every
    /// edge of a face is one of the surface. A way that is 2^21 grid steps long or longer is none.
    pub fn find(&mut self, vertices: Placed, faces: &[[u32; 3]]) {
        let Placed { positions, regions } = vertices;
        self.clear();
        if regions.windows(2).all(|pair| pair[0] == pair[1]) {
            return;
        }
        self.of_vertex.resize(positions.len(), [None; MOST]);
        let surface =
            Surface { positions, regions, neighbours: vertex_neighbours(positions.len(), faces) };
        for (vertex, &region) in (0_u32..).zip(regions) {
            self.push_around(&surface, vertex, NearRegion { region, distance: 0 });
        }
        while let Some(Reverse((distance, region, vertex))) = self.waiting.pop() {
            let near = NearRegion { region, distance };
            if let Some(free) = self.free(vertex, region) {
                self.of_vertex[vertex as usize][free] = Some(near);
                self.push_around(&surface, vertex, near);
            }
        }
    }

    /// The near regions of a vertex.
    pub(crate) fn of_vertex(&self, vertex: usize) -> impl Iterator<Item = NearRegion> + '_ {
        self.of_vertex.get(vertex).into_iter().flatten().map_while(|near| *near)
    }

    /// Whether these are the regions near so many vertices.
    pub(crate) fn is_of(&self, vertices: usize) -> bool {
        self.of_vertex.is_empty() || self.of_vertex.len() == vertices
    }

    /// The place for another region of a vertex; `None` where it is there already or all are taken.
    fn free(&self, vertex: u32, region: u8) -> Option<usize> {
        for (place, near) in self.of_vertex[vertex as usize].iter().enumerate() {
            match near {
                None => return Some(place),
                Some(near) if near.region == region => return None,
                Some(_) => {}
            }
        }
        None
    }

    /// Lengthens a path that has come to `vertex` by every edge there.
    fn push_around(&mut self, surface: &Surface, vertex: u32, near: NearRegion) {
        for &next in surface.neighbours.row(vertex as usize) {
            let is_other = surface.regions[next as usize] != near.region;
            if is_other && self.free(next, near.region).is_some() {
                let distance = near.distance + surface.length(vertex, next);
                if distance < LIMIT {
                    self.waiting.push(Reverse((distance, near.region, next)));
                }
            }
        }
    }
}

/// The mesh on which ways are measured.
struct Surface<'a> {
    positions: &'a [[i32; 3]],
    regions: &'a [u8],
    neighbours: Rows,
}

impl Surface<'_> {
    /// The length of an edge in whole grid steps, rounded down, at least 1.
    fn length(&self, a: u32, b: u32) -> u32 {
        let [a, b] = [a, b].map(|vertex| self.positions[vertex as usize]);
        let squared: i64 = (0..3).map(|k| i64::from(a[k] - b[k])).map(|d| d * d).sum();
        // Differences are below 2^21, so the root is below 2^22.
        (squared.isqrt() as u32).max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(positions: &[[i32; 3]], regions: &[u8], faces: &[[u32; 3]]) -> Vec<Vec<(u8, u32)>> {
        let mut near = NearRegions::default();
        near.find(Placed { positions, regions }, faces);
        let of_vertex = |vertex| near.of_vertex(vertex).map(|near| (near.region, near.distance));
        (0..positions.len()).map(|vertex| of_vertex(vertex).collect()).collect()
    }

    #[test]
    fn ways_are_measured_along_the_surface() {
        // A strip that comes back beside itself: 0 and 5 touch, but the way is four edges long.
        let positions = [[0, 0, 0], [10, 0, 0], [20, 0, 0], [20, 5, 1], [10, 1, 0], [0, 1, 0]];
        let faces = [[0, 1, 1], [1, 2, 2], [2, 3, 3], [3, 4, 4], [4, 5, 5]];
        let found = near(&positions, &[1, 1, 1, 7, 7, 7], &faces);
        assert_eq!(found[2], [(7, 5)]);
        assert_eq!(found[0], [(7, 25)]);
        assert_eq!(found[5], [(1, 25)]);
        assert_eq!(near(&positions, &[3; 6], &faces), vec![Vec::new(); 6]);
        // An island is nobody's neighbour.
        assert_eq!(near(&positions, &[1, 1, 1, 7, 7, 7], &faces[..2])[0], []);
    }

    #[test]
    fn two_regions_at_most_and_of_equal_ways_the_lower_ones() {
        let positions = [[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9], [0, 0, 0]];
        let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 4]];
        let found = near(&positions, &[5, 8, 2, 4, 5], &faces);
        assert_eq!(found[0], [(2, 9), (4, 9)]);
        // An edge without length counts as 1.
        assert_eq!(found[4], [(4, 9), (2, 10)]);
    }

    #[test]
    fn a_way_is_shorter_than_the_grid_is_wide() {
        let end = (1 << 20) - 1;
        let positions = [[-end, 0, 0], [end, 0, 0], [end, 1, 0], [end, 2, 0]];
        let faces = [[0, 1, 1], [1, 2, 2], [2, 3, 3]];
        let found = near(&positions, &[1, 2, 2, 2], &faces);
        assert_eq!(
            (&found[1][..], &found[2][..]),
            (&[(1, (1 << 21) - 2)][..], &[(1, (1 << 21) - 1)][..])
        );
        assert_eq!(found[3], []);
    }
}
