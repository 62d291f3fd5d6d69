//! Every stream of `spec/conformance`, found in the folder: one named test each.
//!
//! A sound stream decodes to the recorded frames, whole, byte by byte and by the literal decoder; the
//! decoder and the interpreter of the syntax tables see the same elements; its text assembles to its
//! bytes. A faulty one is refused by the recorded rule.

use std::path::Path;
use std::sync::Arc;

use kn_codec::{Limits, Progress, StreamDecoder, digest};
use kn_conform::{Spec, Stream, judge, load_corpus, node_labels, run_ours_on, stream_trace};
use kn_mesh::Mesh;
use libtest_mimic::{Arguments, Failed, Trial};

fn main() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("spec");
    let spec = Arc::new(Spec::load(&folder).unwrap_or_else(|error| panic!("spec: {error}")));
    let streams = load_corpus(&folder.join("conformance"));
    let streams = streams.unwrap_or_else(|error| panic!("corpus: {error}"));
    let trials = streams.into_iter().map(|stream| {
        let spec = Arc::clone(&spec);
        Trial::test(stream.name.clone(), move || check(&spec, &stream))
    });
    libtest_mimic::run(&Arguments::from_args(), trials.collect()).exit();
}

fn check(spec: &Spec, stream: &Stream) -> Result<(), Failed> {
    let verdict = judge(stream, &run_ours_on(&stream.path));
    if !verdict.passed {
        return Err(verdict.reason.into());
    }
    let bytes = std::fs::read(&stream.path)?;
    ensure(bytes.len() <= 64 << 10, "the stream is larger than 64 KiB")?;
    let text = std::fs::read_to_string(stream.path.with_extension("txt"))?;
    let assembled = spec.assemble(&text, &node_labels)?;
    ensure(assembled == bytes, "the text assembles to other bytes")?;
    match &stream.description.rule {
        None => check_sound(spec, stream, &bytes),
        Some(rule) => check_faulty(spec, rule, &bytes),
    }
}

/// The literal decoder, which shares no code with ours, refuses it by the same rule.
fn check_faulty(spec: &Spec, rule: &str, bytes: &[u8]) -> Result<(), Failed> {
    match spec.reconstruct(bytes) {
        Ok(_) => Err("read literally it decodes".into()),
        Err(failure) => match failure.rule {
            Some(found) if found.id() == rule => Ok(()),
            _ => Err(format!("read literally: {failure}").into()),
        },
    }
}

fn check_sound(spec: &Spec, stream: &Stream, bytes: &[u8]) -> Result<(), Failed> {
    let (by_decoder, result) = stream_trace(bytes);
    result?;
    let by_tables = spec.parse(bytes, &node_labels)?;
    for (decoder, tables) in by_decoder.iter().zip(&by_tables) {
        if decoder != tables {
            return Err(format!("the decoder reads {decoder}, the tables {tables}").into());
        }
    }
    ensure(by_decoder.len() == by_tables.len(), "one of the parsers reads more elements")?;
    let literal = spec.reconstruct(bytes)?;
    ensure(literal.frames == stream.description.frames, "read literally it decodes otherwise")?;
    ensure(literal.stages == stream.description.stages, "its stages are others")?;
    let text = spec.disassemble(bytes, &node_labels)?;
    let again = spec.assemble(&text, &node_labels)?;
    ensure(again == bytes, "taken apart and assembled it is another stream")?;
    let digests = decode_byte_by_byte(bytes)?;
    let recorded = stream.description.frames.iter().filter_map(|line| line.rsplit(' ').next());
    ensure(recorded.eq(digests.iter().map(String::as_str)), "byte by byte it decodes otherwise")
}

fn decode_byte_by_byte(bytes: &[u8]) -> Result<Vec<String>, Failed> {
    let mut decoder = StreamDecoder::new(Limits::default());
    let mut mesh = Mesh::default();
    let mut digests = Vec::new();
    for byte in bytes {
        decoder.push(std::slice::from_ref(byte));
        while let Progress::Frame(_) = decoder.poll(&mut mesh)? {
            digests.push(digest::frame_sha256(decoder.grid_positions(), decoder.faces()));
        }
    }
    Ok(digests)
}

fn ensure(holds: bool, otherwise: &str) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(otherwise.into()) }
}
