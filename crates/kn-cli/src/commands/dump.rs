//! `kn dump`: prints every syntax element of a stream.

use crate::Outcome;
use crate::output::print;
use crate::stream;
use anyhow::{Context, Result};
use kn_bitstream::{Element, Value};
use std::io::{self, Write};
use std::path::PathBuf;

/// Print every syntax element of a stream: bit offset, name, value
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Names are those of the syntax tables in spec/. A damaged stream is printed as far as it can be read.

Examples:
  kn dump dance.knm | less
  kn dump dance.knm | grep translation_step")]
pub(crate) struct DumpArguments {
    /// The stream; - is standard input
    #[arg(value_name = "FILE")]
    input: PathBuf,
    /// Print long byte strings whole, not only their beginning
    #[arg(long)]
    full: bool,
}

/// Bytes of a byte string that are printed without --full.
const SHOWN_BYTES: usize = 16;

/// Runs the command.
pub(crate) fn run(arguments: &DumpArguments) -> Result<Outcome> {
    let mut source = stream::open(&arguments.input)?;
    let decoded = print(|out| {
        let mut written = Ok(());
        let mut print = |element: &Element<'_>| {
            if written.is_ok() {
                written = print_element(out, element, arguments.full);
            }
        };
        let decoded = stream::decode_traced(&mut source, false, &mut print, |_| ());
        written?;
        Ok(decoded)
    })?;
    decoded.with_context(|| stream::name_of(&arguments.input))?;
    Ok(Outcome::Good)
}

fn print_element(out: &mut dyn Write, element: &Element<'_>, full: bool) -> io::Result<()> {
    let name = element.name.to_string();
    match element.value {
        Value::Bytes(bytes) if bytes.len() > SHOWN_BYTES && !full => {
            let start = Value::Bytes(&bytes[..SHOWN_BYTES]);
            writeln!(out, "{:>10}  {name:<28} {start}… ({} bytes)", element.bit, bytes.len())
        }
        value => writeln!(out, "{:>10}  {name:<28} {value}", element.bit),
    }
}
