//! Decoding of one unit of each type.

use super::{Stage, Step, StreamDecoder};
use crate::decode::frame_info::{FrameInfo, FrameKind};
use crate::decode::reconstruction::Reconstruction;
use crate::digest::{faces_digest, positions_digest};
use crate::error::{DecodeError, DecodeErrorKind};
use crate::intra::{IntraLimits, decode_intra};
use crate::order::FrameNumbers;
use kn_bitstream::params::LabelSet;
use kn_bitstream::unit::{self, Unit};
use kn_bitstream::{
    BitReader, FrameHeader, Index, IndexGroup, IntraFrame, KeyNodes, KeyNodesContext,
    SequenceHeader, Trace,
    rule::{self, Rule},
};

impl StreamDecoder {
    /// Decodes a unit whose place in the order is correct. `payload_start` is a bit of the file.
    pub(super) fn decode_unit(
        &mut self,
        unit: &Unit<'_>,
        payload_start: u64,
        trace: Option<&mut Trace<'_>>,
    ) -> Result<Step, DecodeError> {
        self.frame_bytes += unit.total_len as u64;
        let mut bits = BitReader::new(unit.payload).at(payload_start);
        if let Some(trace) = trace {
            bits = bits.traced(trace);
        }
        match unit.unit_type {
            unit::SEQUENCE_HEADER => self.decode_header(bits),
            unit::INTRA_FRAME => self.decode_intra_frame(bits),
            unit::KEY_NODES => self.decode_nodes(bits),
            unit::MOTION_FRAME => self.decode_motion_frame(bits),
            unit::INDEX => self.decode_index(bits, unit.payload.len() as u32),
            _ => Ok(Step::Continue),
        }
    }

    fn decode_header(&mut self, mut bits: BitReader<'_, '_>) -> Result<Step, DecodeError> {
        let at = bits.position();
        let header = SequenceHeader::read(&mut bits).map_err(|error| self.at(error))?;
        bits.finish().map_err(|error| self.at(error))?;
        self.level = header.limits().ok_or(self.malformed(rule::HEADER_LEVEL_KNOWN, at))?;
        self.group = Reconstruction::new(&header);
        self.header = Some(header);
        self.stage = Stage::BeforeGroup;
        self.frame_bytes = 0;
        Ok(Step::Continue)
    }

    fn decode_intra_frame(&mut self, mut bits: BitReader<'_, '_>) -> Result<Step, DecodeError> {
        let frame = IntraFrame::read(&mut bits, &self.level).map_err(|error| self.at(error))?;
        let payload = &frame.payload;
        let sections = payload.connectivity.len() + payload.geometry.len() + payload.labels.len();
        // The sections are the last elements, so they begin where the reader ends.
        let sections_start = bits.position() - 8 * sections as u64;
        bits.finish().map_err(|error| self.at(error))?;
        self.begin_group()?;
        let limits = IntraLimits {
            max_vertices: self.limits.max_vertices.min(self.level.max_vertices),
            max_faces: self.limits.max_faces.min(self.level.max_faces),
        };
        let decoder = &mut self.intra_decoder;
        self.group
            .begin(frame.smoothing, |mesh| decode_intra(payload, &limits, decoder, mesh))
            .map_err(|error| self.intra_error(error, sections_start))?;
        self.check_labels(payload.header.has_labels, sections_start)?;
        self.show(&frame.header)?;
        if self.check_digests
            && frame.faces_digest.is_some_and(|digest| digest != faces_digest(self.faces()))
        {
            return Err(self.differs(rule::INTRA_DIGEST_FACES));
        }
        self.stage = Stage::AfterIntra;
        Ok(self.finish_frame(FrameKind::Intra))
    }

    /// Begins a GoF at the current unit.
    fn begin_group(&mut self) -> Result<(), DecodeError> {
        self.close_group()?;
        self.group_start = self.offset;
        self.groups.push(IndexGroup { bytes: 0, frames: 0 });
        Ok(())
    }

    /// Ends the last GoF before the current unit. No index can describe a GoF of 4 GiB or more.
    fn close_group(&mut self) -> Result<(), DecodeError> {
        let bytes = u32::try_from(self.offset - self.group_start);
        let bytes = bytes.map_err(|_| self.malformed(rule::INDEX_GROUPS_MATCH, 8 * self.offset))?;
        if let Some(group) = self.groups.last_mut() {
            group.bytes = bytes;
        }
        Ok(())
    }

