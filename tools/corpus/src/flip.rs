//! Flips every number of `spec/tables` and of kn-deform, one at a time, and counts those that no
//! test notices: `cargo run --release -p kn-corpus -- flip`.
//!
//! A table's number is flipped in its CSV, and noticed where the Rust table is another then. A
//! number of kn-deform is flipped in a copy of the workspace in `target/flip`, and noticed where
//! the crate does not build or its tests fail. `--list` prints the numbers and flips none; a number
//! N begins at the Nth, to go on where a run was ended.

use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Result, bail, ensure};
use kn_conform::tables::{Table, TableError};
use kn_corpus::rust_tables::{cauchy_source, levels_source};

/// Numbers that no result depends on, by what stands in their line and which of it, all where that
/// is empty.
const NOT_NORMATIVE: [(&str, &str); 15] = [
    // Sizes of work units, of buffers, and what these are filled with before they are overwritten.
    ("const CHUNK", ""),
    ("const LANES", ""),
    (".resize(", ""),
    ("[f64; MAX_Q + 1]", "1"),
    ("[u16; MAX_Q + 1]", "1"),
    ("let mut squared = [0.0; MAX_Q]", "0.0"),
    ("let mut sum = [0.0; 3]", "3"),
    // The lane beside x, y and z, which is always zero.
    ("blended[..3]", "3"),
    ("a[2][k], 0.0]", "0.0"),
    ("b(2), 0.0]", "0.0"),
    // A vertex to name where none is outside.
    ("find(outside).unwrap_or(0)", ""),
    // A bound that saves time and excludes no node.
    ("fold(0.0, f64::max)", "0.0"),
    ("limit = farthest + 1.0", "1.0"),
    // Twice all weights, which their sum divides by; the first of two equals.
    ("1.0 / floored(squared)", "1.0"),
    ("run[0]", "0"),
];

/// A number in a source.
struct Literal {
    file: String,
    line: usize,
    column: usize,
    text: String,
}

/// Flips the constants of the checkout at `root`.
pub(crate) fn run(root: &Path, argument: &str) -> Result<()> {
    let literals = literals(&root.join("crates/kn-deform/src"))?;
    if argument == "--list" {
        for (number, literal) in literals.iter().enumerate() {
            let Literal { file, line, column, text } = literal;
            println!("{number}: {file}:{}:{}: {text} -> {}", line + 1, column + 1, flipped(text));
        }
        return Ok(());
    }
    let tables = root.join("spec/tables");
    let rust = root.join("crates/kn-bitstream/src/tables");
    let cauchy =
        flip_table(&tables.join("cauchy_huffman.csv"), &rust.join("cauchy.rs"), cauchy_source)?;
    let levels = flip_table(&tables.join("levels.csv"), &rust.join("levels.rs"), levels_source)?;
    println!(
        "tables: {} numbers flipped, {} not noticed",
        cauchy.0 + levels.0,
        cauchy.1 + levels.1
    );
    let first = argument.parse().unwrap_or(0);
    let survivors = flip_sources(root, &literals, first)?;
    println!("kn-deform: {} numbers flipped, {survivors} not noticed", literals.len() - first);
    ensure!(survivors + cauchy.1 + levels.1 == 0, "some are not noticed");
    Ok(())
}

type Source = fn(&str) -> Result<String, TableError>;

/// Numbers of a CSV table, and how many of them can be flipped with the same Rust table.
fn flip_table(csv: &Path, rust: &Path, source: Source) -> Result<(usize, usize)> {
    let (text, rust) = (std::fs::read_to_string(csv)?, std::fs::read_to_string(rust)?);
    let table = Table::parse(&text)?;
    let (mut count, mut survivors) = (0, 0);
    for row in 0..table.rows.len() {
        for column in 0..table.columns.len() {
            let mut flipped = table.clone();
            flipped.rows[row][column] += 1;
            let lines = flipped
                .rows
                .iter()
                .map(|row| row.iter().map(u64::to_string).collect::<Vec<_>>().join(","));
            let text = [flipped.columns.join(",")].into_iter().chain(lines).collect::<Vec<_>>();
            count += 1;
            // The first column only numbers the rows: a test of the tables reads it.
            survivors += usize::from(column > 0 && source(&(text.join("\n") + "\n"))? == rust);
        }
    }
    Ok((count, survivors))
}

/// The numbers outside comments and tests.
fn literals(folder: &Path) -> Result<Vec<Literal>> {
    let mut literals = Vec::new();
    let mut files = std::fs::read_dir(folder)?
        .map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()))
        .collect::<std::io::Result<Vec<String>>>()?;
    files.sort();
    for file in files {
        let text = std::fs::read_to_string(folder.join(&file))?;
        for (line, content) in text.lines().enumerate() {
            if content.starts_with("#[cfg(test)]") {
                break;
            }
            let is_code = !content.trim_start().starts_with("//") && !content.contains('"');
            let counts = |(_, text): &(usize, String)| {
                let exempt = |(place, number): &(&str, &str)| {
                    content.contains(place) && (number.is_empty() || number == text)
                };
                is_code && !NOT_NORMATIVE.iter().any(exempt)
            };
            let numbers = numbers(content).into_iter().filter(counts);
            literals.extend(numbers.map(|(column, text)| {
                let file = file.clone();
                Literal { file, line, column, text }
            }));
        }
    }
    Ok(literals)
}

