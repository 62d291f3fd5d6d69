//! Writing of syntax elements: the descriptors of chapter 2.

use crate::huffman::CauchyTable;

/// Writes syntax elements, most significant bit first. The mirror of [`crate::BitReader`].
///
/// The writer does not check values. A value out of range gives a stream that a reader refuses.
#[derive(Debug, Default)]
pub struct BitWriter {
    bytes: Vec<u8>,
    /// The last `held` < 8 bits, right-aligned.
    partial: u64,
    held: u32,
}

impl BitWriter {
    /// Makes an empty writer.
    pub fn new() -> Self {
        Self::default()
    }

    /// Number of bits written.
    pub fn position(&self) -> u64 {
        8 * self.bytes.len() as u64 + u64::from(self.held)
    }

    /// `u(n)`, n ≤ 64.
    pub fn u(&mut self, value: u64, n: u32) {
        if n > 32 {
            self.put(value >> 32, n - 32);
        }
        self.put(value & 0xffff_ffff, n.min(32));
    }

    /// `u(1)` as a flag.
    pub fn flag(&mut self, value: bool) {
        self.put(u64::from(value), 1);
    }

    /// `uleb`: seven bits at a time, the least significant first, as few as will do.
    pub fn uleb(&mut self, mut value: u32) {
        while value >= 0x80 {
            self.put(u64::from(value & 0x7f | 0x80), 8);
            value >>= 7;
        }
        self.put(u64::from(value), 8);
    }

    /// `f64`: the 64 bits of an IEEE 754 binary64, sign first.
    pub fn f64(&mut self, value: f64) {
        self.u(value.to_bits(), 64);
    }

    /// `bytes(n)`. Every such element of the syntax begins at a byte boundary.
    pub fn bytes(&mut self, bytes: &[u8]) {
        debug_assert_eq!(self.held, 0, "bytes(n) begins at a byte boundary");
        self.bytes.extend_from_slice(bytes);
    }

    /// `rice(k)`; `value >> k` is at most [`crate::RICE_UNARY_LIMIT`].
    pub fn rice(&mut self, value: u32, k: u32) {
        let value = u64::from(value);
        self.put_unary((value >> k) as u32);
        self.put(value, k);
    }

    /// `srice(k)`: a zigzagged `rice(k)`.
    pub fn srice(&mut self, value: i32, k: u32) {
        self.rice(zigzag(value), k);
    }

    /// `huffman(t)`; `value` is below 2^20 in magnitude.
    pub fn huffman(&mut self, value: i32, table: &CauchyTable) {
        debug_assert!(value.unsigned_abs() < crate::HUFFMAN_VALUE_LIMIT);
        let beyond = value.unsigned_abs().checked_sub(table.max_magnitude() + 1);
        let (code, length) = table.code_of(value);
        self.put(u64::from(code), length);
        if let Some(beyond) = beyond {
            self.put_ue(beyond, table.escape_order());
            self.flag(value < 0);
        }
    }

    /// Writes zero bits up to the next byte boundary.
    pub fn byte_align(&mut self) {
        if self.held > 0 {
            self.put(0, 8 - self.held);
        }
    }

    /// Aligns the writer and returns its bytes.
    pub fn into_bytes(mut self) -> Vec<u8> {
        self.byte_align();
        self.bytes
    }

    fn put_ue(&mut self, value: u32, k: u32) {
        let shifted = u64::from(value) + (1 << k);
        let unary = shifted.ilog2() - k;
        self.put_unary(unary);
        self.put(shifted, unary + k);
    }

    fn put_unary(&mut self, ones: u32) {
        debug_assert!(ones <= 32);
        self.put((1 << (ones + 1)) - 2, ones + 1);
    }

    /// The low n ≤ 56 bits of `value`.
    fn put(&mut self, value: u64, n: u32) {
        self.partial = self.partial << n | value & ((1 << n) - 1);
        self.held += n;
        while self.held >= 8 {
            self.held -= 8;
            self.bytes.push((self.partial >> self.held) as u8);
        }
    }
}

/// 0, 1, 2, 3, … from 0, −1, 1, −2, …
pub(crate) fn zigzag(value: i32) -> u32 {
    (value << 1 ^ value >> 31) as u32
}

