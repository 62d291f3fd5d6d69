//! Joins a sequence of scans into one animated GLB file:
//! `cargo run --release -p kn-io --example to_glb -- out.glb 'scan/*.obj'`.

use kn_io::{GlbWriter, Inputs, ReadNotes, ReadOptions};
use kn_mesh::CleanReport;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let Some(output) = arguments.next() else { return Err("give an output and inputs".into()) };
    let inputs: Vec<PathBuf> = arguments.collect();
    let options = ReadOptions::default();
    let mut writer = GlbWriter::create(Path::new(&output), options.frame_rate)?;
    let (mut notes, mut report) = (ReadNotes::default(), CleanReport::default());
    for frame in Inputs::find(&inputs, options)?.frames() {
        let frame = frame?;
        let cleaned = kn_mesh::clean(&frame.mesh)?;
        notes += &frame.notes;
        report += cleaned.report;
        writer.push(&cleaned.mesh)?;
    }
    writer.finish()?;
    println!("{report}");
    if !notes.is_empty() {
        println!("{notes}");
    }
    Ok(())
}
