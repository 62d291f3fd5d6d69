//! The commands on sound input.

mod common;

use common::{FRAMES, Scans, command, fails, kn, names_in, stderr, succeeds};
use kn_io::read_mesh;
use serde_json::Value;
use std::fs;
use std::io::{Read, Write};
use std::path::Path;
use std::process::Stdio;

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

#[test]
fn every_command_explains_itself_with_examples() {
    let help = succeeds(["--help"]);
    let listed = help.split("Commands:").nth(1).and_then(|rest| rest.split("Options:").next());
    let commands: Vec<&str> = listed
        .expect("a list of commands")
        .lines()
        .filter_map(|line| line.strip_prefix("  ")?.split_once(' '))
        .map(|(command, _)| command)
        .filter(|&command| !command.is_empty() && command != "help")
        .collect();
    assert!(commands.len() >= 11, "{commands:?}");
    for command in commands {
        let help = succeeds([command, "--help"]);
        assert!(help.contains("Examples:") && help.contains(&format!("  kn {command} ")), "{help}");
        for flag in ["--threads", "--quiet"] {
            assert!(help.contains(flag), "{command} {flag}");
        }
    }
    assert!(succeeds(["--version"]).starts_with("kn 0."));
    assert_eq!(kn(["no-such-command"]).status.code(), Some(2));
    assert_eq!(kn::<&str>([]).status.code(), Some(2));
}

#[test]
fn scans_come_back_within_half_a_step_and_under_their_names() {
    let scans = Scans::new();
    let step = 0.002;
    let (step_text, report) = (step.to_string(), scans.text("report.json"));
    succeeds(scans.encode("scan", &["--step", &step_text, "--report", &report, "--unit", "m"]));
    succeeds(["decode", &scans.text("a.knm"), "-o", &scans.text("out"), "--format", "ply"]);
    let expected: Vec<String> = (0..FRAMES).map(|i| format!("f_{:02}.ply", i + 8)).collect();
    assert_eq!(names_in(&scans.path("out")), expected);

    // Frames 0 and 3 are I-frames: each decoded vertex is a scanned one, rounded to the grid.
    for frame in [0, 3] {
        let scan = read_mesh(&scans.file(frame), &Default::default()).expect("a scan").mesh;
        let out = scans.path("out").join(&expected[frame]);
        let decoded = read_mesh(&out, &Default::default()).expect("a mesh").mesh;
        assert_eq!(decoded.faces.len(), scan.faces.len());
        for vertex in &decoded.positions {
            let near = |p: &[f64; 3]| (0..3).all(|i| (p[i] - vertex[i]).abs() <= 0.5001 * step);
            assert!(scan.positions.iter().any(near), "frame {frame}: {vertex:?}");
        }
    }
    let report = json(&fs::read_to_string(report).expect("written"));
    assert_eq!(report["frames"].as_array().map(Vec::len), Some(FRAMES));
    assert_eq!(report["frames"][1]["coded"]["kind"], "P");
    assert_eq!(report["settings"]["step"], step);
    let bytes = fs::metadata(scans.path("a.knm")).expect("written").len();
    assert_eq!(report["bytes"], bytes);
}

#[test]
fn the_report_says_what_was_chosen_and_what_it_costs() {
    let scans = Scans::new();
    let report_of = |flags: &[&str]| {
        let report = scans.text("report.json");
        succeeds(scans.encode("scan", &[flags, &["--report", &report]].concat()));
        json(&fs::read_to_string(report).expect("written"))
    };
    let chosen = report_of(&["--choice", "per-frame", "--affine", "all", "--lambda", "1e-5"]);
    let coded = &chosen["frames"][1]["coded"];
    let number = |value: &Value| value.as_f64().expect("a number");
    let [distortion, bytes, total] =
        ["distortion", "bytes", "total"].map(|key| number(&coded["cost"][key]));
    assert!((distortion + 1e-5 * bytes - total).abs() < 1e-9);
    assert!(bytes > 0.0 && bytes <= number(&coded["bytes"]));
    assert!(number(&coded["steps"]["translation"]) > 0.0);
    assert_eq!(coded["affine_nodes"], coded["nodes"]);
    assert_eq!(chosen["settings"]["combination"], "per-frame");
    assert_eq!(chosen["settings"]["motion_step"], "auto");

    let forced = report_of(&["--combination", "TSH", "--affine", "all", "--motion-step", "1"]);
    let coded = &forced["frames"][1]["coded"];
    assert_eq!(coded["combination"], "TSH");
    assert_eq!(number(&coded["steps"]["rotation"]), 0.0);
    assert_eq!(number(&coded["steps"]["translation"]), 1.0);
    assert_eq!(coded["cost"], Value::Null);
}