/// The Rice parameter that codes `values` in the fewest bits, the smallest of equals.
///
/// A parameter that would need a longer unary part than allowed is passed over.
pub fn best_rice(values: impl Iterator<Item = u32> + Clone) -> u32 {
    let bits = |k: u32| -> u64 {
        let unary = values.clone().map(|value| u64::from(value >> k));
        let longest = unary.clone().max().unwrap_or(0);
        let too_long = longest > u64::from(crate::RICE_UNARY_LIMIT);
        if too_long { u64::MAX } else { unary.map(|ones| ones + 1 + u64::from(k)).sum() }
    };
    (0..32).min_by_key(|&k| bits(k)).unwrap_or(31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BitReader;
    use crate::huffman::cauchy_table;
    use proptest::prelude::*;

    #[derive(Clone, Debug)]
    enum Field {
        U(u64, u32),
        Uleb(u32),
        F64(u64),
        Rice(u32, u32),
        Srice(i32, u32),
        Huffman(i32, u8),
    }

    fn field() -> impl Strategy<Value = Field> {
        prop_oneof![
            (any::<u64>(), 1..=64_u32).prop_map(|(v, n)| Field::U(v >> (64 - n), n)),
            (any::<u32>(), 0..32).prop_map(|(v, s)| Field::Uleb(v >> s)),
            any::<u64>().prop_map(Field::F64),
            (0..=32_u32, 0..27_u32, any::<u32>())
                .prop_map(|(ones, k, low)| Field::Rice(ones << k | low & ((1 << k) - 1), k)),
            (-(1 << 20)..1 << 20, 16..27_u32).prop_map(|(v, k)| Field::Srice(v, k)),
            (any::<i32>(), 12..31, 0..48_u8).prop_map(|(v, s, t)| Field::Huffman(v >> s, t)),
        ]
    }

    proptest! {
        #[test]
        fn reads_what_it_writes(fields in prop::collection::vec(field(), 0..60)) {
            let mut writer = BitWriter::new();
            for field in &fields {
                match *field {
                    Field::U(value, n) => writer.u(value, n),
                    Field::Uleb(value) => writer.uleb(value),
                    Field::F64(bits) => writer.f64(f64::from_bits(bits)),
                    Field::Rice(value, k) => writer.rice(value, k),
                    Field::Srice(value, k) => writer.srice(value, k),
                    Field::Huffman(value, t) => writer.huffman(value, cauchy_table(t)),
                }
            }
            let end = writer.position();
            let bytes = writer.into_bytes();
            let mut reader = BitReader::new(&bytes);
            for field in &fields {
                match *field {
                    Field::U(value, n) => prop_assert_eq!(reader.u("u", n), Ok(value)),
                    Field::Uleb(value) => prop_assert_eq!(reader.uleb("uleb"), Ok(value)),
                    Field::F64(bits) => {
                        prop_assert_eq!(reader.f64("f64").map(f64::to_bits), Ok(bits));
                    }
                    Field::Rice(value, k) => prop_assert_eq!(reader.rice("rice", k), Ok(value)),
                    Field::Srice(value, k) => prop_assert_eq!(reader.srice("srice", k), Ok(value)),
                    Field::Huffman(value, t) => {
                        prop_assert_eq!(reader.huffman("huffman", cauchy_table(t)), Ok(value));
                    }
                }
            }
            prop_assert_eq!(reader.position(), end);
            prop_assert_eq!(reader.finish(), Ok(()));
        }
    }

    proptest! {
        #[test]
        fn code_lengths_are_what_is_written(value in any::<i32>(), shift in 12..31, table in 0..48_u8) {
            let mut writer = BitWriter::new();
            writer.huffman(value >> shift, cauchy_table(table));
            let estimated = cauchy_table(table).code_length(value >> shift);
            prop_assert_eq!(writer.position(), u64::from(estimated));
        }
    }

    #[test]
    fn the_best_rice_parameter_keeps_the_unary_part_short() {
        assert_eq!(best_rice([0, 0, 0].into_iter()), 0);
        assert_eq!(best_rice([5, 6, 7, 4].into_iter()), 2);
        let lonely = std::iter::repeat_n(0, 4000).chain([1 << 20]);
        let k = best_rice(lonely);
        assert!((1_u32 << 20) >> k <= crate::RICE_UNARY_LIMIT);
    }
}
