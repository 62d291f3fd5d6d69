//! Samples of the field on a lattice whose position differs from frame to frame. Only blocks that
//! can hold the surface are sampled: an octree drops every block whose centre is farther from the
//! surface than the size of the block.

use super::field::Scene;
use super::random::Random;
use super::rigid::{Rigid, rotation_x, rotation_y};
use super::shape::LIPSCHITZ;
use super::skeleton::PELVIS;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// Lattice points along the side of a leaf block, and in all of it.
pub(super) const SIDE: i32 = 4;
pub(super) const LEAF: usize = (SIDE * SIDE * SIDE) as usize;
/// Lattice points at the corners of all cells of a leaf.
const CORNERS: usize = ((SIDE + 1) * (SIDE + 1) * (SIDE + 1)) as usize;
/// A leaf that does not exist.
pub(super) const NONE: u32 = u32::MAX;
/// Radius around the pelvis that holds the figure in any pose, metres.
const REACH: f64 = 1.35;
/// Cells by which blocks are grown before they are tested, so that the cells around a cut lattice
/// edge are mostly there from the start; [`Lattice::complete`] finds the others.
const MARGIN: f64 = 0.5;

/// A block of [`LEAF`] lattice points.
#[derive(Clone, Debug)]
pub(super) struct Leaf {
    /// Position among blocks: its first lattice point is `SIDE · key`.
    pub(super) key: [i32; 3],
    /// Primitives that matter here.
    pub(super) candidates: Vec<u16>,
    /// Field at the block's lattice points, x fastest.
    pub(super) values: Vec<f64>,
    /// Whether some of the values are outside, and whether some are inside.
    pub(super) sides: [bool; 2],
    /// The 27 leaves around and including this, x fastest; [`NONE`] where the field has no zero.
    pub(super) around: [u32; 27],
}

/// The sampled part of space.
#[derive(Debug)]
pub(super) struct Lattice {
    /// Lattice axes and the place of lattice point (0, 0, 0).
    pub(super) frame: Rigid,
    /// Metres between lattice points.
    pub(super) step: f64,
    pub(super) leaves: Vec<Leaf>,
}

/// A block of the octree: its position among blocks of its size, and what matters in it.
type Block = ([i32; 3], Vec<u16>);

impl Lattice {
    /// Samples `scene` at a spacing of `step` metres, the lattice turned and shifted by `random`.
    pub(super) fn sample(scene: &Scene, step: f64, random: Random) -> Self {
        let turn = |i| TAU * random.unit(i);
        let rotation = rotation_y(turn(0)) * rotation_x(turn(1)) * rotation_y(turn(2));
        let origin = scene.pose.bones[PELVIS].origin + step * random.vector(3);
        let mut lattice = Self { frame: Rigid { rotation, origin }, step, leaves: Vec::new() };
        let mut size = SIDE;
        while f64::from(size) * step < REACH {
            size *= 2;
        }
        let mut blocks: Vec<Block> = (0..8).map(|i| (octant([-1; 3], i), scene.all())).collect();
        while size > SIDE {
            blocks.retain(|(key, all)| lattice.keep(scene, *key, size, all).is_some());
            size /= 2;
            blocks = blocks
                .par_iter()
                .flat_map_iter(|(key, all)| lattice.split(scene, *key, size, all))
                .collect();
        }
        lattice.leaves = blocks.into_par_iter().map(|b| lattice.leaf(scene, b)).collect();
        lattice.connect();
        lattice
    }

    /// Adds the blocks that the octree dropped although the surface, seen from a neighbour, enters
    /// them: distances of lofts and folds are not exact. Returns whether there were any.
    pub(super) fn complete(&mut self, scene: &Scene) -> bool {
        let mut missing: Vec<[i32; 3]> =
            (0..self.leaves.len()).into_par_iter().flat_map_iter(|l| self.missing(l)).collect();
        missing.sort_unstable();
        missing.dedup();
        let radius = self.radius(SIDE);
        let added = missing.into_par_iter().map(|key| {
            let near = scene.nearby(self.centre(key, SIDE), radius, 2.0 * self.step, &scene.all());
            self.leaf(scene, (key, near))
        });
        let added: Vec<Leaf> = added.collect();
        let any = !added.is_empty();
        self.leaves.extend(added);
        if any {
            self.connect();
        }
        any
    }