#[test]
fn info_has_every_frame() {
    let scans = Scans::new();
    let stream = scans.encoded();
    let info = json(&succeeds([Path::new("info"), &stream, Path::new("--json")]));
    let keys: Vec<&String> = info.as_object().expect("an object").keys().collect();
    let expected = "bytes fps frames group_length influence labels level nodes_per_vertex origin step \
                    unit up weights";
    assert_eq!(keys, expected.split(' ').collect::<Vec<_>>());
    let words = ["unit", "up", "weights", "influence", "labels"].map(|key| &info[key]);
    assert_eq!(words, ["unspecified", "y", "sumner", "fallback", "body"]);
    assert_eq!((&info["group_length"], &info["nodes_per_vertex"]), (&3.into(), &4.into()));
    assert!(info["step"].as_f64().is_some_and(|step| step > 0.0));
    assert_eq!(info["bytes"], fs::metadata(&stream).expect("written").len());
    assert_eq!(info["fps"], 30.0);
    let frames = info["frames"].as_array().expect("an array");
    let kinds: Vec<&str> = frames.iter().filter_map(|frame| frame["kind"].as_str()).collect();
    assert_eq!(kinds, ["I", "P", "P", "I", "P"]);
    for (index, frame) in frames.iter().enumerate() {
        let keys: Vec<&String> = frame.as_object().expect("an object").keys().collect();
        assert_eq!(keys, ["bytes", "faces", "index", "kind", "nodes", "vertices"]);
        assert_eq!(frame["index"], index);
        assert_eq!(frame["nodes"], if frame["kind"] == "I" { 0 } else { 24 });
    }
    assert!(succeeds([Path::new("info"), &stream]).contains("5 frames (2 I, 3 P)"));
}

#[test]
fn dump_covers_the_file() {
    let scans = Scans::new();
    let stream = scans.encoded();
    let dump = succeeds([Path::new("dump"), &stream]);
    let bits: Vec<u64> = dump
        .lines()
        .map(|line| line.split_whitespace().next().and_then(|bit| bit.parse().ok()).expect("a bit"))
        .collect();
    assert!(bits.is_sorted_by(|a, b| a < b), "every element has bits of its own");
    assert_eq!(bits[0], 0);
    let size = fs::metadata(&stream).expect("written").len();
    assert_eq!(bits.last(), Some(&(8 * size - 32)), "the last element is a CRC");
    assert!(dump.contains("translation[23][2]"), "{dump}");
}

#[test]
fn a_stream_can_be_taken_apart_and_put_together() {
    let spec = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec");
    if !spec.exists() {
        eprintln!("skipped: spec/ is absent");
        return;
    }
    let scans = Scans::new();
    let stream = scans.encoded();
    let (spec, text, again) = (spec.to_string_lossy(), scans.text("a.txt"), scans.text("b.knm"));
    let input = stream.to_string_lossy();
    succeeds(["assemble", &*input, "--reverse", "-o", &*text, "--spec", &*spec]);
    succeeds(["assemble", &*text, "-o", &*again, "--spec", &*spec]);
    assert_eq!(fs::read(again).expect("written"), fs::read(&stream).expect("written"));
    fs::write(&text, "version = 7 8 9\n").expect("written");
    let message = fails(["assemble", &*text, "-o", &scans.text("c.knm"), "--spec", &*spec]);
    assert!(message.contains("a.txt: "), "{message}");
    assert!(!scans.path("c.knm").exists());
}

#[test]
fn frames_can_be_chosen() {
    let scans = Scans::new();
    let stream = scans.encoded().to_string_lossy().into_owned();
    succeeds(["decode", &stream, "-o", &scans.text("all")]);
    succeeds(["decode", &stream, "-o", &scans.text("some"), "--frames", "2..3"]);
    assert_eq!(names_in(&scans.path("some")), ["f_10.obj", "f_11.obj"]);
    for name in names_in(&scans.path("some")) {
        let read = |folder: &str| fs::read(scans.path(folder).join(&name)).expect("decoded");
        assert_eq!(read("some"), read("all"), "{name}");
    }
    let message = fails(["decode", &stream, "-o", &scans.text("none"), "--frames", "5"]);
    assert!(message.contains("there is no frame 5"), "{message}");
    assert!(!scans.path("none").exists());
}

#[test]
fn one_glb_holds_the_sequence() {
    let scans = Scans::new();
    let stream = scans.encoded().to_string_lossy().into_owned();
    succeeds(["decode", &stream, "-o", &scans.text("all.glb")]);
    succeeds(["encode", &scans.text("all.glb"), "-o", &scans.text("b.knm"), "--nodes", "24"]);
    let info = json(&succeeds(["info", &scans.text("b.knm"), "--json"]));
    assert_eq!(info["frames"].as_array().map(Vec::len), Some(FRAMES));
}

