//! Exact search for the vertex that is nearest to a point (`nodes.label.nearest`).

use kn_mesh::adjacency::Rows;

/// Vertices in slabs across the longest side of their box. A search goes outwards from the point's
/// slab and ends where a whole slab is too far: the result is that of a search through them all.
pub(crate) struct Slabs<'a> {
    positions: &'a [[i32; 3]],
    axis: usize,
    /// Lower end of the first slab.
    low: i32,
    thickness: i64,
    /// A row of vertices for each slab, by rising index.
    slabs: Rows,
}

/// Mean number of vertices in a slab. Slabs of an uneven mesh hold more or fewer.
const VERTICES_PER_SLAB: usize = 16;

impl<'a> Slabs<'a> {
    /// Sorts the vertices (`#V × 3`, magnitudes below 2^30, at least one) into slabs.
    pub(crate) fn new(positions: &'a [[i32; 3]]) -> Self {
        let (axis, low, side) = longest_axis(positions);
        let wanted = (positions.len() / VERTICES_PER_SLAB + 1) as i64;
        let thickness = side / wanted + 1;
        let slab = |p: &[i32; 3]| ((i64::from(p[axis]) - i64::from(low)) / thickness) as u32;
        let vertices = positions.iter().zip(0u32..).map(|(p, vertex)| (slab(p), vertex));
        let slabs = Rows::collect((side / thickness) as usize + 1, vertices);
        Self { positions, axis, low, thickness, slabs }
    }

    /// The vertex nearest to `point`, the lowest among equals; squared distances are exact.
    pub(crate) fn nearest(&self, point: [i32; 3]) -> usize {
        let offset = i64::from(point[self.axis]) - i64::from(self.low);
        let last = self.slabs.len() as i64 - 1;
        let home = (offset / self.thickness).clamp(0, last);
        let mut best = (i64::MAX, u32::MAX);
        for slab in home..=last {
            let ahead = (slab * self.thickness - offset).max(0);
            if ahead * ahead > best.0 {
                break;
            }
            self.search(slab as usize, point, &mut best);
        }
        for slab in (0..home).rev() {
            let behind = (offset - (slab + 1) * self.thickness + 1).max(0);
            if behind * behind > best.0 {
                break;
            }
            self.search(slab as usize, point, &mut best);
        }
        best.1 as usize
    }

    fn search(&self, slab: usize, point: [i32; 3], best: &mut (i64, u32)) {
        for &vertex in self.slabs.row(slab) {
            let position = self.positions[vertex as usize];
            let difference = |axis: usize| i64::from(position[axis]) - i64::from(point[axis]);
            let squared = (0..3).map(difference).map(|d| d * d).sum();
            *best = (*best).min((squared, vertex));
        }
    }
}

/// The axis along which the box is longest, its lower end and its length.
fn longest_axis(positions: &[[i32; 3]]) -> (usize, i32, i64) {
    let mut longest = (0, 0, -1);
    for axis in 0..3 {
        let along = positions.iter().map(|p| p[axis]);
        let low = along.clone().min().unwrap_or(0);
        let side = i64::from(along.max().unwrap_or(0)) - i64::from(low);
        if side > longest.2 {
            longest = (axis, low, side);
        }
    }
    longest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The literal reading of the rule.
    fn plain(point: [i32; 3], positions: &[[i32; 3]]) -> usize {
        let squared = |p: &[i32; 3]| -> i64 {
            (0..3).map(|axis| i64::from(p[axis]) - i64::from(point[axis])).map(|d| d * d).sum()
        };
        (0..positions.len()).min_by_key(|&v| (squared(&positions[v]), v)).expect("not empty")
    }

    #[test]
    fn one_vertex_is_the_nearest_to_all() {
        assert_eq!(Slabs::new(&[[5, -7, 9]]).nearest([1 << 28, -(1 << 28), 0]), 0);
    }

    proptest::proptest! {
        #[test]
        fn slabs_find_what_a_plain_search_finds(
            positions in proptest::collection::vec([-9..9_i32, -60..60, -4..4], 1..200),
            points in proptest::collection::vec([-20..20_i32, -90..90, -20..20], 1..20),
            scale in 1..1000_i32,
        ) {
            let scaled = |p: &[i32; 3]| p.map(|c| c * scale);
            let positions: Vec<_> = positions.iter().map(scaled).collect();
            let slabs = Slabs::new(&positions);
            for point in points.iter().map(scaled) {
                proptest::prop_assert_eq!(slabs.nearest(point), plain(point, &positions));
            }
        }
    }
}
