//! The conformance streams, and the verdicts on a decoder that runs on them.

use std::fmt;
use std::fs::File;
use std::io::Read;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use kn_bitstream::Rule;
use kn_codec::{Decoder, FrameKind, digest};
use kn_mesh::Mesh;
use serde::{Deserialize, Serialize};

/// The folders of the corpus.
pub const FOLDERS: [&str; 3] = ["core", "uncommon", "faulty"];

/// The description of a stream, from `NAME.json`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Description {
    /// The mistake that the stream catches.
    pub danger: String,
    /// Rules that it exercises.
    #[serde(default)]
    pub covers: Vec<String>,
    /// The rule that a faulty stream breaks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rule: Option<String>,
    /// The lines that a decoder prints for a sound stream (9.7).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub frames: Vec<String>,
    /// The lines of its stages (9.6).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stages: Vec<String>,
}

/// One stream of the corpus.
#[derive(Clone, Debug)]
pub struct Stream {
    /// `core/NAME`
    pub name: String,
    /// The `.knm` file.
    pub path: PathBuf,
    /// The description of the stream.
    pub description: Description,
}

/// The error for a corpus that cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("{path}: {reason}")]
pub struct CorpusError {
    path: PathBuf,
    reason: String,
}

/// Loads all streams of a corpus, sorted by folder and name.
pub fn load_corpus(folder: &Path) -> Result<Vec<Stream>, CorpusError> {
    let mut streams = Vec::new();
    for kind in FOLDERS {
        let folder = folder.join(kind);
        let wrong = |reason: std::io::Error| CorpusError {
            path: folder.clone(),
            reason: reason.to_string(),
        };
        if !folder.exists() {
            continue;
        }
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(&folder).map_err(wrong)? {
            let path = entry.map_err(wrong)?.path();
            if path.extension().is_some_and(|extension| extension == "knm") {
                paths.push(path);
            }
        }
        paths.sort();
        for path in paths {
            streams.push(load_stream(kind, path)?);
        }
    }
    Ok(streams)
}

fn load_stream(kind: &str, path: PathBuf) -> Result<Stream, CorpusError> {
    let beside = path.with_extension("json");
    let wrong = |reason: String| CorpusError { path: beside.clone(), reason };
    let text = std::fs::read_to_string(&beside).map_err(|error| wrong(error.to_string()))?;
    let description = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    Ok(Stream { name: format!("{kind}/{}", stem.unwrap_or_default()), path, description })
}

/// The outcome of a decoder on a stream.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The lines of its frames.
    Frames(Vec<String>),
    /// The decoder refused the stream.
    Refused {
        /// The rule that it named, where it named one.
        rule: Option<String>,
        /// Its message.
        message: String,
    },
    /// The decoder could not be run.
    NotRun(String),
}

/// Runs our decoder, which also checks the digests inside the stream.
pub fn run_ours(stream: impl Read) -> Outcome {
    match frames_of(stream) {
        Ok(frames) => Outcome::Frames(frames),
        Err(error) => {
            let rule = error.rule().map_or("no rule", Rule::id).to_owned();
            Outcome::Refused { rule: Some(rule), message: error.to_string() }
        }
    }
}

/// Runs our decoder on a file.
pub fn run_ours_on(path: &Path) -> Outcome {
    match File::open(path) {
        Ok(file) => run_ours(file),
        Err(error) => Outcome::NotRun(format!("{}: {error}", path.display())),
    }
}

fn frames_of(stream: impl Read) -> Result<Vec<String>, kn_codec::DecodeError> {
    let mut decoder = Decoder::new(stream)?;
    decoder.check_digests(true);
    let mut mesh = Mesh::default();
    let mut lines = Vec::new();
    while let Some(frame) = decoder.next_frame(&mut mesh)? {
        let kind = if frame.kind == FrameKind::Intra { 'I' } else { 'P' };
        let (positions, faces) = (decoder.stream().grid_positions(), decoder.stream().faces());
        let sha256 = digest::frame_sha256(positions, faces);
        let (index, vertices, faces) = (frame.index, frame.vertices, frame.faces);
        lines.push(format!("{index} {kind} {vertices} {faces} {sha256}"));
    }
    Ok(lines)
}

