//! Outputs: none replaces an input or another output, and what cannot be written is said before
//! any work.

mod common;

use common::{Scans, fails, names_in, succeeds};
use std::fs;

/// Expects an error with these words.
#[track_caller]
fn refused(arguments: &[&str], words: &[&str]) {
    let message = fails(arguments);
    for word in words {
        assert!(message.contains(word), "{arguments:?}: {message:?} does not say {word:?}");
    }
}

/// The bytes of all files, by path.
fn contents(scans: &Scans) -> Vec<(String, Vec<u8>)> {
    let read =
        |name: String| (name.clone(), fs::read(scans.path("scan").join(name)).expect("read"));
    names_in(&scans.path("scan")).into_iter().map(read).collect()
}

#[test]
fn an_input_is_no_output() {
    let scans = Scans::new();
    let stream = scans.encoded().to_string_lossy().into_owned();
    let (bytes, before) = (fs::read(&stream).expect("written"), contents(&scans));
    let (pattern, folder) = (scans.text("scan/*.obj"), scans.text("scan"));
    let (a, b) = (scans.text("scan/f_08.obj"), scans.text("scan/f_09.obj"));
    let labels = scans.text("scan/f_09.labels");
    let is_input = ["would replace an input"];
    refused(&["encode", &folder, "-o", &a], &[&a, "--output", is_input[0]]);
    refused(&["encode", &a, &b, "-o", &scans.text("scan/../scan/f_08.obj")], &is_input);
    refused(&["encode", &folder, "-o", &scans.text("x.knm"), "--report", &b], &is_input);
    let given = ["encode", &folder, "--labels", &scans.text("scan/*.labels"), "-o", &labels];
    refused(&given, &is_input);
    refused(&["register", &a, &b, "-o", &b], &is_input);
    refused(&["assemble", &stream, "--reverse", "-o", &stream], &is_input);
    fs::create_dir(scans.path("odd")).expect("made");
    let odd = [scans.text("odd"), scans.text("odd/f_10.obj")];
    fs::copy(&stream, &odd[1]).expect("copied");
    refused(&["decode", &odd[1], "-o", &odd[0], "--overwrite"], &[&odd[1], is_input[0]]);
    assert_eq!(names_in(&scans.path("odd")), ["f_10.obj"]);
    for (flag, path) in [("--csv", &stream), ("--csv", &a)] {
        refused(&["compare", &pattern, &stream, flag, path], &[flag, is_input[0]]);
    }
    assert!(contents(&scans) == before && fs::read(&stream).expect("there") == bytes);
    assert!(!scans.path("x.knm").exists());
}

#[cfg(unix)]
#[test]
fn an_input_is_no_output_under_another_name() {
    let scans = Scans::new();
    let (soft, hard) = (scans.text("soft.obj"), scans.text("hard.obj"));
    std::os::unix::fs::symlink(scans.file(0), &soft).expect("linked");
    fs::hard_link(scans.file(0), &hard).expect("linked");
    for link in [&soft, &hard] {
        refused(&["encode", &scans.text("scan"), "-o", link], &["would replace an input"]);
    }
}

#[test]
fn two_outputs_are_two_files() {
    let scans = Scans::new();
    let (scan, a) = (scans.text("scan"), scans.text("scan/f_08.obj"));
    let (q, again) = (scans.text("q.knm"), scans.text("scan/../q.knm"));
    let both = ["--output and --report name the same file"];
    refused(&["encode", &scan, "-o", &q, "--report", &q], &both);
    refused(&["encode", &scan, "-o", &q, "--report", &again], &both);
    refused(&["encode", &scan, "-o", "-", "--report", "-"], &["standard output: ", both[0]]);
    let png = scans.text("q.png");
    refused(&["compare", &a, &a, "--csv", &png, "--heatmap", &png], &["--csv and --heatmap"]);
    refused(&["compare", &a, &a, "--heatmap", "-"], &["the result and --heatmap"]);
    scans.assert_untouched();
}

#[test]
fn a_folder_that_is_not_there_is_said_before_any_work() {
    let scans = Scans::new();
    let stream = scans.encoded().to_string_lossy().into_owned();
    let (scan, absent) = (scans.text("scan"), scans.text("absent/file.png"));
    let reason = [&absent[..], "No such file"];
    refused(&["encode", &scan, "-o", &scans.text("b.knm"), "--report", &absent], &reason);
    refused(&["compare", &scan, &stream, "--csv", &absent], &reason);
    refused(&["compare", &scan, &stream, "--heatmap", &absent], &reason);
    refused(&["segment", &scan, "-o", &scans.text("labels"), "--preview", &absent], &reason);
    refused(
        &["decode", &stream, "-o", &scans.text("absent/a.glb")],
        &["absent/a.glb: ", "No such"],
    );
    let folder = format!("{}/", scans.text("folder"));
    refused(&["encode", &scan, "-o", &folder], &[&folder, "a folder, but --output is a file"]);
    assert_eq!(names_in(&scans.path(".")), ["a.knm", "scan"]);
}