    fn check_labels(&self, has_labels: bool, at: u64) -> Result<(), DecodeError> {
        let has_set = self.header.as_ref().is_some_and(|h| h.labels != LabelSet::None);
        if has_labels != has_set {
            Err(self.malformed(rule::INTRA_LABELS_PRESENT, at))
        } else if !self.group.labels_in_range() {
            Err(self.malformed(rule::INTRA_LABELS_RANGE, at))
        } else {
            Ok(())
        }
    }

    fn decode_nodes(&mut self, mut bits: BitReader<'_, '_>) -> Result<Step, DecodeError> {
        let at = bits.position();
        let vertex_count = self.group.intra().positions.len() as u32;
        if vertex_count == 0 {
            return Err(self.malformed(rule::INTRA_VERTICES_NODES, at));
        }
        let header = self.header.as_ref().ok_or(self.malformed(rule::FILE_ORDER, at))?;
        let context = KeyNodesContext {
            label_count: header.labels.label_count(),
            weight_scheme: header.weight_scheme,
            vertex_count,
            max_nodes: self.level.max_nodes,
        };
        let nodes = KeyNodes::read(&mut bits, &context).map_err(|error| self.at(error))?;
        bits.finish().map_err(|error| self.at(error))?;
        if nodes.count() > self.limits.max_nodes {
            let (asked, allowed) = (u64::from(nodes.count()), u64::from(self.limits.max_nodes));
            return Err(DecodeErrorKind::Limit { what: "key nodes", asked, allowed, at }.into());
        }
        self.group.place(&nodes).map_err(|rule| self.malformed(rule, at))?;
        self.stage = Stage::AfterNodes;
        Ok(Step::Continue)
    }

    fn decode_motion_frame(&mut self, mut bits: BitReader<'_, '_>) -> Result<Step, DecodeError> {
        let at = bits.position();
        let max_length = self.max_group_length();
        if self.groups.last().is_none_or(|group| group.frames >= max_length) {
            return Err(self.malformed(rule::FILE_GROUP_LENGTH, at));
        }
        let context = self.group.motion_context();
        let mut motion = std::mem::take(&mut self.motion);
        let result = motion.read(&mut bits, &context).and_then(|()| bits.finish());
        self.motion = motion;
        result.map_err(|error| self.at(error))?;
        // `reference_mode` is 0.
        let from = self.group.last();
        self.group.apply(&self.motion, from).map_err(|rule| self.malformed(rule, at))?;
        let header = std::mem::take(&mut self.motion.header);
        let shown = self.show(&header);
        self.motion.header = header;
        shown?;
        self.stage = Stage::InGroup;
        Ok(self.finish_frame(FrameKind::Predicted))
    }

    /// Takes the frame's name and checks its digest.
    fn show(&mut self, header: &FrameHeader) -> Result<(), DecodeError> {
        self.frame_name.clear();
        self.frame_name.push_str(&header.name);
        match header.positions_digest {
            Some(digest)
                if self.check_digests && digest != positions_digest(self.grid_positions()) =>
            {
                Err(self.differs(rule::FRAME_DIGEST_POSITIONS))
            }
            _ => Ok(()),
        }
    }

    /// The error for a frame that differs from a digest in its unit.
    fn differs(&self, rule: Rule) -> DecodeError {
        DecodeErrorKind::Digest { rule, at: 8 * self.offset, frame: self.decoded }.into()
    }

    fn finish_frame(&mut self, kind: FrameKind) -> Step {
        if let Some(group) = self.groups.last_mut() {
            // Bounded by max_group_length, which is at most 255.
            group.frames += 1;
        }
        let nodes = match kind {
            FrameKind::Intra => 0,
            FrameKind::Predicted => self.group.nodes().positions.len() as u32,
        };
        let numbers = FrameNumbers::in_order(self.decoded);
        let info = FrameInfo {
            index: numbers.display,
            decode_index: numbers.decode,
            kind,
            bytes: self.frame_bytes,
            vertices: self.grid_positions().len() as u32,
            faces: self.faces().len() as u32,
            nodes,
        };
        self.decoded += 1;
        self.shown = Some(numbers);
        self.frame_bytes = 0;
        Step::Frame(info)
    }

    fn decode_index(
        &mut self,
        mut bits: BitReader<'_, '_>,
        size: u32,
    ) -> Result<Step, DecodeError> {
        let at = bits.position();
        let index = Index::read(&mut bits, size, self.max_group_length())
            .map_err(|error| self.at(error))?;
        bits.finish().map_err(|error| self.at(error))?;
        self.close_group()?;
        if index.groups != self.groups {
            return Err(self.malformed(rule::INDEX_GROUPS_MATCH, at));
        }
        self.stage = Stage::End;
        Ok(Step::Continue)
    }
}
