//! Fits key-node transforms to scanned meshes.
//!
//! A fit finds the transforms of the key nodes that carry a reference mesh onto a scan. Points are
//! matched to the closest points of the other surface. With the matches held fixed, L-BFGS
//! minimises the bi-modal paper's energy L_data + α_reg L_reg + α_orth L_orth. Then the points are
//! matched again. Nothing here is normative: a decoder never fits.

mod affine;
mod cholesky;
mod coarse;
mod constants;
mod deformed;
mod energy;
mod error;
mod fitter;
mod gains;
mod generate;
mod geodesic;
mod group;
mod matching;
mod measures;
mod node_graph;
mod options;
mod orthogonality;
mod parts;
mod pattern;
mod place;
mod quadratic;
mod reach;
mod register;
mod report;
mod sample;
mod schedule;
mod source;
mod surface;
mod target;

pub use error::{FitError, Side};
pub use fitter::Fitter;
pub use gains::{AffineGains, affine_gains};
pub use generate::{GenerateOptions, NodeCount, NodeSource, RankBy, generate_nodes};
pub use measures::{FitMeasures, MeasureOptions, Region, Tear};
pub use options::{FitOptions, PartStart};
pub use place::place_farthest;
pub use register::{RegisterOptions, Registration, register};
pub use report::{Fit, FitReport, Residuals};
pub use source::{FitSource, MAX_NODES};
pub use target::{Deviation, FitTarget};
