//! Body parts: found by `kn segment` and `kn encode`, checked where they come from elsewhere.

mod common;

use common::{FRAMES, Scans, fails, kn, names_in, stderr, succeeds};
use serde_json::Value;
use std::fs;
use std::path::Path;

fn labels_in(path: &Path) -> Vec<u8> {
    let text = fs::read_to_string(path).expect("labels");
    text.lines().map(|line| line.parse().expect("an integer")).collect()
}

/// Gives every vertex of a scan's label file another label.
fn relabel(scans: &Scans, index: usize, change: impl Fn(u8) -> u8) {
    let path = scans.file(index).with_extension("labels");
    let lines: String =
        labels_in(&path).into_iter().map(|label| format!("{}\n", change(label))).collect();
    fs::write(path, lines).expect("written");
}

fn scan_arguments(scans: &Scans, more: &[&str]) -> Vec<String> {
    let more = more.iter().map(|&argument| argument.into());
    ["segment".into(), scans.text("scan")].into_iter().chain(more).collect()
}

#[test]
fn every_vertex_of_a_file_gets_its_label() {
    let scans = Scans::new();
    let (out, sheet) = (scans.text("labels"), scans.text("parts.png"));
    let text = succeeds(scan_arguments(&scans, &["-o", &out, "--preview", &sheet, "--json"]));
    let json: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(names_in(Path::new(&out))[0], "f_08.labels");
    assert_eq!(names_in(Path::new(&out)).len(), FRAMES);
    for index in 0..FRAMES {
        let truth = labels_in(&scans.file(index).with_extension("labels"));
        let found = labels_in(&Path::new(&out).join(format!("f_{:02}.labels", index + 8)));
        assert_eq!(found.len(), truth.len());
        let right = truth.iter().zip(&found).filter(|(a, b)| a == b).count();
        assert!(10 * right > 8 * truth.len(), "frame {index}: {right} of {}", truth.len());
        let row = &json["frames"][index];
        assert_eq!(row["vertices"], truth.len());
        assert!(row["trust"].as_f64().expect("a number") > 0.6, "{row}");
        assert!(row["confidence"]["Head"].as_f64().expect("a number") > 0.5, "{row}");
    }
    assert!(fs::read(&sheet).expect("a picture").starts_with(b"\x89PNG"));
}

#[test]
fn labels_that_are_found_code_like_labels_from_files() {
    let scans = Scans::new();
    succeeds(scan_arguments(&scans, &["-o", &scans.text("labels")]));
    let stream = |labels: &str| {
        succeeds(scans.encode("scan/*.obj", &["--labels", labels]));
        fs::read(scans.path("a.knm")).expect("a stream")
    };
    let auto = stream("auto");
    assert!(auto == stream(&scans.text("labels/*.labels")), "another stream");
    assert!(auto != stream("none"), "labels are used");
}

#[test]
fn threads_do_not_change_the_labels() {
    let scans = Scans::new();
    let labels = |threads: &str| {
        let out = scans.text(threads);
        succeeds(scan_arguments(&scans, &["-o", &out, "--threads", threads]));
        (8..13).map(|i| labels_in(&scans.path(&format!("{threads}/f_{i:02}.labels")))).collect()
    };
    let one: Vec<Vec<u8>> = labels("1");
    assert_eq!(one, labels("3"));
}

#[test]
fn no_person_is_no_error() {
    let scans = Scans::new();
    // A performer whose height was squeezed to a slab: nobody.
    for index in 0..FRAMES {
        let mut mesh =
            kn_io::read_mesh(&scans.file(index), &Default::default()).expect("sound").mesh;
        mesh.positions.iter_mut().for_each(|p| p[1] *= 0.05);
        kn_io::write_mesh(&scans.file(index), &mesh).expect("written");
    }
    let output = kn(scan_arguments(&scans, &["-o", &scans.text("labels"), "--json"]));
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let json: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(json["frames"][0]["doubts"][0], "no person was found: every vertex is Other");
    assert!(labels_in(&scans.path("labels/f_08.labels")).iter().all(|&label| label == 14));
    let output = kn(scans.encode("scan/*.obj", &[]));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("no body parts found in 5 of 5 frames"), "{output:?}");
    succeeds(["verify".into(), scans.text("a.knm")]);
}

#[test]
fn odd_labels_are_named_with_frame_and_part() {
    let scans = Scans::new();
    relabel(&scans, 1, |label| match label {
        3 => 6,
        6 => 3,
        _ => label,
    });
    relabel(&scans, 3, |label| if label == 13 { 0 } else { label });
    let labels = scans.text("scan/*.labels");
    let output = kn(scans.encode("scan/*.obj", &["--labels", &labels]));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let told = stderr(&output);
    for (file, what) in [
        ("f_09.obj: frame 1: labels: Left hand", "grows from a limb of the other side"),
        ("f_11.obj: frame 3: labels: Head lies in two pieces", "% of the height apart"),
    ] {
        assert!(told.lines().any(|line| line.contains(file) && line.contains(what)), "{told}");
    }
    let output = kn(scan_arguments(&scans, &["--check", &labels]));
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    let row =
        |name: &str| table.lines().find(|line| line.contains(name)).expect("a row").to_owned();
    assert!(row("f_09").contains("Right hand") && row("f_11").contains("Head"), "{table}");
    assert!(!row("f_08").contains("hand"), "{table}");
}

#[test]
fn nothing_is_left_of_a_command_that_fails() {
    let scans = Scans::new();
    fs::write(scans.file(2), "v 0 0 zero\n").expect("written");
    let message = fails(scan_arguments(&scans, &["-o", &scans.text("labels")]));
    assert!(message.contains("f_10.obj") && message.contains("frame 2"), "{message}");
    scans.assert_untouched();
    let twice = [scans.text("scan/f_08.obj"), scans.text("scan/f_08.obj")];
    let same = ["segment".into(), twice[0].clone(), twice[1].clone(), "-o".into()];
    let message = fails(same.into_iter().chain([scans.text("labels")]));
    assert!(message.contains("frame 1: another frame has the same name"), "{message}");
    scans.assert_untouched();
    assert_eq!(kn(scan_arguments(&scans, &[])).status.code(), Some(2), "no output was named");
}

#[test]
fn an_interrupt_leaves_nothing_half_written() {
    let scans = Scans::new();
    scans.interrupt(scan_arguments(&scans, &["-o", &scans.text("labels")]));
    scans.assert_untouched();
}
