//! The index: the sizes of the GoFs of a file (chapter 3.8).

use crate::error::Error;
use crate::reader::BitReader;
use crate::rule;
use crate::unit::unit_len;
use crate::writer::BitWriter;

/// Bytes at the end of a file that hold `index_size` and the CRC of the index.
pub const TAIL_BYTES: usize = 8;

/// The index of a file: the size of each GoF. A reader finds any GoF by it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Index {
    /// The GoFs in file order.
    pub groups: Vec<IndexGroup>,
}

/// One GoF in the index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexGroup {
    /// Bytes from the start of this GoF's I-frame to that of the next or to the index.
    pub bytes: u32,
    /// Number of frames of the GoF.
    pub frames: u8,
}

/// Size of the index unit, from the last [`TAIL_BYTES`] bytes of a file.
pub fn index_size(tail: [u8; TAIL_BYTES]) -> u32 {
    (u64::from_be_bytes(tail) >> 32) as u32
}

impl Index {
    /// Reads the index from a unit's payload of `size` bytes; the caller calls
    /// [`BitReader::finish`]. Allocates in proportion to `size`.
    pub fn read(
        bits: &mut BitReader<'_, '_>,
        size: u32,
        max_group_length: u8,
    ) -> Result<Self, Error> {
        let group_count = bits.uleb("group_count")?;
        bits.require(group_count > 0, rule::INDEX_COUNT_RANGE)?;
        // A GoF takes at least two bytes.
        bits.require(group_count <= size / 2, rule::UNIT_SIZE_EXACT)?;
        let mut groups = Vec::with_capacity(group_count as usize);
        for group in 0..group_count {
            let bytes = bits.uleb(("group_bytes", group))?;
            let frames = bits.u8(("group_frames", group), 8)?;
            bits.require((1..=max_group_length).contains(&frames), rule::INDEX_FRAMES_RANGE)?;
            groups.push(IndexGroup { bytes, frames });
        }
        let index_size = bits.u("index_size", 32)?;
        bits.require(index_size == u64::from(unit_len(size)), rule::INDEX_SIZE_VALUE)?;
        Ok(Self { groups })
    }

    /// Writes the index into an empty writer; the mirror of [`Self::read`].
    pub fn write(&self, bits: &mut BitWriter) {
        bits.uleb(self.groups.len() as u32);
        for group in &self.groups {
            bits.uleb(group.bytes);
            bits.u(u64::from(group.frames), 8);
        }
        let size = (bits.position() / 8) as u32 + 4;
        bits.u(u64::from(unit_len(size)), 32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit::{INDEX, write_unit};
    use proptest::prelude::*;

    fn read(payload: &[u8]) -> Result<Index, Error> {
        let mut bits = BitReader::new(payload);
        let index = Index::read(&mut bits, payload.len() as u32, 200)?;
        bits.finish()?;
        Ok(index)
    }

    fn written(index: &Index) -> Vec<u8> {
        let mut bits = BitWriter::new();
        index.write(&mut bits);
        bits.into_bytes()
    }

    proptest! {
        #[test]
        fn reads_what_it_writes(groups in prop::collection::vec((any::<u32>(), 1..=200_u8), 1..80)) {
            let groups = groups.into_iter().map(|(bytes, frames)| IndexGroup { bytes, frames });
            let index = Index { groups: groups.collect() };
            let payload = written(&index);
            prop_assert_eq!(read(&payload), Ok(index));
            let mut file = b"what came before".to_vec();
            let start = file.len();
            write_unit(&mut file, INDEX, &payload);
            let tail = file.last_chunk().expect("long enough");
            prop_assert_eq!(index_size(*tail) as usize, file.len() - start);
        }
    }

    #[test]
    fn a_promise_of_many_groups_is_not_believed() {
        let mut bits = BitWriter::new();
        bits.uleb(u32::MAX);
        bits.u(0, 32);
        let error = read(&bits.into_bytes()).expect_err("there are none");
        assert_eq!(error.rule(), Some(rule::UNIT_SIZE_EXACT));
    }
}
