//! The `kn` command: encode, decode, inspect, measure and check scanned human dynamic meshes.

mod arguments;
mod choices;
mod commands;
mod faults;
mod frames;
mod heatmap;
mod interrupt;
mod nearest;
mod output;
mod outputs;
mod picture;
mod progress;
mod settings;
mod specification;
mod stream;
mod table;

use anyhow::Context;
use arguments::{Arguments, Global};
use clap::Parser;
use std::io;
use std::process::ExitCode;

/// The outcome of a command that could do its work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    /// Done, equal, conforming: exit code 0.
    Good,
    /// A difference or a failed check: exit code 1.
    Bad,
}

/// Exit code of everything that kept a command from doing its work.
const ERROR: u8 = 2;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    faults::keep_silent();
    let done = prepare(&arguments.global)
        .and_then(|()| faults::caught(|| commands::run(&arguments.command, &arguments.global)));
    match done {
        Ok(Outcome::Good) => ExitCode::SUCCESS,
        Ok(Outcome::Bad) => ExitCode::FAILURE,
        // Whoever reads our output has seen enough (`kn dump x.knm | head`).
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("kn: error: {}", message(&error));
            faults::tell();
            ExitCode::from(ERROR)
        }
    }
}

/// Threads and Ctrl-C, before any work.
fn prepare(global: &Global) -> anyhow::Result<()> {
    interrupt::install()?;
    let threads = global.threads.map_or(0, |threads| usize::from(threads.get()));
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global()
        .context("cannot start the threads")
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        let own = cause.downcast_ref().map(io::Error::kind);
        let inside = cause.downcast_ref().and_then(serde_json::Error::io_error_kind);
        own.or(inside) == Some(io::ErrorKind::BrokenPipe)
    })
}

/// The chain of causes in one line; a cause that its context has already told is not repeated.
fn message(error: &anyhow::Error) -> String {
    let mut message = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if message.is_empty() {
            message = cause;
        } else if !message.ends_with(&cause) {
            message = format!("{message}: {cause}");
        }
    }
    message
}
