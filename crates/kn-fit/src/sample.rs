//! Evenly spread samples of a surface's vertices.

use crate::constants::sampling::CELLS_PER_AREA;
use kn_mesh::vec3::{Vec3, distance, scale};

/// Vertices that stand for the surface around them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sample {
    /// Vertex indices, rising.
    pub(crate) vertices: Vec<u32>,
    /// The share of the surface's area that each stands for; the sum is 1.
    pub(crate) weights: Vec<f64>,
}

impl Sample {
    /// Every vertex that has an area.
    pub(crate) fn all(areas: &[f64]) -> Self {
        let total: f64 = areas.iter().sum();
        let with_area = (0..areas.len() as u32).filter(|&v| areas[v as usize] > 0.0);
        let vertices: Vec<u32> = with_area.collect();
        let weights = vertices.iter().map(|&v| areas[v as usize] / total).collect();
        Self { vertices, weights }
    }

    /// About `count` vertices, one per occupied cell of a cubic grid: the one nearest to the
    /// cell's middle.
    pub(crate) fn spread(positions: &[Vec3], areas: &[f64], count: usize) -> Self {
        if positions.len() <= count {
            return Self::all(areas);
        }
        let total: f64 = areas.iter().sum();
        let side = (CELLS_PER_AREA * total / count as f64).sqrt();
        let cell = |v: u32| positions[v as usize].map(|c| (c / side).floor() as i64);
        let mut order: Vec<([i64; 3], u32)> = (0..positions.len() as u32)
            .filter(|&v| areas[v as usize] > 0.0)
            .map(|v| (cell(v), v))
            .collect();
        order.sort_unstable();
        let mut chosen: Vec<(u32, f64)> = order
            .chunk_by(|a, b| a.0 == b.0)
            .map(|members| {
                let middle = scale(members[0].0.map(|c| c as f64 + 0.5), side);
                let off = |v: u32| distance(positions[v as usize], middle);
                let mut best = (f64::INFINITY, 0);
                for &(_, v) in members {
                    if (off(v), v) < best {
                        best = (off(v), v);
                    }
                }
                let area: f64 = members.iter().map(|&(_, v)| areas[v as usize]).sum();
                (best.1, area / total)
            })
            .collect();
        chosen.sort_unstable_by_key(|&(v, _)| v);
        let (vertices, weights) = chosen.into_iter().unzip();
        Self { vertices, weights }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_about_as_many_as_asked_for() {
        let positions: Vec<Vec3> =
            (0..10_000).map(|i| [f64::from(i % 100), f64::from(i / 100), 0.0]).collect();
        let areas = vec![1.0; positions.len()];
        let sample = Sample::spread(&positions, &areas, 1000);
        let count = sample.vertices.len();
        assert!((500..2000).contains(&count), "{count}");
        assert!((sample.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(sample.vertices.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
