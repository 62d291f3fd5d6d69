//! Bounding-volume hierarchies: eight boxes a node, in binary32, over triangles or points.
//!
//! Boxes only exclude. What a leaf holds, and how near it is, is its owner's business ([`Search`]).

mod build;
mod node;
mod search;

pub(crate) use build::{Item, build};
pub(crate) use node::{Bounds, LANES, Lanes, Node, Query};
pub(crate) use search::{Patience, Search, descend};
