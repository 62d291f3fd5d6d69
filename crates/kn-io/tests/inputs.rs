//! Sequences of files: read in order, ahead of the caller, as often as wanted, until an error.

use kn_io::{Inputs, LabelSource, MeshErrorKind, ReadOptions};
use std::path::PathBuf;
use tempfile::TempDir;

/// A folder with frames `f_0.obj`, …; frame `i` has its corner at `(i, 0, 0)`.
fn sequence(frames: usize) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for frame in 0..frames {
        let text = format!("v {frame} 0 0\nv 1 1 0\nv 0 1 1\nf 1 2 3\n");
        std::fs::write(folder.path().join(format!("f_{frame}.obj")), text).expect("written");
    }
    folder
}

fn find(folder: &TempDir, spec: &str) -> Inputs {
    Inputs::find(&[folder.path().join(spec)], ReadOptions::default())
        .unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn frames_come_in_natural_order_and_twice() {
    let folder = sequence(12);
    for spec in ["", "*.obj", "f_%d.obj"] {
        let inputs = find(&folder, spec);
        assert_eq!((inputs.len(), inputs.is_empty()), (12, false));
        for _ in 0..2 {
            for (index, frame) in inputs.frames().enumerate() {
                let frame = frame.expect("readable");
                assert_eq!((frame.index, frame.name), (index, format!("f_{index}")));
                assert_eq!(frame.mesh.positions[0][0], index as f64);
            }
        }
    }
}

#[test]
fn a_list_is_read_as_given() {
    let folder = sequence(3);
    let files: Vec<PathBuf> =
        [2, 0, 1].iter().map(|n| folder.path().join(format!("f_{n}.obj"))).collect();
    let inputs = Inputs::find(&files, ReadOptions::default()).expect("all exist");
    let read: Vec<PathBuf> = inputs.frames().map(|frame| frame.expect("readable").path).collect();
    assert_eq!(read, files);
    let none = Inputs::find(&[], ReadOptions::default());
    assert!(matches!(none.map_err(|error| error.kind), Err(MeshErrorKind::NoMatch)));
}

#[test]
fn an_error_names_its_frame_and_ends_the_sequence() {
    let folder = sequence(5);
    std::fs::write(folder.path().join("f_2.obj"), "v 0 0 0\nv 1 nan 0\n").expect("written");
    let mut frames = find(&folder, "").frames();
    assert!(frames.next().is_some_and(|frame| frame.is_ok()));
    assert!(frames.next().is_some_and(|frame| frame.is_ok()));
    let message = frames.next().expect("an error").expect_err("NaN").to_string();
    assert!(
        message.ends_with(
            "f_2.obj (frame 2), line 2: a coordinate is NaN or infinite, or beyond 1e38"
        ),
        "{message}"
    );
    assert!(frames.next().is_none());
}

#[test]
fn a_file_that_vanishes_is_an_error() {
    let folder = sequence(3);
    let inputs = find(&folder, "*.obj");
    std::fs::remove_file(folder.path().join("f_1.obj")).expect("removed");
    let message = inputs.read(1).expect_err("gone").to_string();
    assert!(message.contains("f_1.obj (frame 1): No such file"), "{message}");
}

#[test]
fn dropping_the_iterator_early_is_fine() {
    let folder = sequence(40);
    let inputs = find(&folder, "");
    for _ in 0..20 {
        assert!(inputs.frames().next().is_some_and(|frame| frame.is_ok()));
    }
}

#[test]
fn labels_must_be_one_file_per_frame_and_one_label_per_vertex() {
    let folder = sequence(2);
    let label = |frame: usize, text: &str| {
        let path = folder.path().join(format!("f_{frame}.labels"));
        std::fs::write(path, text).expect("written");
    };
    label(0, "1\n2\n3\n");
    let message = |spec: &str| {
        let labelled = find(&folder, "*.obj").with_labels(&folder.path().join(spec));
        labelled.map(|inputs| inputs.frames().find_map(Result::err)).map_or_else(
            |error| error.to_string(),
            |error| error.map_or("all read".into(), |error| error.to_string()),
        )
    };
    assert!(message("*.labels").contains("1 label files for 2 frames"));
    assert!(message("*.txt").contains("no label file matches"));
    label(1, "1\n2\n");
    let error = message("f_%d.labels");
    assert!(error.ends_with("f_1.labels (frame 1): 2 labels for 3 vertices"), "{error}");
    label(1, "1\n2\n15\n");
    let error = message("*.labels");
    assert!(
        error.ends_with(
            "f_1.labels (frame 1), line 3: label 15 is out of range: labels are 0 to 14"
        )
    );
    label(1, "1\n2\n14\n");
    assert_eq!(message(""), "all read");
}

#[test]
fn labels_can_come_from_vertex_colours() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.obj");
    let read = |text: &str| {
        std::fs::write(&path, text).expect("written");
        let labels = LabelSource::Colours;
        let options = ReadOptions { labels, ..ReadOptions::default() };
        let inputs = Inputs::find(std::slice::from_ref(&path), options).expect("found");
        inputs.read(0).map(|frame| frame.mesh.labels).map_err(|error| error.to_string())
    };
    let text = "v 0 0 0 1 0.8 0\nv 1 0 0 0 0.6 0.2\nv 0 1 0 0.502 0.50196 0.501961\nf 1 2 3\n";
    assert_eq!(read(text), Ok(vec![0, 7, 14]));
    let error = read(&text.replace("1 0.8 0\n", "1 0.9 0\n")).expect_err("no part");
    assert!(error.contains("vertex 0: colour [255, 230, 0] is the colour of no body part"));
    let error = read(&text.replace(" 1 0.8 0\n", "\n")).expect_err("one has none");
    assert!(error.contains("2 labels for 3 vertices"), "{error}");
    let error = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect_err("none");
    assert!(error.contains("labels were asked from vertex colours, but the file has none"));
}
