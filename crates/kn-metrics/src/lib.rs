#![doc = include_str!("../README.md")]
//!
//! Distortion metrics for triangle meshes, and the exact closest point that they are built on.
//!
//! Positions are `&[[f64; 3]]` in world units, faces `&[[u32; 3]]`; nothing is read from files
//! here. All metrics use the threads of rayon's current pool, and their results do not depend on
//! how many those are.
//!
//! | metric | entry |
//! |---|---|
//! | all of two meshes | [`compare()`] |
//! | MSDM2, both directions and per vertex | [`Msdm2Surface`], [`msdm2()`] |
//! | point to surface: RMS, mean, Hausdorff, PSNR | [`p2s()`], [`p2s_of_vertices`] |
//! | MPEG's D1 and D2, on vertices, samples of the surface or along a grid | [`PointCloud`], [`point_distortion`] |
//! | Bjøntegaard delta rate | [`bd_rate`] |
//! | exact closest points | [`TriangleTree`] |

mod bjontegaard;
mod bvh;
mod compare;
mod d1d2;
mod lanes;
mod msdm2;
mod p2s;
mod surface;
mod tree;

pub use bjontegaard::{BdError, BdRate, Dominated, RatePoint, bd_rate};
pub use compare::{
    CompareError, CompareOptions, Comparison, EmptySide, FaceMarks, Metric, PointSampling,
    UnknownMetric, compare, compare_empty, compare_faces, compare_surfaces,
};
pub use d1d2::{Grid, MeanSquares, PointCloud, PointDistortion, PointError, point_distortion};
pub use kn_mesh::BoundingBox;
pub use msdm2::{
    DEFAULT_LEVELS, Interpolation, MAX_LEVELS, Msdm2, Msdm2Direction, Msdm2Error, Msdm2Surface,
    msdm2, msdm2_one_way,
};
pub use p2s::{
    Distances, P2s, P2sError, distances_to_surface, p2s, p2s_of_vertices, sample_surface,
};
pub use surface::{IndexedMesh, MeshRef, Surface};
pub use tree::{Closest, TreeError, TriangleTree};
