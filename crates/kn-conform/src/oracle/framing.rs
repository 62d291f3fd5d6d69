//! 3.1, 3.8 and 6.1: the order of units, and the index.

use crate::value::TraceLine;
use kn_bitstream::rule::{self, Rule};

const ORDER: Rule = rule::FILE_ORDER;

/// The last unit, of those that are not skippable.
#[derive(Clone, Copy, Default, PartialEq)]
enum Stage {
    #[default]
    Start,
    Header,
    Intra,
    Nodes,
    Motion,
    Index,
    End,
}

/// Keeps the order of units and the bytes and frames of the GoFs.
#[derive(Default)]
pub(super) struct Framing {
    stage: Stage,
    max_group_length: u64,
    /// Byte of the file, and number of frames.
    groups: Vec<(u64, u64)>,
    /// Entries of the index.
    group_bytes: Vec<u64>,
    group_frames: Vec<u64>,
    /// The first byte of the index unit.
    index_at: u64,
}

impl Framing {
    pub(super) fn element(&mut self, line: &TraceLine) -> Result<(), Rule> {
        let value = line.value.number() as u64;
        match line.name.as_str() {
            "unit_type" => self.unit(value, line.bit / 8)?,
            "unit_crc" if self.stage == Stage::Index => self.stage = Stage::End,
            "max_group_length" => self.max_group_length = value,
            "group_bytes" => self.group_bytes.push(value),
            "group_frames" => self.group_frames.push(value),
            "index_size" => {
                let next = self.groups.iter().skip(1).map(|group| group.0).chain([self.index_at]);
                let bytes = next.zip(&self.groups).map(|(next, group)| next - group.0);
                let frames = self.groups.iter().map(|group| group.1);
                let agrees = bytes.eq(self.group_bytes.iter().copied())
                    && frames.eq(self.group_frames.iter().copied());
                return if agrees { Ok(()) } else { Err(rule::INDEX_GROUPS_MATCH) };
            }
            _ => {}
        }
        Ok(())
    }

    fn unit(&mut self, unit_type: u64, at: u64) -> Result<(), Rule> {
        use Stage as S;
        let (from, to): (&[Stage], _) = match unit_type {
            1 => (&[S::Start], S::Header),
            2 => (&[S::Header, S::Intra, S::Motion], S::Intra),
            3 => (&[S::Intra], S::Nodes),
            4 => (&[S::Nodes, S::Motion], S::Motion),
            5 => (&[S::Intra, S::Motion], S::Index),
            _ => (&[S::Header, S::Intra, S::Nodes, S::Motion], self.stage),
        };
        if !from.contains(&self.stage) {
            return Err(ORDER);
        }
        self.stage = to;
        match unit_type {
            2 => self.groups.push((at, 1)),
            5 => self.index_at = at,
            4 => {
                if let Some(group) = self.groups.last_mut() {
                    group.1 += 1;
                    if group.1 > self.max_group_length {
                        return Err(rule::FILE_GROUP_LENGTH);
                    }
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Whether the file may end here.
    pub(super) fn finish(&self) -> Result<(), Rule> {
        if self.stage == Stage::End { Ok(()) } else { Err(ORDER) }
    }
}
