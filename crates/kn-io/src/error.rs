//! Errors of files, with the place in the file and the frame.

use std::fmt;
use std::path::{Path, PathBuf};

/// An error about one file. Its message names the file, the frame and the place, then the reason.
#[derive(Debug)]
pub struct MeshError {
    /// The file, or the pattern that matched none.
    pub path: PathBuf,
    /// The frame of the sequence, counted from 0, where the file was read as one.
    pub frame: Option<usize>,
    /// The place in the file.
    pub place: Place,
    /// The kind of the error.
    pub kind: MeshErrorKind,
}

/// A place in a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a text file, counted from 1.
    Line(usize),
    /// A vertex, counted from 0.
    Vertex(usize),
    /// A face, counted from 0.
    Face(usize),
}

/// What can be done where frames are missing; see [`Missing`](super::Missing).
const MISSING_FRAMES: &str =
    "--missing skip goes on without such frames, --missing hold repeats the frame before";

/// The reasons why a file cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshErrorKind {
    /// The operating system reported an error: no such file, no permission, a full disk.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// The file has no bytes or no vertices.
    #[error("{0}")]
    Empty(&'static str),
    /// The file has vertices, but no faces; see
    /// [`ReadOptions::allow_empty`](super::ReadOptions).
    #[error("the mesh has no faces")]
    NoFaces,
    /// The content breaks the rules of its format.
    #[error("{0}")]
    Malformed(String),
    /// The file ends before its content does.
    #[error("the file ends early: {0}")]
    Truncated(String),
    /// A coordinate is NaN, infinite, or beyond [`kn_mesh::MAX_COORDINATE`].
    #[error("a coordinate is NaN or infinite, or beyond 1e38")]
    NotFinite,
    /// A face names a vertex that does not exist. `index` is as written in the file.
    #[error("face index {index} is out of range: there are {vertices} vertices")]
    FaceIndex {
        /// The index as written in the file.
        index: i64,
        /// The number of vertices.
        vertices: usize,
    },
    /// There is not one label for each vertex.
    #[error("{labels} labels for {vertices} vertices")]
    LabelCount {
        /// The number of labels.
        labels: usize,
        /// The number of vertices.
        vertices: usize,
    },
    /// A label is above the largest one allowed.
    #[error("label {label} is out of range: labels are 0 to {max}")]
    LabelRange {
        /// The label as written in the file.
        label: i64,
        /// The largest label allowed.
        max: u8,
    },
    /// Labels were asked for from colours, but a colour belongs to no body part.
    #[error("colour {0:?} is the colour of no body part")]
    UnknownColour([u8; 3]),
    /// Labels were asked for from colours, but the file has no colours.
    #[error("labels were asked from vertex colours, but the file has none")]
    NoColours,
    /// A format, or a feature of a format, is not supported.
    #[error("{0}")]
    Unsupported(String),
    /// A pattern or folder has no mesh file.
    #[error("no mesh file matches (.obj, .ply, .off, .stl, .glb, .gltf)")]
    NoMatch,
    /// A pattern or folder has no label file.
    #[error("no label file matches")]
    NoLabelFile,
    /// A numbered frame is absent between two that exist.
    #[error("this frame is missing: the sequence runs from {first} to {last}; {MISSING_FRAMES}")]
    MissingFrame {
        /// Name of the first file.
        first: String,
        /// Name of the last file.
        last: String,
    },
    /// Frames are absent before this one: the numbers, such as times, rise by more than elsewhere.
    #[error(
        "frames are missing between {after} and this one: elsewhere numbers rise by {step}; {MISSING_FRAMES}"
    )]
    MissingBefore {
        /// Name of the file before.
        after: String,
        /// The usual distance of two numbers.
        step: i64,
    },
    /// The reader has a fault of its own, which this file shows.
    #[error("internal error: {0}; please report it with this file")]
    Internal(String),
    /// The inputs do not say which frames are meant.
    #[error("{0}")]
    Ambiguous(String),
    /// The file is above a limit.
    #[error("{what}: {asked} is more than {allowed}")]
    TooLarge {
        /// The quantity that is limited.
        what: &'static str,
        /// The amount in the file.
        asked: u64,
        /// The amount that is allowed.
        allowed: u64,
    },
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        if let Some(frame) = self.frame {
            write!(f, " (frame {frame})")?;
        }
        match self.place {
            Place::File => write!(f, ": {}", self.kind),
            Place::Line(line) => write!(f, ", line {line}: {}", self.kind),
            Place::Vertex(vertex) => write!(f, ", vertex {vertex}: {}", self.kind),
            Place::Face(face) => write!(f, ", face {face}: {}", self.kind),
        }
    }
}

impl std::error::Error for MeshError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &self.kind {
            MeshErrorKind::Io(error) => Some(error),
            _ => None,
        }
    }
}

impl MeshError {
    /// Makes an error about a file as a whole.
    pub fn new(path: impl Into<PathBuf>, kind: impl Into<MeshErrorKind>) -> Self {
        Self { path: path.into(), frame: None, place: Place::File, kind: kind.into() }
    }

    /// Sets the frame that the error is about.
    pub fn in_frame(mut self, frame: usize) -> Self {
        self.frame = Some(frame);
        self
    }
}

/// An error inside a file whose name the format's reader does not know.
#[derive(Debug)]
pub(super) struct Fault {
    place: Place,
    kind: MeshErrorKind,
}

impl Fault {
    pub(super) fn at(self, path: &Path) -> MeshError {
        MeshError { path: path.to_owned(), frame: None, place: self.place, kind: self.kind }
    }
}

impl From<MeshErrorKind> for Fault {
    fn from(kind: MeshErrorKind) -> Self {
        Self { place: Place::File, kind }
    }
}

impl Place {
    /// A fault here.
    pub(super) fn fault(self, kind: MeshErrorKind) -> Fault {
        Fault { place: self, kind }
    }

    /// Content here that breaks the rules of its format.
    pub(super) fn malformed(self, what: impl Into<String>) -> Fault {
        self.fault(MeshErrorKind::Malformed(what.into()))
    }

    /// The vertex that an index from 0 on means here; a fault where there is no such vertex.
    pub(super) fn vertex(self, index: i64, vertices: usize) -> Result<u32, Fault> {
        match u32::try_from(index) {
            Ok(vertex) if (vertex as usize) < vertices => Ok(vertex),
            _ => Err(self.fault(MeshErrorKind::FaceIndex { index, vertices })),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_name_file_frame_place_and_reason() {
        let kind = MeshErrorKind::FaceIndex { index: 9, vertices: 8 };
        let error = Place::Line(12).fault(kind).at(Path::new("scan/f_7.obj")).in_frame(7);
        assert_eq!(
            error.to_string(),
            "scan/f_7.obj (frame 7), line 12: face index 9 is out of range: there are 8 vertices"
        );
        let error = MeshError::new("out.ply", std::io::Error::other("disk full"));
        assert_eq!(error.to_string(), "out.ply: disk full");
    }
}
