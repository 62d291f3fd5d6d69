//! Smoothing of an I-frame: removes the steps that rounding to the grid leaves on the surface. No
//! vertex moves by more than half a grid step on an axis.

use crate::parallel::*;
use kn_mesh::adjacency::{Rows, vertex_links};

/// Passes of the smoothing (`smooth.pass`).
const PASSES: usize = 3;
/// Vertices per unit of parallel work.
const CHUNK: usize = 4096;

/// Parameters of a strength of smoothing, which the stream names by its code.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Strength {
    /// μ, the weight of bending against the distance from the decoded position.
    bending: f64,
    /// ω, how far a pass goes.
    relaxation: f64,
}

/// `smooth.strength`; code 1 is the first.
const STRENGTHS: [Strength; Smoother::STRENGTHS as usize] = [
    Strength { bending: 0.125, relaxation: 0.875 },
    Strength { bending: 0.25, relaxation: 0.75 },
    Strength { bending: 0.5, relaxation: 0.625 },
    Strength { bending: 1.0, relaxation: 0.4375 },
    Strength { bending: 2.0, relaxation: 0.28125 },
];

/// Smooths meshes. It keeps its buffers between calls.
///
/// Positions were rounded to a grid, which makes a fine mesh bumpier than the surface it shows. A
/// few passes of a bilaplacian with a data term bring them back to a smooth surface, none farther
/// than half a grid step on each axis from where it was decoded, which is as much as the grid left
/// open.
#[derive(Clone, Debug, Default)]
pub struct Smoother {
    /// `#V` rows: the neighbours of each vertex, rising; none for a vertex that does not move.
    neighbours: Rows,
    /// `#V` rows: the other two corners of every face at each vertex.
    links: Rows<[u32; 2]>,
    /// `#V × 3`: positions of the current pass.
    positions: Vec<[f64; 3]>,
    /// `#V × 3`: the operator applied once.
    once: Vec<[f64; 3]>,
}

impl Smoother {
    /// Strengths are 1 to this; 0 leaves a mesh as it is.
    pub const STRENGTHS: u8 = 5;

    /// Forgets the last mesh: the next one may have other faces.
    pub fn begin_mesh(&mut self) {
        self.neighbours.offsets.clear();
    }

    /// Smooths `positions` (`#V × 3`, reference units) of a mesh with `faces` (`#F × 3`)
    /// (`smooth.neighbours` to `smooth.clamp`). `half_step` is half a grid step in reference units.
    /// The faces are looked at once, in the first call after [`Self::begin_mesh`].
    ///
    /// # Panics
    /// Where a face names a vertex beyond `positions`, there are other vertices than in the first
    /// call, or `strength` is above [`Self::STRENGTHS`].
    pub fn smooth(
        &mut self,
        positions: &mut [[i32; 3]],
        faces: &[[u32; 3]],
        strength: u8,
        half_step: i32,
    ) {
        let Some(index) = strength.checked_sub(1) else { return };
        let strength = STRENGTHS[usize::from(index)];
        if self.neighbours.offsets.is_empty() {
            self.collect_neighbours(positions.len(), faces);
        }
        assert_eq!(self.neighbours.len(), positions.len());
        self.positions.clear();
        self.positions.extend(positions.iter().map(|p| p.map(f64::from)));
        for _ in 0..PASSES {
            self.pass(positions, strength);
        }
        let bound = f64::from(half_step);
        for (position, smoothed) in positions.iter_mut().zip(&self.positions) {
            for axis in 0..3 {
                let moved = smoothed[axis] - f64::from(position[axis]);
                position[axis] += moved.clamp(-bound, bound).round_ties_even() as i32;
            }
        }
    }

