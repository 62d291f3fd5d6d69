//! Units: the type, the size and the CRC around every structure.

use crate::error::{Error, ErrorKind};
use crate::level::Level;
use crate::reader::BitReader;
use crate::rule;
use crate::trace::{Element, Trace, Value};
use crate::writer::BitWriter;

/// The first eight bytes of a file.
pub const FILE_SIGNATURE: [u8; 8] = 0x8B4B_4E4D_0D0A_1A0A_u64.to_be_bytes();

/// `unit_type` of a sequence header.
pub const SEQUENCE_HEADER: u8 = 1;
/// `unit_type` of an I-frame.
pub const INTRA_FRAME: u8 = 2;
/// `unit_type` of the key nodes of a GoF.
pub const KEY_NODES: u8 = 3;
/// `unit_type` of a P-frame.
pub const MOTION_FRAME: u8 = 4;
/// `unit_type` of the index.
pub const INDEX: u8 = 5;
/// The lowest `unit_type` that a decoder skips.
pub const FIRST_SKIPPABLE: u8 = 128;

/// Whether CRCs are checked. They are not while fuzzing, so that mutations get past them.
const CHECK_CRC: bool = !cfg!(fuzzing);

/// Number of bytes of the CRC that ends a unit.
const CRC_BYTES: usize = 4;
/// Largest number of bytes of `unit_type` and `unit_size`.
const MAX_HEADER_BYTES: usize = 6;

/// A whole unit, its CRC checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit<'a> {
    /// Type of the unit.
    pub unit_type: u8,
    /// Bytes of the structure, without type, size and CRC.
    pub payload: &'a [u8],
    /// Number of bytes before the payload.
    pub header_len: usize,
    /// Number of bytes of the whole unit.
    pub total_len: usize,
    /// The CRC as it stands in the stream.
    pub crc: u32,
}

/// The result of [`read_unit`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Framing<'a> {
    /// The unit is not complete: at least this many further bytes are needed.
    NeedBytes(usize),
    /// A whole unit.
    Unit(Unit<'a>),
}

/// The largest values of `unit_size` that are accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SizeLimits {
    /// The limit of the stream's level. Above it the stream is malformed.
    pub level: u32,
    /// The limit of the caller. Above it the stream may be sound.
    pub caller: u32,
}

impl Default for SizeLimits {
    /// The highest level's limit: for the sequence header, before the level is known.
    fn default() -> Self {
        let level = Level::all().map(|(_, level)| level.max_unit_bytes).max().unwrap_or(0);
        Self { level, caller: level }
    }
}

/// Reads the unit at the start of `bytes`, which may not hold all of it yet.
///
/// The limits are checked as soon as the size is known, so that a caller never collects more. Bits
/// of errors count from the start of `bytes`. Safe on untrusted input; allocates nothing.
///
/// # Errors
/// The type is unknown, the size is above a limit, or the CRC is wrong.
pub fn read_unit(bytes: &[u8], limits: SizeLimits) -> Result<Framing<'_>, Error> {
    let mut bits = BitReader::new(&bytes[..bytes.len().min(MAX_HEADER_BYTES)]);
    let (unit_type, size) = match read_header(&mut bits, limits) {
        Ok(header) => header,
        Err(Error { kind: ErrorKind::UnexpectedEnd, .. }) => {
            // The smallest unit has a header of two bytes.
            let known = (2 + CRC_BYTES).max(bytes.len() + 1);
            return Ok(Framing::NeedBytes(known - bytes.len()));
        }
        Err(error) => return Err(error),
    };
    let header_len = (bits.position() / 8) as usize;
    let payload_end = header_len.saturating_add(size as usize);
    let total_len = payload_end.saturating_add(CRC_BYTES);
    let Some(crc) = bytes.get(payload_end..).and_then(|rest| rest.first_chunk()) else {
        return Ok(Framing::NeedBytes(total_len - bytes.len()));
    };
    let crc = u32::from_be_bytes(*crc);
    if CHECK_CRC && crc != crc32fast::hash(&bytes[..payload_end]) {
        return Err(Error::malformed(rule::UNIT_CRC_MATCH, 8 * payload_end as u64));
    }
    let payload = &bytes[header_len..payload_end];
    Ok(Framing::Unit(Unit { unit_type, payload, header_len, total_len, crc }))
}

fn read_header(bits: &mut BitReader<'_, '_>, limits: SizeLimits) -> Result<(u8, u32), Error> {
    let unit_type = bits.u8("unit_type", 8)?;
    let known = (SEQUENCE_HEADER..=INDEX).contains(&unit_type) || unit_type >= FIRST_SKIPPABLE;
    bits.require_supported(known, rule::UNIT_TYPE_KNOWN)?;
    let size = bits.uleb("unit_size")?;
    bits.require(size <= limits.level, rule::UNIT_SIZE_LIMIT)?;
    if size > limits.caller {
        let kind = ErrorKind::Limit {
            what: "bytes in a unit",
            asked: u64::from(size),
            allowed: u64::from(limits.caller),
        };
        return Err(Error { kind, bit: bits.position() });
    }
    Ok((unit_type, size))
}

