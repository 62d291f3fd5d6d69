//! Static coding of the I-frame's mesh: any list of triangles on the integer grid, exactly
//! (`spec/05-intra.md`).
//!
//! Connectivity goes first: surfaces are conquered triangle by triangle, and the valence of every
//! vertex, once known, forces most of what follows. Positions come second, in an order that gives
//! every vertex as many known triangles around it as can be, each one expected from these and its
//! error coded with contexts for how far off it may be along and across the surface. Labels follow
//! the same order.
//!
//! Encoder and decoder are one code, generic over
//! [`BinaryCoder`](kn_bitstream::range::BinaryCoder): the symbols that an encoder brings and a
//! decoder finds cannot get out of step.

use kn_bitstream::Rule;

mod border;
mod conquest;
mod decode;
#[cfg(feature = "encode")]
mod encode;
mod geometry;
mod joins;
mod labels;
mod lattice;
mod predict;
mod residual;
mod spread;
mod surface;
#[cfg(feature = "encode")]
mod survey;
mod symbols;
#[cfg(feature = "encode")]
mod topology;
mod traversal;

pub use decode::{IntraDecoder, IntraLimits, decode_intra};
#[cfg(feature = "encode")]
pub use encode::{IntraEncoding, encode_intra};

/// Most vertices or faces of a mesh: half-edges of closed surfaces are numbered in 32 bits.
const MOST: u32 = (1 << 28) - 1;

/// Why a mesh could not be coded or a payload not decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum IntraError {
    /// The payload breaks a rule of the specification.
    #[error("byte {at} of the sections: the mesh breaks a rule: {rule}")]
    Malformed {
        /// The rule.
        rule: Rule,
        /// Byte near which it shows, counted from the first section.
        at: usize,
    },
    /// The payload announces more than the caller allows.
    #[error("intra payload: {asked} {what}, the limit is {allowed}")]
    Limit {
        /// What there is too much of.
        what: &'static str,
        /// Announced.
        asked: u32,
        /// Allowed.
        allowed: u32,
    },
    /// A face of the mesh to encode names a vertex that does not exist.
    #[error("face {face} names a vertex that does not exist")]
    FaceIndex {
        /// Index of the face.
        face: usize,
    },
    /// A coordinate of the mesh to encode lies outside the grid.
    #[error("vertex {vertex} lies outside the grid")]
    Outside {
        /// Index of the vertex.
        vertex: usize,
    },
    /// The mesh to encode has labels, but not one for each vertex.
    #[error("{labels} labels for {vertices} vertices")]
    LabelCount {
        /// Number of labels.
        labels: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// The mesh to encode has 2^28 vertices or faces, or more.
    #[error("{count} {what} are too many")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        count: usize,
    },
}
