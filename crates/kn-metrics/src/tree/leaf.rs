//! The leaves of the BVH over triangles, with four triangles each, in binary32.
//!
//! Everything here is a lower bound of the distance. The four lanes of a vector are triangles.
//! Coordinates are normalised: the mesh fills −1..=1 along its longest side.

use crate::bvh::{LANES, Lanes, Query};
use kn_mesh::vec3::{Vec3, cross, dot, norm, scale, sub};

/// Rounding in this file and in the nodes' boxes moves a distance by less than this much times
/// (1 + |query|∞): some 40 operations, each good to 2⁻²⁴ of numbers below 2 + |query|.
pub(super) const ROUNDING: f64 = 1.0 / (1 << 18) as f64;

/// A unit vector per lane and the largest value that its product with a triangle's points takes.
#[derive(Clone, Debug)]
struct Planes {
    unit: [Lanes; 3],
    offset: Lanes,
}

impl Planes {
    fn set(&mut self, lane: usize, unit: Vec3, offset: f64) {
        for axis in 0..3 {
            self.unit[axis][lane] = unit[axis] as f32;
        }
        self.offset[lane] = offset as f32;
    }

    #[inline]
    fn heights(&self, query: &Query) -> Lanes {
        let [x, y, z] = self.unit;
        x * query[0] + y * query[1] + z * query[2] - self.offset
    }
}

/// Four triangles as far as a lower bound needs them: their plane, and the planes through their
/// sides at right angles to it.
#[derive(Clone, Debug)]
pub(super) struct Leaf {
    plane: Planes,
    sides: [Planes; 3],
    pub(super) faces: [u32; LANES],
    /// A bit for each lane that holds a face.
    pub(super) used: u8,
}

impl Leaf {
    pub(super) fn new() -> Self {
        let planes = Planes { unit: [Lanes::ZERO; 3], offset: Lanes::ZERO };
        Self {
            plane: planes.clone(),
            sides: [planes.clone(), planes.clone(), planes],
            faces: [0; LANES],
            used: 0,
        }
    }

    /// Adds a triangle; there are at most four. One without area keeps zero vectors: its bound is
    /// zero, and only its box can exclude it.
    pub(super) fn push(&mut self, face: u32, corners: [Vec3; 3]) {
        let lane = self.used.count_ones() as usize;
        self.faces[lane] = face;
        self.used |= 1 << lane;
        let normal = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]));
        let Some(normal) = unit(normal) else { return };
        let Some(outward) = outward_of_sides(corners, normal) else { return };
        let middle = (0..3).map(|i| dot(normal, corners[i])).sum::<f64>() / 3.0;
        self.plane.set(lane, normal, middle);
        for (side, outward) in outward.into_iter().enumerate() {
            // The largest of all corners: the bound then holds whatever rounding did to `outward`.
            let offset = corners.map(|c| dot(outward, c)).into_iter().fold(f64::MIN, f64::max);
            self.sides[side].set(lane, outward, offset);
        }
    }

    /// Lower bounds of the squared distances: exact up to rounding where the closest point is
    /// inside or on a side, less where it is a corner.
    #[inline]
    pub(super) fn distances_squared(&self, query: &Query) -> Lanes {
        let [ab, bc, ca] = &self.sides;
        let outside = ab.heights(query).max(bc.heights(query)).max(ca.heights(query));
        let outside = outside.max(Lanes::ZERO);
        let height = self.plane.heights(query);
        height * height + outside * outside
    }
}

/// In the triangle's plane, at right angles to each side, pointing away from the third corner.
fn outward_of_sides(corners: [Vec3; 3], normal: Vec3) -> Option<[Vec3; 3]> {
    let mut outward = [[0.0; 3]; 3];
    for i in 0..3 {
        outward[i] = unit(cross(sub(corners[(i + 1) % 3], corners[i]), normal))?;
        // A thin triangle's normal has lost digits; then the planes may not be at right angles.
        let tilt = dot(sub(corners[(i + 2) % 3], corners[i]), normal).abs();
        if dot(outward[i], normal).abs() > 1e-8 || tilt > 1e-8 {
            return None;
        }
    }
    Some(outward)
}

fn unit(vector: Vec3) -> Option<Vec3> {
    let length = norm(vector);
    // Below this the product of two normalised sides is mostly rounding.
    (length > 1e-15).then(|| scale(vector, 1.0 / length))
}
