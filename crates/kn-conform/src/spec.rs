//! The specification as data: rules, syntax tables, examples, CSV tables.

use std::path::{Path, PathBuf};

use crate::huffman::Codes;
use crate::interpret::NodeLabels;
use crate::syntax::{Syntax, SyntaxError};
use crate::tables::{Table, TableError};

/// The specification as data.
#[derive(Debug)]
pub struct Spec {
    /// All rules, in the order of the chapters.
    pub rules: Vec<Clause>,
    /// The tables of chapter 3.
    pub syntax: Syntax,
    /// The worked examples, in the order of the chapters.
    pub examples: Vec<Example>,
    pub(crate) codes: Codes,
    pub(crate) levels: Table,
    /// Headings so far.
    sections: usize,
}

/// A clause with an id.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Clause {
    /// `nodes.count.range`
    pub id: String,
    /// The clause, up to the next rule, note, heading or block.
    pub text: String,
    /// File name of its chapter.
    pub chapter: String,
    /// Number of its section: headings counted through all chapters.
    pub section: usize,
}

impl Clause {
    /// Whether the clause asks something of streams, so that a decoder can refuse one by it.
    ///
    /// Chapter 1 keeps the word "shall" for this.
    pub fn is_requirement(&self) -> bool {
        let words = |word: &str| self.text.split_whitespace().any(|w| w.trim_matches('"') == word);
        words("shall") || self.text.contains("requirement of bitstream conformance")
    }
}

/// A worked example: bytes and what they mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Example {
    /// Chapter and line, as in `02-descriptors.md:41`.
    pub place: String,
    /// Number of its section, as of rules.
    pub section: usize,
    /// The table to read with, or `descriptor NAME(ARGUMENT)`.
    pub structure: String,
    /// Values that the example takes as known, such as `NodeCount`.
    pub given: Vec<(String, i64)>,
    /// The bytes.
    pub bytes: Vec<u8>,
    /// The meaning of the bytes.
    pub expected: Expected,
}

/// The meaning of an example's bytes.
#[derive(Clone, Debug, PartialEq)]
pub enum Expected {
    /// Trace lines, `bit name = value`.
    Trace(Vec<String>),
    /// The id of the rule that the bytes break.
    Reject(String),
}

/// A specification that cannot be read.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum SpecError {
    #[error("{path}: {error}")]
    Io { path: PathBuf, error: std::io::Error },
    #[error("{chapter}: {error}")]
    Syntax { chapter: String, error: SyntaxError },
    #[error("{path}: {error}")]
    Table { path: PathBuf, error: TableError },
    #[error("{place}: {reason}")]
    Example { place: String, reason: String },
}

impl Spec {
    /// Reads the chapters `NN-*.md` and the tables of a folder.
    pub fn load(folder: &Path) -> Result<Self, SpecError> {
        let table = |name: &str| {
            let path = folder.join("tables").join(name);
            Table::parse(&read(&path)?).map_err(|error| SpecError::Table { path, error })
        };
        let mut spec = Self {
            rules: Vec::new(),
            syntax: Syntax::default(),
            examples: Vec::new(),
            codes: Codes::new(&table("cauchy_huffman.csv")?),
            levels: table("levels.csv")?,
            sections: 0,
        };
        for chapter in chapters(folder)? {
            let name = chapter.file_name().map(|name| name.to_string_lossy().into_owned());
            spec.add_chapter(&name.unwrap_or_default(), &read(&chapter)?)?;
        }
        Ok(spec)
    }

    fn add_chapter(&mut self, chapter: &str, text: &str) -> Result<(), SpecError> {
        let mut lines = (1..).zip(text.lines());
        let mut in_rule = false;
        while let Some((number, line)) = lines.next() {
            if let Some(kind) = line.strip_prefix("```") {
                let inside = lines.by_ref().map(|(_, line)| line).take_while(|&line| line != "```");
                let block = inside.collect::<Vec<_>>();
                self.add_block(kind, &block, chapter, number)?;
                // A clause may go on after a formula, not after an example.
                in_rule &= kind != "example";
            } else if let Some(id) = line.strip_prefix("r[").and_then(|id| id.strip_suffix(']')) {
                let (id, text, chapter) = (id.to_owned(), String::new(), chapter.to_owned());
                self.rules.push(Clause { id, text, chapter, section: self.sections });
                in_rule = true;
            } else if line.starts_with('#') || is_note(line) {
                self.sections += usize::from(line.starts_with('#'));
                in_rule = false;
            } else if let Some(rule) = self.rules.last_mut().filter(|_| in_rule) {
                rule.text.push_str(line);
                rule.text.push('\n');
            }
        }
        Ok(())
    }

