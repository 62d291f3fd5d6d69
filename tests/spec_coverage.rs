//! Rules, code, examples and streams belong together.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use kn_bitstream::rule;
use kn_conform::{Expected, Spec, load_corpus};
use kn_corpus::coverage::{branches, coverage, coverage_page};

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

/// Paragraphs that may stand outside rules, by chapter and beginning. Introductions, and what is
/// said of the specification itself.
const WITHOUT_RULE: &[(&str, &str)] = &[
    ("01-conventions.md", "\"shall\" says what every stream obeys"),
    ("01-conventions.md", "Each rule begins with a line of its own"),
    ("01-conventions.md", "A worked example gives the structure"),
    ("02-descriptors.md", "In table 8 the first symbols"),
    ("06-semantics.md", "The elements in the order of the tables"),
    ("06-semantics.md", "Which values an element may have stands"),
    ("06-semantics.md", "The rules of 3.1 and 3.2 apply."),
    ("06-semantics.md", "The values of a P-frame are in chapter 7."),
    ("08-deformation.md", "Rounding to a grid makes a fine mesh bumpier"),
    ("09-conformance.md", "`conformance/` holds small synthetic streams"),
    ("09-conformance.md", "- `NAME.knm`, the stream;"),
    ("09-conformance.md", "`kn conform --stream FILE.knm` says"),
];

#[test]
fn every_clause_has_a_rule() {
    let mut loose = Vec::new();
    let mut exempt = BTreeSet::new();
    for path in chapters() {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&path).expect("a chapter");
        for (line, paragraph) in paragraphs_without_rule(&text) {
            let known = |(chapter, start): &&(&str, &str)| {
                *chapter == name.as_str() && paragraph.starts_with(start)
            };
            match WITHOUT_RULE.iter().find(known) {
                Some(entry) => drop(exempt.insert(*entry)),
                None => loose.push(format!("{name}:{line}: {paragraph}")),
            }
        }
    }
    assert!(loose.is_empty(), "a rule id or an entry in WITHOUT_RULE for: {loose:#?}");
    assert_eq!(exempt.len(), WITHOUT_RULE.len(), "exempt, but not in the text");
}

/// The chapters that bind: all but the scope.
fn chapters() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(spec_folder()).expect("the specification").flatten();
    let binds = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.ends_with(".md")
            && name.starts_with(|c: char| c.is_ascii_digit())
            && !name.starts_with("00")
    };
    let chapters: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(binds).collect();
    assert_eq!(chapters.len(), 9);
    chapters
}

/// Paragraphs, lists, tables and formulas that belong to no rule: in front of the first of their
/// section, or behind a note or an example. Notes bind nobody, walkthroughs are examples, and
/// syntax tables and examples stand for themselves.
fn paragraphs_without_rule(text: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    let (mut in_rule, mut in_walkthrough) = (false, false);
    // The kind of block inside its fences, and whether the line before is of the same paragraph.
    let (mut block, mut in_paragraph) = (None, false);
    for (number, line) in (1..).zip(text.lines()) {
        if let Some(kind) = line.strip_prefix("```") {
            let opened = block.is_none();
            let stands = in_rule || in_walkthrough || matches!(kind, "syntax" | "example");
            if opened && !stands {
                found.push((number, line));
            }
            in_rule &= kind != "example";
            block = opened.then_some(kind);
            in_paragraph = false;
        } else if block.is_some() {
        } else if line.starts_with("r[") && line.ends_with(']') {
            (in_rule, in_paragraph) = (true, false);
        } else if line.starts_with('#') {
            (in_rule, in_paragraph) = (false, false);
            in_walkthrough = line.ends_with("Walkthrough");
        } else if line.is_empty() {
            in_paragraph = false;
        } else if !in_paragraph {
            in_paragraph = true;
            let note = line.starts_with("*Note.") || line.starts_with("> Note.");
            in_rule &= !note;
            if !(note || in_rule || in_walkthrough) {
                found.push((number, line));
            }
        }
    }
    found
}

#[test]
fn paragraphs_without_a_rule_are_seen() {
    let starts = |text| -> Vec<usize> {
        paragraphs_without_rule(text).into_iter().map(|(number, _)| number).collect()
    };
    assert_eq!(starts("# 1\n\nloose,\nits second line\n\nr[a.b]\nclause\n\ngoes on\n"), [3]);
    assert_eq!(starts("r[a.b]\nclause\n\n```text\nx\n```\n\nof it\n\n## 2\n\nloose\n"), [12]);
    assert_eq!(starts("r[a.b]\nclause\n\n*Note. x\ny*\n\nloose\n\n| a |\n"), [7, 9]);
    assert_eq!(starts("```syntax\nx\n```\n\n```example\nx\n```\n\n```text\nx\n```\n"), [9]);
    assert_eq!(starts("### Walkthrough\n\nx\n\n```text\nx\n```\n"), [0; 0]);
    assert_eq!(starts("r[a.b]\nclause\n\n```example\nx\n```\n\nloose\n"), [8]);
}

#[test]
fn what_the_text_asks_of_streams_the_code_checks_and_the_reverse() {
    let spec = spec();
    let required = spec.rules.iter().filter(|rule| rule.is_requirement());
    let required: BTreeSet<&str> = required.map(|rule| rule.id.as_str()).collect();
    let checked: BTreeSet<&str> = rule::ALL.iter().map(|rule| rule.id()).collect();
    let unchecked: Vec<_> = required.difference(&checked).collect();
    assert!(unchecked.is_empty(), "in the specification, not in the code: {unchecked:?}");
    let unwritten: Vec<_> = checked.difference(&required).collect();
    assert!(unwritten.is_empty(), "in the code, not in the specification: {unwritten:?}");
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
fn every_requirement_has_what_breaks_it_and_every_other_rule_what_shows_it() {
    let spec = spec();
    let streams = load_corpus(&spec_folder().join("conformance")).expect("the corpus");
    let covered = coverage(&spec, &streams);
    let bare = covered.iter().filter(|entry| entry.is_bare());
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
