//! `kn register`: what it writes, what it measures, and whom it blames.

mod common;

use common::{Scans, fails, kn, names_in, stderr, succeeds};
use kn_io::{ReadOptions, read_mesh, write_mesh};
use kn_mesh::Mesh;
use kn_performer::{Performer, PerformerConfig};
use serde_json::Value;
use std::fs;
use std::path::Path;

const NODES: &str = "60";

fn read(path: &Path) -> Mesh {
    let options = ReadOptions { allow_empty: true, ..ReadOptions::default() };
    read_mesh(path, &options).expect("a mesh").mesh
}

/// `register scan0 scan3 -o out.obj` with more arguments.
fn arguments(scans: &Scans, more: &[&str]) -> Vec<String> {
    let file = |index| scans.file(index).to_string_lossy().into_owned();
    let mut arguments = vec!["register".into(), file(0), file(3)];
    arguments.extend(["-o".into(), scans.text("out.obj"), "--nodes".into(), NODES.into()]);
    arguments.extend(more.iter().map(|&argument| argument.into()));
    arguments
}

#[track_caller]
fn json(scans: &Scans, more: &[&str]) -> Value {
    serde_json::from_str(&succeeds(arguments(scans, more))).expect("JSON")
}

#[track_caller]
fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} in {value}"))
}

/// Writes the true positions of the vertices of scan 0 in scan 3 to `truth.obj`.
fn write_truth(scans: &Scans) {
    let config = PerformerConfig { vertices: 1_200, ..PerformerConfig::default() };
    let performer = Performer::new(config).expect("valid settings");
    let source = performer.frame(0);
    let positions = performer.transport(&source, 0, 3);
    let truth = Mesh::new(positions, source.faces);
    write_mesh(&scans.path("truth.obj"), &truth).expect("written");
}

#[test]
fn a_dancer_is_carried_to_a_later_frame() {
    let scans = Scans::new();
    write_truth(&scans);
    let found = json(&scans, &["--json", "--truth", &scans.text("truth.obj")]);
    let keys: Vec<&String> = found.as_object().expect("an object").keys().collect();
    let expected = ["s2t", "t2s", "hausdorff", "truth", "nodes", "iterations", "seconds"];
    assert_eq!(keys.len(), expected.len());
    assert!(expected.iter().all(|key| !found[*key].is_null()), "{found}");
    assert_eq!(number(&found, "nodes"), 60.0);

    // What is printed is what is in the file, and it is nearer than no motion.
    let (source, target) = (scans.file(0), scans.file(3));
    let compare = |from: &str| -> Value {
        let to = target.to_string_lossy();
        serde_json::from_str(&succeeds(["compare", &to, from, "--fast", "--json"])).expect("JSON")
    };
    let after = number(&compare(&scans.text("out.obj"))["mean"], "p2s_rms");
    let before = number(&compare(&source.to_string_lossy())["mean"], "p2s_rms");
    assert!(after < 0.7 * before, "{after} after, {before} before");
    let worse = number(&found, "s2t").max(number(&found, "t2s"));
    assert!((0.5 * after..2.0 * after).contains(&worse), "{worse} printed, {after} compared");
    assert!(number(&found, "truth") < 0.02, "{found}");
    let (deformed, source) = (read(&scans.path("out.obj")), read(&source));
    assert_eq!(deformed.faces, source.faces);
    assert_eq!(deformed.positions.len(), source.positions.len());
}

#[test]
fn every_vertex_comes_out_in_its_place() {
    let scans = Scans::new();
    let clean = scans.file(0);
    let mut mesh = read(&clean);
    let count = mesh.positions.len() as u32;
    // A cut along a seam (a vertex twice), faces that cleaning drops, a vertex without a face.
    let twin = mesh.faces[0][0];
    mesh.positions.push(mesh.positions[twin as usize]);
    mesh.faces[0][0] = count;
    mesh.faces.push([5, 5, 6]);
    mesh.faces.push(mesh.faces[1]);
    mesh.positions.push(mesh.positions[10].map(|c| c + 0.01));
    write_mesh(&clean, &mesh).expect("written");
    let table = succeeds(arguments(&scans, &[]));
    assert!(table.contains("Hausdorff") && table.contains("60 key nodes"), "{table}");
    let deformed = read(&scans.path("out.obj"));
    assert_eq!(deformed.faces, mesh.faces);
    assert_eq!(deformed.positions.len(), mesh.positions.len());
    assert_eq!(deformed.positions[count as usize], deformed.positions[twin as usize]);
    let loose = deformed.positions[count as usize + 1];
    let moved = (0..3).any(|axis| loose[axis] != mesh.positions[count as usize + 1][axis]);
    assert!(moved, "the vertex without a face stayed behind");
}

#[test]
fn a_second_body_is_told_and_registration_goes_on() {
    let scans = Scans::new();
    let mut target = read(&scans.file(3));
    let count = target.positions.len() as u32;
    let apart: Vec<[f64; 3]> = target.positions.iter().map(|&[x, y, z]| [x + 2.0, y, z]).collect();
    target.positions.extend(apart);
    let faces = target.faces.clone();
    target.faces.extend(faces.iter().map(|face| face.map(|vertex| vertex + count)));
    write_mesh(&scans.file(3), &target).expect("written");
    let output = kn(arguments(&scans, &["--json"]));
    assert_eq!(output.status.code(), Some(0));
    let note = stderr(&output);
    assert!(note.contains("f_11.obj: not explained: "), "{note}");
    assert!(stderr(&kn(arguments(&scans, &["--quiet"]))).is_empty());
}

#[test]
fn errors_name_the_file() {
    let scans = Scans::new();
    write_truth(&scans);
    let blames = |more: &[&str], parts: &[&str]| {
        let message = fails(arguments(&scans, more));
        assert!(parts.iter().all(|part| message.contains(part)), "{message}");
        assert!(!scans.path("out.obj").exists());
    };
    let mut truth = read(&scans.path("truth.obj"));
    truth.positions.pop();
    truth.faces.clear();
    write_mesh(&scans.path("short.obj"), &truth).expect("written");
    blames(&["--truth", &scans.text("short.obj")], &["short.obj", "true positions"]);
    blames(&["--truth", &scans.text("absent.obj")], &["absent.obj", "No such file"]);
    // A target that is one line has no surface.
    let line = "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n";
    fs::write(scans.file(3), line).expect("written");
    blames(&[], &["f_11.obj", "no surface"]);
    fs::write(scans.file(3), "v 0 0 0\nv 1 0 nan\nf 1 2 2\n").expect("written");
    blames(&[], &["f_11.obj"]);
    assert_eq!(names_in(&scans.path("scan")).len(), 2 * common::FRAMES);
}

#[test]
fn an_output_that_cannot_be_written_is_refused_first() {
    let scans = Scans::new();
    let source = scans.file(0).to_string_lossy().into_owned();
    let message = fails(["register", &source, &source, "-o", "out.xyz"]);
    assert!(message.contains("out.xyz"), "{message}");
}
