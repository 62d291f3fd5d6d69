//! The payload's header (`spec/05-intra.md`): counts and section sizes.

use kn_bitstream::rule::{self, Rule};

/// Bit of the flags byte: the payload has labels.
const LABELS: u8 = 1;
/// Bit of the flags byte: positions are coded as ranks in a lattice.
const LATTICE: u8 = 2;
/// Vertices and faces that a byte of payload can hold at most.
pub(super) const DENSITY: u64 = 2048;

/// Everything in front of the sections.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) has_labels: bool,
    pub(super) has_lattice: bool,
    /// All vertices, and how many of them no coded face uses.
    pub(super) vertices: u32,
    pub(super) isolated: u32,
    /// All faces, and how many of them repeat a vertex and are listed as they are.
    pub(super) faces: u32,
    pub(super) raw_faces: u32,
    /// Connected parts of the conquest.
    pub(super) components: u32,
    /// Vertices of the conquest that repeat another.
    pub(super) joins: u32,
    /// Bytes of the sections.
    pub(super) connectivity_bytes: u32,
    pub(super) geometry_bytes: u32,
    pub(super) label_bytes: u32,
}

impl Header {
    /// Reads it off the front of `bytes`, and where the sections begin.
    pub(super) fn read(bytes: &[u8]) -> Result<(Self, usize), (Rule, usize)> {
        let mut reader = Reader { bytes, at: 0 };
        let flags = reader.byte()?;
        if flags & !(LABELS | LATTICE) != 0 {
            return Err((rule::INTRA_HEADER, 0));
        }
        let attributes = reader.byte()?;
        if attributes != 0 {
            return Err((rule::INTRA_HEADER_ATTRIBUTES, 1));
        }
        let header = Self {
            has_labels: flags & LABELS != 0,
            has_lattice: flags & LATTICE != 0,
            vertices: reader.uleb128()?,
            isolated: reader.uleb128()?,
            faces: reader.uleb128()?,
            raw_faces: reader.uleb128()?,
            components: reader.uleb128()?,
            joins: reader.uleb128()?,
            connectivity_bytes: reader.uleb128()?,
            geometry_bytes: reader.uleb128()?,
            label_bytes: reader.uleb128()?,
        };
        header.check(bytes.len()).map_err(|rule| (rule, reader.at))?;
        Ok((header, reader.at))
    }

    /// Appends it to `out`.
    #[cfg(feature = "encode")]
    pub(super) fn write(&self, out: &mut Vec<u8>) {
        let flags =
            if self.has_labels { LABELS } else { 0 } | if self.has_lattice { LATTICE } else { 0 };
        out.extend([flags, 0]);
        for count in [
            self.vertices,
            self.isolated,
            self.faces,
            self.raw_faces,
            self.components,
            self.joins,
            self.connectivity_bytes,
            self.geometry_bytes,
            self.label_bytes,
        ] {
            write_uleb128(out, count);
        }
    }

    /// Faces that the conquest brings.
    pub(super) fn conquered_faces(&self) -> u32 {
        self.faces - self.raw_faces
    }

    fn check(&self, payload: usize) -> Result<(), Rule> {
        if u64::from(self.vertices) + u64::from(self.faces) > DENSITY * payload as u64 {
            return Err(rule::INTRA_COUNTS_DENSITY);
        }
        if self.isolated > self.vertices {
            return Err(rule::INTRA_VERTICES_COUNT);
        }
        if self.raw_faces > self.faces || self.components > self.conquered_faces() {
            return Err(rule::INTRA_FACES_COUNT);
        }
        if u64::from(self.joins) > 3 * u64::from(self.conquered_faces()) {
            return Err(rule::INTRA_JOIN_ORDER);
        }
        Ok(())
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Reader<'_> {
    fn byte(&mut self) -> Result<u8, (Rule, usize)> {
        let byte = self.bytes.get(self.at).copied().ok_or((rule::INTRA_HEADER, self.at))?;
        self.at += 1;
        Ok(byte)
    }

    /// Seven bits a byte, the lowest first, the top bit set where more follow; no longer than
    /// needed, less than 2^32.
    fn uleb128(&mut self) -> Result<u32, (Rule, usize)> {
        let start = self.at;
        let mut value = 0u64;
        for place in 0..5 {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << (7 * place);
            if byte & 0x80 == 0 {
                let padded = byte == 0 && place > 0;
                let value = u32::try_from(value).ok().filter(|_| !padded);
                return value.ok_or((rule::INTRA_HEADER, start));
            }
        }
        Err((rule::INTRA_HEADER, start))
    }
}

#[cfg(feature = "encode")]
fn write_uleb128(out: &mut Vec<u8>, mut value: u32) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

#[cfg(all(test, feature = "encode"))]
mod tests {
    use super::*;

    #[test]
    fn reads_what_it_writes_and_names_what_is_wrong() {
        let header = Header {
            has_labels: true,
            vertices: 300,
            faces: 500,
            components: 2,
            connectivity_bytes: 70,
            ..Header::default()
        };
        let mut bytes = Vec::new();
        header.write(&mut bytes);
        let length = bytes.len();
        assert_eq!(Header::read(&bytes), Ok((header, length)));
        assert_eq!(Header::read(&bytes[..4]), Err((rule::INTRA_HEADER, 4)));
        bytes[1] = 1;
        assert_eq!(Header::read(&bytes), Err((rule::INTRA_HEADER_ATTRIBUTES, 1)));
        bytes[..2].copy_from_slice(&[4, 0]);
        assert_eq!(Header::read(&bytes), Err((rule::INTRA_HEADER, 0)));
        let dense = Header { vertices: 1 << 20, ..Header::default() };
        let mut bytes = Vec::new();
        dense.write(&mut bytes);
        assert_eq!(Header::read(&bytes).map_err(|(rule, _)| rule), Err(rule::INTRA_COUNTS_DENSITY));
    }

    #[test]
    fn a_number_in_more_bytes_than_needed_is_refused() {
        assert_eq!(Header::read(&[0, 0, 0x80, 0x00]), Err((rule::INTRA_HEADER, 2)));
    }
}
