//! Errors of the segmentation.

/// The reason why a mesh cannot be segmented.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SegmentError {
    /// The mesh has no vertices or no faces.
    #[error("the mesh is empty")]
    Empty,
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} is not finite")]
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} has an index out of range")]
    FaceIndex {
        /// Index of the face.
        face: usize,
    },
    /// The faces have no area, or none that can be measured.
    #[error("the mesh has no area")]
    NoArea,
    /// There is not one label for each vertex.
    #[error("{labels} labels for {vertices} vertices")]
    LabelCount {
        /// Number of labels.
        labels: usize,
        /// Number of vertices.
        vertices: usize,
    },
}
