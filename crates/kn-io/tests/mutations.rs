//! Ten thousand odd and broken files of every format: each is a sound mesh or an error.

use kn_io::{Inputs, LabelSource, ReadOptions, read_mesh};
use kn_testdata::mutation::{FORMATS, files};

const COUNT: u64 = 10_000;

#[test]
fn every_mutation_is_a_sound_mesh_or_an_error() {
    for format in FORMATS {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut read = 0;
        for seed in 0..COUNT {
            let files = files(format, seed);
            for (name, bytes) in &files {
                // Some file systems wait for the disk when a file is overwritten.
                let path = folder.path().join(name);
                std::fs::remove_file(&path).ok();
                std::fs::write(path, bytes).expect("written");
            }
            let path = folder.path().join(&files[0].0);
            let labels = if seed % 4 == 0 { LabelSource::Colours } else { LabelSource::Property };
            let options =
                ReadOptions { labels, allow_empty: seed % 2 == 0, ..ReadOptions::default() };
            if let Ok(scan) = read_mesh(&path, &options) {
                scan.mesh.check().unwrap_or_else(|fault| panic!("{format} {seed}: {fault}"));
                read += 1;
            }
            if matches!(format, "glb" | "gltf")
                && let Ok(inputs) = Inputs::find(&[path], ReadOptions::default())
            {
                for frame in inputs.frames().take(2).flatten() {
                    frame.mesh.check().unwrap_or_else(|fault| panic!("{format} {seed}: {fault}"));
                }
            }
        }
        // Enough of them pass the first checks for the later ones to be tried.
        assert!((COUNT / 10..COUNT).contains(&read), "{format}: {read} of {COUNT} are read");
    }
}
