//! Maintains the data of the specification in this checkout: `cargo run --release -p kn-corpus -- COMMAND`.

mod cauchy;
mod flip;
mod streams;

use anyhow::{Result, bail};
use kn_corpus::{coverage, examples, rust_tables};
use std::path::Path;

const USAGE: &str = "\
usage: kn-corpus COMMAND

  streams                           make spec/conformance anew
  coverage                          write spec/coverage.md
  examples                          write spec/examples.json
  cauchy [--check|--write|--loss]   print, check or write spec/tables/cauchy_huffman.csv from the
                                    Cauchy density, or print what it costs
  tables                            write the tables of kn-bitstream from spec/tables
  flip [--list|N]                   flip every number of the tables and of kn-deform, from the Nth
                                    on, and count those that no test notices";

fn main() -> Result<()> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["streams"] => streams::write(root),
        ["coverage"] => coverage::write(root),
        ["examples"] => examples::write(root),
        ["cauchy"] => cauchy::run(root, None),
        ["cauchy", option] => cauchy::run(root, Some(option)),
        ["tables"] => rust_tables::write(root),
        ["flip"] => flip::run(root, ""),
        ["flip", argument] => flip::run(root, argument),
        _ => bail!("{USAGE}"),
    }
}