    /// Blocks that are not sampled but hold a corner of a cell at a cut edge of a leaf.
    fn missing(&self, leaf: usize) -> Vec<[i32; 3]> {
        let mut missing = Vec::new();
        if !self.leaves[leaf].around.contains(&NONE) || !self.is_cut(leaf) {
            return missing;
        }
        for place in 0..LEAF {
            for axis in (0..3).filter(|&axis| self.cuts(leaf, place, axis)) {
                let around = (0..18).map(|i| {
                    let mut at = local(place);
                    at[axis] += i / 9;
                    at[(axis + 1) % 3] += i % 3 - 1;
                    at[(axis + 2) % 3] += i / 3 % 3 - 1;
                    at
                });
                let lost = around.filter(|&at| self.find(leaf, at).is_none());
                let block = |at: [i32; 3]| {
                    [0, 1, 2].map(|a| self.leaves[leaf].key[a] + at[a].div_euclid(SIDE))
                };
                missing.extend(lost.map(block));
            }
        }
        missing
    }

    /// Whether the surface cuts the lattice edge from `place` of a leaf along `axis`.
    pub(super) fn cuts(&self, leaf: usize, place: usize, axis: usize) -> bool {
        let mut far = local(place);
        far[axis] += 1;
        let inside = |(leaf, place): (usize, usize)| self.leaves[leaf].values[place] < 0.0;
        self.find(leaf, far).is_some_and(|there| inside(there) != inside((leaf, place)))
    }

    /// World position of a lattice point.
    pub(super) fn point(&self, at: [i32; 3]) -> DVec3 {
        let [x, y, z] = at.map(|c| f64::from(c) * self.step);
        self.frame.apply(DVec3::new(x, y, z))
    }

    fn split(&self, scene: &Scene, key: [i32; 3], size: i32, all: &[u16]) -> Vec<Block> {
        let first = key.map(|k| 2 * k);
        let child = |i| {
            let key = octant(first, i);
            self.keep(scene, key, size, all).map(|near| (key, near))
        };
        (0..8).filter_map(child).collect()
    }

    /// The primitives that matter in a block, or `None` where it has no part of the surface.
    fn keep(&self, scene: &Scene, key: [i32; 3], size: i32, all: &[u16]) -> Option<Vec<u16>> {
        let (centre, radius) = (self.centre(key, size), self.radius(size));
        let near = scene.nearby(centre, radius, 2.0 * self.step, all);
        let bound = LIPSCHITZ * radius;
        (scene.value(centre, &near).abs() <= bound).then_some(near)
    }

    fn centre(&self, key: [i32; 3], size: i32) -> DVec3 {
        let middle = |k: i32| (f64::from(k * size) + f64::from(size - 1) / 2.0) * self.step;
        self.frame.apply(DVec3::from(key.map(middle)))
    }

    /// Of the ball around a block grown by [`MARGIN`].
    fn radius(&self, size: i32) -> f64 {
        3.0_f64.sqrt() * (f64::from(size) / 2.0 + MARGIN) * self.step
    }

    fn leaf(&self, scene: &Scene, (key, candidates): Block) -> Leaf {
        let first = key.map(|k| k * SIDE);
        let value = |i: usize| {
            let at = local(i);
            scene.value(self.point([0, 1, 2].map(|a| first[a] + at[a])), &candidates)
        };
        let values: Vec<f64> = (0..LEAF).map(value).collect();
        let sides = [values.iter().any(|v| *v >= 0.0), values.iter().any(|v| *v < 0.0)];
        Leaf { key, candidates, values, sides, around: [NONE; 27] }
    }

