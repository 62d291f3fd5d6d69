//! Flags of the commands that read sequences of mesh files: which files are frames.

use crate::choices;
use kn_io::{Missing, ReadOptions};
use std::num::NonZeroU16;

/// Which files of a sequence are its frames. A stream has the frames that it has.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct FrameFiles {
    /// Where the numbers of the files have a gap
    #[arg(long, value_parser = choices::named::<Missing>(), value_name = "WHAT", default_value_t)]
    missing: Missing,
    /// Take every Nth file, from the first on
    #[arg(long, value_name = "N", default_value = "1", hide_default_value = true)]
    every: NonZeroU16,
}

impl FrameFiles {
    /// The choice of a configuration file.
    pub(crate) fn new(missing: Option<Missing>, every: Option<NonZeroU16>) -> Self {
        Self { missing: missing.unwrap_or_default(), every: every.unwrap_or(NonZeroU16::MIN) }
    }

    /// The flags that choose the same.
    pub(crate) fn flags(&self) -> Vec<String> {
        let missing =
            (self.missing != Missing::default()).then(|| format!("--missing={}", self.missing));
        let every = (self.every.get() > 1).then(|| format!("--every={}", self.every));
        missing.into_iter().chain(every).collect()
    }

    /// The options of a reader with these files. Frames may be empty.
    pub(crate) fn options(&self, options: ReadOptions) -> ReadOptions {
        ReadOptions {
            allow_empty: true,
            missing: self.missing,
            every: self.every.into(),
            ..options
        }
    }
}
