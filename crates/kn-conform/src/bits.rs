//! Bits one at a time, and the CRC by its definition. The code is literal, and not made for speed.

use kn_bitstream::rule::{self, Rule};

use crate::Failure;

/// Bits of a byte string, most significant first.
#[derive(Clone, Debug)]
pub(crate) struct BitSource<'a> {
    bytes: &'a [u8],
    at: u64,
    /// The end of the structure in the unit that is being read.
    end: Option<u64>,
    /// The rule that is broken where the bytes run out: r[descriptor.end].
    at_end: Rule,
}

impl<'a> BitSource<'a> {
    /// The bits of a structure alone.
    pub(crate) fn of_structure(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, end: None, at_end: rule::UNIT_SIZE_EXACT }
    }

    /// The bits of a file.
    pub(crate) fn of_file(bytes: &'a [u8]) -> Self {
        Self { at_end: rule::FILE_ORDER, ..Self::of_structure(bytes) }
    }

    /// Until it is lifted, nothing is read from here on.
    pub(crate) fn end_at(&mut self, end: Option<u64>) {
        self.end = end;
    }

    pub(crate) fn position(&self) -> u64 {
        self.at
    }

    pub(crate) fn more_data(&self) -> bool {
        self.at < 8 * self.bytes.len() as u64
    }

    /// The bytes from one bit to another, both at byte boundaries.
    pub(crate) fn between(&self, from: u64, to: u64) -> &'a [u8] {
        self.bytes.get((from / 8) as usize..(to / 8) as usize).unwrap_or(&[])
    }

    pub(crate) fn bit(&mut self) -> Result<u64, Failure> {
        if self.end.is_some_and(|end| self.at >= end) {
            return Err(Failure::of_rule(self.at, rule::UNIT_SIZE_EXACT, "the unit ends here"));
        }
        let byte = self.bytes.get((self.at / 8) as usize);
        let byte =
            byte.ok_or_else(|| Failure::of_rule(self.at, self.at_end, "the data ends here"))?;
        let bit = byte >> (7 - self.at % 8) & 1;
        self.at += 1;
        Ok(u64::from(bit))
    }

    pub(crate) fn bits(&mut self, n: u32) -> Result<u64, Failure> {
        let mut value = 0;
        for _ in 0..n {
            value = value << 1 | self.bit()?;
        }
        Ok(value)
    }

    pub(crate) fn bytes(&mut self, n: u64) -> Result<Vec<u8>, Failure> {
        // Not reserved beforehand: n comes from the stream.
        let mut bytes = Vec::new();
        for _ in 0..n {
            bytes.push(self.bits(8)? as u8);
        }
        Ok(bytes)
    }
}

/// Bits being collected, most significant first.
#[derive(Clone, Debug, Default)]
pub(crate) struct BitSink {
    bytes: Vec<u8>,
    /// Bits of the last byte that are in use; 0 where it is full or absent.
    used: u32,
}

impl BitSink {
    pub(crate) fn position(&self) -> u64 {
        8 * self.bytes.len() as u64 - if self.used == 0 { 0 } else { u64::from(8 - self.used) }
    }

    pub(crate) fn bit(&mut self, bit: bool) {
        if self.used == 0 {
            self.bytes.push(0);
        }
        if let Some(last) = self.bytes.last_mut() {
            *last |= u8::from(bit) << (7 - self.used);
        }
        self.used = (self.used + 1) % 8;
    }

    pub(crate) fn bits(&mut self, value: u64, n: u32) {
        (0..n).rev().for_each(|i| self.bit(value >> i & 1 == 1));
    }

    pub(crate) fn align(&mut self) {
        self.used = 0;
    }

    pub(crate) fn as_bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Puts `bytes` at byte `at`, which moves what follows.
    pub(crate) fn insert(&mut self, at: usize, bytes: &[u8]) {
        self.bytes.splice(at..at, bytes.iter().copied());
    }

    /// Puts `bytes` in place of those at byte `at`.
    pub(crate) fn replace(&mut self, at: usize, bytes: &[u8]) {
        self.bytes[at..at + bytes.len()].copy_from_slice(bytes);
    }
}

/// CRC-32 of chapter 2, bit by bit.
pub(crate) fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for &byte in bytes {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
        }
    }
    !crc
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_crc_has_its_published_check_value() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn reads_what_it_writes() {
        let mut sink = BitSink::default();
        sink.bits(0b101, 3);
        sink.bits(0x1234, 16);
        assert_eq!(sink.position(), 19);
        let mut source = BitSource::of_structure(sink.as_bytes());
        assert_eq!(source.bits(3), Ok(0b101));
        assert_eq!(source.bits(16), Ok(0x1234));
        assert_eq!(source.position(), 19);
        assert!(source.bits(6).is_err());
    }
}
