//! `kn conform`: checks decoders and streams against the specification.

use crate::Outcome;
use crate::output::{print, print_json};
use crate::specification;
use crate::stream;
use anyhow::{Context, Result, bail, ensure};
use kn_conform::{Report, load_corpus, run_foreign, run_ours_on};
use serde::Serialize;
use serde_json::json;
use std::fmt::Display;
use std::io::Read;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// Run a decoder over the conformance streams, or check one stream
#[derive(Debug, clap::Args)]
#[command(after_help = "\
A decoder conforms if for every stream in core/ and uncommon/ it prints the expected line per frame
(`index kind #V #F sha256`) and exits with 0, and for every stream in faulty/ it exits with another
code. Without --decoder the decoder of this program is checked. --threads says how many
decoders run at once. FOLDER is spec/conformance of kn's
sources.

A stream obeys the specification if this decoder, the syntax tables and a literal decoder accept it
and agree. They read the folder spec/ of kn's sources: run the command there, or name the folder
with --spec. The literal decoder needs time and memory.

Exit codes: 0 it conforms, 1 it does not, 2 an error.

Examples:
  kn conform spec/conformance
  kn conform spec/conformance --decoder 'python3 spec/reference/kn_decode.py'
  kn conform spec/conformance --json
  kn conform --stream dance.knm --spec ~/kn/spec
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
    /// {passed, frames, findings: [{reader, passed, rule, reason}]}, or {stages: [line]}
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &ConformArguments) -> Result<Outcome> {
    if let Some(file) = &arguments.stages {
        return print_stages(file, &arguments.spec, arguments.json);
    }
    if let Some(file) = &arguments.stream {
        let report = specification::load(&arguments.spec)?.check_stream(&read(file)?);
        return print_report(&report, report.passed, arguments.json);
    }
    let Some(corpus) = &arguments.corpus else { bail!("name a folder of streams") };
    let streams = load_corpus(corpus)?;
    ensure!(!streams.is_empty(), "{}: there is no stream in this folder", corpus.display());
    let limit = Duration::from_secs(u64::from(arguments.timeout));
    if let Some(command) = &arguments.decoder {
        check_runs(command)?;
    }
    let threads = NonZero::new(rayon::current_num_threads()).unwrap_or(NonZero::<usize>::MIN);
    let report = match &arguments.decoder {
        Some(command) => {
            Report::run(&streams, threads, |path: &Path| run_foreign(command, path, limit))
        }
        None => Report::run(&streams, NonZero::<usize>::MIN, run_ours_on),
    };
    print_report(&report, report.passed(), arguments.json)
}

/// Whether a decoder can be started at all: else no verdict would be about it.
fn check_runs(command: &str) -> Result<()> {
    let mut words = command.split_whitespace();
    let program = words.next().context("--decoder: there is no command")?;
    let mut decoder = Command::new(program);
    decoder.args(words).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut child =
        decoder.spawn().with_context(|| format!("--decoder: {program} cannot be run"))?;
    // It was given no stream: whatever it does about that is of no interest.
    let _ = child.kill();
    child.wait().map(drop).with_context(|| program.to_owned())
}

fn read(file: &Path) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    stream::open(file)?.read_to_end(&mut bytes).with_context(|| stream::name_of(file))?;
    Ok(bytes)
}

/// Digests of the literal reading, with which the decoder agrees on every frame.
fn print_stages(file: &Path, spec: &Path, json: bool) -> Result<Outcome> {
    let literal = specification::load(spec)?.reconstruct(&read(file)?);
    let literal = literal.with_context(|| stream::name_of(file))?;
    if json {
        print_json(&json!({ "stages": literal.stages }))?;
    } else {
        print(|out| Ok(literal.stages.iter().try_for_each(|line| writeln!(out, "{line}"))?))?;
    }
    Ok(Outcome::Good)
}

fn print_report(report: &(impl Serialize + Display), passed: bool, json: bool) -> Result<Outcome> {
    if json {
        print_json(report)?;
    } else {
        print(|out| Ok(write!(out, "{report}")?))?;
    }
    Ok(if passed { Outcome::Good } else { Outcome::Bad })
}
