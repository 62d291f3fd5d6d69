//! Reads scans from OBJ, PLY, OFF, STL, GLB and glTF files, and writes meshes as OBJ, PLY and GLB.
//!
//! Reading keeps the order and the number of the vertices, cuts polygons into triangles, and
//! lists what it does not carry in [`ReadNotes`]. [`Inputs`] is a sequence of frames: a folder,
//! a glob, a printf pattern, a list of files or one animated glTF file. Writing goes through a
//! temporary file, so that a file is there whole or not at all.
//!
//! ```no_run
//! use kn_io::{Inputs, ReadOptions};
//!
//! let inputs = Inputs::find(&["scan/*.obj".into()], ReadOptions::default())?;
//! for frame in inputs.frames() {
//!     let frame = frame?;
//!     let cleaned = kn_mesh::clean(&frame.mesh)?;
//!     println!("{}: {} {}", frame.name, cleaned.report, frame.notes);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod atomic;
mod error;
mod gltf;
mod inputs;
mod labels;
mod materials;
mod notes;
mod obj;
mod off;
mod off_binary;
mod parsed;
mod ply;
mod ply_header;
mod ply_values;
mod polygons;
mod read;
mod sequence;
mod stl;
mod text;
mod triangulation;
mod write;

pub use atomic::write_atomically;
pub use error::{MeshError, MeshErrorKind, Place};
pub use gltf::GlbWriter;
pub use inputs::{Frames, InputFrame, Inputs};
pub use labels::{read_labels, write_labels};
pub use notes::ReadNotes;
pub use read::{LabelSource, MAX_FILE_BYTES, ReadOptions, Scan, read_mesh};
pub use sequence::Missing;
pub use write::{check_scalar_format, write_mesh, write_mesh_in, write_mesh_with_scalar};

use error::Fault;
use std::path::Path;

/// The mesh formats, by file extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY: ascii or binary of either byte order is read, binary is written.
    Ply,
    /// Geomview OFF, text or binary; read only.
    Off,
    /// STL, text or binary; read only.
    Stl,
    /// glTF 2.0 in one binary file.
    Glb,
    /// glTF 2.0 as JSON with its buffers beside it or inside; read only.
    Gltf,
}

impl MeshFormat {
    /// The format of an extension, in upper or lower case; `None` for an unknown extension.
    pub fn of_extension(extension: &str) -> Option<Self> {
        match extension.to_ascii_lowercase().as_str() {
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "off" => Some(Self::Off),
            "stl" => Some(Self::Stl),
            "glb" => Some(Self::Glb),
            "gltf" => Some(Self::Gltf),
            _ => None,
        }
    }

    /// The format of a file by its name.
    ///
    /// # Errors
    /// [`MeshErrorKind::Unsupported`] where the extension is not that of a mesh format.
    pub fn of_path(path: &Path) -> Result<Self, MeshError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        Self::of_extension(&extension).ok_or_else(|| {
            let what = "no known mesh format (.obj, .ply, .off, .stl, .glb, .gltf)";
            MeshError::new(path, MeshErrorKind::Unsupported(what.into()))
        })
    }
}
