//! Material libraries of OBJ. They are not carried, so they are counted and never parsed: nothing
//! in one can fail a read.

use super::ReadNotes;
use super::text::{Lines, words};
use std::fs;
use std::path::{Component, Path};

/// The largest material library that is looked into, in bytes.
const MAX_LIBRARY_BYTES: u64 = 1 << 20;

/// Notes how many materials and textures a library has.
pub(super) fn note_materials(folder: &Path, name: &str, notes: &mut ReadNotes) {
    let shown = name.escape_debug();
    match read_library(folder, name) {
        Ok(library) => {
            let (materials, textures) = count(&library);
            notes.ignore(format!("materials of {shown}"), materials);
            notes.ignore(format!("textures of {shown}"), textures);
        }
        Err(reason) => notes.ignore(format!("material library {shown}: {reason}"), 1),
    }
}

fn read_library(folder: &Path, name: &str) -> Result<Vec<u8>, &'static str> {
    // A mesh file must not make us open devices or files elsewhere.
    let path = Path::new(name);
    if !path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
        return Err("not beside the mesh");
    }
    let path = folder.join(path);
    match path.metadata() {
        Ok(found) if !found.is_file() => Err("no file"),
        Ok(found) if found.len() > MAX_LIBRARY_BYTES => Err("too large"),
        Ok(_) => fs::read(&path).map_err(|_| "cannot be read"),
        Err(_) => Err("not there"),
    }
}

/// The numbers of materials (`newmtl`) and of textures (`map_Kd` and the like).
fn count(library: &[u8]) -> (u64, u64) {
    let (mut materials, mut textures) = (0, 0);
    for (_, line) in Lines::new(library) {
        match words(line).next() {
            Some(b"newmtl") => materials += 1,
            Some(b"bump" | b"norm" | b"disp" | b"decal" | b"refl") => textures += 1,
            Some(keyword) if keyword.starts_with(b"map_") => textures += 1,
            _ => {}
        }
    }
    (materials, textures)
}
