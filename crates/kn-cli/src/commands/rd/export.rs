//! results.json and results.csv.

use super::deltas::Delta;
use super::results::{CellRow, Share, Study};
use crate::output::write_file;
use anyhow::{Context, Result};
use kn_metrics::Metric;
use serde::Serialize;
use std::fs;
use std::path::Path;

const JSON: &str = "results.json";

/// The content of results.json: the study and its results.
#[derive(Serialize)]
struct Results<'a> {
    #[serde(flatten)]
    study: &'a Study,
    bd_rates: &'a [Delta],
}

/// Writes both files.
///
/// # Errors
/// A file cannot be written.
pub(super) fn write(output: &Path, study: &Study, deltas: &[Delta]) -> Result<()> {
    let results = Results { study, bd_rates: deltas };
    write_file(&output.join(JSON), |out| Ok(serde_json::to_writer_pretty(out, &results)?))?;
    write_file(&output.join("results.csv"), |out| write_rows(out, study))
}

/// Reads the study that an earlier run wrote.
///
/// # Errors
/// There is none, or another version of kn wrote it.
pub(super) fn read(output: &Path) -> Result<Study> {
    let path = output.join(JSON);
    let named = || path.display().to_string();
    let text = fs::read(&path).with_context(named)?;
    serde_json::from_slice(&text).with_context(named)
}

fn write_rows(out: &mut dyn std::io::Write, study: &Study) -> Result<()> {
    let mut rows = csv::Writer::from_writer(out);
    let own = [
        "sequence",
        "codec",
        "point",
        "bytes_per_frame",
        "intra_bytes",
        "predicted_bytes",
        "mbit_per_s",
    ];
    let seconds = ["encode_cpu_seconds", "decode_cpu_seconds"];
    let metrics = Metric::ALL.map(Metric::name);
    rows.write_record(own.iter().chain(&metrics).chain(&seconds).chain(&["key"]))?;
    for cell in &study.cells {
        rows.write_record(row(cell, study))?;
    }
    rows.flush()?;
    Ok(())
}

fn row(cell: &CellRow, study: &Study) -> Vec<String> {
    let result = &cell.result;
    let text = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    let bytes = result.bytes_per_frame(Share::All);
    let fps = study.sequences.iter().find(|one| one.name == cell.sequence).map(|one| one.fps);
    let mbit = bytes.zip(fps).map(|(bytes, fps)| megabits(bytes, fps));
    let mut row = vec![cell.sequence.clone(), cell.codec.clone(), cell.point.clone()];
    row.extend([bytes, result.intra_bytes(), result.bytes_per_frame(Share::Predicted)].map(text));
    row.push(text(mbit));
    row.extend(Metric::ALL.map(|metric| text(result.mean(metric, Share::All))));
    let frames = result.frames.len().max(1) as f64;
    let seconds = [result.encode_seconds, result.decode_seconds];
    row.extend(seconds.map(|seconds| (seconds / frames).to_string()));
    row.push(result.key.clone());
    row
}

/// Megabits a second.
pub(super) fn megabits(bytes_per_frame: f64, fps: f64) -> f64 {
    8e-6 * bytes_per_frame * fps
}
