//! The side of the border between two labels on which a vertex is: a linear fit to the labels along
//! it (`spec/05-intra.md`). Binary64 in the written order.

use super::predict::Point;
use super::surface::{Spoke, Surface};
use kn_mesh::vec3::norm_squared;

/// Largest number of edges from a vertex to the known vertices that are searched.
const RINGS: usize = 4;
/// Largest number of vertices that a search finds, and of neighbours that it visits at each vertex.
/// It keeps the search fast at vertices with very many triangles.
const MOST_FOUND: usize = 256;
const MOST_SPOKES: usize = 32;
/// A vertex at the centre weighs four times more than one at the mean distance, nearly.
const NEARNESS: f64 = 0.25;
/// Weight of the slope of a border against the known samples.
const RIDGE: f64 = 1.0 / 256.0;
/// Contexts for a fitted value v: 3v, rounded, is −8 to 8.
pub(super) const LEANS: usize = 17;

/// The vertices around a vertex, with the buffers of the search.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighbourhood {
    /// `#M` the search that last met each vertex.
    met: Vec<u32>,
    search: u32,
    found: Vec<u32>,
}

impl Neighbourhood {
    /// Starts over with `vertices`.
    pub(super) fn restart(&mut self, vertices: usize) {
        self.met.clear();
        self.met.resize(vertices, 0);
        self.search = 0;
    }

    /// Vertices up to [`RINGS`] edges from `vertex`, itself first, breadth first; no dummies, and
    /// at most [`MOST_FOUND`].
    pub(super) fn gather(&mut self, surface: &Surface, vertex: u32) -> &[u32] {
        self.search += 1;
        self.found.clear();
        self.found.push(vertex);
        self.met[vertex as usize] = self.search;
        let mut from = 0;
        for _ in 0..RINGS {
            let to = self.found.len();
            for place in from..to {
                for spoke in near_ring(surface, self.found[place]) {
                    let met = &mut self.met[spoke.neighbour as usize];
                    if self.found.len() == MOST_FOUND {
                        return &self.found;
                    }
                    if *met != self.search && !surface.is_dummy(spoke.neighbour) {
                        *met = self.search;
                        self.found.push(spoke.neighbour);
                    }
                }
            }
            from = to;
        }
        &self.found
    }
}

/// The first neighbours of a vertex.
pub(super) fn near_ring(surface: &Surface, vertex: u32) -> &[Spoke] {
    let ring = surface.ring(vertex);
    &ring[..ring.len().min(MOST_SPOKES)]
}

/// The context of a vertex at `own`: the value there of the linear function that fits `samples`,
/// points along the border with 1 on the expected side and −1 on the other.
pub(super) fn lean(own: &Point, samples: &[(Point, f64)]) -> usize {
    let middle = LEANS / 2;
    if samples.is_empty() {
        return middle;
    }
    let third = (3.0 * fitted(own, samples) + 0.5).floor();
    (third.clamp(-(middle as f64), middle as f64) + middle as f64) as usize
}

/// Minimises Σ w·(g·d + v − t)² + ridge·|g|² over g and v by elimination, and returns v.
fn fitted(own: &Point, samples: &[(Point, f64)]) -> f64 {
    let away =
        |point: &Point| [0, 1, 2].map(|k| point.position[k] - own.position[k]).map(f64::from);
    let total: f64 = samples.iter().map(|(point, _)| norm_squared(away(point))).sum();
    let scale = (total / samples.len() as f64).max(1.0);
    let mut normal = [[0.0; 5]; 4];
    let mut weights = 0.0;
    for (point, target) in samples {
        let d = away(point);
        let weight = 1.0 / (norm_squared(d) / scale + NEARNESS);
        let row = [d[0], d[1], d[2], 1.0, *target];
        weights += weight;
        for i in 0..4 {
            for j in i..5 {
                normal[i][j] += weight * row[i] * row[j];
            }
        }
    }
    let ridge = RIDGE * weights * scale;
    (0..3).for_each(|i| normal[i][i] += ridge);
    for i in 0..3 {
        for j in i + 1..4 {
            let factor = normal[i][j] / normal[i][i];
            for k in j..5 {
                normal[j][k] -= factor * normal[i][k];
            }
        }
    }
    normal[3][4] / normal[3][3]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(position: [i32; 3]) -> Point {
        Point { position, error: 0 }
    }

    #[test]
    fn a_vertex_beyond_a_straight_border_leans_to_its_side() {
        let side = |x: i32| if x > 0 { 1.0 } else { -1.0 };
        let samples: Vec<_> = (0..20)
            .map(|i| [if i % 2 == 0 { 10 } else { -10 }, 10 * i, i % 3])
            .map(|p| (point(p), side(p[0])))
            .collect();
        assert_eq!(lean(&point([0, 200, 0]), &samples), 8);
        assert!(lean(&point([14, 200, 0]), &samples) >= 10);
        assert!(lean(&point([-14, 200, 0]), &samples) <= 6);
        assert_eq!(lean(&point([0; 3]), &[]), 8);
    }

    #[test]
    fn samples_in_one_place_or_far_away_do_no_harm() {
        let far = (1 << 20) - 1;
        for own in [[0; 3], [far, -far, far]] {
            for at in [[0; 3], [-far, far, -far]] {
                for count in [1, 2, 9] {
                    let value = fitted(&point(own), &vec![(point(at), 1.0); count]);
                    assert!((0.0..=1.000_001).contains(&value), "{value}");
                }
            }
        }
    }
}
