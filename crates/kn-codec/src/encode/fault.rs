//! Reasons why a frame cannot be coded.

use crate::intra::IntraError;
use kn_bitstream::params::BodyPart;
use kn_bitstream::rule::{DEFORM_INFLUENCE_STRICT, Rule};
use kn_fit::FitError;
use kn_mesh::{GridError, MeshFault};
use kn_metrics::Msdm2Error;
use std::fmt;

/// The reason why a frame cannot be coded.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum InputFault {
    /// The mesh has no vertices.
    NoVertices,
    /// The mesh has no faces.
    NoFaces,
    /// The mesh is not valid.
    Mesh(MeshFault),
    /// A label is none of those of [`BodyPart`].
    Label {
        /// The label.
        label: u8,
        /// Index of the vertex that has it.
        vertex: usize,
    },
    /// The frame has labels, and the frames before it have none.
    LabelsAppear,
    /// The frame has no labels, and the frames before it have some.
    LabelsEnd,
    /// The first frame is so large that no level of the specification holds twice its size.
    Level {
        /// Number of vertices.
        vertices: usize,
        /// Number of faces.
        faces: usize,
    },
    /// A position has no place on the grid.
    Grid(GridError),
    /// The grid is lossless, and a vertex does not lie on it.
    OffGrid {
        /// Index of the vertex.
        vertex: usize,
    },
    /// No face is left on the grid.
    NothingLeft {
        /// Step of the grid, in world units.
        step: f64,
    },
    /// The mesh of an I-frame cannot be coded.
    Intra(IntraError),
    /// The influence mode is strict, and the region of a body part has no key node.
    WithoutNodes {
        /// The part, where it is known.
        part: Option<BodyPart>,
    },
    /// The motion cannot be fitted.
    Fit(FitError),
    /// MSDM2 cannot be measured.
    Msdm2(Msdm2Error),
    /// The frame would break a rule of the specification.
    Rule(Rule),
    /// The GoF that the frame begins is larger than 4 GiB.
    GroupTooLarge,
}

impl fmt::Display for InputFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoVertices => f.write_str("the mesh has no vertices"),
            Self::NoFaces => f.write_str("the mesh has no faces"),
            Self::Mesh(fault) => fault.fmt(f),
            Self::Label { label, vertex } => {
                write!(f, "label {label} of vertex {vertex} is not 0 to {}", BodyPart::COUNT - 1)
            }
            Self::LabelsAppear => f.write_str("the frame has labels, earlier frames have none"),
            Self::LabelsEnd => f.write_str("the frame has no labels, earlier frames have"),
            Self::Level { vertices, faces } => {
                write!(f, "no level holds twice its {vertices} vertices and {faces} faces")
            }
            Self::Grid(error) => error.fmt(f),
            Self::OffGrid { vertex } => {
                write!(f, "vertex {vertex} does not lie on the lossless grid")
            }
            Self::NothingLeft { step } => write!(
                f,
                "no face is left on the grid, whose step is {step:.3e}: the mesh is too small for it"
            ),
            Self::Intra(error) => error.fmt(f),
            Self::WithoutNodes { part } => {
                let part = part.map_or("a part".into(), |part| part.to_string());
                write!(f, "{DEFORM_INFLUENCE_STRICT}: there is none for {part}")
            }
            Self::Fit(error) => error.fmt(f),
            Self::Msdm2(error) => error.fmt(f),
            Self::Rule(rule) => rule.fmt(f),
            Self::GroupTooLarge => f.write_str("the GoF is larger than 4 GiB"),
        }
    }
}

impl std::error::Error for InputFault {}

/// Conversions from the errors that a fault holds.
macro_rules! from {
    ($($variant:ident($error:ty),)*) => {$(
        impl From<$error> for InputFault {
            fn from(error: $error) -> Self {
                Self::$variant(error)
            }
        }
    )*};
}

from! {
    Mesh(MeshFault),
    Grid(GridError),
    Intra(IntraError),
    Fit(FitError),
    Msdm2(Msdm2Error),
    Rule(Rule),
}
