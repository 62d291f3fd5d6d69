//! The nodes of the BVH, with eight boxes each, and its leaves, with four triangles each, in
//! binary32.
//!
//! Everything here is a lower bound of the distance. The four lanes of a vector are children or
//! triangles. Coordinates are normalised: the mesh fills −1..=1 along its longest side.

use glam::{Vec3A, Vec4};

use kn_mesh::vec3::{Vec3, cross, dot, norm, scale, sub};

/// Triangles of a leaf.
pub(super) const LANES: usize = 4;

/// Children of a node: two vectors. Measured against one, a query visits half the nodes.
pub(super) const CHILDREN: usize = 2 * LANES;

/// One number per lane. glam's type because it is a vector register in safe code; whether it fuses
/// multiplications and additions does not matter for a bound.
pub(super) type Lanes = Vec4;

/// A query, each coordinate in all lanes.
pub(super) type Query = [Lanes; 3];

/// Rounding in this file moves a distance by less than this much times (1 + |query|∞): some 40
/// operations, each good to 2⁻²⁴ of numbers below 2 + |query|.
pub(super) const ROUNDING: f64 = 1.0 / (1 << 18) as f64;

/// An axis-aligned box, rounded outwards.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) min: Vec3A,
    pub(super) max: Vec3A,
}

impl Bounds {
    pub(super) const EMPTY: Self = Self { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

    pub(super) fn of(corners: [Vec3; 3]) -> Self {
        let mut bounds = Self::EMPTY;
        for corner in corners {
            let nearest = Vec3A::from_array(corner.map(|x| x as f32));
            bounds.min = bounds.min.min(nearest);
            bounds.max = bounds.max.max(nearest);
        }
        // More than the rounding of coordinates in −1..=1; a thousandth of ROUNDING.
        let rounding = Vec3A::splat(f32::EPSILON / 2.0);
        Self { min: bounds.min - rounding, max: bounds.max + rounding }
    }

    #[inline]
    pub(super) fn union(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }

    /// Half the surface; the box must not be empty.
    #[inline]
    pub(super) fn half_area(&self) -> f32 {
        let [x, y, z] = (self.max - self.min).to_array();
        x * y + y * z + z * x
    }
}

/// A child: another node or a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct Child(u32);

impl Child {
    const LEAF: u32 = 1 << 31;

    pub(super) fn node(index: usize) -> Self {
        Self(index as u32)
    }

    pub(super) fn leaf(index: usize) -> Self {
        Self(index as u32 | Self::LEAF)
    }

    /// The leaf's index, or else the node's.
    #[inline]
    pub(super) fn get(self) -> Result<usize, usize> {
        if self.0 & Self::LEAF == 0 {
            Err(self.0 as usize)
        } else {
            Ok((self.0 & !Self::LEAF) as usize)
        }
    }
}

/// Four boxes side by side.
#[derive(Clone, Copy, Debug)]
struct Boxes {
    min: [Lanes; 3],
    max: [Lanes; 3],
}

impl Boxes {
    /// Squared distances; infinite for an empty box.
    #[inline]
    fn distances_squared(&self, query: &Query) -> Lanes {
        let mut sum = Lanes::ZERO;
        for axis in 0..3 {
            let below = self.min[axis] - query[axis];
            let above = query[axis] - self.max[axis];
            let outside = below.max(above).max(Lanes::ZERO);
            sum += outside * outside;
        }
        sum
    }
}

/// Eight boxes with what is in them.
#[derive(Clone, Debug)]
pub(super) struct Node {
    halves: [Boxes; 2],
    pub(super) children: [Child; CHILDREN],
}

impl Node {
    pub(super) fn new() -> Self {
        let empty = Bounds::EMPTY;
        let empty = Boxes {
            min: empty.min.to_array().map(Lanes::splat),
            max: empty.max.to_array().map(Lanes::splat),
        };
        Self { halves: [empty; 2], children: [Child(0); CHILDREN] }
    }

    pub(super) fn set(&mut self, child: usize, bounds: &Bounds, content: Child) {
        let half = &mut self.halves[child / LANES];
        for axis in 0..3 {
            half.min[axis][child % LANES] = bounds.min[axis];
            half.max[axis][child % LANES] = bounds.max[axis];
        }
        self.children[child] = content;
    }

    /// Lower bounds of the squared distances to the children, and a bit for each below `limit`.
    #[inline]
    pub(super) fn children_within(&self, query: &Query, limit: f32) -> ([f32; CHILDREN], u8) {
        let [low, high] = self.halves.each_ref().map(|half| half.distances_squared(query));
        let limit = Lanes::splat(limit);
        let hits = low.cmplt(limit).bitmask() | high.cmplt(limit).bitmask() << LANES;
        let mut bounds = [0.0; CHILDREN];
        bounds[..LANES].copy_from_slice(&low.to_array());
        bounds[LANES..].copy_from_slice(&high.to_array());
        (bounds, hits as u8)
    }
}

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
