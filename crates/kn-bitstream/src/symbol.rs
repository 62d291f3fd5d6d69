//! The entropy coding of a P-frame's values. `MotionFrame` says which values a frame has; an
//! [`EntropyMode`] says how they become bits, through a [`SymbolCoder`].

use crate::error::Error;
use crate::huffman::{TABLE_COUNT, cauchy_table};
use crate::reader::BitReader;
use crate::rule::{self, Rule};
use crate::writer::BitWriter;
use std::convert::Infallible;
use std::ops::RangeInclusive;

/// The lists of values in a P-frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueList {
    /// Changes of the translations, one for each part.
    TranslationChange,
    /// Translations, less their predictions.
    Translation,
    /// Rotations.
    Rotation,
    /// Scales, less 1.
    Scale,
    /// Shears.
    Shear,
}

impl ValueList {
    /// Name of the syntax element.
    fn name(self) -> &'static str {
        match self {
            Self::TranslationChange => "translation_change",
            Self::Translation => "translation",
            Self::Rotation => "rotation",
            Self::Scale => "scale",
            Self::Shear => "shear",
        }
    }
}

/// One value of a P-frame: everything that both sides know of it before it is coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// The list that it belongs to.
    pub list: ValueList,
    /// Its entry in the list.
    pub entry: u32,
    /// Its coordinate, 0 to 2.
    pub axis: u32,
    /// Huffman table of the list.
    pub table: u8,
}

/// Codes one value after another. Code that is generic over it describes reading, writing and
/// counting bits at once, as with [`crate::range::BinaryCoder`].
pub trait SymbolCoder {
    /// The reason why a value cannot be coded.
    type Error;

    /// Codes `value` and returns it. A reader ignores `value` and returns what it reads.
    ///
    /// # Errors
    /// A reader's: the data ends, or holds no value.
    fn symbol(&mut self, symbol: Symbol, value: i32) -> Result<i32, Self::Error>;

    /// Refuses the last value unless `holds`. Only a reader does.
    ///
    /// # Errors
    /// A reader's: the value breaks `rule`.
    fn require(&self, holds: bool, rule: Rule) -> Result<(), Self::Error>;
}

/// The entropy coding of the values of a P-frame (`entropy_mode`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum EntropyMode {
    /// Cauchy-based Huffman codes.
    #[default]
    Huffman,
}

impl EntropyMode {
    pub(crate) fn read(bits: &mut BitReader<'_, '_>) -> Result<Self, Error> {
        let mode = bits.u("entropy_mode", 1)?;
        bits.require_supported(mode == 0, rule::MOTION_ENTROPY_KNOWN)?;
        Ok(Self::Huffman)
    }

    pub(crate) fn write(self, bits: &mut BitWriter) {
        bits.u(self as u64, 1);
    }

    /// Reads `lists` in their order into `values`, whose buffers are reused.
    pub(crate) fn read_lists<const N: usize>(
        self,
        bits: &mut BitReader<'_, '_>,
        lists: &[List; N],
        values: [&mut Vec<[i32; 3]>; N],
    ) -> Result<(), Error> {
        match self {
            Self::Huffman => read_lists(&mut HuffmanReader { bits }, lists, values),
        }
    }

    /// Writes the values of `lists` in their order; the mirror of [`Self::read_lists`].
    pub(crate) fn write_lists<const N: usize>(
        self,
        bits: &mut BitWriter,
        lists: &[List; N],
        values: [&[[i32; 3]]; N],
    ) {
        match self {
            Self::Huffman => write_lists(&mut HuffmanWriter { bits }, lists, values),
        }
    }

    /// Number of bits of `values` in a list with table `table`.
    pub fn bits(self, list: ValueList, values: &[[i32; 3]], table: u8) -> u64 {
        match self {
            Self::Huffman => {
                let mut counter = HuffmanCounter::default();
                let count = values.len() as u32;
                write_lists(&mut counter, &[List { list, count, table, bounds: None }], [values]);
                counter.bits
            }
        }
    }

    /// The table that codes `lists` together in the fewest bits, the lowest of equals, and the
    /// number of bits.
    pub fn best_table(self, lists: &[(ValueList, &[[i32; 3]])]) -> (u8, u64) {
        let bits = |table: u8| -> u64 {
            lists.iter().map(|&(list, values)| self.bits(list, values, table)).sum()
        };
        let tables = (0..TABLE_COUNT).map(|table| (table, bits(table)));
        tables.min_by_key(|&(_, bits)| bits).unwrap_or((0, 0))
    }
}

/// One list of quantised triples.
#[derive(Clone, Debug)]
pub(crate) struct List {
    pub(crate) list: ValueList,
    /// Number of triples.
    pub(crate) count: u32,
    pub(crate) table: u8,
    /// None where the bounds are those of the sum with a prediction, which the decoder checks.
    pub(crate) bounds: Option<Bounds>,
}

