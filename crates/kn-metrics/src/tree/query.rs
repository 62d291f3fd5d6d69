//! Searches for the closest point: exact distances decide, bounds in binary32 only exclude.

use super::leaf::ROUNDING;
use super::triangle::Foot;
use super::{Closest, TriangleTree};
use crate::bvh::{Lanes, Patience, Query, Search, descend};
use crate::lanes::lanes;
use kn_mesh::vec3::{Vec3, distance_squared, mul_add, scale};

/// Half sides of the box beyond which a query is pulled in: the slack of bounds in binary32 grows
/// with the distance. Seen from there the closest point is at most 2e-4 half sides farther away
/// than the one that is closest to the query itself.
const FAR: f64 = 4096.0;

/// A search with the best face so far.
struct Nearest<'t> {
    tree: &'t TriangleTree,
    point: Vec3,
    query: Query,
    /// What rounding can do to a bound, in normalised coordinates.
    slack: f64,
    patience: Patience,
    face: u32,
    foot: Foot,
    /// Nothing whose lower bound is at least this can be as close as `foot`.
    limit: f32,
}

impl TriangleTree {
    /// Finds the closest point on the surface. Of equally close faces the one with the lowest index
    /// is taken.
    ///
    /// Exact up to rounding, with two exceptions. From more than 4096 half sides of the mesh's box
    /// away the distance is right to 1e-7 of itself. And where hundreds of boxes of faces are as near
    /// as the closest face, such as seen from the centre of a sphere, the search ends early with a
    /// face that is nearly as close: work is bounded for any mesh and any query.
    ///
    /// Safe on any input: coordinates that are not finite give a face of the tree and a distance
    /// that is not finite.
    pub fn closest(&self, point: [f64; 3]) -> Closest {
        self.closest_from(point, u32::MAX)
    }

    /// Finds the same point as [`closest`](Self::closest), faster if `hint` is a face near the
    /// query, such as the answer for a neighbour or for the last iteration. The hint does not change
    /// the result, except of a search that ends early. A hint that is no face is ignored.
    pub fn closest_from(&self, point: [f64; 3], hint: u32) -> Closest {
        let query = self.normalise(point);
        let reach = query.iter().fold(1.0, |sum, x| sum + x.abs());
        if !reach.is_finite() {
            return self.answer(point, 0, self.triangles[0].closest(point));
        }
        if reach > FAR {
            let query = scale(query, FAR / reach);
            let pulled = mul_add(self.centre, self.to_unit.recip(), query);
            let (face, foot) = self.search(pulled, query, 1.0 + FAR, hint);
            return self.answer(point, face, foot);
        }
        let (face, foot) = self.search(point, query, reach, hint);
        self.answer(point, face, foot)
    }

    fn search(&self, point: Vec3, query: Vec3, reach: f64, hint: u32) -> (u32, Foot) {
        let mut nearest = Nearest {
            tree: self,
            point,
            query: query.map(|x| Lanes::splat(x as f32)),
            slack: ROUNDING * reach,
            patience: Patience::FULL,
            face: u32::MAX,
            foot: Foot { point, weights: [0.0; 3], distance_squared: f64::INFINITY },
            limit: f32::INFINITY,
        };
        if let Some(triangle) = self.triangles.get(hint as usize) {
            nearest.take(hint, triangle.closest(point));
        }
        let query = nearest.query;
        descend(&self.nodes, &query, &mut nearest);
        (nearest.face, nearest.foot)
    }

    /// What a face's point is to `point`.
    pub(super) fn answer(&self, point: Vec3, face: u32, foot: Foot) -> Closest {
        let foot = self.triangles[face as usize].in_face_order(foot);
        Closest {
            face,
            point: foot.point,
            barycentric: foot.weights,
            distance_squared: distance_squared(point, foot.point),
        }
    }
}

impl Nearest<'_> {
    #[inline]
    fn take(&mut self, face: u32, foot: Foot) {
        (self.face, self.foot) = (face, foot);
        self.set_limit();
    }

    /// The distance in normalised coordinates, enlarged by all that rounding can do to a bound.
    #[inline]
    fn set_limit(&mut self) {
        let part = self.patience.part();
        let reach = part * self.foot.distance_squared.sqrt() * self.tree.to_unit + self.slack;
        self.limit = if part > 0.0 { (reach * reach * (1.0 + 1e-6)) as f32 } else { 0.0 };
    }
}

impl Search for Nearest<'_> {
    #[inline]
    fn limit(&self) -> f32 {
        self.limit
    }

    #[inline]
    fn visit(&mut self, leaf: usize) {
        let leaf = &self.tree.leaves[leaf];
        let bounds = leaf.distances_squared(&self.query);
        let hits = bounds.cmplt(Lanes::splat(self.limit)).bitmask() as u8 & leaf.used;
        for lane in lanes(hits) {
            let face = leaf.faces[lane];
            if bounds[lane] >= self.limit || face == self.face {
                continue;
            }
            let foot = self.tree.triangles[face as usize].closest(self.point);
            let (found, best) = (foot.distance_squared, self.foot.distance_squared);
            if found < best || (found == best && face < self.face) {
                self.take(face, foot);
            }
        }
    }

    fn hurry(&mut self) {
        self.patience = self.patience.less();
        self.set_limit();
    }
}
