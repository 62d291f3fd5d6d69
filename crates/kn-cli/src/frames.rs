//! Flags of the commands that read sequences of mesh files: which files are frames.

use clap::ValueEnum;
use kn_io::{Missing, ReadOptions};
use std::num::NonZeroU16;

/// Which files of a sequence are its frames. A stream has the frames that it has.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct FrameFiles {
    /// Where the numbers of the files have a gap
    #[arg(long, value_enum, value_name = "WHAT", default_value_t = MissingFrames::Fail)]
    missing: MissingFrames,
    /// Take every Nth file, from the first on
    #[arg(long, value_name = "N", default_value = "1", hide_default_value = true)]
    every: NonZeroU16,
}

/// What is done where a numbered sequence lacks a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum MissingFrames {
    /// It is an error
    Fail,
    /// The sequence goes on without the frame
    Skip,
    /// The frame before is shown again
    Hold,
}

impl From<MissingFrames> for Missing {
    fn from(missing: MissingFrames) -> Self {
        match missing {
            MissingFrames::Fail => Self::Fail,
            MissingFrames::Skip => Self::Skip,
            MissingFrames::Hold => Self::Hold,
        }
    }
}

impl FrameFiles {
    /// The choice of a configuration file.
    pub(crate) fn new(missing: Option<MissingFrames>, every: Option<NonZeroU16>) -> Self {
        Self {
            missing: missing.unwrap_or(MissingFrames::Fail),
            every: every.unwrap_or(NonZeroU16::MIN),
        }
    }

    /// The flags that choose the same.
    pub(crate) fn flags(&self) -> Vec<String> {
        let missing =
            self.missing.to_possible_value().filter(|_| self.missing != MissingFrames::Fail);
        let missing = missing.map(|value| format!("--missing={}", value.get_name()));
        let every = (self.every.get() > 1).then(|| format!("--every={}", self.every));
        missing.into_iter().chain(every).collect()
    }

    /// The options of a reader with these files. Frames may be empty.
    pub(crate) fn options(&self, options: ReadOptions) -> ReadOptions {
        ReadOptions {
            allow_empty: true,
            missing: self.missing.into(),
            every: self.every.into(),
            ..options
        }
    }
}
