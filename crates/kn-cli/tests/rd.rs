//! `kn rd`: the matrix, going on after an interruption, tables of other codecs, mistakes.

mod common;

use common::{fails, kn, names_in, stderr, succeeds};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;
use tempfile::TempDir;

/// Two presets, two rate points, three frames of a small performer, one foreign codec.
const CONFIG: &str = r#"
title = "a <b> & c"
anchors = ["baseline", "other"]

[[sequence]]
name = "dance"
performer = { motion = "dance", frames = 3, vertices = 1000, holes = 1 }

[[preset]]
name = "bimodal"
nodes = 20

[[preset]]
name = "baseline"
nodes = 40

[[rate]]
name = "coarse"
bits = 8
gof = 3

[[rate]]
name = "fine"
bits = 10
gof = 3

[pictures]
frame = 9

[[csv]]
path = "other.csv"
columns = { bytes = "rate" }
"#;

/// A table with a codec that is better than anything, one row without a rate.
const TABLE: &str = "sequence,codec,point,rate,msdm2,p2s_psnr\n\
    dance,other,a,10,0.01,200\ndance,other,b,20,0.005,210\ndance,still,x,,0.3,50\n\
    elsewhere,other,a,10,0.1,60\n";

struct Study {
    folder: TempDir,
}

