//! kn-bitstream's readers and writers, driven for comparison with the tables.

use kn_bitstream::unit::{self, Framing, SizeLimits, Unit};
use kn_bitstream::{
    BitReader, BitWriter, Error, FrameHeader, Index, IntraFrame, KeyNodes, KeyNodesContext, Level,
    MotionContext, MotionFrame, SequenceHeader, WeightScheme, cauchy_table, rule,
};

use crate::interpret::{CountAffine, GroupPayloads};
use crate::spec::Example;
use crate::value::TraceLine;

/// The trace of an example, by kn-bitstream.
pub fn example_trace(example: &Example) -> Result<Vec<TraceLine>, Error> {
    let mut lines = Vec::new();
    if example.structure == "unit" {
        trace_lone_unit(example, &mut lines)?;
    } else {
        let mut sink = |element: &kn_bitstream::Element<'_>| lines.push(element.into());
        let mut bits = BitReader::new(&example.bytes).traced(&mut sink);
        read_structure(example, &mut bits)?;
        bits.finish()?;
    }
    Ok(lines)
}

/// The bytes of an example, read and written again by kn-bitstream; the bytes as they are where
/// the structure has no writer of its own.
pub fn example_written(example: &Example) -> Result<Vec<u8>, Error> {
    let mut bits = BitReader::new(&example.bytes);
    let mut out = BitWriter::new();
    match example.structure.as_str() {
        "sequence_header" => SequenceHeader::read(&mut bits)?.write(&mut out),
        "intra_frame" => IntraFrame::read(&mut bits)?.write(&mut out),
        "key_nodes" => KeyNodes::read(&mut bits, &nodes_context(example))?.write(&mut out),
        "index" => read_index(example, &mut bits)?.write(&mut out),
        "frame_header" => {
            let mut header = FrameHeader::default();
            header.read(&mut bits)?;
            header.write(&mut out);
        }
        "motion_frame" => {
            let mut frame = MotionFrame::default();
            frame.read(&mut bits, &motion_context(example))?;
            frame.write(&mut out);
        }
        structure => match structure.strip_prefix("descriptor ") {
            Some(descriptor) => copy_descriptor(descriptor, &mut bits, &mut out)?,
            None => return Ok(example.bytes.clone()),
        },
    }
    Ok(out.into_bytes())
}

fn read_structure(example: &Example, bits: &mut BitReader<'_, '_>) -> Result<(), Error> {
    match example.structure.as_str() {
        "sequence_header" => SequenceHeader::read(bits).map(drop),
        "frame_header" => FrameHeader::default().read(bits),
        "intra_frame" => IntraFrame::read(bits).map(drop),
        "key_nodes" => KeyNodes::read(bits, &nodes_context(example)).map(drop),
        "motion_frame" => MotionFrame::default().read(bits, &motion_context(example)),
        "index" => read_index(example, bits).map(drop),
        structure => {
            let descriptor = structure.strip_prefix("descriptor ").unwrap_or("");
            copy_descriptor(descriptor, bits, &mut BitWriter::new())
        }
    }
}

/// Reads one element `value` and writes it again.
fn copy_descriptor(
    descriptor: &str,
    bits: &mut BitReader<'_, '_>,
    out: &mut BitWriter,
) -> Result<(), Error> {
    let (kind, argument) = descriptor.split_once('(').unwrap_or((descriptor, ""));
    let argument = argument.trim_end_matches(')').parse().unwrap_or(0);
    match kind {
        "u" => out.u(bits.u("value", argument)?, argument),
        "uleb" => out.uleb(bits.uleb("value")?),
        "f64" => out.f64(bits.f64("value")?),
        "bytes" => out.bytes(bits.bytes("value", argument)?),
        "rice" => out.rice(bits.rice("value", argument)?, argument),
        "srice" => out.srice(bits.srice("value", argument)?, argument),
        _ => {
            let table = cauchy_table(argument as u8);
            out.huffman(bits.huffman("value", table)?, table);
        }
    }
    Ok(())
}

fn given(example: &Example, name: &str) -> Option<u32> {
    let (_, value) = example.given.iter().find(|(given, _)| given == name)?;
    u32::try_from(*value).ok()
}

fn nodes_context(example: &Example) -> KeyNodesContext {
    let level = Level::numbered(given(example, "level").unwrap_or(0) as u8);
    KeyNodesContext {
        label_count: given(example, "LabelCount").unwrap_or(1),
        weight_scheme: match given(example, "weight_scheme") {
            Some(2) => WeightScheme::Gaussian,
            Some(1) => WeightScheme::Sumner,
            _ => WeightScheme::InverseSquare,
        },
        vertex_count: given(example, "VertexCount").unwrap_or(u32::MAX),
        max_nodes: level.map_or(0, |level| level.max_nodes),
    }
}

fn motion_context(example: &Example) -> MotionContext {
    MotionContext {
        node_count: given(example, "NodeCount").unwrap_or(0),
        affine_count: given(example, "AffineCount").unwrap_or(0),
    }
}

fn read_index(example: &Example, bits: &mut BitReader<'_, '_>) -> Result<Index, Error> {
    let longest = given(example, "max_group_length").unwrap_or(255) as u8;
    Index::read(bits, example.bytes.len() as u32, longest)
}

