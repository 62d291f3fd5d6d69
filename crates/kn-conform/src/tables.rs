//! The CSV tables of `spec/tables`.

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
