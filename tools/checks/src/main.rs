//! Checks and figures of the sources, without a build of them.
//!
//! `cargo run -p kn-checks -- COMMAND`:
//!
//! - `api [--accept]` compares the public items of the published crates with `docs/api/CRATE.txt`.
//!   `--accept` writes these files: a change of the API is thus seen in a review.
//! - `structure [ROOT]` prints the figures of `docs/notes/structure.md` for a checkout.
//! - `rust-version` says which dependencies ask for a newer Rust than the workspace.

mod api;
mod public;
mod render;
mod rust_version;
mod source;
mod structure;
mod twins;

use anyhow::{Result, bail};
use std::path::Path;
use std::process::ExitCode;

fn main() -> Result<ExitCode> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let sound = match words[..] {
        ["api"] => api::check(root)?,
        ["api", "--accept"] => api::accept(root)?,
        ["structure"] => structure::print(root)?,
        ["structure", other] => structure::print(Path::new(other))?,
        ["rust-version"] => rust_version::check(root)?,
        _ => bail!("usage: kn-checks api [--accept] | structure [ROOT] | rust-version"),
    };
    Ok(if sound { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
