//! glTF 2.0: meshes, skins, morph targets and animations in; meshes and their sequences out.
//!
//! The gltf crate does not read the files: its JSON types refuse much of what writers write, hold the
//! places of nodes in binary32, and its accessor readers panic on broken files
//! (`docs/notes/reading-scans.md`). Every index and range is checked here.

mod accessor;
mod animation;
mod container;
mod instances;
mod json;
mod nodes;
mod pose;
mod requirements;
mod scene;
mod views;
mod write;

pub(super) use scene::Scene;
pub use write::GlbWriter;

use super::parsed::Parsed;
use super::{Fault, Place};
use std::path::Path;

/// Reads the default scene of a GLB or glTF file at rest. `folder` is where its buffers lie.
pub(super) fn read_rest_pose(bytes: Vec<u8>, folder: &Path) -> Result<Parsed, Fault> {
    let scene = Scene::load(bytes, folder)?;
    let mut parsed = scene.at_rest();
    parsed.notes.ignore("animations", scene.animation_count() as u64);
    Ok(parsed)
}

/// Content that breaks the rules of glTF.
fn bad(what: impl std::fmt::Display) -> Fault {
    Place::File.malformed(format!("glTF: {what}"))
}
