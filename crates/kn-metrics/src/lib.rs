//! Distortion metrics for triangle meshes, and the exact closest point that they are built on.
//!
//! Positions are `&[[f64; 3]]`, faces `&[[u32; 3]]`; nothing is read from files here.

mod tree;
mod vec3;

pub use tree::{Closest, TreeError, TriangleTree};
