//! `kn compare`, `kn demo` and `kn conform`: what they measure, and what they write.

mod common;

use common::{FRAMES, Scans, fails, kn, names_in, stderr, succeeds};
use serde_json::Value;
use std::fs;

/// Runs the command and reads the JSON that it prints.
#[track_caller]
fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&succeeds(arguments)).expect("JSON")
}

#[track_caller]
fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} in {value}"))
}

#[test]
fn a_mesh_equals_itself() {
    let scans = Scans::new();
    let file = scans.file(0).to_string_lossy().into_owned();
    let mean = &json(&["compare", &file, &file, "--json"])["mean"];
    for metric in ["p2s_rms", "hausdorff", "msdm2", "msdm2_ab", "msdm2_ba", "msdm2_projected"] {
        assert!(number(mean, metric) < 1e-6, "{metric} is {}", mean[metric]);
    }
    assert!(mean["d1_psnr"].is_null(), "infinite decibels are null");
}

#[test]
fn a_stream_is_measured_against_its_scans() {
    let scans = Scans::new();
    let stream = scans.encoded().to_string_lossy().into_owned();
    let pattern = scans.text("scan/*.obj");
    let found = json(&["compare", &pattern, &stream, "--json", "--frames", "..2"]);
    let frames = found["frames"].as_array().expect("an array");
    assert_eq!(frames.len(), 3);
    let metrics = [
        "p2s_rms",
        "p2s_psnr",
        "hausdorff",
        "msdm2",
        "msdm2_ab",
        "msdm2_ba",
        "msdm2_projected",
        "d1_psnr",
        "d2_psnr",
    ];
    for metric in metrics {
        let mean = frames.iter().map(|frame| number(frame, metric)).sum::<f64>() / 3.0;
        assert!((number(&found["mean"], metric) - mean).abs() < 1e-9, "{metric}");
    }
    // An I-frame is the scan rounded to 11 bits: well within a grid step everywhere.
    let step = number(&found["box"], "side") / 2047.0;
    assert_eq!((&frames[0]["kind"], &frames[1]["kind"]), (&"I".into(), &"P".into()));
    assert!(number(&frames[0], "hausdorff_world") < step);
    assert!(number(&frames[1], "p2s_rms_world") > number(&frames[0], "p2s_rms_world"));
    assert!(number(&found["mean_predicted"], "p2s_psnr") > 40.0);

    // The decoded files are the same as the stream.
    succeeds(["decode", &stream, "-o", &scans.text("out")]);
    let distance = |other: &str| {
        let found = json(&["compare", &pattern, other, "--fast", "--json"]);
        assert_eq!(found["frames"].as_array().map(Vec::len), Some(FRAMES));
        number(&found["mean"], "p2s_rms")
    };
    // The files have the digits that the grid needs, not all of a binary64 number.
    let (files, stream) = (distance(&scans.text("out")), distance(&stream));
    assert!((files - stream).abs() < 1e-4 * stream, "{files} and {stream}");
}

#[test]
fn sequences_of_different_length_are_compared_where_both_have_frames() {
    let scans = Scans::new();
    let [all, some] = [scans.text("scan/*.obj"), scans.text("scan/f_0*.obj")];
    let message = fails(["compare", &all, &some, "--fast", "--json"]);
    assert!(message.contains("scan/f_0*.obj: frame 2: there is no such frame, but "), "{message}");
    let message = fails(["compare", &all, &all, "--fast", "--frames", "9"]);
    let said = format!("there is no frame 9 to measure: {all} and {all} have 5 frames");
    assert_eq!(message, said);
    let found = json(&["compare", &all, &some, "--fast", "--json", "--frames", "..1"]);
    assert_eq!(found["frames"].as_array().map(Vec::len), Some(2));
}

#[test]
fn tables_csv_and_pictures() {
    let scans = Scans::new();
    let stream = scans.encoded().to_string_lossy().into_owned();
    let pattern = scans.text("scan/*.obj");
    let [csv, picture, values] = ["rows.csv", "error.png", "error.ply"].map(|n| scans.text(n));
    let arguments = [
        "compare",
        &pattern,
        &stream,
        "--fast",
        "--frames",
        "1..2",
        "--csv",
        &csv,
        "--heatmap",
        &picture,
        "--values",
        &values,
    ];
    let table = succeeds(arguments);
    assert!(table.contains("mean P") && table.contains("PSNR dB"), "{table}");
    let rows = fs::read_to_string(csv).expect("written");
    let rows: Vec<&str> = rows.lines().collect();
    assert!(rows[0].starts_with("frame,kind,bytes,p2s_rms,"), "{}", rows[0]);
    assert!(rows[1].starts_with("1,P,") && rows[2].starts_with("2,P,") && rows.len() == 3);
    assert!(fs::read(picture).expect("written").starts_with(b"\x89PNG\r\n\x1a\n"));
    let ply = fs::read(values).expect("written");
    assert!(String::from_utf8_lossy(&ply[..400]).contains("property float error"));
}

