//! Every mesh of the measured sequences reads, with the counts that its lines say.

use kn_io::{Inputs, LabelSource, ReadOptions, read_mesh};
use kn_mesh::CleanReport;
use kn_testdata::data;
use std::path::Path;

/// `(vertices, faces)` by counting lines.
fn line_counts(path: &Path) -> (usize, usize) {
    let text = std::fs::read_to_string(path).expect("readable");
    let count = |start: &str| text.lines().filter(|line| line.starts_with(start)).count();
    (count("v "), count("f "))
}

#[test]
fn sequences_read_and_count_as_their_lines() {
    for (folder, frames) in
        [("dancer", 16), ("mitch", 10), ("liam", 32), ("tshirt_turn", 24), ("punch_dirty", 24)]
    {
        let Some(folder) = data(folder) else { return };
        let inputs = Inputs::find(&[folder], ReadOptions::default()).expect("found");
        assert_eq!(inputs.len(), frames);
        for frame in inputs.frames() {
            let frame = frame.expect("readable");
            let counts = (frame.mesh.positions.len(), frame.mesh.faces.len());
            assert_eq!(counts, line_counts(&frame.path), "{}", frame.path.display());
            assert!(frame.notes.is_empty(), "{}: {}", frame.path.display(), frame.notes);
        }
    }
}

#[test]
fn registration_pairs_read() {
    let Some(folder) = data("pairs") else { return };
    for pair in std::fs::read_dir(folder).expect("folder") {
        for file in std::fs::read_dir(pair.expect("entry").path()).expect("folder") {
            let path = file.expect("entry").path();
            let mesh = read_mesh(&path, &ReadOptions::default()).expect("readable").mesh;
            assert_eq!((mesh.positions.len(), mesh.faces.len()), line_counts(&path));
        }
    }
}

#[test]
fn labels_come_with_their_frames() {
    let Some(folder) = data("tshirt_turn") else { return };
    let options = ReadOptions { max_label: 13, ..ReadOptions::default() };
    let inputs = Inputs::find(&[folder.join("*.obj")], options).expect("found");
    let inputs = inputs.with_labels(&folder.join("frame_%04d.labels")).expect("found");
    let last = inputs.read(inputs.len() - 1).expect("readable");
    assert_eq!(last.mesh.labels.len(), last.mesh.positions.len());
    assert!((0..14).all(|part| last.mesh.labels.contains(&part)), "all parts are there");

    let wrong = LabelSource::File(folder.join("frame_0001.labels"));
    let options = ReadOptions { labels: wrong, ..ReadOptions::default() };
    let error = read_mesh(&folder.join("frame_0000.obj"), &options).expect_err("another count");
    assert!(error.to_string().contains("labels for 15486 vertices"), "{error}");
}

#[test]
fn oracle_meshes_read_as_off() {
    let Some(folder) = kn_testdata::oracle() else { return };
    for file in std::fs::read_dir(folder.join("meshes")).expect("folder") {
        let path = file.expect("entry").path();
        let mesh = read_mesh(&path, &ReadOptions::default()).expect("readable").mesh;
        let text = std::fs::read_to_string(&path).expect("readable");
        let counts: Vec<usize> =
            text.split_whitespace().skip(1).take(2).filter_map(|word| word.parse().ok()).collect();
        assert_eq!([mesh.positions.len(), mesh.faces.len()], counts[..], "{}", path.display());
    }
}

/// tobj as a second reader: the same corners at the same places, face by face. What it does to
/// the order of the vertices is why we do not read positions with it.
#[test]
fn tobj_sees_the_same_surface_in_another_order() {
    let Some(folder) = data("punch_dirty") else { return };
    let path = folder.join("frame_0000.obj");
    let ours = read_mesh(&path, &ReadOptions::default()).expect("readable").mesh;
    let (models, _) = tobj::load_obj(&path, &tobj::LoadOptions::default()).expect("readable");
    let [model] = &models[..] else { panic!("one object, not {}", models.len()) };
    let theirs: Vec<&[f32]> = model.mesh.positions.chunks_exact(3).collect();
    let corners = ours
        .faces
        .iter()
        .flatten()
        .map(|&vertex| ours.positions[vertex as usize].map(|x| x as f32));
    for (ours, &theirs_at) in corners.zip(&model.mesh.indices) {
        assert_eq!(theirs[theirs_at as usize], ours);
    }
    assert_eq!(model.mesh.indices.len(), 3 * ours.faces.len());
    let moved =
        ours.positions.iter().zip(&theirs).filter(|(a, b)| a.map(|x| x as f32) != ***b).count();
    assert!(moved > ours.positions.len() / 2, "{moved} vertices have another number");
}

#[test]
fn cleaning_finds_what_the_captures_are_known_for() {
    let Some(folder) = data("punch_dirty") else { return };
    let mut sum = CleanReport::default();
    let inputs = Inputs::find(&[folder], ReadOptions::default()).expect("found");
    for frame in inputs.frames() {
        let cleaned = kn_mesh::clean(&frame.expect("readable").mesh).expect("valid");
        let report = cleaned.report;
        assert!((40..=125).contains(&report.components), "{report}");
        assert!((40..=329).contains(&report.boundary_edges), "{report}");
        assert!(report.non_manifold_edges <= 54, "{report}");
        assert!(!kn_mesh::clean(&cleaned.mesh).expect("valid").report.changed());
        sum += report;
    }
    assert_eq!((sum.frames, sum.welded, sum.degenerate, sum.duplicate), (24, 5, 6, 15));
}