impl Unit<'_> {
    /// Hands the elements before the payload to `trace`; `start` is the unit's first bit.
    pub fn trace_header(&self, start: u64, trace: &mut Trace<'_>) {
        let unit_type = Value::Unsigned(u64::from(self.unit_type));
        trace(&Element { bit: start, name: "unit_type".into(), value: unit_type });
        let unit_size = Value::Unsigned(self.payload.len() as u64);
        trace(&Element { bit: start + 8, name: "unit_size".into(), value: unit_size });
    }

    /// Hands the elements after the structure to `trace`; `start` is the unit's first bit.
    pub fn trace_end(&self, start: u64, trace: &mut Trace<'_>) {
        let payload_bit = start + 8 * self.header_len as u64;
        if self.unit_type >= FIRST_SKIPPABLE {
            let value = Value::Bytes(self.payload);
            trace(&Element { bit: payload_bit, name: "skipped".into(), value });
        }
        let crc_bit = payload_bit + 8 * self.payload.len() as u64;
        let value = Value::Word(u64::from(self.crc));
        trace(&Element { bit: crc_bit, name: "unit_crc".into(), value });
    }
}

/// Appends a unit to `out`: type, size, payload, CRC.
pub fn write_unit(out: &mut Vec<u8>, unit_type: u8, payload: &[u8]) {
    let start = out.len();
    let mut header = BitWriter::new();
    header.u(u64::from(unit_type), 8);
    header.uleb(payload.len() as u32);
    out.extend_from_slice(&header.into_bytes());
    out.extend_from_slice(payload);
    let crc = crc32fast::hash(&out[start..]);
    out.extend_from_slice(&crc.to_be_bytes());
}

/// Number of bytes of a whole unit whose payload has `size` bytes.
pub fn unit_len(size: u32) -> u32 {
    let groups = (u32::BITS - (size | 1).leading_zeros()).div_ceil(7);
    1 + groups + size + CRC_BYTES as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_what_it_writes() {
        for size in [0, 1, 127, 128, 70_000] {
            let payload = vec![0xa5; size];
            let mut bytes = Vec::new();
            write_unit(&mut bytes, KEY_NODES, &payload);
            assert_eq!(bytes.len(), unit_len(size as u32) as usize);
            let Ok(Framing::Unit(unit)) = read_unit(&bytes, SizeLimits::default()) else {
                panic!("not a unit")
            };
            assert_eq!((unit.unit_type, unit.payload), (KEY_NODES, &payload[..]));
            assert_eq!(unit.total_len, bytes.len());
        }
    }

    #[test]
    fn a_short_unit_says_how_many_bytes_to_bring() {
        let mut bytes = Vec::new();
        write_unit(&mut bytes, INDEX, &[7; 300]);
        let mut have = 0;
        while have < bytes.len() {
            match read_unit(&bytes[..have], SizeLimits::default()) {
                Ok(Framing::NeedBytes(n)) => {
                    assert!(n > 0 && have + n <= bytes.len());
                    have += n;
                }
                other => panic!("{other:?} after {have} bytes"),
            }
        }
        assert!(matches!(read_unit(&bytes, SizeLimits::default()), Ok(Framing::Unit(_))));
    }

    #[test]
    fn a_flipped_bit_is_found() {
        let mut sound = Vec::new();
        write_unit(&mut sound, MOTION_FRAME, b"motion");
        for bit in 0..8 * sound.len() {
            let mut bytes = sound.clone();
            bytes[bit / 8] ^= 0x80 >> (bit % 8);
            // A size that grew asks for more bytes; a file that ends there is cut short.
            let found = !matches!(read_unit(&bytes, SizeLimits::default()), Ok(Framing::Unit(_)));
            assert!(found, "bit {bit}");
        }
    }

    #[test]
    fn a_huge_size_is_refused_before_its_bytes_arrive() {
        let bytes = [INTRA_FRAME, 0xff, 0xff, 0xff, 0xff, 0x0f];
        let error = read_unit(&bytes, SizeLimits::default()).expect_err("4 GiB are too many");
        assert_eq!(error.rule(), Some(rule::UNIT_SIZE_LIMIT));
        let limits = SizeLimits { level: u32::MAX, caller: 1 << 20 };
        let error = read_unit(&bytes, limits).expect_err("the caller has not that much");
        assert!(matches!(error.kind, ErrorKind::Limit { asked: 0xffff_ffff, .. }));
    }
}
