//! kn-bitstream's readers and writers, driven for comparison with the tables.

use kn_bitstream::params::WeightScheme;
use kn_bitstream::unit::{self, Framing, SizeLimits};
use kn_bitstream::{
    BitReader, BitWriter, Error, FrameHeader, Index, IntraFrame, KeyNodes, KeyNodesContext, Level,
    MotionContext, MotionFrame, SequenceHeader, cauchy_table, rule,
};
use kn_codec::{DecodeError, Limits, Progress, StreamDecoder};
use kn_mesh::Mesh;

use crate::spec::Example;
use crate::value::TraceLine;

/// The trace of an example, by kn-bitstream.
pub fn example_trace(example: &Example) -> Result<Vec<TraceLine>, Error> {
    let mut lines = Vec::new();
    if example.structure == "unit" {
        trace_unit(example, &mut lines)?;
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
        "intra_frame" => IntraFrame::read(&mut bits, &level(example))?.write(&mut out),
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
            frame.write(&mut out, &motion_context(example));
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
        "intra_frame" => IntraFrame::read(bits, &level(example)).map(drop),
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

/// The level that is given, or the highest.
fn level(example: &Example) -> Level {
    let (given, levels) = (given(example, "level"), Level::all());
    let matches = |(number, _): &(u8, Level)| given.is_none_or(|level| level == u32::from(*number));
    levels.filter(matches).last().map_or_else(|| panic!("no such level"), |(_, level)| level)
}

fn nodes_context(example: &Example) -> KeyNodesContext {
    let level = level(example);
    KeyNodesContext {
        label_count: given(example, "LabelCount").unwrap_or(1),
        weight_scheme: match given(example, "weight_scheme") {
            Some(2) => WeightScheme::Gaussian,
            Some(1) => WeightScheme::Sumner,
            _ => WeightScheme::InverseSquare,
        },
        vertex_count: given(example, "VertexCount").unwrap_or(u32::MAX),
        max_nodes: level.max_nodes,
    }
}

fn motion_context(example: &Example) -> MotionContext {
    MotionContext {
        node_count: given(example, "NodeCount").unwrap_or(0),
        affine_count: given(example, "AffineCount").unwrap_or(0),
        part_count: given(example, "PartCount").unwrap_or(1),
        previous_table: given(example, "PreviousTable").map(|table| table as u8),
    }
}

fn read_index(example: &Example, bits: &mut BitReader<'_, '_>) -> Result<Index, Error> {
    let longest = given(example, "max_group_length").unwrap_or(255) as u8;
    Index::read(bits, example.bytes.len() as u32, longest)
}

/// A unit that a decoder steps over: the frame alone.
fn trace_unit(example: &Example, lines: &mut Vec<TraceLine>) -> Result<(), Error> {
    let mut sink = |element: &kn_bitstream::Element<'_>| lines.push(element.into());
    let end = 8 * example.bytes.len() as u64;
    match unit::read_unit(&example.bytes, SizeLimits::default())? {
        Framing::Unit(unit) if unit.total_len == example.bytes.len() => {
            unit.trace_header(0, &mut sink);
            unit.trace_end(0, &mut sink);
            Ok(())
        }
        _ => Err(Error::malformed(rule::FILE_ORDER, end)),
    }
}

/// Every syntax element of a stream, as kn-codec's decoder reads it, up to the error if it errs.
pub fn stream_trace(stream: &[u8]) -> (Vec<TraceLine>, Result<(), DecodeError>) {
    let mut lines = Vec::new();
    let mut sink = |element: &kn_bitstream::Element<'_>| lines.push(element.into());
    let mut decoder = StreamDecoder::new(Limits::default());
    decoder.push(stream);
    let mut mesh = Mesh::default();
    let result = loop {
        match decoder.poll_traced(&mut mesh, Some(&mut sink)) {
            Ok(Progress::Frame(_)) => {}
            Ok(Progress::End | Progress::NeedBytes(_)) => break Ok(()),
            Err(error) => break Err(error),
        }
    };
    (lines, result)
}