/// Numbers of a line with their columns.
fn numbers(line: &str) -> Vec<(usize, String)> {
    let code = line.split("//").next().unwrap_or("");
    let bytes = code.as_bytes();
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let in_word = at > 0 && (bytes[at - 1].is_ascii_alphanumeric() || bytes[at - 1] == b'_');
        if !bytes[at].is_ascii_digit() || in_word {
            at += 1;
            continue;
        }
        let start = at;
        while at < bytes.len() {
            let exponent = bytes[at] == b'-' && bytes[at - 1] == b'e';
            let point = bytes[at] == b'.' && bytes.get(at + 1).is_some_and(u8::is_ascii_digit);
            if !(bytes[at].is_ascii_alphanumeric() || bytes[at] == b'_' || exponent || point) {
                break;
            }
            at += 1;
        }
        found.push((start, code[start..at].to_owned()));
    }
    found
}

/// The number with another digit: the last one of its mantissa that makes another value.
fn flipped(text: &str) -> String {
    let value = |text: &str| text.replace('_', "").parse::<f64>().ok();
    let mantissa = text.find('e').unwrap_or(text.len());
    let digits = text[..mantissa].trim_end_matches(|c: char| !c.is_ascii_digit());
    // `3.0` becomes `4.0`, not `3.1`.
    let digits = digits.strip_suffix(".0").unwrap_or(digits);
    let places = (0..digits.len()).rev().filter(|&at| digits.as_bytes()[at].is_ascii_digit());
    let others = places.map(|at| {
        let digit = digits.as_bytes()[at] - b'0';
        // Downwards from 6: the room for 256 regions would not be missed at 257.
        let other = if digit == 6 { 5 } else { (digit + 1) % 10 };
        format!("{}{other}{}", &text[..at], &text[at + 1..])
    });
    let mut others = others.filter(|other| value(text).is_none() || value(other) != value(text));
    others.next().unwrap_or_default()
}

/// The number of literals, from `first` on, that no test notices.
fn flip_sources(root: &Path, literals: &[Literal], first: usize) -> Result<usize> {
    let copy = root.join("target/flip");
    std::fs::create_dir_all(copy.join("workspace"))?;
    for name in
        ["Cargo.toml", "Cargo.lock", "crates", "tests", "benches", "examples", "spec", "tools"]
    {
        copy_all(&root.join(name), &copy.join("workspace").join(name))?;
    }
    if !passes(&copy)? {
        bail!("the tests fail before anything is flipped");
    }
    let mut survivors = 0;
    for (number, literal) in literals.iter().enumerate().skip(first) {
        let path = copy.join("workspace/crates/kn-deform/src").join(&literal.file);
        let sound = std::fs::read_to_string(&path)?;
        let mut lines: Vec<String> = sound.lines().map(str::to_owned).collect();
        let end = literal.column + literal.text.len();
        lines[literal.line].replace_range(literal.column..end, &flipped(&literal.text));
        std::fs::write(&path, lines.join("\n") + "\n")?;
        let survives = passes(&copy)?;
        std::fs::write(&path, sound)?;
        survivors += usize::from(survives);
        let Literal { file, line, column, text } = literal;
        let word = if survives { "NOT NOTICED" } else { "noticed" };
        println!("{number}: {file}:{}:{}: {text}: {word}", line + 1, column + 1);
    }
    Ok(survivors)
}

/// Whether the unit tests pass and, which costs a second build, the others.
fn passes(copy: &Path) -> Result<bool> {
    Ok(tests_pass(copy, "--lib")? && tests_pass(copy, "--test=*")?)
}

fn tests_pass(copy: &Path, which: &str) -> Result<bool> {
    let status = Command::new("cargo")
        .args(["test", "--quiet", "--package", "kn-deform", which, "--target-dir"])
        .arg(copy.join("target"))
        .current_dir(copy.join("workspace"))
        .env("CARGO_PROFILE_DEV_OPT_LEVEL", "1")
        .env("CARGO_PROFILE_DEV_DEBUG", "0")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()?;
    Ok(status.success())
}

fn copy_all(from: &Path, to: &Path) -> Result<()> {
    if !from.is_dir() {
        std::fs::copy(from, to)?;
        return Ok(());
    }
    std::fs::create_dir_all(to)?;
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        copy_all(&entry.path(), &to.join(entry.file_name()))?;
    }
    Ok(())
}