#[test]
fn streams_go_through_pipes() {
    let scans = Scans::new();
    let mut arguments = scans.encode("scan", &[]);
    arguments[3] = "-".into();
    let encoded = kn(&arguments);
    assert_eq!(encoded.status.code(), Some(0), "{}", stderr(&encoded));
    assert_eq!(fs::read(scans.encoded()).expect("written"), encoded.stdout);

    let mut child = command(["verify", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    child.stdin.take().expect("piped").write_all(&encoded.stdout).expect("taken");
    let output = child.wait_with_output().expect("ends");
    assert_eq!(output.status.code(), Some(0));
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(said, "standard input: 5 frames, all digests match\n");
}

#[test]
fn threads_do_not_change_the_stream() {
    let scans = Scans::new();
    let streams = ["1", "2", "8"].map(|threads| {
        succeeds(scans.encode("scan", &["--threads", threads, "--quiet"]));
        fs::read(scans.path("a.knm")).expect("written")
    });
    assert!(streams[0] == streams[1] && streams[0] == streams[2]);
}

#[test]
fn help_fits_and_its_placeholders_are_values() {
    let scans = Scans::new();
    for command in ["segment", "conform", "encode", "decode", "compare", "assemble", "rd"] {
        let help = command_of_width(command);
        assert!(help.lines().all(|line| line.chars().count() <= 100), "{help}");
        // What is broken by hand and then once more leaves a word on a line of its own.
        let text = help.rsplit("Print version").next().unwrap_or_default();
        let lone = |line: &&str| !line.starts_with(' ') && line.len() < 5 && !line.is_empty();
        let lone: Vec<&str> = text.lines().filter(lone).collect();
        assert!(lone.is_empty(), "{command}: {lone:?}");
    }
    assert!(!succeeds(["encode", "--help"]).contains("[default: default]"));
    let auto = ["--smoothing", "AUTO", "--motion-step", "AUTO"];
    succeeds(scans.encode("scan/f_08.obj", &auto));
    for (arguments, flag) in [
        (["info", "x.knm", "--threads", "0"], "--threads"),
        (["info", "x.knm", "--threads", "70000"], "--threads"),
        (["rd", "x.toml", "--jobs", "0"], "--jobs"),
    ] {
        let said = stderr(&kn(arguments));
        assert!(said.contains(flag) && said.contains("from 1 to 65535"), "{said}");
    }
}

/// The help of a command on a terminal of 100 columns.
fn command_of_width(name: &str) -> String {
    let output = command([name, "--help"]).env("COLUMNS", "100").output().expect("starts");
    String::from_utf8(output.stdout).expect("UTF-8")
}

#[test]
fn the_help_of_encode_fits_two_screens() {
    let help = command_of_width("encode");
    assert!(help.lines().count() <= 100, "{} lines", help.lines().count());
    assert!(!help.contains("Expert settings") && help.contains("--help-all"), "{help}");
    let all = succeeds(["encode", "--help-all"]);
    let (_, expert) = all.split_once("Expert settings:").expect("a heading");
    for flag in ["--placement", "--combination", "--lambda", "--shear-step"] {
        assert!(expert.contains(flag), "{flag}");
    }
}

#[test]
fn one_of_a_thing_is_called_so() {
    let scans = Scans::new();
    let mut arguments = scans.encode("scan/f_08.obj", &[]);
    let said = stderr(&kn(&arguments));
    assert!(said.contains(" 1 I-frame of ") && said.contains(" 0 P-frames of "), "{said}");
    let output = kn(["decode", &scans.text("a.knm"), "-o", &scans.text("out")]);
    assert!(stderr(&output).contains("out: 1 frame in 1 file\n"), "{}", stderr(&output));
    arguments[3] = "-".into();
    assert!(stderr(&kn(&arguments)).contains("standard output: "));
}

#[test]
fn quiet_says_nothing() {
    let scans = Scans::new();
    let output = kn(scans.encode("scan", &["--quiet"]));
    assert_eq!(output.status.code(), Some(0));
    assert_eq!((stderr(&output).as_str(), output.stdout.as_slice()), ("", &[][..]));
    let output = kn(scans.encode("scan", &[]));
    assert!(stderr(&output).contains("I-frames of"), "{}", stderr(&output));
    assert!(!stderr(&output).contains('\r'), "no progress bar where there is no terminal");
}

#[test]
fn a_closed_pipe_is_success() {
    let scans = Scans::new();
    let stream = scans.encoded();
    let mut child = command([Path::new("dump"), &stream])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    let mut first = [0; 16];
    child.stdout.take().expect("piped").read_exact(&mut first).expect("some output");
    let output = child.wait_with_output().expect("ends");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stderr(&output), "");
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_nothing_half_written() {
    let scans = Scans::new();
    scans.interrupt(scans.encode("scan", &[]));
    scans.assert_untouched();
}
