//! The nodes of a BVH, with eight boxes each, in binary32.

use glam::{Vec3A, Vec4};

/// Lanes of a vector: children of half a node.
pub(crate) const LANES: usize = 4;

/// Children of a node: two vectors. Measured against one, a query visits half the nodes.
pub(crate) const CHILDREN: usize = 2 * LANES;

/// One number per lane. glam's type because it is a vector register in safe code; whether it fuses
/// multiplications and additions does not matter for a bound.
pub(crate) type Lanes = Vec4;

/// A query, each coordinate in all lanes.
pub(crate) type Query = [Lanes; 3];

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub(crate) min: Vec3A,
    pub(crate) max: Vec3A,
}

impl Bounds {
    pub(crate) const EMPTY: Self = Self { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

    #[inline]
    pub(crate) fn include(&mut self, point: [f32; 3]) {
        let point = Vec3A::from_array(point);
        self.min = self.min.min(point);
        self.max = self.max.max(point);
    }

    /// The box, larger by `margin` on every side.
    pub(crate) fn widened(self, margin: f32) -> Self {
        let margin = Vec3A::splat(margin);
        Self { min: self.min - margin, max: self.max + margin }
    }

    #[inline]
    pub(crate) fn union(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }

    /// Half the surface; the box must not be empty.
    #[inline]
    pub(crate) fn half_area(&self) -> f32 {
        let [x, y, z] = (self.max - self.min).to_array();
        x * y + y * z + z * x
    }
}

/// A child: another node or a leaf.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Child(u32);

impl Child {
    const LEAF: u32 = 1 << 31;

    pub(crate) fn node(index: usize) -> Self {
        Self(index as u32)
    }

    pub(crate) fn leaf(index: usize) -> Self {
        Self(index as u32 | Self::LEAF)
    }

    /// The leaf's index, or else the node's.
    #[inline]
    pub(crate) fn get(self) -> Result<usize, usize> {
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
pub(crate) struct Node {
    halves: [Boxes; 2],
    pub(crate) children: [Child; CHILDREN],
}

impl Node {
    pub(crate) fn new() -> Self {
        let empty = Bounds::EMPTY;
        let empty = Boxes {
            min: empty.min.to_array().map(Lanes::splat),
            max: empty.max.to_array().map(Lanes::splat),
        };
        Self { halves: [empty; 2], children: [Child(0); CHILDREN] }
    }

    pub(crate) fn set(&mut self, child: usize, bounds: &Bounds, content: Child) {
        let half = &mut self.halves[child / LANES];
        for axis in 0..3 {
            half.min[axis][child % LANES] = bounds.min[axis];
            half.max[axis][child % LANES] = bounds.max[axis];
        }
        self.children[child] = content;
    }

    /// Lower bounds of the squared distances to the children, and a bit for each below `limit`.
    #[inline]
    pub(crate) fn children_within(&self, query: &Query, limit: f32) -> ([f32; CHILDREN], u8) {
        let [low, high] = self.halves.each_ref().map(|half| half.distances_squared(query));
        let limit = Lanes::splat(limit);
        let hits = low.cmplt(limit).bitmask() | high.cmplt(limit).bitmask() << LANES;
        let mut bounds = [0.0; CHILDREN];
        bounds[..LANES].copy_from_slice(&low.to_array());
        bounds[LANES..].copy_from_slice(&high.to_array());
        (bounds, hits as u8)
    }
}
