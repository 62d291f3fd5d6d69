//! Walks the tree: exact distances decide, bounds in binary32 only exclude.

use super::build::MAX_LEVELS;
use super::node::{CHILDREN, Child, Lanes, Query, ROUNDING};
use super::triangle::Foot;
use super::{Closest, TriangleTree};
use crate::lanes::lanes;
use kn_mesh::vec3::Vec3;

/// Beyond this many half sides of the box a bound in binary32 may overflow.
const FAR: f64 = 1e15;

/// Nodes and leaves that can wait at once: of each node on the way all children but one.
const STACK: usize = MAX_LEVELS * (CHILDREN - 1) + CHILDREN;

/// The best face so far.
struct Best {
    face: u32,
    foot: Foot,
    /// Nothing whose lower bound is at least this can be as close as `foot`.
    limit: f32,
}

/// Nodes and leaves with their lower bounds, the next one on top.
struct Waiting {
    stack: [(f32, Child); STACK],
    count: usize,
}

impl Waiting {
    fn new(root: Child) -> Self {
        Self { stack: [(0.0, root); STACK], count: 1 }
    }

    #[inline]
    fn pop(&mut self) -> Option<(f32, Child)> {
        self.count = self.count.checked_sub(1)?;
        Some(self.stack[self.count])
    }

    /// Keeps what is above `bottom` sorted, the nearest on top.
    #[inline]
    fn push_above(&mut self, bottom: usize, entry: (f32, Child)) {
        let mut place = self.count;
        while place > bottom && self.stack[place - 1].0 < entry.0 {
            self.stack[place] = self.stack[place - 1];
            place -= 1;
        }
        self.stack[place] = entry;
        self.count += 1;
    }
}

impl TriangleTree {
    /// Finds the closest point on the surface. Of equally close faces the one with the lowest index
    /// is taken.
    ///
    /// Exact up to rounding for any finite query. Safe on any input: coordinates that are not
    /// finite give a face of the tree and a distance that is not finite.
    pub fn closest(&self, point: [f64; 3]) -> Closest {
        self.closest_from(point, u32::MAX)
    }

    /// Finds the same point as [`closest`](Self::closest), faster if `hint` is a face near the
    /// query, such as the answer for a neighbour or for the last iteration. The hint never changes
    /// the result. A hint that is no face is ignored.
    pub fn closest_from(&self, point: [f64; 3], hint: u32) -> Closest {
        let query = self.normalise(point);
        let reach = query.iter().fold(1.0, |sum, x| sum + x.abs());
        if reach.is_nan() || reach >= FAR {
            return self.closest_by_scan(point);
        }
        let slack = ROUNDING * reach;
        let mut best = self.start(point, hint, slack);
        self.descend(point, query.map(|x| Lanes::splat(x as f32)), slack, &mut best);
        self.answer(best.face, best.foot)
    }

    fn start(&self, point: Vec3, hint: u32, slack: f64) -> Best {
        match self.triangles.get(hint as usize) {
            Some(triangle) => {
                let foot = triangle.closest(point);
                Best { face: hint, foot, limit: self.limit(foot.distance_squared, slack) }
            }
            None => {
                let foot = Foot { point, weights: [0.0; 3], distance_squared: f64::INFINITY };
                Best { face: u32::MAX, foot, limit: f32::INFINITY }
            }
        }
    }

    fn descend(&self, point: Vec3, query: Query, slack: f64, best: &mut Best) {
        let mut waiting = Waiting::new(Child::node(0));
        while let Some((bound, child)) = waiting.pop() {
            if bound >= best.limit {
                continue;
            }
            match child.get() {
                Ok(leaf) => self.visit_leaf(leaf, point, &query, slack, best),
                Err(node) => {
                    let node = &self.nodes[node];
                    let (bounds, hits) = node.children_within(&query, best.limit);
                    let bottom = waiting.count;
                    for lane in lanes(hits) {
                        waiting.push_above(bottom, (bounds[lane], node.children[lane]));
                    }
                }
            }
        }
    }

    #[inline]
    fn visit_leaf(&self, leaf: usize, point: Vec3, query: &Query, slack: f64, best: &mut Best) {
        let leaf = &self.leaves[leaf];
        let bounds = leaf.distances_squared(query);
        let hits = bounds.cmplt(Lanes::splat(best.limit)).bitmask() as u8 & leaf.used;
        for lane in lanes(hits) {
            let face = leaf.faces[lane];
            if bounds[lane] >= best.limit || face == best.face {
                continue;
            }
            let foot = self.triangles[face as usize].closest(point);
            let nearer = foot.distance_squared < best.foot.distance_squared;
            if nearer || (foot.distance_squared == best.foot.distance_squared && face < best.face) {
                let limit = self.limit(foot.distance_squared, slack);
                *best = Best { face, foot, limit };
            }
        }
    }

    /// The distance in normalised coordinates, enlarged by all that rounding can do to a bound.
    #[inline]
    fn limit(&self, distance_squared: f64, slack: f64) -> f32 {
        let reach = distance_squared.sqrt() * self.to_unit + slack;
        (reach * reach * (1.0 + 1e-6)) as f32
    }

    /// For queries so far away that binary32 cannot tell faces apart.
    #[cold]
    pub(super) fn closest_by_scan(&self, point: Vec3) -> Closest {
        let mut best = (0, self.triangles[0].closest(point));
        for (face, triangle) in self.triangles.iter().enumerate().skip(1) {
            let foot = triangle.closest(point);
            if foot.distance_squared < best.1.distance_squared {
                best = (face as u32, foot);
            }
        }
        self.answer(best.0, best.1)
    }

    fn answer(&self, face: u32, foot: Foot) -> Closest {
        let foot = self.triangles[face as usize].in_face_order(foot);
        Closest {
            face,
            point: foot.point,
            barycentric: foot.weights,
            distance_squared: foot.distance_squared,
        }
    }
}
