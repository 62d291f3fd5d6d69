//! How much the motion stretches the edges of a GoF's mesh: a surface that comes apart between two
//! regions has edges there that are many times as long as before.

use kn_mesh::adjacency::EdgeTable;
use kn_mesh::vec3::distance_squared;

/// Quantiles of the lengths of edges, each relative to its length in the I-frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// 95 % of the edges are at most this many times as long.
    pub most: f64,
    /// 99.9 % of the edges are at most this many times as long.
    pub nearly_all: f64,
}

/// The stretch of the edges of a P-frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StretchReport {
    /// Of edges between two regions of influence; `None` where there are none.
    pub borders: Option<Stretch>,
    /// Of all other edges; `None` where there are none.
    pub inside: Option<Stretch>,
}

/// The edges of a GoF's mesh.
#[derive(Debug, Default)]
pub(crate) struct StretchMeter {
    borders: Vec<Edge>,
    inside: Vec<Edge>,
}

#[derive(Clone, Copy, Debug)]
struct Edge {
    ends: [u32; 2],
    /// Squared length in the I-frame.
    squared: f64,
}

impl StretchMeter {
    /// For an I-frame: `positions` `#V × 3` in reference units, `regions` `#V`.
    pub(crate) fn new(positions: &[[i32; 3]], faces: &[[u32; 3]], regions: &[u8]) -> Self {
        let mut meter = Self::default();
        for ends in EdgeTable::new(positions.len(), faces).edges {
            let squared = squared(positions, ends);
            if squared == 0.0 {
                continue;
            }
            let [a, b] = ends.map(|vertex| regions[vertex as usize]);
            let list = if a == b { &mut meter.inside } else { &mut meter.borders };
            list.push(Edge { ends, squared });
        }
        meter
    }

    /// Measures a decoded frame with the same vertices.
    pub(crate) fn measure(&self, positions: &[[i32; 3]]) -> StretchReport {
        let stretch = |edges: &[Edge]| {
            let ratio = |edge: &Edge| squared(positions, edge.ends) / edge.squared;
            let mut ratios: Vec<f64> = edges.iter().map(ratio).collect();
            let nearly_all = quantile(&mut ratios, 0.999)?.sqrt();
            Some(Stretch { most: quantile(&mut ratios, 0.95)?.sqrt(), nearly_all })
        };
        StretchReport { borders: stretch(&self.borders), inside: stretch(&self.inside) }
    }
}

fn squared(positions: &[[i32; 3]], ends: [u32; 2]) -> f64 {
    let [a, b] = ends.map(|vertex| positions[vertex as usize].map(f64::from));
    distance_squared(a, b)
}

/// The smallest value that is not below this share of the values.
fn quantile(values: &mut [f64], share: f64) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    let at = (share * values.len() as f64).ceil() as usize;
    Some(*values.select_nth_unstable_by(at.clamp(1, last + 1) - 1, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_between_regions_are_measured_apart() {
        let before = [[0, 0, 0], [10, 0, 0], [0, 10, 0], [10, 10, 0]];
        let faces = [[0, 1, 2], [1, 3, 2]];
        let meter = StretchMeter::new(&before, &faces, &[4, 4, 4, 5]);
        let mut after = before;
        after[3] = [10, 30, 0];
        let report = meter.measure(&after);
        assert_eq!(report.borders.expect("two edges").nearly_all, 3.0);
        assert_eq!(report.inside, Some(Stretch { most: 1.0, nearly_all: 1.0 }));
        let none = StretchMeter::new(&before, &faces, &[0; 4]).measure(&after);
        assert_eq!(none.borders, None);
        assert_eq!(none.inside.expect("five edges").most, 3.0);
    }
}
