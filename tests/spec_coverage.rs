//! Rules, code, examples and streams belong together.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use kn_conform::{Expected, Spec, branches, coverage, coverage_page, load_corpus};

fn spec_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("spec")
}

fn spec() -> Spec {
    Spec::load(&spec_folder()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn ids_are_unique() {
    let spec = spec();
    let mut places = BTreeMap::new();
    for rule in &spec.rules {
        let other = places.insert(&rule.id, &rule.chapter);
        assert_eq!(other, None, "{} stands twice", rule.id);
    }
}

#[test]
fn what_the_text_asks_of_streams_the_code_checks_and_the_reverse() {
    let spec = spec();
    let required = spec.rules.iter().filter(|rule| rule.is_requirement());
    let required: BTreeSet<&str> = required.map(|rule| rule.id.as_str()).collect();
    let checked = checked_rules();
    let checked: BTreeSet<&str> = checked.iter().map(String::as_str).collect();
    let unchecked: Vec<_> = required.difference(&checked).collect();
    assert!(unchecked.is_empty(), "in the specification, not in the code: {unchecked:?}");
    let unwritten: Vec<_> = checked.difference(&required).collect();
    assert!(unwritten.is_empty(), "in the code, not in the specification: {unwritten:?}");
}

/// Ids of the rules that a decoder can refuse a stream by: the strings in every `rule.rs`.
fn checked_rules() -> BTreeSet<String> {
    let files = rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("crates"));
    let mut rules = BTreeSet::new();
    for file in files.iter().filter(|file| file.ends_with("rule.rs")) {
        let text = std::fs::read_to_string(file).unwrap_or_default();
        let lines = text.lines().filter(|line| !line.trim_start().starts_with("//"));
        let quoted = lines.flat_map(|line| line.split('"').skip(1).step_by(2));
        rules.extend(quoted.filter(|quoted| is_id(quoted)).map(str::to_owned));
    }
    rules
}

fn is_id(text: &str) -> bool {
    let letter = |c: char| c.is_ascii_lowercase() || c == '.' || c == '_';
    text.contains('.') && text.chars().all(letter) && text.split('.').all(|part| !part.is_empty())
}

#[test]
fn what_comments_cite_is_in_the_specification() {
    let spec = spec();
    let ids: BTreeSet<&str> = spec.rules.iter().map(|rule| rule.id.as_str()).collect();
    let topics: BTreeSet<&str> = ids.iter().filter_map(|id| id.split('.').next()).collect();
    let mut unknown = Vec::new();
    for file in rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("crates")) {
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let comments = text.lines().filter(|line| line.trim_start().starts_with("//"));
        for quoted in comments.flat_map(|line| line.split('`').skip(1).step_by(2)) {
            let topic = quoted.split('.').next().unwrap_or("");
            if is_id(quoted) && topics.contains(topic) && !ids.contains(quoted) {
                unknown.push(format!("{}: {quoted}", file.display()));
            }
        }
    }
    assert!(unknown.is_empty(), "{unknown:#?}");
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}

#[test]
fn examples_and_streams_name_rules_of_the_specification() {
    let spec = spec();
    let streams = load_corpus(&spec_folder().join("conformance")).expect("the corpus");
    for example in &spec.examples {
        if let Expected::Reject(id) = &example.expected {
            assert!(spec.rule(id).is_some(), "{}: there is no rule {id}", example.place);
        }
    }
    for stream in &streams {
        for id in stream.description.covers.iter().chain(&stream.description.rule) {
            assert!(spec.rule(id).is_some(), "{}: there is no rule {id}", stream.name);
        }
    }
}

#[test]
fn the_page_of_coverage_is_up_to_date() {
    let spec = spec();
    let streams = load_corpus(&spec_folder().join("conformance")).expect("the corpus");
    let covered = coverage(&spec, &streams);
    let page = std::fs::read_to_string(spec_folder().join("coverage.md")).unwrap_or_default();
    let branches = branches(&spec, &streams).expect("streams");
    assert!(page == coverage_page(&covered, &branches), "run the example `coverage` of kn-conform");
}

#[test]
fn every_requirement_has_an_example_or_a_stream_that_breaks_it() {
    let spec = spec();
    let streams = load_corpus(&spec_folder().join("conformance")).expect("the corpus");
    let covered = coverage(&spec, &streams);
    let bare = covered.iter().filter(|entry| entry.rule.is_requirement() && entry.is_bare());
    let bare: Vec<_> = bare.map(|entry| entry.rule.id.as_str()).collect();
    assert!(bare.is_empty(), "{bare:?}");
}

#[test]
fn sound_streams_take_every_branch_of_the_syntax_tables_both_ways() {
    let spec = spec();
    let streams = load_corpus(&spec_folder().join("conformance")).expect("the corpus");
    for branch in branches(&spec, &streams).expect("streams") {
        assert!(!branch.holds.is_empty(), "{}: never holds", branch.condition);
        assert!(!branch.fails.is_empty(), "{}: always holds", branch.condition);
    }
}

#[test]
fn every_faulty_stream_says_what_only_it_is_for() {
    let streams = load_corpus(&spec_folder().join("conformance")).expect("the corpus");
    let mut said = BTreeMap::new();
    for stream in streams.iter().filter(|stream| stream.description.rule.is_some()) {
        let other = said.insert(&stream.description.danger, &stream.name);
        assert_eq!(other, None, "{} says the same", stream.name);
    }
}
