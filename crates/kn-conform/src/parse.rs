//! The second parser: bits to elements by the descriptors of chapter 2.

use kn_bitstream::rule::{self, Rule};

use crate::bits::{BitSource, crc32};
use crate::huffman::{Code, Codes};
use crate::interpret::{Elements, OpenUnit, Place};
use crate::syntax::Descriptor;
use crate::value::{Failure, Value};

/// Reads elements from the bits of a stream.
pub(crate) struct StreamElements<'a> {
    bits: BitSource<'a>,
    codes: &'a Codes,
    /// First bit of the unit that is being read.
    unit_start: u64,
}

impl<'a> StreamElements<'a> {
    pub(crate) fn new(bits: BitSource<'a>, codes: &'a Codes) -> Self {
        Self { bits, codes, unit_start: 0 }
    }

    /// After an example's structure only zero bits up to the byte boundary may be left.
    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        self.align()?;
        let at = self.bits.position();
        let rule = rule::UNIT_SIZE_EXACT;
        if self.bits.more_data() {
            Err(Failure::of_rule(at, rule, "bytes are left"))
        } else {
            Ok(())
        }
    }

    fn align(&mut self) -> Result<(), Failure> {
        while !self.bits.position().is_multiple_of(8) {
            if self.bits.bit()? == 1 {
                let bit = self.bits.position() - 1;
                return Err(Failure::of_rule(bit, rule::UNIT_ALIGN_ZERO, "not zero"));
            }
        }
        Ok(())
    }

    fn uleb(&mut self) -> Result<Value, Failure> {
        let start = self.bits.position();
        let mut value = 0;
        for group in 0..5 {
            let more = self.bits.bit()? == 1;
            let seven = self.bits.bits(7)?;
            value |= seven << (7 * group);
            if !more {
                if group > 0 && seven == 0 {
                    let rule = rule::DESCRIPTOR_ULEB_SHORTEST;
                    return Err(Failure::of_rule(start, rule, "a group too many"));
                }
                return below_2_32(value, start, rule::DESCRIPTOR_ULEB_RANGE);
            }
        }
        Err(Failure::of_rule(start, rule::DESCRIPTOR_ULEB_RANGE, "more than 5 groups"))
    }

    /// Number of 1 bits before a 0 bit.
    fn unary(&mut self, limit: u64, rule: Rule) -> Result<u64, Failure> {
        let start = self.bits.position();
        let mut ones = 0;
        while self.bits.bit()? == 1 {
            ones += 1;
            if ones > limit {
                return Err(Failure::of_rule(start, rule, "the unary part is too long"));
            }
        }
        Ok(ones)
    }

    fn rice(&mut self, k: u32) -> Result<Value, Failure> {
        let start = self.bits.position();
        let ones = self.unary(32, rule::DESCRIPTOR_RICE_RANGE)?;
        let value = (ones << k) + self.bits.bits(k)?;
        below_2_32(value, start, rule::DESCRIPTOR_RICE_RANGE)
    }

    fn srice(&mut self, k: u32) -> Result<Value, Failure> {
        let code = self.rice(k)?.number() as i64;
        Ok(Value::Integer(if code % 2 == 0 { code / 2 } else { -(code + 1) / 2 }))
    }

    fn huffman(&mut self, code: &Code) -> Result<Value, Failure> {
        let start = self.bits.position();
        let (mut length, mut read) = (0, 0);
        let symbol = loop {
            read = read << 1 | self.bits.bit()?;
            length += 1;
            if let Some(symbol) = code.symbol(length, read) {
                break symbol;
            }
            if length > 24 {
                return Err(Failure::new(start, "no such Huffman code"));
            }
        };
        if let Some(value) = symbol {
            return Ok(Value::Integer(value));
        }
        let ones = self.unary(20, rule::DESCRIPTOR_UE_RANGE)? as u32;
        let order = code.escape_order;
        let beyond = (((1_u64 << ones) - 1) << order) + self.bits.bits(ones + order)?;
        let magnitude = code.max_magnitude + 1 + beyond as i64;
        let value = if self.bits.bit()? == 1 { -magnitude } else { magnitude };
        if magnitude >= 1 << 20 {
            return Err(Failure::of_rule(start, rule::DESCRIPTOR_HUFFMAN_RANGE, "too large"));
        }
        Ok(Value::Integer(value))
    }
}

fn below_2_32(value: u64, bit: u64, rule: Rule) -> Result<Value, Failure> {
    match u32::try_from(value) {
        Ok(value) => Ok(Value::Integer(i64::from(value))),
        Err(_) => Err(Failure::of_rule(bit, rule, "2^32 or more")),
    }
}

impl Elements for StreamElements<'_> {
    fn element(&mut self, place: &Place<'_>) -> Result<Value, Failure> {
        let start = self.bits.position();
        if place.name == "unit_type" {
            self.unit_start = start;
        }
        let argument = u32::try_from(place.argument).unwrap_or(0);
        let value = match place.descriptor {
            Descriptor::U if argument < 32 => Value::Integer(self.bits.bits(argument)? as i64),
            Descriptor::U => Value::Word(self.bits.bits(argument)?),
            Descriptor::Uleb => self.uleb()?,
            Descriptor::F64 => Value::Float(f64::from_bits(self.bits.bits(64)?)),
            Descriptor::Bytes => Value::Bytes(self.bits.bytes(u64::from(argument))?),
            Descriptor::Rice => self.rice(argument)?,
            Descriptor::Srice => self.srice(argument)?,
            Descriptor::Huffman => {
                let code = self.codes.code(place.argument).ok_or_else(|| {
                    Failure::of_rule(start, rule::MOTION_TABLE_RANGE, "there is no such table")
                })?;
                self.huffman(code)?
            }
        };
        if place.name == "unit_size" {
            let end = i128::from(self.bits.position()) + 8 * value.number();
            self.bits.end_at(u64::try_from(end).ok());
        }
        if place.name == "unit_crc" {
            let unit = self.bits.between(self.unit_start, start);
            if value.number() != i128::from(crc32(unit)) {
                return Err(Failure::of_rule(start, rule::UNIT_CRC_MATCH, "another CRC"));
            }
        }
        Ok(value)
    }

    fn more_data(&mut self) -> bool {
        self.bits.more_data()
    }

    fn position(&self) -> u64 {
        self.bits.position()
    }

    fn end_structure(&mut self, unit: OpenUnit) -> Result<(), Failure> {
        self.align()?;
        let end = self.bits.position();
        if i128::from(end) != i128::from(unit.start) + 8 * unit.size {
            return Err(Failure::of_rule(end, rule::UNIT_SIZE_EXACT, "the unit ends elsewhere"));
        }
        self.bits.end_at(None);
        Ok(())
    }
}
