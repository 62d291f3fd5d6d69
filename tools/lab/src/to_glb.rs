//! Joins a sequence of scans into one animated GLB file:
//! `cargo run --release -p kn-lab -- to-glb out.glb 'scan/*.obj'`.

use anyhow::{Context, Result};
use kn_io::{GlbWriter, Inputs, ReadNotes, ReadOptions};
use kn_mesh::CleanReport;
use std::path::{Path, PathBuf};

pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let mut arguments = arguments.iter().map(PathBuf::from);
    let output = arguments.next().context("usage: to-glb OUTPUT.glb INPUT...")?;
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