impl Study {
    fn new(config: &str, table: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fs::write(folder.path().join("study.toml"), config).expect("written");
        fs::write(folder.path().join("other.csv"), table).expect("written");
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn arguments(&self, more: &[&str]) -> Vec<String> {
        let text = |name| self.path(name).to_string_lossy().into_owned();
        let mut arguments = vec!["rd".into(), text("study.toml"), "-o".into(), text("out")];
        arguments.extend(more.iter().map(|&argument| argument.to_owned()));
        arguments
    }

    fn results(&self) -> Value {
        let text = fs::read(self.path("out/results.json")).expect("written");
        serde_json::from_slice(&text).expect("JSON")
    }

    /// The time at which each file of the cells was written.
    fn times(&self) -> BTreeMap<String, SystemTime> {
        let cells = self.path("out/cells");
        let time = |name: &String| {
            fs::metadata(cells.join(name)).and_then(|file| file.modified()).expect("a file")
        };
        names_in(&cells).into_iter().map(|name| (name.clone(), time(&name))).collect()
    }
}

/// The first file of that extension.
fn some_file(folder: &Path, extension: &str) -> PathBuf {
    let names = names_in(folder);
    let name = names.iter().find(|name| name.ends_with(extension)).expect("such a file");
    folder.join(name)
}

#[test]
fn a_study_runs_goes_on_and_reports_again() {
    let study = Study::new(CONFIG, TABLE);
    succeeds(study.arguments(&["--jobs", "2"]));
    let first = study.times();
    assert_eq!(first.len(), 8, "four cells, each a stream and a result");
    let results = study.results();
    check_cells(&results, &study);
    check_deltas(&results);
    check_report(&study);

    // Only what is missing is done again, and a broken result is none.
    let gone = some_file(&study.path("out/cells"), ".json");
    fs::remove_file(&gone).expect("removed");
    succeeds(study.arguments(&[]));
    let gone = gone.file_name().expect("a name").to_string_lossy().into_owned();
    let stem = gone.trim_end_matches(".json");
    for (name, time) in study.times() {
        assert_eq!(time != first[&name], name.starts_with(stem), "{name}");
    }
    assert_eq!(study.results()["bd_rates"], results["bd_rates"], "streams are deterministic");

    // The report needs neither frames nor streams.
    fs::remove_dir_all(study.path("out/performer")).expect("removed");
    fs::remove_dir_all(study.path("out/cells")).expect("removed");
    fs::remove_file(study.path("out/report.html")).expect("removed");
    succeeds(study.arguments(&["--report-only"]));
    check_report(&study);
    assert_eq!(study.results(), {
        let mut expected = study.results();
        expected["bd_rates"] = results["bd_rates"].clone();
        expected
    });
}

#[track_caller]
fn check_cells(results: &Value, study: &Study) {
    let cells = results["cells"].as_array().expect("an array");
    let name = |cell: &Value| format!("{} {}", cell["codec"], cell["point"]).replace('"', "");
    let names: Vec<String> = cells.iter().map(name).collect();
    assert_eq!(names, ["bimodal coarse", "bimodal fine", "baseline coarse", "baseline fine"]);
    for cell in cells {
        let frames = cell["frames"].as_array().expect("an array");
        let kinds: Vec<&str> = frames.iter().filter_map(|frame| frame["kind"].as_str()).collect();
        assert_eq!(kinds, ["I", "P", "P"]);
        assert!(frames[1]["msdm2"].as_f64().is_some_and(|value| value > 0.0 && value < 1.0));
        let key = cell["key"].as_str().expect("a key");
        let stream = fs::read(study.path(&format!("out/cells/{}.knm", &key[..16]))).expect("kept");
        assert_eq!(cell["bytes"], stream.len());
        // The command that is told writes the same stream.
        let command = cell["command"].as_str().expect("a command");
        let words = command.split(' ').map(|word| word.trim_matches('\''));
        let mut words: Vec<String> = words.skip(1).map(String::from).collect();
        let at = words.iter().position(|word| word == "-o").expect("an output") + 1;
        words[at] = study.path("again.knm").to_string_lossy().into_owned();
        succeeds(words);
        assert_eq!(fs::read(study.path("again.knm")).expect("written"), stream, "{command}");
    }
    // What differs in motion only has the same I-frames.
    let intra = |cell: &Value| cell["frames"][0]["bytes"].clone();
    assert_eq!(intra(&cells[0]), intra(&cells[2]));
    assert_eq!(cells[0]["frames"][0]["msdm2"], cells[2]["frames"][0]["msdm2"]);
    assert_ne!(intra(&cells[0]), intra(&cells[1]));
}

#[track_caller]
fn check_deltas(results: &Value) {
    let deltas = results["bd_rates"].as_array().expect("an array");
    let of = |anchor: &str| deltas.iter().filter(|delta| delta["anchor"] == anchor).count();
    // Against the preset: the other preset by all bytes and by P-frames, the table's codec by all
    // bytes, in two metrics. Against the table's codec: both presets by all bytes.
    assert_eq!((of("baseline"), of("other")), (6, 4), "{deltas:#?}");
    for delta in deltas.iter().filter(|delta| delta["anchor"] == "other") {
        let reason = delta["reason"].as_str().expect("no delta");
        assert!(reason.contains("do not overlap"), "{reason}");
    }
}

#[track_caller]
fn check_report(study: &Study) {
    let html = fs::read_to_string(study.path("out/report.html")).expect("written");
    assert!(html.contains("<h1>a &lt;b&gt; &amp; c</h1>") && !html.contains("a <b>"));
    for part in ["<svg", "data:image/png;base64,", "kn encode", "do not overlap", "frame 2"] {
        assert!(html.contains(part), "{part}");
    }
    // Three letters by chance are no fault of a picture.
    let (mut texts, mut rest) = (String::new(), &html[..]);
    while let Some((before, after)) = rest.split_once(";base64,") {
        texts += before;
        rest = after.split_once('"').expect("an end").1;
    }
    texts += rest;
    for bad in ["http", "<script", "NaN"] {
        assert!(!texts.contains(bad), "{bad}");
    }
    let rows = fs::read_to_string(study.path("out/results.csv")).expect("written");
    assert!(rows.starts_with("sequence,codec,point,bytes_per_frame,"), "{rows}");
    assert_eq!(rows.lines().count(), 5);
    let text = fs::read_to_string(study.path("out/report.md")).expect("written");
    assert!(text.starts_with("# a <b> & c\n"), "{text}");
    assert!(text.contains("## BD-rate against baseline: MSDM2, P-frames alone, %"), "{text}");
    assert!(!text.contains("NaN"), "{text}");
    let widths = |line: &str| line.matches('|').count();
    for table in text.split("\n\n").filter(|part| part.starts_with('|')) {
        let mut lines = table.lines().map(widths);
        let first = lines.next().expect("a header");
        assert!(lines.all(|width| width == first), "{table}");
    }
}

#[test]
fn mistakes_are_found_before_any_work() {
    let message = |from: &str, to: &str| {
        assert!(CONFIG.contains(from), "{from}");
        let study = Study::new(&CONFIG.replace(from, to), TABLE);
        let message = fails(study.arguments(&[]));
        assert!(!study.path("out/cells").exists(), "{message}");
        message
    };
    let preset = message("name = \"baseline\"", "name = \"baselin\"");
    assert!(preset.contains("study.toml: preset 'baselin': there is no preset 'baselin'; did you"));
    assert!(message("nodes = 40", "node = 40").contains("no key 'node'; did you mean 'nodes'?"));
    assert!(message("[pictures]", "[picture]").contains("did you mean 'pictures'?"));
    assert!(message("frame = 9", "frames = 9").contains("unknown field `frames`"));
    assert!(message("\"other\"]", "\"othre\"]").contains("did you mean 'other'?"));
    assert!(message("bits = 8", "bits = 80").contains("--bits is 80; it must be from 4 to 20"));
    assert!(message("{ bytes = \"rate\" }", "{}").contains("other.csv: there is no column 'bytes"));
    assert!(message("\"other.csv\"", "\"none.csv\"").contains("none.csv: No such file"));
}

#[test]
fn an_input_that_is_not_there_is_named() {
    let performer = "performer = { motion = \"dance\", frames = 3, vertices = 1000, holes = 1 }";
    let message =
        |source: &str| fails(Study::new(&CONFIG.replace(performer, source), TABLE).arguments(&[]));
    let empty = message("input = 'scan/*.obj'");
    assert!(empty.contains("sequence 'dance'") && empty.contains("scan/*.obj"), "{empty}");
    let unset = message("input = '${KN_NOT_SET}/*.obj'");
    assert!(unset.ends_with("${KN_NOT_SET}/*.obj: KN_NOT_SET is not set"), "{unset}");
    let motion = message("performer = { motion = 'dane', frames = 3 }");
    assert!(motion.contains("no motion 'dane'; did you mean 'dance'?"), "{motion}");
}

#[test]
fn a_broken_table_is_an_error_and_a_failed_stream_is_reported() {
    let study = Study::new(CONFIG, &TABLE.replace("20,0.005", "2o,0.005"));
    let broken = fails(study.arguments(&[]));
    assert!(broken.ends_with("line 3: '2o' in the column rate is not a number"), "{broken}");

    // One node for seven regions, none of which may go without: only that codec fails.
    let config = CONFIG.replace("nodes = 40", "nodes = 1\ninfluence = \"strict\"");
    let study = Study::new(&config, TABLE);
    let output = kn(study.arguments(&[]));
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("kn: dance, baseline, coarse: "), "{message}");
    let html = fs::read_to_string(study.path("out/report.html")).expect("written");
    assert!(html.contains("Without result"));
}
