//! Lossless coding of the mesh of an I-frame: any list of triangles on the integer grid
//! (`spec/05-intra.md`).
//!
//! Connectivity is coded first: surfaces are conquered triangle by triangle, and the valence of a
//! vertex, once known, decides most of the triangles around it. Positions are coded second, in an
//! order that gives every vertex many known triangles around it. A position is predicted from
//! these, and its residual is coded with contexts for the error along and across the surface.
//! Labels are coded in the same order.
//!
//! Encoder and decoder are one code, generic over
//! [`BinaryCoder`](kn_bitstream::range::BinaryCoder), so that the symbols of an encoder and of a
//! decoder cannot get out of step.

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

/// Largest number of vertices or faces of a mesh: half-edges of closed surfaces have 32-bit
/// numbers.
const MOST: u32 = (1 << 28) - 1;

/// The reason why a mesh cannot be coded or a payload cannot be decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum IntraError {
    /// The payload breaks a rule of the specification.
    #[error("byte {at} of the sections: the mesh breaks a rule: {rule}")]
    Malformed {
        /// The rule.
        rule: Rule,
        /// Byte near which the rule is broken, counted from the first section.
        at: usize,
    },
    /// The payload announces more than the caller allows.
    #[error("intra payload: {asked} {what}, the limit is {allowed}")]
    Limit {
        /// The quantity that is too large.
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
        /// The quantity that is too large.
        what: &'static str,
        /// Its value.
        count: usize,
    },
}
