//! The decoder alone under the contract of 9.7: `kn-frames FILE…` prints a line for each frame and
//! exits with 0, or with another value for a stream that it refuses.
//!
//! It needs neither threads nor an encoder, so that it builds for targets where `kn` does not.

use std::path::Path;
use std::process::ExitCode;

use kn_conform::{Outcome, run_ours_on};

fn main() -> ExitCode {
    let mut code = ExitCode::SUCCESS;
    for file in std::env::args().skip(1) {
        match run_ours_on(Path::new(&file)) {
            Outcome::Frames(lines) => lines.iter().for_each(|line| println!("{line}")),
            Outcome::Refused { message: reason, .. } | Outcome::NotRun(reason) => {
                eprintln!("{file}: {reason}");
                code = ExitCode::FAILURE;
            }
        }
    }
    code
}
