//! The decoder without I/O: bytes are pushed in, frames are polled out.

mod errors;
mod units;

use self::errors::{malformed, place};
use crate::decode::frame_info::FrameInfo;
use crate::decode::reconstruction::Reconstruction;
use crate::error::{DecodeError, DecodeErrorKind};
use crate::intra::IntraDecoder;
use crate::limits::Limits;
use crate::order::FrameNumbers;
use kn_bitstream::unit::{self, FILE_SIGNATURE, Framing, SizeLimits};
use kn_bitstream::{
    BitReader, Element, Error, Index, IndexGroup, Level, MotionFrame, SequenceHeader, Trace, Value,
    rule,
};
use kn_mesh::{Grid, Mesh, Precision};

/// The result of [`StreamDecoder::poll`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// At least this many more bytes are needed.
    NeedBytes(usize),
    /// The next frame in display order has been decoded.
    Frame(FrameInfo),
    /// The index has been read: the stream is complete.
    End,
}

/// The position in the order of units (`file.order`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Signature,
    Header,
    /// Before the first GoF, or after a seek.
    BeforeGroup,
    AfterIntra,
    AfterNodes,
    InGroup,
    End,
    Failed,
}

/// The level before the header has arrived: it allows nothing.
const NO_LEVEL: Level =
    Level { max_vertices: 0, max_faces: 0, max_nodes: 0, max_group_frames: 0, max_unit_bytes: 0 };

/// Decodes a stream from bytes as they arrive. The decoder does no I/O.
///
/// Frames come out in display order. In streams of this version that is the order of decoding, so
/// the delay is 0 frames: [`Self::poll`] returns a frame as soon as its unit is there. A version
/// whose P-frames are decoded in another order than they are shown in would keep this contract: it
/// would return a frame once all frames before it in display order are decoded, after a delay that
/// the sequence header bounds and that ends with the GoF, and it would hold the decoded frames
/// until then.
///
/// Safe on untrusted input: a stream never causes a panic, an endless loop or an allocation beyond
/// its [`Limits`]; the faces of a decoded mesh are in range. Decoding is bit-exact: any two
/// conforming decoders give the same integers, whatever the thread count and the chunking.
#[derive(Debug)]
pub struct StreamDecoder {
    limits: Limits,
    check_digests: bool,
    /// Bytes that have arrived and are not decoded yet begin at `start`.
    buffer: Vec<u8>,
    start: usize,
    /// Offset in the file of `buffer[start]`.
    offset: u64,
    stage: Stage,
    header: Option<SequenceHeader>,
    level: Level,
    group: Reconstruction,
    intra_decoder: IntraDecoder,
    motion: MotionFrame,
    frame_name: String,
    /// Number of frames decoded, those before a seek's target included: the next frame's place in
    /// decode order.
    decoded: u64,
    /// The frame that was returned last.
    shown: Option<FrameNumbers>,
    /// Bytes of units that belong to the next frame.
    frame_bytes: u64,
    /// GoFs so far, to compare with the index.
    groups: Vec<IndexGroup>,
    group_start: u64,
}

impl StreamDecoder {
    /// Makes a decoder that waits for the first byte of a stream.
    pub fn new(limits: Limits) -> Self {
        Self {
            limits,
            check_digests: false,
            buffer: Vec::new(),
            start: 0,
            offset: 0,
            stage: Stage::Signature,
            header: None,
            level: NO_LEVEL,
            group: Reconstruction::default(),
            intra_decoder: IntraDecoder::default(),
            motion: MotionFrame::default(),
            frame_name: String::new(),
            decoded: 0,
            shown: None,
            frame_bytes: 0,
            groups: Vec::new(),
            group_start: 0,
        }
    }

    /// Sets whether every frame is compared with the digest that it carries. The default is no,
    /// since a comparison costs more time than decoding.
    pub fn check_digests(&mut self, check: bool) {
        self.check_digests = check;
    }

    /// Appends the next bytes of the stream.
    pub fn push(&mut self, bytes: &[u8]) {
        if self.start > 0 && self.start >= self.buffer.len() / 2 {
            self.buffer.drain(..self.start);
            self.start = 0;
        }
        self.buffer.extend_from_slice(bytes);
    }

    /// Decodes up to the next frame and writes it into `mesh`, whose buffers are reused.
    ///
    /// # Errors
    /// See [`DecodeErrorKind`]. After an error the stream cannot be continued.
    pub fn poll(&mut self, mesh: &mut Mesh) -> Result<Progress, DecodeError> {
        self.poll_traced(mesh, None)
    }

    /// Decodes like [`Self::poll`], and calls `trace` with every syntax element.
    ///
    /// # Errors
    /// The errors of [`Self::poll`].
    pub fn poll_traced(
        &mut self,
        mesh: &mut Mesh,
        mut trace: Option<&mut Trace<'_>>,
    ) -> Result<Progress, DecodeError> {
        loop {
            match self.step(reborrow(&mut trace)) {
                Ok(Step::Continue) => {}
                Ok(Step::Frame(info)) => {
                    self.fill(mesh);
                    return Ok(Progress::Frame(info));
                }
                Ok(Step::NeedBytes(n)) => return Ok(Progress::NeedBytes(n)),
                Ok(Step::End) => return Ok(Progress::End),
                Err(error) => {
                    self.stage = Stage::Failed;
                    return Err(error);
                }
            }
        }
    }

