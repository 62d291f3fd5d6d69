//! Errors of input that cannot be fitted at all.

/// The reason why no fit can start. A frame that is hard to fit is no error: its report says how
/// far the fit is from the scan.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FitError {
    /// A mesh has no vertices or no faces with an area.
    #[error("the {mesh} mesh has no surface")]
    NoSurface {
        /// The mesh, source or target.
        mesh: Side,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} of the {mesh} mesh is not finite")]
    NotFinite {
        /// The mesh, source or target.
        mesh: Side,
        /// Index of the vertex.
        vertex: usize,
    },
    /// The closest-point search refuses a mesh: too many faces, coordinates too large.
    #[error("the {mesh} mesh cannot be searched")]
    Tree {
        /// The mesh, source or target.
        mesh: Side,
        /// The reason.
        source: kn_metrics::TreeError,
    },
    /// Influence cannot be bound to the nodes.
    #[error(transparent)]
    Bind(#[from] kn_deform::BindError),
    /// A face names a vertex that does not exist.
    #[error("face {face} of the {mesh} mesh names a vertex that does not exist")]
    BadFace {
        /// The mesh, source or target.
        mesh: Side,
        /// Index of the face.
        face: usize,
    },
    /// An array does not have one entry per vertex, node or influence.
    #[error("{what} has {found} entries, {expected} are needed")]
    Length {
        /// The array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// An influence names a node that does not exist, or there are no nodes at all.
    #[error("the influence of vertex {vertex} names a node that does not exist")]
    BadInfluence {
        /// Index of the vertex.
        vertex: usize,
    },
    /// There are more nodes than a fit takes.
    #[error("{nodes} key nodes are more than {}", crate::MAX_NODES)]
    TooManyNodes {
        /// The number asked for.
        nodes: usize,
    },
}

/// The two meshes of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The mesh that is deformed: the decoder's reference.
    Source,
    /// The mesh that it is deformed to: the scan.
    Target,
}

impl std::fmt::Display for Side {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Source => "source",
            Self::Target => "target",
        })
    }
}