#[test]
fn the_picture_may_show_msdm2() {
    let scans = Scans::new();
    let files = [0, 1].map(|index| scans.file(index).to_string_lossy().into_owned());
    let values = scans.text("error.ply");
    let arguments = ["compare", &files[0], &files[1], "--values", &values, "--local", "msdm2"];
    succeeds(arguments);
    assert!(fs::metadata(&values).is_ok_and(|file| file.len() > 1_000));
    let message = fails(arguments.into_iter().chain(["--fast"]));
    assert!(message.contains("--local msdm2 needs MSDM2"), "{message}");
}

#[test]
fn what_cannot_be_compared() {
    let scans = Scans::new();
    let stream = scans.encoded().to_string_lossy().into_owned();
    let pattern = scans.text("scan/*.obj");
    fs::remove_file(scans.file(4)).expect("removed");
    let message = fails(["compare", &pattern, &stream, "--fast"]);
    assert!(message.contains("frame 4: there is no such frame"), "{message}");
    let message = fails(["compare", &pattern, &stream, "--fast", "--frames", "9.."]);
    assert!(message.contains("no frame") || message.contains("no such frame"), "{message}");
    fs::write(scans.path("flat.obj"), "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n").expect("written");
    let message = fails(["compare", &scans.text("flat.obj"), &stream]);
    assert!(message.contains("flat.obj: frame 0: all faces are degenerate"), "{message}");
}

#[test]
fn the_demo_writes_its_three_files() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = folder.path().join("new");
    let output_text = output.to_string_lossy().into_owned();
    let arguments = ["demo", "--output", &output_text, "--frames", "3", "--vertices", "1000"];
    let table = succeeds(arguments);
    assert!(table.contains("mean P") && table.contains("all digests match"), "{table}");
    assert_eq!(names_in(&output), ["demo.json", "demo.knm", "demo.png"]);
    let demo = fs::read_to_string(output.join("demo.json")).expect("written");
    let demo: Value = serde_json::from_str(&demo).expect("JSON");
    assert_eq!(demo["verified"], true);
    assert_eq!(demo["frames"].as_array().map(Vec::len), Some(3));
    let stream = output.join("demo.knm").to_string_lossy().into_owned();
    assert!(succeeds(["verify", &stream]).contains("3 frames, all digests match"));
}

#[test]
fn conform_runs_any_decoder() {
    let scans = Scans::new();
    let core = scans.path("corpus/core");
    fs::create_dir_all(&core).expect("made");
    fs::copy(scans.encoded(), core.join("walk.knm")).expect("copied");
    let description = r#"{"danger": "none", "frames": ["0 I 3 1 00"]}"#;
    fs::write(core.join("walk.json"), description).expect("written");

    let corpus = scans.text("corpus");
    let output = kn(["conform", &corpus]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(said.contains("core/walk") && said.contains("FAILED"), "{said}");
    if cfg!(unix) {
        fs::write(scans.path("decoder"), "echo 0 I 3 1 00\n").expect("written");
        let decoder = format!("sh {}", scans.text("decoder"));
        let verdicts = json(&["conform", &corpus, "--decoder", &decoder, "--json"]);
        assert_eq!(verdicts["verdicts"][0]["passed"], true);
    }
    let message = fails(["conform", &scans.text("scan")]);
    assert!(message.contains("no stream"), "{message}");
}

#[test]
fn one_part_is_measured_on_its_own() {
    let scans = Scans::new();
    let labels = scans.text("scan/*.labels");
    succeeds(scans.encode("scan/*.obj", &["--labels", &labels]));
    let (pattern, stream) = (scans.text("scan/*.obj"), scans.text("a.knm"));
    let of_part = |part: &str| {
        let arguments = ["compare", &pattern, &stream, "--labels", &labels, "--part", part];
        json(&[&arguments[..], &["--json", "--frames", "..1"]].concat())
    };
    let torso = of_part("torso");
    assert_eq!(torso, of_part("7"));
    assert_ne!(torso["mean"]["p2s_rms"], of_part("Left hand")["mean"]["p2s_rms"]);
    let message = fails(["compare", &pattern, &stream, "--part", "torso"]);
    assert!(message.contains("frame 0: the mesh has no labels"), "{message}");
    let output = kn(["compare", &pattern, &stream, "--part", "tail"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("the parts are 0 to 14"), "{}", stderr(&output));
}