/// The range of value · step, and its rule.
#[derive(Clone, Debug)]
pub(crate) struct Bounds {
    pub(crate) step: i64,
    pub(crate) range: RangeInclusive<i64>,
    pub(crate) rule: Rule,
}

impl List {
    /// Codes `values`, and hands what comes out to `coded`.
    #[inline]
    fn code<C: SymbolCoder>(
        &self,
        coder: &mut C,
        values: impl Iterator<Item = [i32; 3]>,
        mut coded: impl FnMut([i32; 3]),
    ) -> Result<(), C::Error> {
        for (entry, mut triple) in (0..).zip(values) {
            for axis in 0..3 {
                let symbol = Symbol { list: self.list, entry, axis, table: self.table };
                let value = coder.symbol(symbol, triple[axis as usize])?;
                if let Some(bounds) = &self.bounds {
                    let inside = bounds.range.contains(&(i64::from(value) * bounds.step));
                    coder.require(inside, bounds.rule)?;
                }
                triple[axis as usize] = value;
            }
            coded(triple);
        }
        Ok(())
    }
}

fn read_lists<C: SymbolCoder, const N: usize>(
    coder: &mut C,
    lists: &[List; N],
    values: [&mut Vec<[i32; 3]>; N],
) -> Result<(), C::Error> {
    for (list, values) in lists.iter().zip(values) {
        values.clear();
        let unknown = (0..list.count).map(|_| [0; 3]);
        list.code(coder, unknown, |triple| values.push(triple))?;
    }
    Ok(())
}

/// Out-of-range values are written as they are, see [`BitWriter`].
fn write_lists<C: SymbolCoder<Error = Infallible>, const N: usize>(
    coder: &mut C,
    lists: &[List; N],
    values: [&[[i32; 3]]; N],
) {
    for (list, values) in lists.iter().zip(values) {
        let Ok(()) = list.code(coder, values.iter().copied(), |_| {});
    }
}

struct HuffmanReader<'b, 'a, 't> {
    bits: &'b mut BitReader<'a, 't>,
}

impl SymbolCoder for HuffmanReader<'_, '_, '_> {
    type Error = Error;

    #[inline]
    fn symbol(&mut self, symbol: Symbol, _value: i32) -> Result<i32, Error> {
        let name = (symbol.list.name(), symbol.entry, symbol.axis);
        self.bits.huffman(name, cauchy_table(symbol.table))
    }

    #[inline]
    fn require(&self, holds: bool, rule: Rule) -> Result<(), Error> {
        self.bits.require(holds, rule)
    }
}

struct HuffmanWriter<'b> {
    bits: &'b mut BitWriter,
}

impl SymbolCoder for HuffmanWriter<'_> {
    type Error = Infallible;

    #[inline]
    fn symbol(&mut self, symbol: Symbol, value: i32) -> Result<i32, Infallible> {
        self.bits.huffman(value, cauchy_table(symbol.table));
        Ok(value)
    }

    #[inline]
    fn require(&self, _holds: bool, _rule: Rule) -> Result<(), Infallible> {
        Ok(())
    }
}

/// Counts the bits that a [`HuffmanWriter`] would write.
#[derive(Default)]
struct HuffmanCounter {
    bits: u64,
}

impl SymbolCoder for HuffmanCounter {
    type Error = Infallible;

    #[inline]
    fn symbol(&mut self, symbol: Symbol, value: i32) -> Result<i32, Infallible> {
        self.bits += u64::from(cauchy_table(symbol.table).code_length(value));
        Ok(value)
    }

    #[inline]
    fn require(&self, _holds: bool, _rule: Rule) -> Result<(), Infallible> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const HUFFMAN: EntropyMode = EntropyMode::Huffman;

    #[test]
    fn the_best_table_grows_with_the_values() {
        let best = |values: &[[i32; 3]]| HUFFMAN.best_table(&[(ValueList::Shear, values)]).0;
        assert_eq!(best(&[[0; 3]; 50]), 0);
        let wide: Vec<[i32; 3]> = (-500..500).map(|v| [v; 3]).collect();
        let narrow: Vec<[i32; 3]> = (-500..500).map(|v| [v / 100; 3]).collect();
        assert!(best(&wide) > best(&narrow) + 10);
    }

    proptest! {
        #[test]
        fn as_many_bits_are_written_as_counted(
            values in prop::collection::vec(prop::array::uniform3(-(1 << 19)..1 << 19), 0..40),
            shift in 0..20,
            table in 0..TABLE_COUNT,
        ) {
            let values: Vec<[i32; 3]> = values.iter().map(|v| v.map(|c| c >> shift)).collect();
            let list =
                List { list: ValueList::Scale, count: values.len() as u32, table, bounds: None };
            let mut bits = BitWriter::new();
            HUFFMAN.write_lists(&mut bits, &[list], [&values]);
            prop_assert_eq!(bits.position(), HUFFMAN.bits(ValueList::Scale, &values, table));
        }
    }
}
