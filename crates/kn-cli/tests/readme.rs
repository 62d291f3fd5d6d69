//! The README says nothing that is not so: its code is in the examples, which are compiled and
//! run, and its commands exist with those flags.

mod common;

use common::succeeds;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// A file of the repository; `None` in a crate that was unpacked alone.
fn read(path: &str) -> Option<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = fs::read_to_string(root.join(path)).ok();
    if text.is_none() {
        eprintln!("skipped: {path} is absent");
    }
    text
}

/// Lines inside blocks of that language.
fn block_lines<'t>(text: &'t str, language: &str) -> Vec<&'t str> {
    let mut inside = false;
    let mut lines = Vec::new();
    for line in text.lines() {
        if let Some(opened) = line.strip_prefix("```") {
            inside = opened == language;
        } else if inside {
            lines.push(line.trim());
        }
    }
    lines
}

#[test]
fn its_code_is_in_the_examples() {
    let Some(readme) = read("README.md") else { return };
    let names = ["encode_sequence", "decode_frames", "decode_network_stream", "compare_sequences"];
    let examples: Option<String> =
        names.iter().map(|name| read(&format!("examples/{name}.rs"))).collect();
    let Some(examples) = examples else { return };
    let code = block_lines(&readme, "rust");
    assert!(code.len() > 20, "the README shows code");
    for line in code {
        let known = examples.lines().any(|known| known.trim() == line);
        assert!(known, "no example has the line {line:?}");
    }
}

#[test]
fn its_commands_have_those_flags() {
    let Some(readme) = read("README.md") else { return };
    let mut help = BTreeMap::new();
    let commands = block_lines(&readme, "sh");
    assert!(commands.len() > 10, "the README shows commands");
    for line in commands {
        let words: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(words[0], "kn", "{line}");
        let help = help.entry(words[1]).or_insert_with(|| succeeds([words[1], "--help"]));
        for flag in words.iter().filter(|word| word.starts_with('-')) {
            assert!(help.contains(flag), "{line}: kn {} has no {flag}", words[1]);
        }
    }
}
