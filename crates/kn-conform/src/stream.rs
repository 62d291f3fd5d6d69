//! One stream: whether it obeys the specification, by our decoder and two readings of the text that
//! share no code with it. (The literal reading uses the tables' parser, labels and limits.)

use std::fmt;
use std::io::Cursor;

use serde::Serialize;

use crate::corpus::{Outcome, run_ours};
use crate::labels::node_labels;
use crate::product::stream_trace;
use crate::spec::Spec;
use crate::value::Failure;

/// The verdict of one reader on a stream.
#[derive(Clone, Debug, Serialize)]
pub struct Finding {
    /// `decoder`, `syntax tables` or `literal reading`.
    pub reader: &'static str,
    /// Whether it finds nothing wrong.
    pub passed: bool,
    /// The rule that is broken, where one is.
    pub rule: Option<String>,
    /// The error; empty where the reader accepts the stream.
    pub reason: String,
}

/// The verdict on a stream.
#[derive(Clone, Debug, Serialize)]
pub struct StreamReport {
    /// Whether every reader passes it.
    pub passed: bool,
    /// The lines of its frames (9.7), as far as the decoder gives them.
    pub frames: Vec<String>,
    /// One entry a reader.
    pub findings: Vec<Finding>,
}

impl Spec {
    /// Checks a stream against every rule that can be checked on it: the decoder, with all digests;
    /// the syntax tables with the ranges of the text; the literal reading of chapters 4 to 9.
    pub fn check_stream(&self, stream: &[u8]) -> StreamReport {
        let mut findings = Vec::new();
        let frames = match run_ours(Cursor::new(stream)) {
            Outcome::Frames(frames) => {
                findings.push(Finding::passed("decoder"));
                frames
            }
            Outcome::Refused { rule, message } => {
                findings.push(Finding::failed("decoder", rule, message));
                Vec::new()
            }
            Outcome::NotRun(reason) => {
                findings.push(Finding::failed("decoder", None, reason));
                Vec::new()
            }
        };
        let sound = findings[0].passed;
        findings.push(self.check_by_tables(stream, sound));
        findings.push(match self.reconstruct(stream) {
            Ok(literal) if sound && literal.frames != frames => {
                let reason = "it decodes to other frames than the decoder's".into();
                Finding::failed("literal reading", Some("conformance.exact".into()), reason)
            }
            Ok(_) => Finding::passed("literal reading"),
            Err(failure) => Finding::of_failure("literal reading", &failure),
        });
        let passed = findings.iter().all(|finding| finding.passed);
        StreamReport { passed, frames, findings }
    }

    fn check_by_tables(&self, stream: &[u8], sound: bool) -> Finding {
        const READER: &str = "syntax tables";
        match self.parse_strictly(stream, &node_labels) {
            (_, Err(failure)) => Finding::of_failure(READER, &failure),
            (trace, Ok(())) if sound && trace != stream_trace(stream).0 => {
                let reason = "they read other elements than the decoder".into();
                Finding::failed(READER, Some("conformance.exact".into()), reason)
            }
            _ => Finding::passed(READER),
        }
    }
}

impl Finding {
    fn passed(reader: &'static str) -> Self {
        Self { reader, passed: true, rule: None, reason: String::new() }
    }

    fn failed(reader: &'static str, rule: Option<String>, reason: String) -> Self {
        Self { reader, passed: false, rule, reason }
    }

    fn of_failure(reader: &'static str, failure: &Failure) -> Self {
        Self::failed(reader, failure.rule.map(|rule| rule.id().to_owned()), failure.to_string())
    }
}

impl fmt::Display for StreamReport {
    /// A line a reader, then the verdict.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for finding in &self.findings {
            let word = if finding.passed { "ok" } else { "FAILED" };
            let rule = finding.rule.as_deref().unwrap_or("");
            writeln!(f, "{:16} {word}  {rule}  {}", finding.reader, finding.reason)?;
        }
        let verdict = if self.passed { "obeys" } else { "does not obey" };
        writeln!(f, "the stream {verdict} the specification: {} frames", self.frames.len())
    }
}
