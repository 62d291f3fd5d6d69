//! Distortion metrics for triangle meshes, and the exact closest point that they are built on.
//!
//! Positions are `&[[f64; 3]]`, faces `&[[u32; 3]]`; nothing is read from files here.

mod msdm2;
mod tree;
mod vec3;

pub use msdm2::{
    DEFAULT_LEVELS, Interpolation, MAX_LEVELS, Msdm2, Msdm2Direction, Msdm2Error, Msdm2Surface,
    msdm2, msdm2_one_way,
};
pub use tree::{Closest, TreeError, TriangleTree};
