//! A short sequence of the performer in files, with its stream.
#![allow(dead_code, reason = "each test binary uses a part of it")]

use kn_codec::{Encoder, EncoderConfig};
use kn_io::{write_labels, write_mesh};
use kn_mesh::Mesh;
use kn_performer::{Performer, PerformerConfig};
use std::fs::{self, File};
use std::path::PathBuf;
use tempfile::TempDir;

/// Number of frames.
pub(crate) const FRAMES: usize = 3;

/// A folder with `f_0.obj`, `f_0.labels`, `f_0.ply` (with labels) and so on, and `a.knm`.
pub(crate) struct Files {
    folder: TempDir,
    pub(crate) meshes: Vec<Mesh>,
}

impl Files {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let config = PerformerConfig { vertices: 2_500, ..PerformerConfig::default() };
        let performer = Performer::new(config).expect("sound settings");
        let meshes: Vec<Mesh> = (0..FRAMES as u32).map(|index| performer.frame(index)).collect();
        let files = Self { folder, meshes };
        for (index, mesh) in files.meshes.iter().enumerate() {
            let path = |extension: &str| files.path(&format!("f_{index}.{extension}"));
            write_mesh(&path("obj"), mesh).expect("written");
            write_mesh(&path("ply"), mesh).expect("written");
            let out = File::create(path("labels")).expect("made");
            write_labels(out, &mesh.labels).expect("written");
        }
        let config = EncoderConfig::default().with_nodes(40);
        let mut encoder = Encoder::new(Vec::new(), config).expect("sound settings");
        files.meshes.iter().for_each(|mesh| encoder.push(mesh).expect("coded"));
        let stream = encoder.finish().expect("coded").writer;
        fs::write(files.path("a.knm"), stream).expect("written");
        files
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
}