    /// Decodes up to the sequence header. Returns the number of bytes that are missing, or `None`
    /// once the header is there.
    pub(crate) fn poll_header(&mut self) -> Result<Option<usize>, DecodeError> {
        while self.header.is_none() {
            if let Step::NeedBytes(n) = self.step(None)? {
                return Ok(Some(n));
            }
        }
        Ok(None)
    }

    /// The sequence header; `None` before it has arrived.
    pub fn header(&self) -> Option<&SequenceHeader> {
        self.header.as_ref()
    }

    /// The grid of decoded positions; `None` before the header has arrived. Its step is a reference
    /// unit, 2^-`fraction_bits` steps of the grid that I-frames are coded on.
    pub fn grid(&self) -> Option<Grid> {
        let fine = |h: &SequenceHeader| h.grid_step / f64::from(1_u32 << h.fraction_bits);
        self.header.as_ref().map(|h| Grid { origin: h.grid_origin, step: fine(h) })
    }

    /// The precision that files of the decoded meshes need; `None` before the header was read.
    pub fn precision(&self) -> Option<Precision> {
        let precision = |h: &SequenceHeader| {
            Grid { origin: h.grid_origin, step: h.grid_step }.precision(h.fraction_bits)
        };
        self.header.as_ref().map(precision)
    }

    /// Positions of the last frame on [`Self::grid`] (`#V × 3`). They are the same in every
    /// decoder.
    pub fn grid_positions(&self) -> &[[i32; 3]] {
        self.group.last_positions()
    }

