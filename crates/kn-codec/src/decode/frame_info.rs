//! Facts about a decoded frame.

/// The kind of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameKind {
    /// An I-frame: begins a GoF and decodes alone.
    Intra,
    /// A P-frame: a decoded frame of its GoF, deformed.
    Predicted,
}

/// Facts about a decoded frame: numbers, kind and size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameInfo {
    /// Place in the sequence, from 0: display order. Rises by one from frame to frame, except over
    /// a seek.
    pub index: u64,
    /// Place in the stream, from 0: decode order. Equal to `index` in streams of this version.
    pub decode_index: u64,
    /// Whether the frame is an I-frame or a P-frame.
    pub kind: FrameKind,
    /// Bytes of the frame's units; a GoF's key nodes count with its first P-frame.
    pub bytes: u64,
    /// Number of vertices.
    pub vertices: u32,
    /// Number of faces.
    pub faces: u32,
    /// Number of key nodes, 0 for an I-frame.
    pub nodes: u32,
}

impl FrameInfo {
    /// Whether the frame has no vertices: nothing is shown at that time.
    pub fn is_empty(&self) -> bool {
        self.vertices == 0
    }
}
