//! Measures distortion: `cargo run --release --example compare_sequences [SCANS DECODED]`.
//!
//! An argument is a folder, a pattern or a .knm stream. Without any, the performer is measured.

use anyhow::Result;
use kn_codec::{Encoder, EncoderConfig};
use kn_performer::{Performer, PerformerConfig};
use kn_sequence::{CompareSequences, Metric, Sequence, SequenceOptions, compare_sequences};
use std::path::Path;

fn main() -> Result<()> {
    match &std::env::args_os().skip(1).collect::<Vec<_>>()[..] {
        [scans, decoded] => compare(scans.as_ref(), decoded.as_ref()),
        _ => {
            let folder = tempfile::tempdir()?;
            let performer =
                Performer::new(PerformerConfig { vertices: 3_000, ..Default::default() })?;
            let mut encoder = Encoder::new(Vec::new(), EncoderConfig::default())?;
            for index in 0..2 {
                let scan = performer.frame(index);
                kn_io::write_mesh(&folder.path().join(format!("{index}.ply")), &scan)?;
                encoder.push(&scan)?;
            }
            let stream = folder.path().join("dance.knm");
            std::fs::write(&stream, encoder.finish()?.writer)?;
            compare(&folder.path().join("*.ply"), &stream)
        }
    }
}

fn compare(scans: &Path, decoded: &Path) -> Result<()> {
    let options = SequenceOptions::cleaned();
    let (scans, decoded) = (Sequence::open(scans, &options)?, Sequence::open(decoded, &options)?);
    let result = compare_sequences(&scans, &decoded, &CompareSequences::default())?;
    for frame in &result.frames {
        println!("{}: PSNR {:?} dB", frame.index, frame.comparison.get(Metric::P2sPsnr));
    }
    println!("mean MSDM2: {:?}", result.mean.get(Metric::Msdm2));
    Ok(())
}
