//! Decodes frame by frame and seeks: `cargo run --release --example decode_frames [FILE.knm]`.
//!
//! Without an argument a short sequence of the synthetic performer is encoded first.

use anyhow::Result;
use kn_codec::{Decoder, Encoder, EncoderConfig, FrameInfo};
use kn_mesh::Mesh;
use kn_performer::{Performer, PerformerConfig};
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek};

fn main() -> Result<()> {
    match std::env::args_os().nth(1) {
        Some(path) => decode(BufReader::new(File::open(path)?)),
        None => decode(Cursor::new(performer_stream()?)),
    }
}

fn decode(reader: impl Read + Seek) -> Result<()> {
    let mut decoder = Decoder::new(reader)?;
    // The digests in the stream are compared only on request: that costs more than decoding.
    decoder.check_digests(true);

    // One mesh for all frames: its buffers are reused.
    let mut mesh = Mesh::default();
    while let Some(frame) = decoder.next_frame(&mut mesh)? {
        show(&frame, &mesh);
    }

    // Any frame can be reached through the index; only its GoF is decoded.
    let last = decoder.frame_count()?.saturating_sub(1);
    decoder.seek(last)?;
    if let Some(frame) = decoder.next_frame(&mut mesh)? {
        show(&frame, &mesh);
    }
    Ok(())
}

/// Prints the frame; a player would draw it.
fn show(frame: &FrameInfo, mesh: &Mesh) {
    let height = mesh.bounding_box().map_or(0.0, |bounds| bounds.max[1] - bounds.min[1]);
    println!(
        "frame {:2}: {:?}, {} vertices, {} faces, {} bytes, {height:.3} high",
        frame.index, frame.kind, frame.vertices, frame.faces, frame.bytes,
    );
}

fn performer_stream() -> Result<Vec<u8>> {
    let config = PerformerConfig { vertices: 5_000, ..PerformerConfig::default() };
    let performer = Performer::new(config)?;
    let config = EncoderConfig::default().with_nodes(100).with_group_length(4);
    let mut encoder = Encoder::new(Vec::new(), config)?;
    for index in 0..8 {
        encoder.push(&performer.frame(index))?;
    }
    Ok(encoder.finish()?.writer)
}
