//! The command line: every flag is defined once, with its help, in its command's file.

use crate::choices::count;
use crate::commands::Command;
use clap::Parser;
use std::num::NonZeroU16;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// A codec for scanned human dynamic meshes: one mesh a frame in, a small .knm file out, and back.
#[derive(Debug, Parser)]
#[command(
    name = "kn",
    version,
    propagate_version = true,
    after_help = "\
Exit codes: 0 done, or all checks hold; 1 a difference or a failed check; 2 an error.

Examples:
  kn encode 'scan/*.obj' -o dance.knm
  kn decode dance.knm -o out/
  kn demo"
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
    #[command(flatten)]
    pub(crate) global: Global,
}

/// Flags of every command.
#[derive(Debug, clap::Args)]
pub(crate) struct Global {
    /// Threads to use; results do not depend on it [default: all]
    #[arg(long, global = true, display_order = 900, value_name = "N", value_parser = count)]
    pub(crate) threads: Option<NonZeroU16>,
    /// Print errors and results only
    #[arg(short, long, global = true, display_order = 901)]
    pub(crate) quiet: bool,
}

impl Global {
    /// Prints a note for the user on standard error. Standard output is for data.
    pub(crate) fn note(&self, text: impl std::fmt::Display) {
        if !self.quiet {
            eprintln!("{text}");
        }
    }
}

/// Frames to work on: `5`, `3..7` (both included), `3..`, `..7`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FrameRange(RangeInclusive<u64>);

impl FrameRange {
    /// The first frame.
    pub(crate) fn first(&self) -> u64 {
        *self.0.start()
    }

    /// The last frame; `u64::MAX` where the range is open.
    pub(crate) fn last(&self) -> u64 {
        *self.0.end()
    }

    pub(crate) fn contains(&self, frame: u64) -> bool {
        self.0.contains(&frame)
    }
}

impl Default for FrameRange {
    /// All frames.
    fn default() -> Self {
        Self(0..=u64::MAX)
    }
}

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str, open: u64| match text {
            "" => Ok(open),
            digits => digits.parse().map_err(|_| format!("'{digits}' is not a frame number")),
        };
        let range = match text.split_once("..") {
            Some((first, last)) => number(first, 0)?..=number(last, u64::MAX)?,
            None if text.is_empty() => return Err("give frames, such as 5 or 3..7".into()),
            None => number(text, 0)?..=number(text, 0)?,
        };
        if range.is_empty() {
            return Err(format!("{text} has no frame: give the smaller number first"));
        }
        Ok(Self(range))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn frame_ranges_include_both_ends() {
        let range = |text: &str| text.parse::<FrameRange>().map(|range| range.0);
        assert_eq!(range("3..7"), Ok(3..=7));
        assert_eq!(range("5"), Ok(5..=5));
        assert_eq!(range("3.."), Ok(3..=u64::MAX));
        assert_eq!(range("..7"), Ok(0..=7));
        for bad in ["", "7..3", "a..b", "1...2", "-1"] {
            assert!(range(bad).is_err(), "{bad}");
        }
    }
}
