//! The Rust tables of kn-bitstream, generated from the CSV tables of `spec/tables`.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::Result;
use kn_conform::tables::{Table, TableError};

/// Writes `crates/kn-bitstream/src/tables` in the checkout at `root`.
///
/// # Errors
/// A table cannot be read, or a source cannot be written.
pub fn write(root: &Path) -> Result<()> {
    let (spec, rust) = (root.join("spec/tables"), root.join("crates/kn-bitstream/src/tables"));
    let cauchy = std::fs::read_to_string(spec.join("cauchy_huffman.csv"))?;
    std::fs::write(rust.join("cauchy.rs"), cauchy_source(&cauchy)?)?;
    let levels = std::fs::read_to_string(spec.join("levels.csv"))?;
    std::fs::write(rust.join("levels.rs"), levels_source(&levels)?)?;
    Ok(())
}

/// `crates/kn-bitstream/src/tables/cauchy.rs` from `cauchy_huffman.csv`.
///
/// # Errors
/// The text is no table of unsigned integers.
pub fn cauchy_source(csv: &str) -> Result<String, TableError> {
    let table = Table::parse(csv)?;
    let mut source = String::from(
        "//! The Cauchy-Huffman codes. Generated from `spec/tables/cauchy_huffman.csv`: do not edit.\n\n\
         /// Shape of one code; see [`crate::huffman::CauchyTable`].\n\
         pub(crate) struct Shape {\n    pub(crate) max_magnitude: u32,\n    \
         pub(crate) escape_order: u32,\n    pub(crate) escape_length: u32,\n    \
         /// Number of symbols of length 1, 2, …, without the escape.\n    \
         pub(crate) symbols: [u32; 24],\n}\n\n",
    );
    let _ = writeln!(source, "#[rustfmt::skip]");
    let _ = writeln!(source, "pub(crate) const SHAPES: [Shape; {}] = [", table.rows.len());
    for row in &table.rows {
        let _ = writeln!(
            source,
            "    Shape {{ max_magnitude: {}, escape_order: {}, escape_length: {}, symbols: {:?} }},",
            row[1],
            row[2],
            row[3],
            &row[4..]
        );
    }
    source.push_str("];\n");
    Ok(source)
}

/// `crates/kn-bitstream/src/tables/levels.rs` from `levels.csv`.
///
/// # Errors
/// The text is no table of unsigned integers.
pub fn levels_source(csv: &str) -> Result<String, TableError> {
    let table = Table::parse(csv)?;
    let mut source = String::from(
        "//! The limits of the levels. Generated from `spec/tables/levels.csv`: do not edit.\n\n\
         use crate::level::Level;\n\n",
    );
    let _ = writeln!(source, "#[rustfmt::skip]");
    let _ = writeln!(source, "pub(crate) const LEVELS: [Level; {}] = [", table.rows.len());
    for row in &table.rows {
        let cells = table.columns.iter().zip(row).skip(1);
        let fields: Vec<_> = cells.map(|(column, value)| format!("{column}: {value}")).collect();
        let _ = writeln!(source, "    Level {{ {} }},", fields.join(", "));
    }
    source.push_str("];\n");
    Ok(source)
}