fn trace_lone_unit(example: &Example, lines: &mut Vec<TraceLine>) -> Result<(), Error> {
    let mut walk = Walk::new(lines, crate::no_labels());
    let length = walk.unit(&example.bytes, 0)?;
    if length == example.bytes.len() {
        Ok(())
    } else {
        Err(Error::malformed(rule::FILE_ORDER, 8 * length as u64))
    }
}

/// Every syntax element of a stream, read by kn-bitstream.
///
/// The frames themselves are not decoded; `count_affine` is asked where affine nodes are given by
/// labels.
pub fn stream_trace(
    stream: &[u8],
    count_affine: &CountAffine<'_>,
) -> Result<Vec<TraceLine>, Error> {
    let mut lines = Vec::new();
    let mut sink = |element: &kn_bitstream::Element<'_>| lines.push(element.into());
    let mut bits = BitReader::new(stream).traced(&mut sink);
    let found = bits.u("file_signature", 64)?;
    let expected = u64::from_be_bytes(unit::FILE_SIGNATURE);
    bits.require(found == expected, rule::FILE_SIGNATURE_VALUE)?;
    let mut walk = Walk::new(&mut lines, count_affine);
    let mut at = unit::FILE_SIGNATURE.len();
    while at < stream.len() {
        at += walk.unit(&stream[at..], at)?;
    }
    Ok(lines)
}

/// What must be known from one unit to read the next.
struct Walk<'w> {
    lines: &'w mut Vec<TraceLine>,
    count_affine: &'w CountAffine<'w>,
    payloads: GroupPayloads,
    header: Option<SequenceHeader>,
    motion: MotionContext,
}

impl<'w> Walk<'w> {
    fn new(lines: &'w mut Vec<TraceLine>, count_affine: &'w CountAffine<'w>) -> Self {
        let motion = MotionContext { node_count: 0, affine_count: 0 };
        Self { lines, count_affine, payloads: GroupPayloads::default(), header: None, motion }
    }

    /// Traces the unit at the start of `bytes`, which is byte `at` of the file; its length.
    fn unit(&mut self, bytes: &[u8], at: usize) -> Result<usize, Error> {
        let start = 8 * at as u64;
        let in_file = |error: Error| Error { bit: error.bit + start, ..error };
        let level = self.header.as_ref().and_then(SequenceHeader::limits);
        let limits = level.map_or(SizeLimits::default(), |level| SizeLimits {
            level: level.max_unit_bytes,
            caller: level.max_unit_bytes,
        });
        let unit = match unit::read_unit(bytes, limits).map_err(in_file)? {
            Framing::Unit(unit) => unit,
            Framing::NeedBytes(_) => {
                return Err(Error::malformed(rule::FILE_ORDER, start + 8 * bytes.len() as u64));
            }
        };
        let mut lines = Vec::new();
        let mut sink = |element: &kn_bitstream::Element<'_>| lines.push(element.into());
        unit.trace_header(start, &mut sink);
        self.structure(&unit, start + 8 * unit.header_len as u64, &mut sink)?;
        unit.trace_end(start, &mut sink);
        self.lines.append(&mut lines);
        Ok(unit.total_len)
    }

    fn structure(
        &mut self,
        unit: &Unit<'_>,
        start: u64,
        sink: &mut kn_bitstream::Trace<'_>,
    ) -> Result<(), Error> {
        let mut bits = BitReader::new(unit.payload).at(start).traced(sink);
        let out_of_order = Error::malformed(rule::FILE_ORDER, start);
        match unit.unit_type {
            unit::SEQUENCE_HEADER => {
                self.payloads.sequence_header = unit.payload.to_vec();
                self.header = Some(SequenceHeader::read(&mut bits)?);
            }
            unit::INTRA_FRAME => {
                self.payloads.intra_frame = unit.payload.to_vec();
                IntraFrame::read(&mut bits)?;
            }
            unit::KEY_NODES => {
                let nodes = KeyNodes::read(&mut bits, &self.nodes_context().ok_or(out_of_order)?)?;
                self.payloads.key_nodes = unit.payload.to_vec();
                self.motion = self.motion_context(&nodes);
            }
            unit::MOTION_FRAME => MotionFrame::default().read(&mut bits, &self.motion)?,
            unit::INDEX => {
                let longest = self.header.as_ref().map_or(255, |header| header.max_group_length);
                Index::read(&mut bits, unit.payload.len() as u32, longest)?;
            }
            _ => return Ok(()),
        }
        bits.finish()
    }

    fn nodes_context(&self) -> Option<KeyNodesContext> {
        let header = self.header.as_ref()?;
        let level = header.limits()?;
        Some(KeyNodesContext {
            label_count: header.labels.label_count(),
            weight_scheme: header.weight_scheme,
            vertex_count: level.max_vertices,
            max_nodes: level.max_nodes,
        })
    }

    fn motion_context(&self, nodes: &KeyNodes) -> MotionContext {
        use kn_bitstream::AffineNodes;
        let node_count = nodes.count();
        let affine_count = match &nodes.affine {
            AffineNodes::None => 0,
            AffineNodes::Labels(_) => (self.count_affine)(&self.payloads).unwrap_or(0),
            AffineNodes::All => node_count,
            AffineNodes::Nodes(flags) => flags.iter().filter(|flag| **flag).count() as u32,
        };
        MotionContext { node_count, affine_count }
    }
}
