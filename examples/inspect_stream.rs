//! Shows where the bits of a stream go: `cargo run --release --example inspect_stream [FILE.knm]`.
//!
//! Every syntax element passes by as it is read, under its name in spec/. Without an argument a
//! short sequence of the performer is inspected.

use anyhow::{Result, bail};
use kn_bitstream::Element;
use kn_codec::{Encoder, EncoderConfig, Limits, Progress, StreamDecoder};
use kn_mesh::Mesh;
use kn_performer::{Performer, PerformerConfig};
use std::collections::BTreeMap;

fn main() -> Result<()> {
    let stream = match std::env::args_os().nth(1) {
        Some(path) => std::fs::read(path)?,
        None => performer_stream()?,
    };
    // An element ends where the next one begins.
    let mut bits = BTreeMap::<&str, u64>::new();
    let mut last: Option<(&str, u64)> = None;
    let mut count = |element: &Element<'_>| {
        if let Some((name, start)) = last {
            *bits.entry(name).or_default() += element.bit - start;
        }
        last = Some((element.name.text(), element.bit));
    };

    let mut decoder = StreamDecoder::new(Limits::default());
    decoder.push(&stream);
    let mut mesh = Mesh::default();
    loop {
        match decoder.poll_traced(&mut mesh, Some(&mut count))? {
            Progress::Frame(frame) => println!("{frame:?}"),
            Progress::End => break,
            Progress::NeedBytes(count) => bail!("the file ends early: {count} bytes are missing"),
        }
    }
    if let Some((name, start)) = last {
        *bits.entry(name).or_default() += 8 * stream.len() as u64 - start;
    }

    println!("\n{:>12}  element", "bits");
    let mut bits: Vec<_> = bits.into_iter().collect();
    bits.sort_by_key(|&(_, bits)| std::cmp::Reverse(bits));
    for (name, bits) in bits {
        println!("{bits:>12}  {name}");
    }
    Ok(())
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
