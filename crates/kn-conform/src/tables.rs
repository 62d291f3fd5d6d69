//! The CSV tables of `spec/tables` and the Rust sources that are generated from them.

use std::fmt::Write as _;

/// A CSV table of unsigned integers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Rows, each as long as `columns`.
    pub rows: Vec<Vec<u64>>,
}

/// A CSV table that cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("line {line}: {reason}")]
pub struct TableError {
    line: usize,
    reason: String,
}

impl Table {
    /// Reads a table from CSV: a line of names, then lines of as many unsigned integers.
    pub fn parse(text: &str) -> Result<Self, TableError> {
        let mut lines = text.lines();
        let columns: Vec<_> = lines.next().unwrap_or("").split(',').map(str::to_owned).collect();
        let mut rows = Vec::new();
        for (number, line) in lines.enumerate() {
            let wrong = |reason: String| TableError { line: number + 2, reason };
            let row: Result<Vec<u64>, _> = line.split(',').map(str::parse).collect();
            let row = row.map_err(|error| wrong(error.to_string()))?;
            if row.len() != columns.len() {
                return Err(wrong(format!("{} cells, not {}", row.len(), columns.len())));
            }
            rows.push(row);
        }
        Ok(Self { columns, rows })
    }
}

/// `crates/kn-bitstream/src/tables/cauchy.rs` from `cauchy_huffman.csv`.
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