    fn connect(&mut self) {
        let index: HashMap<[i32; 3], u32> =
            self.leaves.iter().enumerate().map(|(i, leaf)| (leaf.key, i as u32)).collect();
        self.leaves.par_iter_mut().for_each(|leaf| {
            for (i, slot) in leaf.around.iter_mut().enumerate() {
                let i = i as i32;
                let [x, y, z] = leaf.key;
                let key = [x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1];
                *slot = index.get(&key).copied().unwrap_or(NONE);
            }
        });
    }

    /// Leaf and place in it of the lattice point at `at` relative to leaf `leaf`, each coordinate
    /// between −SIDE and 2·SIDE; `None` where nothing was sampled.
    pub(super) fn find(&self, leaf: usize, at: [i32; 3]) -> Option<(usize, usize)> {
        let block = at.map(|c| (c + SIDE) / SIDE);
        let inside = at.map(|c| (c + SIDE) % SIDE);
        let slot = self.leaves[leaf].around[(block[0] + 3 * block[1] + 9 * block[2]) as usize];
        let place = inside[0] + SIDE * (inside[1] + SIDE * inside[2]);
        (slot != NONE).then_some((slot as usize, place as usize))
    }

    /// Whether the surface passes between the lattice points of a leaf's cells.
    pub(super) fn is_cut(&self, leaf: usize) -> bool {
        let around = &self.leaves[leaf].around;
        // The leaf and the seven that hold the upper corners of its cells.
        let upper = [13, 14, 16, 17, 22, 23, 25, 26].map(|slot| around[slot]);
        let known = upper.iter().filter(|&&slot| slot != NONE);
        let sides = known.map(|&slot| self.leaves[slot as usize].sides);
        sides.fold([false; 2], |a, b| [a[0] | b[0], a[1] | b[1]]) == [true; 2]
    }

    /// The field at the corners of all cells of a leaf, [`SIDE`] + 1 lattice points a side, x
    /// fastest; NaN where nothing was sampled.
    pub(super) fn corners(&self, leaf: usize) -> [f64; CORNERS] {
        std::array::from_fn(|i| {
            let (i, side) = (i as i32, SIDE + 1);
            let found = self.find(leaf, [i % side, i / side % side, i / (side * side)]);
            found.map_or(f64::NAN, |(leaf, place)| self.leaves[leaf].values[place])
        })
    }

    /// The cells of a leaf that the surface passes, with the field at their corners (x fastest).
    pub(super) fn cut_cells(&self, leaf: usize) -> impl Iterator<Item = (usize, [f64; 8])> {
        let corners = if self.is_cut(leaf) { self.corners(leaf) } else { [f64::NAN; CORNERS] };
        (0..LEAF).filter_map(move |cell| {
            let values = std::array::from_fn(|i| {
                let [x, y, z] = octant(local(cell), i as i32);
                corners[(x + (SIDE + 1) * (y + (SIDE + 1) * z)) as usize]
            });
            let whole = values.iter().all(|v| !v.is_nan());
            (whole && !matches!(mask(&values), 0 | 255)).then_some((cell, values))
        })
    }
}

/// Coordinates within a leaf of its place `i`.
pub(super) fn local(i: usize) -> [i32; 3] {
    let i = i as i32;
    [i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE)]
}

/// Corner `i` of the unit cube at `at`, x fastest.
pub(super) fn octant(at: [i32; 3], i: i32) -> [i32; 3] {
    [at[0] + (i & 1), at[1] + (i >> 1 & 1), at[2] + (i >> 2 & 1)]
}

/// Bit i is set where corner i is inside.
pub(super) fn mask(values: &[f64; 8]) -> u8 {
    values.iter().enumerate().fold(0, |mask, (i, v)| mask | u8::from(*v < 0.0) << i)
}
