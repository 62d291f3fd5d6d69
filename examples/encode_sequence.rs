//! Encodes a sequence of scans: `cargo run --release --example encode_sequence [PATTERN OUTPUT]`.
//!
//! PATTERN is a folder, a glob or a printf pattern of OBJ, PLY or glTF files, OUTPUT the .knm file
//! to write. Without arguments the synthetic performer is encoded into memory.

use anyhow::Result;
use kn_codec::{Encoder, EncoderConfig, FrameReport, GridChoice};
use kn_io::{Inputs, ReadOptions};
use kn_mesh::{BoundingBox, Mesh, clean};
use kn_performer::{Performer, PerformerConfig};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    match &arguments[..] {
        [] => {
            let config = PerformerConfig { vertices: 5_000, ..PerformerConfig::default() };
            let performer = Performer::new(config)?;
            let stream = encode((0..12).map(|index| Ok(performer.frame(index))), Vec::new())?;
            println!("{} bytes in memory", stream.len());
        }
        [pattern, output] => {
            let inputs = Inputs::find(std::slice::from_ref(pattern), ReadOptions::default())?;
            let frames = inputs.frames().map(|frame| Ok(frame?.mesh));
            encode(frames, BufWriter::new(File::create(output)?))?.flush()?;
            println!("{} written", output.display());
        }
        _ => anyhow::bail!("usage: encode_sequence [PATTERN OUTPUT]"),
    }
    Ok(())
}

/// Encodes frames as they come and tells what became of each; at most one GoF is held.
fn encode<W: Write>(frames: impl Iterator<Item = Result<Mesh>>, writer: W) -> Result<W> {
    let mut frames = frames.peekable();
    let mut config = EncoderConfig::default().with_nodes(100);
    // The input is not read twice here, so the grid is laid over the first frame's box. Later
    // frames may leave it: integers on the grid are signed.
    let first_box = frames.peek().and_then(|first| first.as_ref().ok()?.bounding_box());
    config.sequence.grid = GridChoice::Bits { bits: 11, bounds: first_box.map(with_room) };

    let mut encoder = Encoder::new(writer, config)?;
    for frame in frames {
        // Scans come with seams and degenerate faces; `clean` reports every change it makes.
        encoder.push(&clean(&frame?)?.mesh)?;
        encoder.drain_reports().for_each(|report| show(&report));
    }
    let finished = encoder.finish()?;
    finished.reports.iter().for_each(show);
    println!("{} frames, {} bytes", finished.summary.frames, finished.summary.bytes);
    Ok(finished.writer)
}

fn show(report: &FrameReport) {
    let frame = report.frame();
    println!("frame {:2}: {:?}, {} bytes", frame.index, report.kind(), frame.bytes);
}

/// A person moves: a step that suits the first frame's box and a fifth more on each side.
fn with_room(bounds: BoundingBox) -> BoundingBox {
    let margin = 0.2 * bounds.longest_side();
    BoundingBox { min: bounds.min.map(|c| c - margin), max: bounds.max.map(|c| c + margin) }
}