    fn add_block(
        &mut self,
        kind: &str,
        block: &[&str],
        chapter: &str,
        line: usize,
    ) -> Result<(), SpecError> {
        match kind {
            "syntax" => self.syntax.add(&block.join("\n")).map_err(|error| {
                let chapter = chapter.to_owned();
                SpecError::Syntax { chapter, error }
            }),
            "example" => {
                let place = format!("{chapter}:{line}");
                let example = parse_example(&place, block)
                    .map_err(|reason| SpecError::Example { place, reason })?;
                self.examples.push(Example { section: self.sections, ..example });
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The rule with an id.
    pub fn rule(&self, id: &str) -> Option<&Clause> {
        self.rules.iter().find(|rule| rule.id == id)
    }
}

/// Notes explain and bind nobody.
fn is_note(line: &str) -> bool {
    line.starts_with("*Note") || line.starts_with("> Note")
}

/// For streams in which nothing depends on the labels of key nodes.
pub fn no_labels() -> &'static NodeLabels<'static> {
    &|_| None
}

fn read(path: &Path) -> Result<String, SpecError> {
    std::fs::read_to_string(path).map_err(|error| SpecError::Io { path: path.to_owned(), error })
}

/// The chapters in order.
fn chapters(folder: &Path) -> Result<Vec<PathBuf>, SpecError> {
    let io = |error| SpecError::Io { path: folder.to_owned(), error };
    let mut chapters = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(io)? {
        let path = entry.map_err(io)?.path();
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
        let is_chapter =
            |name: String| name.ends_with(".md") && name.starts_with(|c: char| c.is_ascii_digit());
        if name.is_some_and(is_chapter) {
            chapters.push(path);
        }
    }
    chapters.sort();
    Ok(chapters)
}

/// `structure Name = 1, …`, bytes, a line `.`, trace lines or `reject RULE`.
fn parse_example(place: &str, block: &[&str]) -> Result<Example, String> {
    let mut lines = block.iter().map(|line| line.split('#').next().unwrap_or("").trim());
    let head = lines.next().unwrap_or("");
    let (structure, given) = head.split_once(" with ").unwrap_or((head, ""));
    let given = given.split(',').filter(|part| !part.trim().is_empty()).map(parse_given);
    let given =
        given.collect::<Option<Vec<_>>>().ok_or("the given values are not `Name = 1, …`")?;
    let mut bits = Vec::new();
    for line in lines.by_ref().take_while(|&line| line != ".") {
        for word in line.split_whitespace() {
            bits.extend(parse_word(word).ok_or_else(|| format!("{word:?} are no bits"))?);
        }
    }
    let rest: Vec<_> = lines.filter(|line| !line.is_empty()).map(str::to_owned).collect();
    let expected = match rest.first().and_then(|line| line.strip_prefix("reject ")) {
        Some(rule) => Expected::Reject(rule.to_owned()),
        None => Expected::Trace(rest),
    };
    let byte =
        |bits: &[bool]| (0..8).fold(0, |byte, i| byte << 1 | u8::from(bits.get(i) == Some(&true)));
    let bytes = bits.chunks(8).map(byte).collect();
    Ok(Example {
        place: place.to_owned(),
        section: 0,
        structure: structure.to_owned(),
        given,
        bytes,
        expected,
    })
}

fn parse_given(text: &str) -> Option<(String, i64)> {
    let (name, value) = text.split_once('=')?;
    Some((name.trim().to_owned(), value.trim().parse().ok()?))
}

/// Hexadecimal digits, or `0b` and bits.
fn parse_word(word: &str) -> Option<Vec<bool>> {
    let (digits, radix, width) = match word.strip_prefix("0b") {
        Some(bits) => (bits, 2, 1),
        None => (word, 16, 4),
    };
    let mut bits = Vec::new();
    for digit in digits.chars() {
        let value = digit.to_digit(radix)?;
        bits.extend((0..width).rev().map(|i| value >> i & 1 == 1));
    }
    Some(bits)
}
