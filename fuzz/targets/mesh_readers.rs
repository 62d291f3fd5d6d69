//! Any bytes are a mesh with indices in range, or an error, in every format that is read.
#![no_main]

use std::path::PathBuf;
use std::sync::LazyLock;

use kn_io::{Inputs, LabelSource, ReadOptions, read_mesh};
use libfuzzer_sys::{Corpus, fuzz_target};
use tempfile::TempDir;

static FOLDER: LazyLock<TempDir> = LazyLock::new(|| TempDir::new().expect("a folder"));
const EXTENSIONS: [&str; 6] = ["obj", "ply", "off", "glb", "gltf", "stl"];

fuzz_target!(init: kn_fuzz::one_thread(), |input: &[u8]| -> Corpus {
    // The first byte is the format's digit, so that seeds can be named by hand.
    let Some((format, bytes)) = input.split_first() else { return Corpus::Reject };
    let Some(extension) = EXTENSIONS.get(usize::from(format.wrapping_sub(b'0'))) else {
        return Corpus::Reject;
    };
    let path: PathBuf = FOLDER.path().join("mesh").with_extension(extension);
    std::fs::write(&path, bytes).expect("a temporary file");
    for labels in [LabelSource::Property, LabelSource::Colours] {
        let options = ReadOptions { labels, allow_empty: true, ..ReadOptions::default() };
        if let Ok(scan) = read_mesh(&path, &options) {
            scan.mesh.check().expect("what is read is sound");
        }
    }
    // Animated files have many frames; the first ones show the way.
    if let Ok(inputs) = Inputs::find(&[path], ReadOptions::default()) {
        for frame in inputs.frames().take(3).flatten() {
            frame.mesh.check().expect("what is read is sound");
        }
    }
    Corpus::Keep
});
