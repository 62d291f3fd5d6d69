//! The errors of a scanner: correlated bumps, noise, and holes.

use super::net::Surface;
use super::random::Random;
use glam::DVec3;
use kn_mesh::adjacency::{Rows, vertex_faces};
use rayon::prelude::*;
use std::collections::VecDeque;

/// Metres (amplitude) and periods per metre of the bumps at noise 1. Calibrated against a real
/// scan in docs/notes/performer.md.
const BUMPS: [(f64, f64); 2] = [(0.0022, 14.0), (0.0012, 38.0)];
/// Metres of independent error along the normal at noise 1.
const GRAIN: f64 = 0.0004;
/// Boundary edges of a hole, least and most.
const HOLE_RIM: (usize, usize) = (8, 26);

/// Moves every vertex along its normal.
pub(super) fn add_noise(surface: &mut Surface, amount: f64, random: Random) {
    if amount <= 0.0 {
        return;
    }
    let streams = [random.fork(0), random.fork(1), random.fork(2)];
    let normals = &surface.normals;
    surface.positions.par_iter_mut().enumerate().for_each(|(i, position)| {
        let mut height = GRAIN * streams[2].signed(i as i64);
        for (stream, (depth, frequency)) in streams.iter().zip(BUMPS) {
            height += depth * stream.noise(*position * frequency);
        }
        *position += normals[i] * (amount * height);
    });
}

/// Cuts `count` holes, each a disc of faces with a simple rim.
pub(super) fn cut_holes(surface: &mut Surface, count: u32, random: Random) {
    let mut cutter = Cutter::new(surface);
    for hole in 0..i64::from(count) {
        // A disc that would touch another hole, or itself around a handle, is given up for
        // another place.
        let tries = (0..40_i64).map(|i| random.fork(hole).fork(i));
        for draw in tries {
            if cutter.cut(draw) {
                break;
            }
        }
    }
    let gone = cutter.gone;
    let mut kept = gone.iter().map(|g| !g);
    surface.faces.retain(|_| kept.next().unwrap_or(true));
}

struct Cutter<'a> {
    surface: &'a Surface,
    around: Rows,
    gone: Vec<bool>,
    /// Vertices of holes and of their rims.
    taken: Vec<bool>,
}

impl<'a> Cutter<'a> {
    fn new(surface: &'a Surface) -> Self {
        let around = vertex_faces(surface.positions.len(), &surface.faces);
        let gone = vec![false; surface.faces.len()];
        Self { surface, around, gone, taken: vec![false; surface.positions.len()] }
    }

    /// Removes the faces around a breadth-first patch of vertices; `false` where it finds no
    /// place for a clean hole.
    fn cut(&mut self, draw: Random) -> bool {
        let (least, most) = HOLE_RIM;
        let rim = least + draw.below(1, most - least);
        let seed = draw.below(0, self.surface.positions.len());
        // A patch of n inner vertices has a rim of about 4 √n vertices.
        let inner = (rim * rim / 22).max(1);
        let Some(faces) = self.disc(seed, inner) else { return false };
        for &face in &faces {
            self.gone[face as usize] = true;
            for v in self.surface.faces[face as usize] {
                self.taken[v as usize] = true;
            }
        }
        true
    }

    /// The faces of a patch, if they form a disc of fresh vertices with one simple rim.
    fn disc(&self, seed: usize, inner: usize) -> Option<Vec<u32>> {
        let patch = self.patch(seed, inner);
        let mut faces: Vec<u32> =
            patch.iter().flat_map(|&v| self.around.row(v as usize).iter().copied()).collect();
        faces.sort_unstable();
        faces.dedup();
        let corners = faces.iter().map(|&f| self.surface.faces[f as usize]);
        let mut vertices: Vec<u32> = corners.clone().flatten().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let mut edges: Vec<[u32; 2]> =
            corners.flat_map(|f| [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]]).collect();
        for edge in &mut edges {
            edge.sort_unstable();
        }
        edges.sort_unstable();
        let rim: Vec<[u32; 2]> =
            edges.chunk_by(|a, b| a == b).filter(|same| same.len() == 1).map(|e| e[0]).collect();
        edges.dedup();
        let disc = vertices.len() + faces.len() == edges.len() + 1;
        let mut ends: Vec<u32> = rim.iter().flatten().copied().collect();
        ends.sort_unstable();
        let simple = ends.chunk_by(|a, b| a == b).all(|same| same.len() == 2);
        let fresh = vertices.iter().all(|&v| !self.taken[v as usize]);
        (disc && simple && fresh).then_some(faces)
    }

    fn patch(&self, seed: usize, inner: usize) -> Vec<u32> {
        let mut patch = vec![seed as u32];
        let mut queue = VecDeque::from([seed as u32]);
        while let Some(v) = queue.pop_front() {
            for &face in self.around.row(v as usize) {
                for next in self.surface.faces[face as usize] {
                    if patch.len() < inner && !patch.contains(&next) {
                        patch.push(next);
                        queue.push_back(next);
                    }
                }
            }
        }
        patch
    }
}

/// A position as a scanner's file has it: rounded to binary32.
pub(super) fn rounded(position: DVec3) -> [f64; 3] {
    position.to_array().map(|c| f64::from(c as f32))
}
