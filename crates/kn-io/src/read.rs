//! Reading one mesh file of any known format.

use super::text::in_utf8;
use super::{MeshError, MeshErrorKind, MeshFormat, Missing, ReadNotes};
use super::{gltf, obj, off, ply, stl};
use kn_bitstream::params::BodyPart;
use kn_mesh::Mesh;
use std::fs::File;
use std::io::Read;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// The source of the labels of vertices.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum LabelSource {
    /// The vertex property `label` of the file (PLY). Files without it give no labels.
    #[default]
    Property,
    /// The vertex colours, which must be exactly those of
    /// [`BodyPart::colour`].
    Colours,
    /// Another file, with one integer per line and vertex.
    File(PathBuf),
    /// No labels, whatever the file holds.
    None,
}

/// Options of the readers of mesh files.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOptions {
    /// Source of the labels.
    pub labels: LabelSource,
    /// The largest label value allowed, at most 254.
    pub max_label: u8,
    /// Whether a mesh without faces or without vertices is read: an empty frame of a sequence, or
    /// points. If not, it is the error [`MeshErrorKind::NoFaces`] or [`MeshErrorKind::Empty`].
    pub allow_empty: bool,
    /// Frames per second that an animated glTF file is sampled at.
    pub frame_rate: f64,
    /// What is done where a sequence of numbered files lacks some.
    pub missing: Missing,
    /// Which frames of a sequence are taken: every n-th, from the first on.
    pub every: NonZeroUsize,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            labels: LabelSource::default(),
            max_label: BodyPart::Other.label(),
            allow_empty: false,
            frame_rate: 30.0,
            missing: Missing::Fail,
            every: NonZeroUsize::MIN,
        }
    }
}

/// A mesh as it is in a file: every vertex in file order, polygons cut into triangles.
///
/// A vertex that is NaN or infinite and that no face uses has the position of a vertex that is
/// used: cleaning drops it, and the vertices after it keep their numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scan {
    /// The mesh. It passes [`Mesh::check`].
    pub mesh: Mesh,
    /// Content of the file that is not carried.
    pub notes: ReadNotes,
}

/// The largest file that is read, in bytes: what is built in memory stays within a dozen times
/// the file's size.
pub const MAX_FILE_BYTES: u64 = 1 << 30;

/// Reads an OBJ, PLY, OFF, STL, GLB or glTF file; the extension says which. Of a glTF file the rest pose
/// of the default scene is read; for its animation see [`Inputs`](super::Inputs).
///
/// Safe on untrusted files: returns an error or a mesh with indices in range, never panics,
/// allocates in proportion to the file and at most what [`MAX_FILE_BYTES`] allows.
///
/// # Errors
/// The file cannot be read, breaks its format, or holds no valid mesh; the error names the place.
pub fn read_mesh(path: &Path, options: &ReadOptions) -> Result<Scan, MeshError> {
    let format = MeshFormat::of_path(path)?;
    let bytes = read_file(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let parsed = match format {
        MeshFormat::Obj => obj::read_obj(&in_utf8(&bytes), folder),
        MeshFormat::Ply => ply::read_ply(&in_utf8(&bytes)),
        MeshFormat::Off => off::read_off(&in_utf8(&bytes)),
        MeshFormat::Stl => stl::read_stl(&bytes),
        MeshFormat::Glb | MeshFormat::Gltf => gltf::read_rest_pose(bytes, folder),
    };
    parsed.map_err(|fault| fault.at(path))?.finish(path, options)
}

/// All bytes of a file that is neither empty nor too large.
pub(super) fn read_file(path: &Path) -> Result<Vec<u8>, MeshError> {
    let failed = |error| MeshError::new(path, MeshErrorKind::Io(error));
    let file = File::open(path).map_err(failed)?;
    let mut size = file.metadata().map_err(failed)?.len();
    let mut bytes = Vec::new();
    if size <= MAX_FILE_BYTES {
        bytes.reserve_exact(size as usize + 1);
        // The size was a hint: devices report none, and a file may grow while it is read.
        let read = file.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes);
        size = read.map_err(failed)? as u64;
    }
    if size > MAX_FILE_BYTES {
        let what = "bytes in the file";
        let kind = MeshErrorKind::TooLarge { what, asked: size, allowed: MAX_FILE_BYTES };
        return Err(MeshError::new(path, kind));
    }
    if size == 0 {
        return Err(MeshError::new(path, MeshErrorKind::Empty("the file is empty")));
    }
    Ok(bytes)
}
