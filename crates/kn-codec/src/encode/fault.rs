//! Reasons why a frame cannot be coded.

use crate::intra::IntraError;
use kn_bitstream::params::BodyPart;
use kn_bitstream::rule::{DEFORM_INFLUENCE_STRICT, Rule};
use kn_fit::FitError;
use kn_mesh::{GridError, MeshFault};
use kn_metrics::Msdm2Error;

/// The reason why a frame cannot be coded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InputFault {
    /// No frame has a vertex, and the settings name no box for the grid.
    #[error("no frame has a vertex, and the settings name no box")]
    NoBox,
    /// The name of the frame cannot be part of a stream.
    #[error("a stream cannot carry the name {0:?}")]
    Name(String),
    /// The mesh is not valid.
    #[error(transparent)]
    Mesh(#[from] MeshFault),
    /// A label is none of those of [`BodyPart`].
    #[error("label {label} of vertex {vertex} is not 0 to {}", BodyPart::COUNT - 1)]
    Label {
        /// The label.
        label: u8,
        /// Index of the vertex that has it.
        vertex: usize,
    },
    /// The frame has labels, and the frames before it have none.
    #[error("the frame has labels, earlier frames have none")]
    LabelsAppear,
    /// The frame has no labels, and the frames before it have some.
    #[error("the frame has no labels, earlier frames have")]
    LabelsEnd,
    /// The first frame is so large that no level of the specification holds twice its size.
    #[error("no level holds twice its {vertices} vertices and {faces} faces")]
    Level {
        /// Number of vertices.
        vertices: usize,
        /// Number of faces.
        faces: usize,
    },
    /// A position has no place on the grid.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// The grid is lossless, and a vertex does not lie on it.
    #[error("vertex {vertex} does not lie on the lossless grid")]
    OffGrid {
        /// Index of the vertex.
        vertex: usize,
    },
    /// No face is left on the grid.
    #[error("no face is left on the grid, whose step is {step:.3e}: the mesh is too small for it")]
    NothingLeft {
        /// Step of the grid, in world units.
        step: f64,
    },
    /// The mesh of an I-frame cannot be coded.
    #[error(transparent)]
    Intra(#[from] IntraError),
    /// The influence mode is strict, and the region of a body part has no key node.
    #[error(
        "{}: there is none for {}",
        DEFORM_INFLUENCE_STRICT,
        part.map_or("a part".into(), |part| part.to_string())
    )]
    WithoutNodes {
        /// The part, where it is known.
        part: Option<BodyPart>,
    },
    /// The motion cannot be fitted.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// MSDM2 cannot be measured.
    #[error(transparent)]
    Msdm2(#[from] Msdm2Error),
    /// The frame would break a rule of the specification.
    #[error("{0}")]
    Rule(Rule),
    /// The GoF that the frame begins is larger than 4 GiB.
    #[error("the GoF is larger than 4 GiB")]
    GroupTooLarge,
}

impl From<Rule> for InputFault {
    fn from(rule: Rule) -> Self {
        Self::Rule(rule)
    }
}