    /// `smooth.pass`.
    fn pass(&mut self, decoded: &[[i32; 3]], strength: Strength) {
        let Self { neighbours, positions, once, .. } = self;
        once.resize(positions.len(), [0.0; 3]);
        let neighbours = &*neighbours;
        once.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, once)| {
            for (offset, out) in once.iter_mut().enumerate() {
                let vertex = chunk * CHUNK + offset;
                *out = umbrella(neighbours.row(vertex), positions, vertex);
            }
        });
        let once = &once[..];
        positions.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, positions)| {
            for (offset, x) in positions.iter_mut().enumerate() {
                let vertex = chunk * CHUNK + offset;
                let twice = umbrella(neighbours.row(vertex), once, vertex);
                for axis in 0..3 {
                    let back = f64::from(decoded[vertex][axis]) - x[axis];
                    x[axis] += strength.relaxation * (back - strength.bending * twice[axis]);
                }
            }
        });
    }

    /// `smooth.neighbours`: a vertex moves where each of its edges has two faces.
    fn collect_neighbours(&mut self, vertex_count: usize, faces: &[[u32; 3]]) {
        let Self { neighbours, links, .. } = self;
        vertex_links(vertex_count, faces, links);
        neighbours.restart();
        for ring in links.iter() {
            let runs = || ring.as_flattened().chunk_by(|a, b| a == b);
            if runs().all(|run| run.len() == 2) {
                neighbours.values.extend(runs().map(|run| run[0]));
            }
            neighbours.end_row();
        }
    }
}

/// `smooth.operator`: from the vertex to the mean of its neighbours; zero where it has none.
#[inline(always)]
fn umbrella(neighbours: &[u32], values: &[[f64; 3]], vertex: usize) -> [f64; 3] {
    if neighbours.is_empty() {
        return [0.0; 3];
    }
    let mut sum = [0.0; 3];
    for &neighbour in neighbours {
        let value = values[neighbour as usize];
        for axis in 0..3 {
            sum[axis] += value[axis];
        }
    }
    let count = neighbours.len() as f64;
    std::array::from_fn(|axis| sum[axis] / count - values[vertex][axis])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sheet of `n × n` vertices, the middle one lifted by `bump`.
    fn sheet(n: u32, bump: i32) -> (Vec<[i32; 3]>, Vec<[u32; 3]>) {
        let at = |x: u32, y: u32| y * n + x;
        let middle = at(n / 2, n / 2);
        let position = |i: u32| {
            let z = if i == middle { bump } else { 0 };
            [(i % n) as i32 * 2560, (i / n) as i32 * 2560, z]
        };
        let quads = (0..n - 1).flat_map(|y| (0..n - 1).map(move |x| (x, y)));
        let faces = quads.flat_map(|(x, y)| {
            let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
            [[a, b, c], [a, c, d]]
        });
        ((0..n * n).map(position).collect(), faces.collect())
    }

    #[test]
    fn strength_0_leaves_the_mesh() {
        let (mut positions, faces) = sheet(5, 200);
        let before = positions.clone();
        Smoother::default().smooth(&mut positions, &faces, 0, 128);
        assert_eq!(positions, before);
    }

    #[test]
    fn a_bump_of_a_step_becomes_lower_with_strength() {
        let height = |strength| {
            let (mut positions, faces) = sheet(9, 256);
            Smoother::default().smooth(&mut positions, &faces, strength, 128);
            positions[40][2]
        };
        let heights: Vec<i32> = (0..=Smoother::STRENGTHS).map(height).collect();
        assert!(heights.is_sorted_by(|a, b| a >= b), "{heights:?}");
        assert!(heights[1] < 256 && heights[5] == 128, "{heights:?}");
    }

    #[test]
    fn borders_and_edges_of_three_faces_stay() {
        let (mut positions, mut faces) = sheet(6, 0);
        for position in &mut positions {
            position[2] = (position[0] * 31 + position[1] * 17) % 97;
        }
        // A fin on the edge between two inner vertices.
        positions.push([9000, 9000, 5000]);
        faces.push([14, 15, 36]);
        let before = positions.clone();
        Smoother::default().smooth(&mut positions, &faces, 3, 128);
        let moved: Vec<usize> = (0..37).filter(|&v| positions[v] != before[v]).collect();
        assert!(
            moved.iter().all(|v| [7, 8, 9, 10, 13, 16, 19, 20, 21, 22, 25, 26, 27, 28].contains(v))
        );
        assert!(moved.len() > 8, "{moved:?}");
    }

    #[test]
    fn nothing_moves_more_than_half_a_step() {
        let (mut positions, faces) = sheet(12, 9000);
        let before = positions.clone();
        Smoother::default().smooth(&mut positions, &faces, 5, 128);
        let far = positions.iter().zip(&before);
        assert!(far.flat_map(|(a, b)| (0..3).map(move |k| (a[k] - b[k]).abs())).max() == Some(128));
    }
}
