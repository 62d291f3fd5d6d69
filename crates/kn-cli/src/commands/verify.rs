//! `kn verify`: are the decoded frames those that the encoder had?

use crate::arguments::Global;
use crate::output::print;
use crate::stream;
use crate::table::counted;
use crate::{Outcome, progress};
use anyhow::{Context, Result, bail};
use kn_bitstream::Element;
use kn_codec::DecodeErrorKind;
use std::path::PathBuf;

/// Check the digests inside a stream: decode every frame and compare
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Exit codes: 0 all digests match; 1 a frame differs from its digest; 2 the stream cannot be decoded,
or not every frame has a digest.

Examples:
  kn verify dance.knm
  kn verify - < dance.knm")]
pub(crate) struct VerifyArguments {
    /// The stream; - is standard input
    #[arg(value_name = "FILE")]
    input: PathBuf,
}

/// Runs the command.
pub(crate) fn run(arguments: &VerifyArguments, global: &Global) -> Result<Outcome> {
    let name = stream::name_of(&arguments.input);
    let mut source = stream::open(&arguments.input)?;
    let bar = progress::bar(global, "verifying", None);
    let (mut frames, mut digests) = (0_u64, 0_u64);
    let mut count_digests = |element: &Element<'_>| {
        digests += u64::from(element.name.text() == "positions_digest");
    };
    let decoded = stream::decode_traced(&mut source, true, &mut count_digests, |_| {
        frames += 1;
        bar.step();
    });
    drop(bar);
    match decoded {
        Err(error) if matches!(error.kind(), DecodeErrorKind::Digest { .. }) => {
            print(|out| Ok(writeln!(out, "{name}: {error}")?))?;
            Ok(Outcome::Bad)
        }
        Err(error) => Err(error).context(name),
        Ok(()) if digests < frames => {
            bail!("{name}: only {digests} of {frames} frames carry a digest")
        }
        Ok(()) => {
            print(|out| {
                Ok(writeln!(out, "{name}: {}, all digests match", counted(frames, "frame"))?)
            })?;
            Ok(Outcome::Good)
        }
    }
}