#[test]
fn decoded_frames_replace_no_file_unasked() {
    let scans = Scans::new();
    let stream = scans.encoded().to_string_lossy().into_owned();
    let (scan, before) = (scans.text("scan"), contents(&scans));
    refused(&["decode", &stream, "-o", &scan], &["scan/f_08.obj: ", "--overwrite"]);
    assert!(contents(&scans) == before);
    // Another format has other names.
    let out = scans.text("out");
    succeeds(["decode", &stream, "-o", &out]);
    succeeds(["decode", &stream, "-o", &out, "--format", "ply"]);
    refused(&["decode", &stream, "-o", &out, "--frames", "3.."], &["out/f_11.obj: "]);
    fs::write(scans.path("out/f_11.obj"), "mine").expect("written");
    succeeds(["decode", &stream, "-o", &out, "--overwrite"]);
    assert!(fs::read(scans.path("out/f_11.obj")).expect("there").len() > 100);
}

#[test]
fn a_mesh_file_is_no_folder() {
    let scans = Scans::new();
    let stream = scans.encoded().to_string_lossy().into_owned();
    for name in ["one.obj", "plain.ply", "a.gltf", "A.OBJ", "again.knm"] {
        let output = scans.text(name);
        refused(&["decode", &stream, "-o", &output], &[&output, "one .glb file", "/"]);
    }
    refused(&["decode", &stream, "-o", "-"], &["standard output: ", ".glb"]);
    let glb = scans.text("a.glb");
    refused(&["decode", &stream, "-o", &glb, "--format", "obj"], &[&glb, "--format"]);
    succeeds(["decode", &stream, "-o", &glb, "--format", "glb"]);
    succeeds(["decode", &stream, "-o", &format!("{}/", scans.text("b.obj"))]);
    assert_eq!(names_in(&scans.path(".")), ["a.glb", "a.knm", "b.obj", "scan"]);
    assert!(scans.path("b.obj").is_dir());
}

#[test]
fn pictures_are_png() {
    let scans = Scans::new();
    let (scan, a) = (scans.text("scan"), scans.text("scan/f_08.obj"));
    for name in ["error.jpg", "error", "scan/f_09.obj"] {
        let picture = scans.text(name);
        refused(&["compare", &a, &a, "--heatmap", &picture], &[&picture, "PNG"]);
        refused(&["segment", &scan, "-o", &scans.text("l"), "--preview", &picture], &["PNG"]);
    }
    refused(&["compare", &a, &a, "--values", &scans.text("error.obj")], &[".ply only"]);
    scans.assert_untouched();
}

#[test]
fn a_folder_in_the_way_leaves_nothing_behind() {
    let scans = Scans::new();
    let stream = scans.encoded().to_string_lossy().into_owned();
    let way = "this is a folder; give the path of a file";
    let arguments = ["decode", &stream, "-o", &scans.text("out"), "--overwrite"];
    fs::create_dir_all(scans.path("out/f_10.obj")).expect("made");
    refused(&arguments, &["out/f_10.obj: ", way]);
    assert_eq!(names_in(&scans.path("out")), ["f_10.obj"]);

    fs::create_dir_all(scans.path("labels/f_11.labels")).expect("made");
    let arguments = ["segment", &scans.text("scan"), "-o", &scans.text("labels")];
    refused(&arguments, &["labels/f_11.labels: ", way]);
    assert_eq!(names_in(&scans.path("labels")), ["f_11.labels"]);

    fs::create_dir_all(scans.path("demo/demo.png")).expect("made");
    refused(&["demo", "-o", &scans.text("demo"), "--frames", "1"], &["demo.png: a folder"]);
    assert_eq!(names_in(&scans.path("demo")), ["demo.png"]);
}

#[test]
fn a_study_keeps_its_tables() {
    let scans = Scans::new();
    let table = "sequence,codec,bytes_per_frame,msdm2\nx,other,100,0.1\n";
    fs::create_dir(scans.path("study")).expect("made");
    fs::write(scans.path("study/results.csv"), table).expect("written");
    let config = "anchors = ['default']\n[[sequence]]\nname = 'x'\ninput = 'scan'\n\
                  [[preset]]\nname = 'default'\n[[rate]]\nname = 'r'\n\
                  [[csv]]\npath = 'study/results.csv'\n";
    fs::write(scans.path("c.toml"), config).expect("written");
    let message = fails(["rd", &scans.text("c.toml"), "-o", &scans.text("study")]);
    assert!(message.contains("results.csv: --output would replace an input"), "{message}");
    assert_eq!(fs::read_to_string(scans.path("study/results.csv")).expect("there"), table);
}
