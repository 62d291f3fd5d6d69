//! `kn conform`: runs a decoder over the conformance streams.

use crate::Outcome;
use anyhow::{Result, ensure};
use kn_conform::{Report, load_corpus, run_foreign, run_ours};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Run a decoder over the conformance streams
#[derive(Debug, clap::Args)]
#[command(after_help = "\
A decoder conforms if for every stream in core/ and uncommon/ it prints the expected line per frame
(`index kind #V #F sha256`) and exits with 0, and for every stream in faulty/ it exits with another
code. Without --decoder it is the decoder of this program.

Exit codes: 0 it conforms, 1 it does not, 2 an error.

Examples:
  kn conform spec/conformance
  kn conform spec/conformance --decoder 'python3 spec/reference/decode.py'
  kn conform spec/conformance --json")]
pub(crate) struct ConformArguments {
    /// The folder with core/, uncommon/ and faulty/
    #[arg(value_name = "FOLDER")]
    corpus: PathBuf,
    /// Run this command, followed by the file, instead of the decoder of this program
    #[arg(long, value_name = "COMMAND")]
    decoder: Option<String>,
    /// Print JSON: {verdicts: [{stream, passed, reason}]}
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &ConformArguments) -> Result<Outcome> {
    let streams = load_corpus(&arguments.corpus)?;
    let found = !streams.is_empty();
    ensure!(found, "{}: there is no stream in this folder", arguments.corpus.display());
    let report = match &arguments.decoder {
        Some(command) => Report::run(&streams, |path: &Path| run_foreign(command, path)),
        None => Report::run(&streams, run_ours),
    };
    let mut out = io::stdout().lock();
    if arguments.json {
        serde_json::to_writer_pretty(&mut out, &report)?;
        writeln!(out)?;
    } else {
        write!(out, "{report}")?;
    }
    Ok(if report.passed() { Outcome::Good } else { Outcome::Bad })
}
