//! What a decoder is willing to spend on a stream.

/// Bounds that are checked before anything is allocated.
///
/// A stream can make a decoder hold at most about `max_unit_bytes` of input and
/// `(100 + 10·Q) · max_vertices + 12 · max_faces` bytes of state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Vertices of an I-frame.
    pub max_vertices: u32,
    /// Faces of an I-frame.
    pub max_faces: u32,
    /// Key nodes of a group of frames.
    pub max_nodes: u32,
    /// Bytes of one unit.
    pub max_unit_bytes: u32,
}

impl Default for Limits {
    /// Enough for scans of four million vertices.
    fn default() -> Self {
        Self { max_vertices: 1 << 22, max_faces: 1 << 23, max_nodes: 4096, max_unit_bytes: 1 << 28 }
    }
}
