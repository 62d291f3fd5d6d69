//! `kn conform`: holds decoders and streams to the specification.

use crate::Outcome;
use crate::stream::{self, Source};
use anyhow::{Context, Result, bail, ensure};
use kn_conform::{Report, Spec, load_corpus, run_foreign, run_ours_on};
use serde::Serialize;
use std::fmt::Display;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Run a decoder over the conformance streams, or check one stream
#[derive(Debug, clap::Args)]
#[command(after_help = "\
A decoder conforms if for every stream in core/ and uncommon/ it prints the expected line per frame
(`index kind #V #F sha256`) and exits with 0, and for every stream in faulty/ it exits with another
code. Without --decoder it is the decoder of this program.

A stream obeys the specification if this decoder, the syntax tables and a literal reading of the text
take it and agree. They need the folder of the specification, and the last one time and memory.

Exit codes: 0 it conforms, 1 it does not, 2 an error.

Examples:
  kn conform spec/conformance
  kn conform spec/conformance --decoder 'python3 spec/reference/kn_decode.py'
  kn conform spec/conformance --json
  kn conform --stream dance.knm
  kn conform --stages spec/conformance/core/groups.knm")]
pub(crate) struct ConformArguments {
    /// The folder with core/, uncommon/ and faulty/
    #[arg(value_name = "FOLDER", required_unless_present_any = ["stream", "stages"])]
    corpus: Option<PathBuf>,
    /// Run this command, followed by the file, instead of the decoder of this program
    #[arg(long, value_name = "COMMAND", requires = "corpus")]
    decoder: Option<String>,
    /// Seconds that the decoder may take for one stream
    #[arg(long, value_name = "SECONDS", default_value = "60", requires = "decoder")]
    timeout: u32,
    /// Check this stream instead of a decoder; - is standard input
    #[arg(long, value_name = "FILE", conflicts_with = "corpus")]
    stream: Option<PathBuf>,
    /// Print the digests of the stages of this stream's frames: nodes, influence, transforms,
    /// predicted, reconstructed
    #[arg(long, value_name = "FILE", conflicts_with_all = ["corpus", "stream"])]
    stages: Option<PathBuf>,
    /// The folder of the specification, for --stream and --stages
    #[arg(long, value_name = "FOLDER", default_value = "spec")]
    spec: PathBuf,
    /// Print JSON: {verdicts: [{stream, passed, reason}]}, or of a stream
    /// {passed, frames, findings: [{reader, passed, rule, reason}]}
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &ConformArguments) -> Result<Outcome> {
    if let Some(file) = &arguments.stages {
        return print_stages(file, &arguments.spec);
    }
    if let Some(file) = &arguments.stream {
        let report = Spec::load(&arguments.spec)?.check_stream(&read(file)?);
        return print(&report, report.passed, arguments.json);
    }
    let Some(corpus) = &arguments.corpus else { bail!("no folder and no stream") };
    let streams = load_corpus(corpus)?;
    ensure!(!streams.is_empty(), "{}: there is no stream in this folder", corpus.display());
    let limit = Duration::from_secs(u64::from(arguments.timeout));
    let report = match &arguments.decoder {
        Some(command) => Report::run(&streams, |path: &Path| run_foreign(command, path, limit)),
        None => Report::run(&streams, run_ours_on),
    };
    print(&report, report.passed(), arguments.json)
}

fn read(file: &Path) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    Source::open(file)?.read_to_end(&mut bytes).with_context(|| stream::name_of(file))?;
    Ok(bytes)
}

/// Digests of the literal reading, with which the decoder agrees on every frame.
fn print_stages(file: &Path, spec: &Path) -> Result<Outcome> {
    let literal = Spec::load(spec)?.reconstruct(&read(file)?);
    let literal = literal.with_context(|| stream::name_of(file))?;
    let mut out = io::stdout().lock();
    literal.stages.iter().try_for_each(|line| writeln!(out, "{line}"))?;
    Ok(Outcome::Good)
}

fn print(report: &(impl Serialize + Display), passed: bool, json: bool) -> Result<Outcome> {
    let mut out = io::stdout().lock();
    if json {
        serde_json::to_writer_pretty(&mut out, report)?;
        writeln!(out)?;
    } else {
        write!(out, "{report}")?;
    }
    Ok(if passed { Outcome::Good } else { Outcome::Bad })
}
