//! The frame header and the I-frame (chapters 3.4 and 3.5).

use crate::error::Error;
use crate::intra::IntraPayload;
use crate::level::Level;
use crate::params::name_text;
use crate::reader::BitReader;
use crate::rule;
use crate::writer::BitWriter;

/// The header of a frame: its name and its digest.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FrameHeader {
    /// Name of the input file. Empty where it is absent or the sequence's pattern gives it.
    pub name: String,
    /// First eight bytes of the SHA-256 of the decoded positions (chapter 9).
    pub positions_digest: Option<u64>,
}

impl FrameHeader {
    /// Reads the header into `self`, whose buffers are reused.
    pub fn read(&mut self, bits: &mut BitReader<'_, '_>) -> Result<(), Error> {
        let digest_present = bits.flag("digest_present")?;
        let name_present = bits.flag("name_present")?;
        let reserved = bits.u8("reserved_zero", 6)?;
        bits.require_supported(reserved == 0, rule::FRAME_RESERVED_ZERO)?;
        self.name.clear();
        if name_present {
            let length = bits.u("name_length", 8)? as u32;
            let name = name_text(bits.bytes("name", length)?);
            let name = name.ok_or(Error::malformed(rule::NAME_CHARACTERS, bits.position()))?;
            bits.require(!matches!(name, "" | "." | ".."), rule::NAME_WHOLE)?;
            self.name.push_str(name);
        }
        self.positions_digest =
            if digest_present { Some(bits.u("positions_digest", 64)?) } else { None };
        Ok(())
    }

    /// Writes the header; the mirror of [`Self::read`].
    pub fn write(&self, bits: &mut BitWriter) {
        bits.flag(self.positions_digest.is_some());
        bits.flag(!self.name.is_empty());
        bits.u(0, 6);
        if !self.name.is_empty() {
            bits.u(self.name.len() as u64, 8);
            bits.bytes(self.name.as_bytes());
        }
        if let Some(digest) = self.positions_digest {
            bits.u(digest, 64);
        }
    }
}

/// Largest strength of smoothing (`intra.smoothing.range`).
pub const MAX_SMOOTHING: u8 = 5;

/// An I-frame.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct IntraFrame<'a> {
    /// Name and digest of the frame.
    pub header: FrameHeader,
    /// First eight bytes of the SHA-256 of the faces; present with the positions' digest.
    pub faces_digest: Option<u64>,
    /// Strength of the smoothing of decoded positions, 0 to [`MAX_SMOOTHING`]. 0 means no
    /// smoothing.
    pub smoothing: u8,
    /// The coded mesh.
    pub payload: IntraPayload<'a>,
}

impl<'a> IntraFrame<'a> {
    /// Reads the frame of a stream of this level from a unit's payload; the caller calls
    /// [`BitReader::finish`].
    pub fn read(bits: &mut BitReader<'a, '_>, level: &Level) -> Result<Self, Error> {
        let mut header = FrameHeader::default();
        header.read(bits)?;
        let digest_present = header.positions_digest.is_some();
        let faces_digest = if digest_present { Some(bits.u("faces_digest", 64)?) } else { None };
        let smoothing = bits.u8("smoothing_strength", 8)?;
        bits.require(smoothing <= MAX_SMOOTHING, rule::INTRA_SMOOTHING_RANGE)?;
        let size = bits.uleb("intra_size")?;
        let payload = IntraPayload::read(bits, size, level)?;
        Ok(Self { header, faces_digest, smoothing, payload })
    }

    /// Writes the frame; the mirror of [`Self::read`].
    pub fn write(&self, bits: &mut BitWriter) {
        debug_assert_eq!(self.header.positions_digest.is_some(), self.faces_digest.is_some());
        self.header.write(bits);
        if let Some(digest) = self.faces_digest {
            bits.u(digest, 64);
        }
        bits.u(u64::from(self.smoothing), 8);
        let mut payload = BitWriter::new();
        self.payload.write(&mut payload);
        let payload = payload.into_bytes();
        bits.uleb(payload.len() as u32);
        bits.bytes(&payload);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level() -> Level {
        Level::numbered(0).expect("there is one")
    }

    fn written(frame: &IntraFrame<'_>) -> Vec<u8> {
        let mut bits = BitWriter::new();
        frame.write(&mut bits);
        bits.into_bytes()
    }

    #[test]
    fn reads_what_it_writes() {
        let named = FrameHeader { name: "first scan".into(), positions_digest: Some(u64::MAX) };
        let payload = IntraPayload { geometry: &[0; 200], ..IntraPayload::default() };
        let frames = [
            IntraFrame { header: named, faces_digest: Some(1), smoothing: 5, payload },
            IntraFrame::default(),
        ];
        for frame in frames {
            let bytes = written(&frame);
            let mut bits = BitReader::new(&bytes);
            assert_eq!(IntraFrame::read(&mut bits, &level()), Ok(frame));
            assert_eq!(bits.finish(), Ok(()));
        }
    }

    #[test]
    fn a_frame_is_not_called_dot_dot() {
        let header = FrameHeader { name: "..".into(), positions_digest: None };
        let bytes = written(&IntraFrame { header, ..IntraFrame::default() });
        let error = IntraFrame::read(&mut BitReader::new(&bytes), &level());
        assert_eq!(error.expect_err("not a name").rule(), Some(rule::NAME_WHOLE));
    }

    #[test]
    fn a_payload_longer_than_its_unit_is_refused() {
        let payload = IntraPayload { geometry: b"mesh", ..IntraPayload::default() };
        let mut bytes = written(&IntraFrame { payload, ..IntraFrame::default() });
        bytes.pop();
        let error = IntraFrame::read(&mut BitReader::new(&bytes), &level());
        assert_eq!(error.expect_err("cut short").rule(), Some(rule::UNIT_SIZE_EXACT));
    }
}
