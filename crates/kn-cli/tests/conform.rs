//! `kn conform`: one stream, its stages, decoders that hang or cannot run; tables, JSON and exit codes.

mod common;

use common::{fails, kn, stderr, succeeds};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const SPEC: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../spec");

fn stream(name: &str) -> String {
    format!("{SPEC}/conformance/{name}.knm")
}

/// Standard output of a run that ends with this exit code.
#[track_caller]
fn ends(code: i32, arguments: &[&str]) -> String {
    let output = kn(arguments);
    assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// The value of a member of a stream's description.
fn described(name: &str, member: &str) -> Value {
    let text = fs::read_to_string(stream(name).replace(".knm", ".json")).expect("described");
    let description: Value = serde_json::from_str(&text).expect("JSON");
    description[member].clone()
}

#[test]
fn a_sound_stream_passes_all_readers() {
    let said = ends(0, &["conform", "--spec", SPEC, "--stream", &stream("core/groups")]);
    assert_eq!(said.matches("ok").count(), 3, "{said}");
}

#[test]
fn a_broken_stream_is_named_by_its_rule() {
    let file = stream("faulty/label_range");
    let said = ends(1, &["conform", "--spec", SPEC, "--stream", &file, "--json"]);
    let report: Value = serde_json::from_str(&said).expect("JSON");
    assert_eq!(report["passed"], false);
    let findings = report["findings"].as_array().expect("a list");
    let rules: Vec<&Value> = findings.iter().map(|finding| &finding["rule"]).collect();
    assert!(rules.contains(&&described("faulty/label_range", "rule")), "{said}");
    assert!(findings.iter().all(|finding| finding["reader"].is_string()), "{said}");
}

#[test]
fn a_stream_is_read_from_the_folder_of_the_specification_only() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let nowhere = folder.path().to_string_lossy().into_owned();
    let groups = stream("core/groups");
    for arguments in [&["conform", "--stream", &groups], &["assemble", &groups, "-o", "-"][..]] {
        let message = fails(arguments.iter().chain(&["--spec", &nowhere]));
        assert!(message.starts_with(&nowhere), "{message}");
        assert!(
            message.contains("name it with --spec FOLDER (spec/ in kn's sources)"),
            "{message}"
        );
    }
    fails(["conform", "--spec", SPEC, "--stream", &format!("{nowhere}/absent.knm")]);
}

#[test]
fn stages_are_those_of_the_description() {
    let said = succeeds(["conform", "--spec", SPEC, "--stages", &stream("core/groups")]);
    let lines: Value = said.lines().collect();
    assert_eq!(lines, described("core/groups", "stages"));
    let said = succeeds(["conform", "--spec", SPEC, "--stages", &stream("core/groups"), "--json"]);
    let found: Value = serde_json::from_str(&said).expect("JSON");
    assert_eq!(found["stages"], lines);
    let broken = stream("faulty/label_range");
    let message = fails(["conform", "--spec", SPEC, "--stages", &broken]);
    assert!(message.contains("intra.labels.range"), "{message}");
}

/// A corpus of one sound and one faulty stream, and a decoder.
struct Trial(TempDir);

impl Trial {
    fn new(decoder: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for name in ["core/one_frame", "faulty/label_range"] {
            let to = folder.path().join("corpus").join(name);
            fs::create_dir_all(to.parent().expect("a folder")).expect("made");
            for suffix in ["knm", "json", "txt"] {
                let from = Path::new(&stream(name)).with_extension(suffix);
                fs::copy(from, to.with_extension(suffix)).expect("copied");
            }
        }
        fs::write(folder.path().join("decoder"), decoder).expect("written");
        Self(folder)
    }

    /// Passed and reason of the sound stream and of the faulty one.
    fn verdicts(&self, code: i32) -> [(bool, String); 2] {
        let at = |name: &str| self.0.path().join(name).to_string_lossy().into_owned();
        let (corpus, decoder) = (at("corpus"), format!("sh {}", at("decoder")));
        let arguments = ["conform", &corpus, "--decoder", &decoder, "--timeout", "1", "--json"];
        let report: Value = serde_json::from_str(&ends(code, &arguments)).expect("JSON");
        [0, 1].map(|index| {
            let verdict = &report["verdicts"][index];
            let passed = verdict["passed"].as_bool().expect("a verdict");
            (passed, verdict["reason"].as_str().unwrap_or_default().to_owned())
        })
    }
}

#[test]
#[cfg(unix)]
fn a_decoder_that_hangs_fails_every_stream() {
    for (passed, reason) in Trial::new("exec sleep 60\n").verdicts(1) {
        assert!(!passed && reason.contains("no answer in 1 s"), "{reason}");
    }
}

#[test]
#[cfg(unix)]
fn a_decoder_passes_by_its_lines_and_exit_codes() {
    let lines = described("core/one_frame", "frames");
    let line = lines[0].as_str().expect("a line");
    let right = format!("case $1 in *one_frame.knm) echo '{line}';; *) exit 3;; esac\n");
    let verdicts = Trial::new(&right).verdicts(0);
    assert!(verdicts.iter().all(|(passed, _)| *passed), "{verdicts:?}");
    let [sound, faulty] = Trial::new(&format!("echo '{line}'\n")).verdicts(1);
    assert!(sound.0 && !faulty.0, "a decoder that takes everything: {faulty:?}");
    let [sound, faulty] = Trial::new("exit 1\n").verdicts(1);
    assert!(!sound.0 && faulty.0, "a decoder that refuses everything: {sound:?}");
}

#[test]
fn a_decoder_that_cannot_run_is_an_error_and_no_verdict() {
    let trial = Trial::new("");
    let corpus = trial.0.path().join("corpus").to_string_lossy().into_owned();
    for decoder in ["/no/such/decoder", "no-such-decoder", &corpus] {
        let message = fails(["conform", &corpus, "--decoder", decoder]);
        assert!(message.contains(decoder) && message.contains("cannot be run"), "{message}");
    }
    assert!(fails(["conform", &corpus, "--decoder", " "]).contains("no command"));
}
