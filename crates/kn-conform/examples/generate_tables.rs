//! Writes the Rust tables of kn-bitstream from the CSV tables of `spec/tables`.

use kn_conform::tables;

const SPEC: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../spec/tables");
const RUST: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../kn-bitstream/src/tables");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let cauchy = std::fs::read_to_string(format!("{SPEC}/cauchy_huffman.csv"))?;
    std::fs::write(format!("{RUST}/cauchy.rs"), tables::cauchy_source(&cauchy)?)?;
    let levels = std::fs::read_to_string(format!("{SPEC}/levels.csv"))?;
    std::fs::write(format!("{RUST}/levels.rs"), tables::levels_source(&levels)?)?;
    Ok(())
}
