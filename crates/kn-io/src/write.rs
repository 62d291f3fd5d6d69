//! Writing of one mesh into one file, whole or not at all.

use super::{GlbWriter, MeshError, MeshErrorKind, MeshFormat, obj, ply, write_atomically};
use kn_mesh::{Mesh, Precision};
use std::path::Path;

/// Writes a mesh in the format that the extension names, in the precision that it needs
/// ([`Mesh::precision`]); see [`write_mesh_in`].
///
/// # Errors
/// The errors of [`write_mesh_in`].
pub fn write_mesh(path: &Path, mesh: &Mesh) -> Result<(), MeshError> {
    write_mesh_in(path, mesh, mesh.precision())
}

/// Writes a mesh in the format that the extension names: OBJ, PLY (binary little-endian, with
/// the labels where there are any) or GLB. OBJ and GLB carry no labels.
///
/// Coordinates in OBJ and PLY have the `precision`: they read back to the same bits of that. See
/// [`GlbWriter`] for GLB, whose coordinates are binary32 relative to the place of a node.
///
/// # Errors
/// The mesh is not valid ([`Mesh::check`]), the format is not written, or the file cannot be
/// written; then nothing is left at `path` that was not there before.
pub fn write_mesh_in(path: &Path, mesh: &Mesh, precision: Precision) -> Result<(), MeshError> {
    check(path, mesh)?;
    match MeshFormat::of_path(path)? {
        MeshFormat::Obj => write_atomically(path, |out| obj::write_obj(mesh, precision, out)),
        MeshFormat::Ply => write_atomically(path, |out| ply::write_ply(mesh, precision, None, out)),
        MeshFormat::Glb => {
            // The rate of a single frame is written nowhere.
            let mut writer = GlbWriter::create(path, 1.0)?;
            writer.push(mesh)?;
            writer.finish()
        }
        MeshFormat::Off => Err(unsupported(path, "OFF files are read, but not written")),
        MeshFormat::Stl => Err(unsupported(path, "STL files are read, but not written")),
        MeshFormat::Gltf => Err(unsupported(path, "glTF files are written as .glb")),
    }
}

/// Writes a mesh as PLY with one more number per vertex (`values`, `#V`), for instance an error,
/// as the property `name`. Coordinates have the precision that the mesh needs.
///
/// # Errors
/// The errors of [`write_mesh`]; also: the file is no `.ply`, `name` is no property name, or there
/// is not one value for each vertex.
pub fn write_mesh_with_scalar(
    path: &Path,
    mesh: &Mesh,
    name: &str,
    values: &[f32],
) -> Result<(), MeshError> {
    check(path, mesh)?;
    check_scalar_format(path)?;
    if name.is_empty() || !name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_') {
        return Err(unsupported(path, "a property name has letters, digits and _ only"));
    }
    if values.len() != mesh.positions.len() {
        let what =
            format!("{} values of {name} for {} vertices", values.len(), mesh.positions.len());
        return Err(MeshError::new(path, MeshErrorKind::Malformed(what)));
    }
    write_atomically(path, |out| ply::write_ply(mesh, mesh.precision(), Some((name, values)), out))
}

/// Checks that [`write_mesh_with_scalar`] can write a file of this name, before any work is done.
///
/// # Errors
/// The file is no `.ply`.
pub fn check_scalar_format(path: &Path) -> Result<(), MeshError> {
    match MeshFormat::of_path(path)? {
        MeshFormat::Ply => Ok(()),
        _ => Err(unsupported(path, "numbers per vertex are written to .ply only")),
    }
}

fn check(path: &Path, mesh: &Mesh) -> Result<(), MeshError> {
    mesh.check().map_err(|fault| MeshError::new(path, MeshErrorKind::Malformed(fault.to_string())))
}

fn unsupported(path: &Path, what: &str) -> MeshError {
    MeshError::new(path, MeshErrorKind::Unsupported(what.into()))
}