/// The verdict on one stream.
#[derive(Clone, Debug, Serialize)]
pub struct Verdict {
    /// `core/NAME`
    pub stream: String,
    /// Whether the decoder did what the stream asks for.
    pub passed: bool,
    /// The difference; empty where the decoder passed.
    pub reason: String,
}

/// Compares the outcome of a decoder with the description of the stream.
pub fn judge(stream: &Stream, outcome: &Outcome) -> Verdict {
    let reason = match (&stream.description.rule, outcome) {
        (_, Outcome::NotRun(reason)) => reason.clone(),
        (Some(rule), Outcome::Frames(_)) => format!("decoded, though it breaks {rule}"),
        (Some(expected), Outcome::Refused { rule: Some(rule), message }) if rule != expected => {
            format!("refused by {rule}, not by {expected}: {message}")
        }
        // A foreign decoder names no rule.
        (Some(_), Outcome::Refused { .. }) => String::new(),
        (None, Outcome::Refused { message, .. }) => format!("refused: {message}"),
        (None, Outcome::Frames(lines)) => difference(&stream.description.frames, lines),
    };
    Verdict { stream: stream.name.clone(), passed: reason.is_empty(), reason }
}

fn difference(expected: &[String], found: &[String]) -> String {
    if let Some(line) = expected.iter().zip(found).position(|(a, b)| a != b) {
        return format!("frame {line}: expected {}, found {}", expected[line], found[line]);
    }
    if expected.len() == found.len() {
        String::new()
    } else {
        format!("{} frames, not {}", found.len(), expected.len())
    }
}

/// The verdicts on a corpus.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Report {
    /// Verdicts in the order of the corpus.
    pub verdicts: Vec<Verdict>,
}

impl Report {
    /// Runs a decoder over all streams, `threads` of them at once.
    pub fn run(
        streams: &[Stream],
        threads: NonZero<usize>,
        decode: impl Fn(&Path) -> Outcome + Sync,
    ) -> Self {
        let verdicts: Vec<_> = streams.iter().map(|_| OnceLock::new()).collect();
        let next = AtomicUsize::new(0);
        let work = || {
            // Streams differ in size a hundred times: each thread takes the next that nobody has.
            loop {
                let place = next.fetch_add(1, Ordering::Relaxed);
                let Some(stream) = streams.get(place) else { return };
                verdicts[place].get_or_init(|| judge(stream, &decode(&stream.path)));
            }
        };
        thread::scope(|scope| (0..threads.get()).for_each(|_| drop(scope.spawn(work))));
        Self { verdicts: verdicts.into_iter().filter_map(OnceLock::into_inner).collect() }
    }

    /// Whether every stream passed.
    pub fn passed(&self) -> bool {
        self.verdicts.iter().all(|verdict| verdict.passed)
    }
}

impl fmt::Display for Report {
    /// A line for each stream, then the counts by folder.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.verdicts.iter().map(|v| v.stream.len()).max().unwrap_or(0);
        for verdict in &self.verdicts {
            let word = if verdict.passed { "ok" } else { "FAILED" };
            writeln!(f, "{:width$}  {word}  {}", verdict.stream, verdict.reason)?;
        }
        for folder in FOLDERS {
            let of_folder = |v: &&Verdict| v.stream.starts_with(folder);
            let all = self.verdicts.iter().filter(of_folder).count();
            let passed = self.verdicts.iter().filter(of_folder).filter(|v| v.passed).count();
            writeln!(f, "{folder}: {passed} of {all} passed")?;
        }
        Ok(())
    }
}
