//! `kn assemble`: makes streams from text by the specification's syntax tables.

use crate::Outcome;
use crate::output::write_file;
use crate::outputs::Outputs;
use crate::specification;
use crate::stream;
use anyhow::{Context, Result};
use kn_conform::node_labels;
use std::io::Read;
use std::path::PathBuf;

/// Make a stream from a text of syntax elements, also one that no encoder would write
#[derive(Debug, clap::Args)]
#[command(after_help = "\
A text has lines `name = values` in the order of the syntax tables; sizes, CRCs and the index may
be left out. The streams in spec/conformance have such texts beside them. The tables are read from
the folder spec/ of kn's sources: run the command there, or name the folder with --spec.

Examples:
  kn assemble x.txt -o x.knm
  kn assemble dance.knm --reverse -o dance.txt --spec ~/kn/spec")]
pub(crate) struct AssembleArguments {
    /// The text; - is standard input
    #[arg(value_name = "FILE")]
    input: PathBuf,
    /// The stream to write; - is standard output
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// The folder of the specification, whose tables are interpreted
    #[arg(long, value_name = "FOLDER", default_value = "spec")]
    spec: PathBuf,
    /// Make the text of a stream instead
    #[arg(long)]
    reverse: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &AssembleArguments) -> Result<Outcome> {
    let name = stream::name_of(&arguments.input);
    Outputs::beside([arguments.input.as_path()]).file("--output", &arguments.output)?;
    let spec = specification::load(&arguments.spec)?;
    let mut input = Vec::new();
    let mut source = stream::open(&arguments.input)?;
    source.read_to_end(&mut input).with_context(|| name.clone())?;
    let output = if arguments.reverse {
        spec.disassemble(&input, &node_labels).with_context(|| name)?.into_bytes()
    } else {
        let text = String::from_utf8(input).with_context(|| name.clone())?;
        spec.assemble(&text, &node_labels).with_context(|| name)?
    };
    write_file(&arguments.output, |out| Ok(out.write_all(&output)?))?;
    Ok(Outcome::Good)
}
