//! Warnings about labels that came with the scans. Each warning is printed once.

use crate::arguments::Global;
use crate::parts;
use kn_segment::LabelWarning;
use std::path::{Path, PathBuf};

/// The warnings so far.
#[derive(Debug, Default)]
pub(super) struct LabelChecks(Vec<Oddity>);

/// One kind of oddity at one part.
#[derive(Debug)]
struct Oddity {
    first: LabelWarning,
    file: PathBuf,
    frame: usize,
    /// Later frames with the same.
    more: usize,
}

impl LabelChecks {
    /// Adds what is odd about a frame.
    pub(super) fn add(&mut self, file: &Path, frame: usize, warnings: Vec<LabelWarning>) {
        for warning in warnings {
            match self.0.iter_mut().find(|known| alike(known.first, warning)) {
                Some(known) => known.more += 1,
                None => {
                    let file = file.to_owned();
                    self.0.push(Oddity { first: warning, file, frame, more: 0 });
                }
            }
        }
    }

    /// Tells the user where each oddity is first, and in how many frames more.
    pub(super) fn tell(&self, global: &Global) {
        for Oddity { first, file, frame, more } in &self.0 {
            let again = match more {
                0 => String::new(),
                more => format!(" (and in {more} more frames)"),
            };
            let what = parts::oddity(*first);
            global.note(format_args!("{}: frame {frame}: labels: {what}{again}", file.display()));
        }
    }
}

/// Whether two oddities are of the same kind and about the same part.
fn alike(a: LabelWarning, b: LabelWarning) -> bool {
    match (a, b) {
        (LabelWarning::Split { part: a, .. }, LabelWarning::Split { part: b, .. }) => a == b,
        _ => a == b,
    }
}
