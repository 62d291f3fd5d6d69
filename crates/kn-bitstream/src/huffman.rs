//! The Cauchy-based Huffman codes. They are canonical codes from the normative tables.

use crate::tables::cauchy::{SHAPES, Shape};

/// Number of tables: `huffman(t)` takes t from 0 to one less.
pub const TABLE_COUNT: u8 = SHAPES.len() as u8;

/// Longest code of any table in bits.
const MAX_LENGTH: usize = 24;

/// A canonical Huffman code for the values 0, +1, −1, …, +M, −M and an escape.
///
/// In symbol order the lengths never fall, so a code is known from the number of symbols of each
/// length; the escape comes last among the symbols of its length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CauchyTable {
    max_magnitude: u32,
    escape_order: u32,
    escape_length: u32,
    shortest: u32,
    /// First code of each length.
    first_code: [u32; MAX_LENGTH + 1],
    /// First symbol of each length.
    first_symbol: [u32; MAX_LENGTH + 1],
    /// Codes of at most this length, left-aligned to 24 bits, lie below.
    limit: [u32; MAX_LENGTH + 1],
}

/// Returns table `index` of chapter 2, γ/Δ = 2^((index − 8)/4).
///
/// # Panics
/// Panics where `index` is not below [`TABLE_COUNT`].
pub fn cauchy_table(index: u8) -> &'static CauchyTable {
    &TABLES[usize::from(index)]
}

impl CauchyTable {
    /// Number of bits of `value` in this table, for estimates of rates.
    pub fn code_length(&self, value: i32) -> u32 {
        match value.unsigned_abs().checked_sub(self.max_magnitude + 1) {
            None => self.code_of(value).1,
            Some(beyond) => {
                let unary = (beyond + (1 << self.escape_order)).ilog2() - self.escape_order;
                self.escape_length + 2 * unary + 1 + self.escape_order + 1
            }
        }
    }

    /// M: the largest magnitude that has a code of its own.
    pub fn max_magnitude(&self) -> u32 {
        self.max_magnitude
    }

    /// Order of the Exp-Golomb code after an escape.
    pub fn escape_order(&self) -> u32 {
        self.escape_order
    }

    /// Code and length of a value, those of the escape for a magnitude above M.
    pub(crate) fn code_of(&self, value: i32) -> (u32, u32) {
        if value.unsigned_abs() > self.max_magnitude {
            let length = self.escape_length as usize;
            return ((self.limit[length] >> (MAX_LENGTH - length)) - 1, self.escape_length);
        }
        let symbol = if value > 0 { 2 * value - 1 } else { -2 * value } as u32;
        let mut length = self.shortest as usize;
        while length < MAX_LENGTH && symbol >= self.first_symbol[length + 1] {
            length += 1;
        }
        (self.first_code[length] + symbol - self.first_symbol[length], length as u32)
    }

    /// Symbol and length of the code that begins `window` (24 bits); `None` is the escape.
    #[inline]
    pub(crate) fn look_up(&self, window: u32) -> (Option<u32>, u32) {
        let mut length = self.shortest as usize;
        while length < MAX_LENGTH && window >= self.limit[length] {
            length += 1;
        }
        let code = window >> (MAX_LENGTH - length);
        let symbol = self.first_symbol[length] + code - self.first_code[length];
        let last = (self.limit[length] >> (MAX_LENGTH - length)) - 1;
        let escape = length as u32 == self.escape_length && code == last;
        (if escape { None } else { Some(symbol) }, length as u32)
    }

    /// The value that a symbol stands for: 0, +1, −1, +2, −2, …
    #[inline]
    pub(crate) fn value_of(&self, symbol: u32) -> i32 {
        let magnitude = symbol.div_ceil(2) as i32;
        if symbol % 2 == 1 { magnitude } else { -magnitude }
    }

    const fn new(shape: &Shape) -> Self {
        let mut table = Self {
            max_magnitude: shape.max_magnitude,
            escape_order: shape.escape_order,
            escape_length: shape.escape_length,
            shortest: 0,
            first_code: [0; MAX_LENGTH + 1],
            first_symbol: [0; MAX_LENGTH + 1],
            limit: [0; MAX_LENGTH + 1],
        };
        let (mut code, mut symbol, mut length) = (0, 0, 1);
        while length <= MAX_LENGTH {
            code *= 2;
            table.first_code[length] = code;
            table.first_symbol[length] = symbol;
            let symbols = shape.symbols[length - 1];
            let escape = (shape.escape_length == length as u32) as u32;
            code += symbols + escape;
            symbol += symbols;
            table.limit[length] = code << (MAX_LENGTH - length);
            if table.shortest == 0 && code > 0 {
                table.shortest = length as u32;
            }
            length += 1;
        }
        table
    }
}

static TABLES: [CauchyTable; SHAPES.len()] = {
    let mut tables = [CauchyTable::new(&SHAPES[0]); SHAPES.len()];
    let mut index = 1;
    while index < SHAPES.len() {
        tables[index] = CauchyTable::new(&SHAPES[index]);
        index += 1;
    }
    tables
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_leads_back_to_its_symbol() {
        for index in 0..TABLE_COUNT {
            let table = cauchy_table(index);
            let most = table.max_magnitude() as i32;
            for value in -most..=most {
                let (code, length) = table.code_of(value);
                let window = code << (MAX_LENGTH as u32 - length);
                let (symbol, found) = table.look_up(window);
                assert_eq!(symbol.map(|s| table.value_of(s)), Some(value), "table {index}");
                assert_eq!(found, length);
                assert_eq!(table.code_length(value), length);
            }
            let (code, length) = table.code_of(most + 1);
            let window = code << (MAX_LENGTH as u32 - length);
            assert_eq!(table.look_up(window), (None, length), "escape of table {index}");
        }
    }

    #[test]
    fn every_table_is_a_complete_code() {
        for (index, shape) in SHAPES.iter().enumerate() {
            let kraft = (1..=MAX_LENGTH).map(|length| {
                let escape = u64::from(shape.escape_length == length as u32);
                (u64::from(shape.symbols[length - 1]) + escape) << (MAX_LENGTH - length)
            });
            assert_eq!(kraft.sum::<u64>(), 1 << MAX_LENGTH, "table {index}");
            assert_eq!(shape.symbols.iter().sum::<u32>(), 2 * shape.max_magnitude + 1);
        }
    }
}
