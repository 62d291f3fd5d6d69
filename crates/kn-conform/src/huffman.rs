//! The Cauchy-Huffman codes, written from chapter 2 and the CSV table, and not made for speed.

use std::collections::HashMap;
use std::sync::OnceLock;

use crate::tables::Table;

/// The codes of all tables.
#[derive(Debug)]
pub(crate) struct Codes {
    rows: Vec<Vec<u64>>,
    built: Vec<OnceLock<Code>>,
}

/// One table's code.
#[derive(Debug)]
pub(crate) struct Code {
    pub(crate) max_magnitude: i64,
    pub(crate) escape_order: u32,
    /// (length, code) of a symbol; `None` is the escape.
    by_symbol: HashMap<Option<i64>, (u32, u64)>,
    by_code: HashMap<(u32, u64), Option<i64>>,
}

impl Codes {
    pub(crate) fn new(table: &Table) -> Self {
        let built = table.rows.iter().map(|_| OnceLock::new()).collect();
        Self { rows: table.rows.clone(), built }
    }

    pub(crate) fn code(&self, index: i128) -> Option<&Code> {
        let index = usize::try_from(index).ok()?;
        let row = self.rows.get(index)?;
        Some(self.built[index].get_or_init(|| Code::new(row)))
    }
}

impl Code {
    fn new(row: &[u64]) -> Self {
        let max_magnitude = row[1] as i64;
        let counts = &row[4..];
        let mut lengths = counts.iter().zip(1..).flat_map(|(&n, length)| vec![length; n as usize]);
        let values = std::iter::once(0).chain((1..=max_magnitude).flat_map(|m| [m, -m]));
        let mut symbols: Vec<(u32, Option<i64>)> =
            values.map(|value| (lengths.next().unwrap_or(0), Some(value))).collect();
        symbols.push((row[3] as u32, None));
        // Stable: the symbols of a length stay in symbol order, the escape last.
        symbols.sort_by_key(|(length, _)| *length);
        let mut code = Self {
            max_magnitude,
            escape_order: row[2] as u32,
            by_symbol: HashMap::new(),
            by_code: HashMap::new(),
        };
        let (mut next, mut last_length) = (0_u64, 0);
        for (length, symbol) in symbols {
            next <<= length - last_length;
            code.by_symbol.insert(symbol, (length, next));
            code.by_code.insert((length, next), symbol);
            (next, last_length) = (next + 1, length);
        }
        code
    }

    pub(crate) fn symbol(&self, length: u32, code: u64) -> Option<Option<i64>> {
        self.by_code.get(&(length, code)).copied()
    }

    /// Length and code of a value, those of the escape beyond the largest magnitude.
    pub(crate) fn of_value(&self, value: i64) -> (u32, u64) {
        let known = self.by_symbol.get(&Some(value)).or_else(|| self.by_symbol.get(&None));
        known.copied().unwrap_or((0, 0))
    }
}
