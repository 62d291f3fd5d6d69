//! Errors of sequences, each with its file and its frame.

use std::io;
use std::path::PathBuf;

use kn_codec::DecodeError;
use kn_io::MeshError;
use kn_mesh::MeshFault;
use kn_metrics::CompareError;
use kn_segment::SegmentError;

/// The reason why a sequence cannot be read or compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SequenceError {
    /// A mesh file cannot be found or read.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A scan cannot be used.
    #[error("{}: frame {frame}: {fault}", file.display())]
    Scan {
        /// The file of the frame.
        file: PathBuf,
        /// Number of the frame.
        frame: usize,
        /// The fault of the scan.
        fault: ScanFault,
    },
    /// A scan cannot be segmented, or its labels cannot be checked.
    #[error("{}: frame {frame}: {source}", file.display())]
    Segment {
        /// The file of the frame.
        file: PathBuf,
        /// Number of the frame.
        frame: usize,
        /// Why.
        source: SegmentError,
    },
    /// A frame shows a fault of the program.
    #[error("{file}: frame {frame}: internal error: {message}; please report it with this frame")]
    Internal {
        /// The file of the frame.
        file: String,
        /// Number of the frame.
        frame: u64,
        /// The message of the panic.
        message: String,
    },
    /// A stream cannot be opened.
    #[error("{name}: {source}")]
    Open {
        /// The stream.
        name: String,
        /// Why.
        source: io::Error,
    },
    /// A stream cannot be decoded.
    #[error("{name}: {source}")]
    Decode {
        /// The stream.
        name: String,
        /// Why.
        source: DecodeError,
    },
    /// No frame of the sequence has a vertex.
    #[error("no frame to measure")]
    Empty,
    /// The sequence has no size that distances could be relative to.
    #[error("all vertices of the reference are at one point")]
    NoExtent,
    /// One sequence ends before the other.
    #[error("{short}: frame {frame}: there is no such frame, but {long} has it")]
    Length {
        /// The sequence that ends.
        short: String,
        /// The sequence that goes on.
        long: String,
        /// The first frame that is in one of them only.
        frame: u64,
    },
    /// The frames that were asked for do not exist.
    #[error("there is no frame {first} to measure: {reference} and {distorted} have {frames} frame{}",
        if *frames == 1 { "" } else { "s" })]
    NoFrame {
        /// The first frame that was asked for.
        first: u64,
        /// The reference.
        reference: String,
        /// The other sequence.
        distorted: String,
        /// Number of frames that both have.
        frames: u64,
    },
    /// A body part cannot be measured, since the frame has no labels.
    #[error("{file}: frame {frame}: the mesh has no labels")]
    NoLabels {
        /// The file of the frame.
        file: String,
        /// Number of the frame.
        frame: u64,
    },
    /// A body part cannot be measured, since no face has it at all three corners.
    #[error("{file}: frame {frame}: no face has the label {part} at all its corners")]
    NoPart {
        /// The file of the frame.
        file: String,
        /// Number of the frame.
        frame: u64,
        /// Label of the part.
        part: u8,
    },
    /// Two frames cannot be compared.
    #[error("{file}: frame {frame}: {source}")]
    Compare {
        /// The file of the frame.
        file: String,
        /// Number of the frame.
        frame: u64,
        /// Why.
        source: CompareError,
    },
}

/// The reason why a scan cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ScanFault {
    /// The mesh is not valid.
    #[error(transparent)]
    Mesh(#[from] MeshFault),
    /// No face is left after cleaning.
    #[error("all faces are degenerate: none has three corners at different places")]
    Degenerate,
}
