//! Reading of syntax elements: the descriptors of chapter 2.

use crate::error::{Error, ErrorKind};
use crate::huffman::CauchyTable;
use crate::rule::{self, Rule};
use crate::trace::{Element, Name, Trace, Value};

/// Largest unary part of a Rice code.
pub const RICE_UNARY_LIMIT: u32 = 32;
/// Largest unary part of an Exp-Golomb code.
pub const UE_UNARY_LIMIT: u32 = 20;
/// Huffman-coded values are smaller than this in magnitude.
pub const HUFFMAN_VALUE_LIMIT: u32 = 1 << 20;

/// Reads syntax elements from the bytes of one unit, most significant bit first.
///
/// Safe on untrusted input: every method returns an error or a value in the range that its
/// descriptor promises; nothing is allocated.
pub struct BitReader<'a, 't> {
    bytes: &'a [u8],
    /// Next byte that is not in the window.
    next: usize,
    /// Unread bits from the top; below the `held` valid ones stand zeros or bits of
    /// `bytes[next..]`.
    window: u64,
    held: u32,
    base: u64,
    trace: Option<&'t mut Trace<'t>>,
}

impl<'a, 't> BitReader<'a, 't> {
    /// Makes a reader at the first bit of `bytes`.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, next: 0, window: 0, held: 0, base: 0, trace: None }
    }

    /// Sets the number that the first bit has in errors and traces.
    pub fn at(mut self, bit: u64) -> Self {
        self.base = bit;
        self
    }

    /// Sets a trace, which is called with every element that is read.
    pub fn traced(mut self, trace: &'t mut Trace<'t>) -> Self {
        self.trace = Some(trace);
        self
    }

    /// Offset of the next bit.
    pub fn position(&self) -> u64 {
        self.base + 8 * self.next as u64 - u64::from(self.held)
    }

    /// Checks a rule: returns an error unless `holds`.
    pub fn require(&self, holds: bool, rule: Rule) -> Result<(), Error> {
        if holds { Ok(()) } else { Err(Error::malformed(rule, self.position())) }
    }

    /// Checks a rule that reserves values: returns [`ErrorKind::Unsupported`] unless `holds`.
    pub fn require_supported(&self, holds: bool, rule: Rule) -> Result<(), Error> {
        if holds { Ok(()) } else { Err(Error::unsupported(rule, self.position())) }
    }

    /// `u(n)`, n ≤ 64.
    pub fn u(&mut self, name: impl Into<Name>, n: u32) -> Result<u64, Error> {
        let start = self.position();
        let high = self.take(n.saturating_sub(32))?;
        let value = high << 32 | self.take(n.min(32))?;
        let traced = if n < 32 { Value::Unsigned(value) } else { Value::Word(value) };
        self.note(start, name, traced);
        Ok(value)
    }

    /// `u(1)` as a flag.
    pub fn flag(&mut self, name: impl Into<Name>) -> Result<bool, Error> {
        Ok(self.u(name, 1)? == 1)
    }

    /// `u(n)` for n ≤ 8.
    pub fn u8(&mut self, name: impl Into<Name>, n: u32) -> Result<u8, Error> {
        debug_assert!(n <= 8);
        Ok(self.u(name, n)? as u8)
    }

    /// `uleb`: seven bits at a time, the least significant first.
    pub fn uleb(&mut self, name: impl Into<Name>) -> Result<u32, Error> {
        let start = self.position();
        let mut value = 0_u64;
        for group in 0..5 {
            let byte = self.take(8)?;
            value |= (byte & 0x7f) << (7 * group);
            if byte & 0x80 == 0 {
                self.require(byte != 0 || group == 0, rule::DESCRIPTOR_ULEB_SHORTEST)?;
                self.require(value < 1 << 32, rule::DESCRIPTOR_ULEB_RANGE)?;
                self.note(start, name, Value::Unsigned(value));
                return Ok(value as u32);
            }
        }
        Err(Error::malformed(rule::DESCRIPTOR_ULEB_RANGE, self.position()))
    }

    /// `f64`: the 64 bits of an IEEE 754 binary64, sign first.
    pub fn f64(&mut self, name: impl Into<Name>) -> Result<f64, Error> {
        let start = self.position();
        let value = f64::from_bits(self.take(32)? << 32 | self.take(32)?);
        self.note(start, name, Value::Float(value));
        Ok(value)
    }

    /// `bytes(n)`, borrowed. Every such element of the syntax begins at a byte boundary.
    pub fn bytes(&mut self, name: impl Into<Name>, n: u32) -> Result<&'a [u8], Error> {
        debug_assert_eq!(self.held % 8, 0, "bytes(n) begins at a byte boundary");
        let start = self.position();
        let from = self.next - self.held as usize / 8;
        let taken = (n as usize).checked_add(from).and_then(|to| self.bytes.get(from..to));
        let taken = taken.ok_or(Error { kind: ErrorKind::UnexpectedEnd, bit: start })?;
        (self.next, self.window, self.held) = (from + taken.len(), 0, 0);
        self.note(start, name, Value::Bytes(taken));
        Ok(taken)
    }

    /// `rice(k)`, k ≤ 31.
    pub fn rice(&mut self, name: impl Into<Name>, k: u32) -> Result<u32, Error> {
        let start = self.position();
        let value = self.take_rice(k)?;
        self.note(start, name, Value::Unsigned(u64::from(value)));
        Ok(value)
    }

    /// `srice(k)`: a zigzagged `rice(k)`.
    pub fn srice(&mut self, name: impl Into<Name>, k: u32) -> Result<i32, Error> {
        let start = self.position();
        let value = unzigzag(self.take_rice(k)?);
        self.note(start, name, Value::Signed(i64::from(value)));
        Ok(value)
    }

    /// `huffman(t)`; the value is below 2^20 in magnitude.
    pub fn huffman(&mut self, name: impl Into<Name>, table: &CauchyTable) -> Result<i32, Error> {
        let start = self.position();
        self.refill();
        let (symbol, length) = table.look_up((self.window >> 40) as u32);
        self.skip(length)?;
        let value = match symbol {
            Some(symbol) => table.value_of(symbol),
            None => {
                let beyond = self.take_ue(table.escape_order())?;
                let magnitude = u64::from(table.max_magnitude()) + 1 + beyond;
                let in_range = magnitude < u64::from(HUFFMAN_VALUE_LIMIT);
                self.require(in_range, rule::DESCRIPTOR_HUFFMAN_RANGE)?;
                let negative = self.take(1)? == 1;
                if negative { -(magnitude as i32) } else { magnitude as i32 }
            }
        };
        self.note(start, name, Value::Signed(i64::from(value)));
        Ok(value)
    }

    /// Goes to the next byte boundary and checks that no byte is left.
    pub fn finish(mut self) -> Result<(), Error> {
        let padding = self.take(self.held % 8)?;
        self.require(padding == 0, rule::UNIT_ALIGN_ZERO)?;
        self.require(self.held == 0 && self.next == self.bytes.len(), rule::UNIT_SIZE_EXACT)
    }

    fn take_rice(&mut self, k: u32) -> Result<u32, Error> {
        let unary = self.take_unary(RICE_UNARY_LIMIT, rule::DESCRIPTOR_RICE_RANGE)?;
        let value = u64::from(unary) << k | self.take(k)?;
        self.require(value < 1 << 32, rule::DESCRIPTOR_RICE_RANGE)?;
        Ok(value as u32)
    }

    fn take_ue(&mut self, k: u32) -> Result<u64, Error> {
        let unary = self.take_unary(UE_UNARY_LIMIT, rule::DESCRIPTOR_UE_RANGE)?;
        Ok((((1_u64 << unary) - 1) << k) + self.take(unary + k)?)
    }

    /// The number of 1 bits before a 0 bit, which is read too.
    fn take_unary(&mut self, limit: u32, rule: Rule) -> Result<u32, Error> {
        self.refill();
        let ones = self.window.leading_ones().min(self.held);
        self.require(ones <= limit, rule)?;
        self.skip(ones + 1)?;
        Ok(ones)
    }

    /// The next n ≤ 56 bits.
    #[inline]
    fn take(&mut self, n: u32) -> Result<u64, Error> {
        self.refill();
        let value = (self.window >> 1) >> (63 - n);
        self.skip(n)?;
        Ok(value)
    }

    /// Drops n bits, which a refill has brought into the window if the data has them.
    #[inline]
    fn skip(&mut self, n: u32) -> Result<(), Error> {
        if n > self.held {
            return Err(Error { kind: ErrorKind::UnexpectedEnd, bit: self.position() });
        }
        self.window <<= n;
        self.held -= n;
        Ok(())
    }

    /// Fills the window to at least 56 bits, or with all that is left.
    #[inline]
    fn refill(&mut self) {
        let rest = &self.bytes[self.next..];
        if let Some(eight) = rest.first_chunk() {
            // Bits of a byte that does not fit whole are set too; the next refill sets them again.
            self.window |= u64::from_be_bytes(*eight) >> self.held;
            let whole = (63 - self.held) / 8;
            self.next += whole as usize;
            self.held += 8 * whole;
        } else {
            for &byte in rest.iter().take((64 - self.held) as usize / 8) {
                self.window |= u64::from(byte) << (56 - self.held);
                self.next += 1;
                self.held += 8;
            }
        }
    }

    #[inline]
    fn note(&mut self, bit: u64, name: impl Into<Name>, value: Value<'_>) {
        if let Some(trace) = &mut self.trace {
            trace(&Element { bit, name: name.into(), value });
        }
    }
}

/// 0, −1, 1, −2, … from 0, 1, 2, 3, …
fn unzigzag(code: u32) -> i32 {
    (code >> 1) as i32 ^ -((code & 1) as i32)
}