    /// Faces of the last frame (`#F × 3`). They are the same in all frames of a GoF.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.group.intra().faces
    }

    /// Name of the last frame, without extension: its own name, or else that of the sequence's
    /// pattern.
    pub fn frame_name(&self) -> Option<String> {
        let shown = self.shown?;
        if !self.frame_name.is_empty() {
            return Some(self.frame_name.clone());
        }
        let names = self.header.as_ref()?.names.as_ref()?;
        Some(names.of_frame(u32::try_from(shown.display).ok()?))
    }

    /// The largest number of frames in a GoF; 0 before the header has arrived.
    fn max_group_length(&self) -> u8 {
        self.header.as_ref().map_or(0, |header| header.max_group_length)
    }

    /// Number of decoded frames. Frames before the target of a seek count.
    pub(crate) fn decoded(&self) -> u64 {
        self.decoded
    }

    /// Number of bytes that have arrived.
    pub(crate) fn received(&self) -> u64 {
        self.offset + (self.buffer.len() - self.start) as u64
    }

    /// Goes to the first byte of a GoF; `before` are the GoFs that precede it. Only an
    /// I-frame may follow, wherever the index points: nothing of another GoF is used.
    pub(crate) fn restart(&mut self, offset: u64, before: &[IndexGroup]) {
        self.buffer.clear();
        self.start = 0;
        self.offset = offset;
        self.stage = Stage::BeforeGroup;
        self.decoded = before.iter().map(|group| u64::from(group.frames)).sum();
        self.shown = None;
        self.frame_bytes = 0;
        self.groups.clear();
        self.groups.extend_from_slice(before);
        self.group_start = offset - before.last().map_or(0, |group| u64::from(group.bytes));
    }

    /// Decodes at most one unit.
    fn step(&mut self, trace: Option<&mut Trace<'_>>) -> Result<Step, DecodeError> {
        match self.stage {
            Stage::Signature => self.read_signature(trace),
            Stage::Failed => Err(DecodeErrorKind::Failed.into()),
            Stage::End if self.start == self.buffer.len() => Ok(Step::End),
            Stage::End => Err(self.malformed(rule::FILE_ORDER, 8 * self.offset)),
            _ => {
                // The buffer is out of `self` while a unit in it is decoded.
                let buffer = std::mem::take(&mut self.buffer);
                let result = self.read_unit(&buffer[self.start..], trace);
                self.buffer = buffer;
                let (step, used) = result?;
                self.start += used;
                self.offset += used as u64;
                Ok(step)
            }
        }
    }

    fn read_signature(&mut self, trace: Option<&mut Trace<'_>>) -> Result<Step, DecodeError> {
        let present = &self.buffer[self.start..];
        let common = present.len().min(FILE_SIGNATURE.len());
        if present[..common] != FILE_SIGNATURE[..common] {
            return Err(self.malformed(rule::FILE_SIGNATURE_VALUE, 0));
        }
        if common < FILE_SIGNATURE.len() {
            return Ok(Step::NeedBytes(FILE_SIGNATURE.len() - common));
        }
        if let Some(trace) = trace {
            let value = Value::Word(u64::from_be_bytes(FILE_SIGNATURE));
            trace(&Element { bit: 0, name: "file_signature".into(), value });
        }
        self.start += common;
        self.offset += common as u64;
        self.stage = Stage::Header;
        Ok(Step::Continue)
    }

    /// Decodes the unit at the beginning of `bytes`. Returns its number of bytes too.
    fn read_unit(
        &mut self,
        bytes: &[u8],
        mut trace: Option<&mut Trace<'_>>,
    ) -> Result<(Step, usize), DecodeError> {
        let start = 8 * self.offset;
        let framing = unit::read_unit(bytes, self.size_limits())
            .map_err(|error| self.at(Error { bit: error.bit + start, ..error }))?;
        let unit = match framing {
            Framing::NeedBytes(n) => return Ok((Step::NeedBytes(n), 0)),
            Framing::Unit(unit) => unit,
        };
        self.check_order(unit.unit_type)?;
        if let Some(trace) = reborrow(&mut trace) {
            unit.trace_header(start, trace);
        }
        let payload_start = start + 8 * unit.header_len as u64;
        let step = self.decode_unit(&unit, payload_start, reborrow(&mut trace))?;
        if let Some(trace) = trace {
            unit.trace_end(start, trace);
        }
        Ok((step, unit.total_len))
    }

    /// Reads the index unit from `bytes`, which begin at bit `start` of the file.
    ///
    /// # Errors
    /// The bytes are no index unit, the unit is above the limits (known as soon as its size is), or
    /// it breaks a rule.
    pub(crate) fn parse_index(&self, bytes: &[u8], start: u64) -> Result<ParsedIndex, DecodeError> {
        let place = |error: Error| place(Error { bit: error.bit + start, ..error }, None);
        let unit = match unit::read_unit(bytes, self.size_limits()).map_err(place)? {
            Framing::NeedBytes(n) => return Ok(ParsedIndex::NeedBytes(n)),
            Framing::Unit(unit) => unit,
        };
        if unit.unit_type != unit::INDEX || unit.total_len != bytes.len() {
            return Err(malformed(rule::INDEX_SIZE_VALUE, start, None));
        }
        let mut bits = BitReader::new(unit.payload).at(8 * unit.header_len as u64);
        let index = Index::read(&mut bits, unit.payload.len() as u32, self.max_group_length());
        let index = index.and_then(|index| bits.finish().map(|()| index)).map_err(place)?;
        Ok(ParsedIndex::Index(index))
    }

    fn size_limits(&self) -> SizeLimits {
        let any_level = SizeLimits::default().level;
        let level = self.header.as_ref().map_or(any_level, |_| self.level.max_unit_bytes);
        SizeLimits { level, caller: self.limits.max_unit_bytes }
    }

    /// Checks the order of units (`file.order`).
    fn check_order(&self, unit_type: u8) -> Result<(), DecodeError> {
        let in_order = match self.stage {
            Stage::Header => unit_type == unit::SEQUENCE_HEADER,
            Stage::BeforeGroup => unit_type == unit::INTRA_FRAME,
            Stage::AfterIntra => {
                matches!(unit_type, unit::INTRA_FRAME | unit::KEY_NODES | unit::INDEX)
            }
            Stage::AfterNodes => unit_type == unit::MOTION_FRAME,
            Stage::InGroup => {
                matches!(unit_type, unit::INTRA_FRAME | unit::MOTION_FRAME | unit::INDEX)
            }
            Stage::Signature | Stage::End | Stage::Failed => false,
        };
        let skippable = unit_type >= unit::FIRST_SKIPPABLE && self.stage != Stage::Header;
        if in_order || skippable {
            Ok(())
        } else {
            Err(self.malformed(rule::FILE_ORDER, 8 * self.offset))
        }
    }

    /// Copies the last frame into `mesh`. The labels are those of the I-frame.
    fn fill(&self, mesh: &mut Mesh) {
        let Some(grid) = self.grid() else { return };
        mesh.positions.clear();
        let world = grid.to_world();
        mesh.positions.extend(self.grid_positions().iter().map(|&p| world.at(p)));
        let intra = self.group.intra();
        // Copied for P-frames too: the caller may have brought another mesh.
        mesh.faces.clear();
        mesh.faces.extend_from_slice(&intra.faces);
        mesh.labels.clear();
        mesh.labels.extend_from_slice(&intra.labels);
    }
}

/// The result of [`StreamDecoder::parse_index`].
pub(crate) enum ParsedIndex {
    /// The unit has this many more bytes.
    NeedBytes(usize),
    /// The GoFs.
    Index(Index),
}

/// The result of one step.
enum Step {
    Continue,
    NeedBytes(usize),
    Frame(FrameInfo),
    End,
}

/// A shorter borrow of an optional trace.
fn reborrow<'a>(trace: &'a mut Option<&mut Trace<'_>>) -> Option<&'a mut Trace<'a>> {
    match trace {
        Some(trace) => Some(&mut **trace),
        None => None,
    }
}
