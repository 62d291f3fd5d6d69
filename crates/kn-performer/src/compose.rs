//! Makes the sampled signs well-composed (Latecki 1997): in no cell do the inside or the outside
//! touch only across a diagonal. Then every cell holds one sheet of surface, and a surface net with
//! one vertex in each cell is a closed manifold.

use super::field::Scene;
use super::lattice::{Lattice, local, mask, octant};
use rayon::prelude::*;

/// The four corners of each face of a cell, around the face.
const FACES: [[usize; 4]; 6] =
    [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];

/// Turns single lattice points from outside to inside until no cell is critical. It only ever
/// adds, so it ends; in practice after two or three rounds.
pub(super) fn make_well_composed(lattice: &mut Lattice, scene: &Scene) {
    loop {
        while lattice.complete(scene) {}
        let critical: Vec<(usize, usize)> = (0..lattice.leaves.len())
            .into_par_iter()
            .flat_map_iter(|leaf| critical_cells(lattice, leaf))
            .collect();
        if critical.is_empty() {
            return;
        }
        for (leaf, place) in critical {
            // Just inside: the surface stays within a hair of this lattice point.
            lattice.leaves[leaf].values[place] = -1e-3 * lattice.step;
            lattice.leaves[leaf].sides[1] = true;
        }
    }
}

fn critical_cells(lattice: &Lattice, leaf: usize) -> Vec<(usize, usize)> {
    let cut = lattice.cut_cells(leaf);
    cut.filter_map(|(cell, values)| Some((cell, offender(&values)?)))
        .filter_map(|(cell, corner)| lattice.find(leaf, octant(local(cell), corner as i32)))
        .collect()
}

/// The corner to turn inside in a critical cell: of those outside that take part, the nearest to
/// the surface.
fn offender(values: &[f64; 8]) -> Option<usize> {
    let inside = mask(values);
    let has = |corner: usize| inside >> corner & 1 == 1;
    let nearest = |corners: &[usize]| {
        let outside = corners.iter().copied().filter(|&c| !has(c));
        outside.min_by(|&a, &b| values[a].total_cmp(&values[b]))
    };
    for face in &FACES {
        let [a, b, c, d] = *face;
        if has(a) == has(c) && has(b) == has(d) && has(a) != has(b) {
            return nearest(face);
        }
    }
    for corner in 0..4 {
        let pair = 1_u8 << corner | 1 << (7 - corner);
        if inside == pair || inside == !pair {
            return nearest(&[0, 1, 2, 3, 4, 5, 6, 7]);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_can_be_repaired() {
        for inside in 0..=255_u8 {
            let mut values: [f64; 8] =
                std::array::from_fn(|i| if inside >> i & 1 == 1 { -1.0 } else { 1.0 + i as f64 });
            while let Some(corner) = offender(&values) {
                assert!(values[corner] > 0.0, "{inside:08b}: corner {corner} is inside already");
                values[corner] = -1.0;
            }
            let before = inside.count_ones();
            assert!(mask(&values).count_ones() >= before);
        }
    }
}
