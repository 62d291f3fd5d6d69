//! The result of the demo as a table and as JSON.

use crate::table::{grouped, table};
use kn_codec::FrameInfo;
use kn_metrics::{Comparison, Metric};
use serde::Serialize;
use std::io::{self, Write};

/// Frames per second of the performer.
const FPS: f64 = 30.0;

/// Wall-clock seconds of each step.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Seconds {
    pub(super) generate: f64,
    pub(super) encode: f64,
    pub(super) decode: f64,
    pub(super) verify: f64,
    pub(super) measure: f64,
}

/// The content of demo.json.
#[derive(Debug, Serialize)]
pub(super) struct DemoResult {
    bytes: u64,
    /// Bytes of the same frames as 32-bit floats and indices.
    raw_bytes: u64,
    fps: f64,
    verified: bool,
    mean: Option<Comparison>,
    mean_predicted: Option<Comparison>,
    /// Mean point-to-surface RMS of the P-frames' scans against the I-frame held still, metres.
    held_still_rms_world: f64,
    seconds: Seconds,
    frames: Vec<FrameRow>,
}

/// One frame.
#[derive(Debug, Serialize)]
pub(super) struct FrameRow {
    index: u64,
    kind: &'static str,
    bytes: u64,
    vertices: u32,
    faces: u32,
    nodes: u32,
    #[serde(flatten)]
    comparison: Comparison,
    #[serde(skip_serializing_if = "Option::is_none")]
    held_still_rms_world: Option<f64>,
}

impl FrameRow {
    pub(super) fn new(
        info: &FrameInfo,
        kind: &'static str,
        comparison: Comparison,
        held_still_rms_world: Option<f64>,
    ) -> Self {
        Self {
            index: info.index,
            kind,
            bytes: info.bytes,
            vertices: info.vertices,
            faces: info.faces,
            nodes: info.nodes,
            comparison,
            held_still_rms_world,
        }
    }

    fn is_predicted(&self) -> bool {
        self.held_still_rms_world.is_some()
    }
}

impl DemoResult {
    pub(super) fn new(bytes: u64, verified: bool, frames: Vec<FrameRow>, seconds: Seconds) -> Self {
        let predicted = || frames.iter().filter(|frame| frame.is_predicted());
        let held_still = predicted().filter_map(|frame| frame.held_still_rms_world);
        let raw = |frame: &FrameRow| 12 * (u64::from(frame.vertices) + u64::from(frame.faces));
        Self {
            bytes,
            raw_bytes: frames.iter().map(raw).sum(),
            fps: FPS,
            verified,
            mean: Comparison::mean(frames.iter().map(|frame| &frame.comparison)),
            mean_predicted: Comparison::mean(predicted().map(|frame| &frame.comparison)),
            held_still_rms_world: held_still.sum::<f64>() / predicted().count().max(1) as f64,
            seconds,
            frames,
        }
    }

    pub(super) fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut table = table(&[
            "frame",
            "kind",
            "bytes",
            "vertices",
            "P2S mm",
            "held still",
            "PSNR dB",
            "Hausdorff mm",
            "MSDM2",
        ]);
        for frame in &self.frames {
            let own = [
                frame.index.to_string(),
                frame.kind.to_owned(),
                grouped(frame.bytes),
                grouped(frame.vertices.into()),
            ];
            table.add_row(
                own.into_iter().chain(cells(&frame.comparison, frame.held_still_rms_world)),
            );
        }
        if let Some(mean) = &self.mean_predicted {
            let own = ["mean P", "", "", ""].map(String::from);
            table.add_row(own.into_iter().chain(cells(mean, Some(self.held_still_rms_world))));
        }
        writeln!(out, "{table}")?;
        self.write_sum(out)
    }

    fn write_sum(&self, out: &mut dyn Write) -> io::Result<()> {
        let mean_bytes = |predicted: bool| {
            let chosen = || self.frames.iter().filter(|frame| frame.is_predicted() == predicted);
            let bytes: u64 = chosen().map(|frame| frame.bytes).sum();
            grouped(bytes.checked_div(chosen().count() as u64).unwrap_or(0))
        };
        let frames = self.frames.len();
        writeln!(
            out,
            "{frames} frames: {} bytes as floats and indices, {} as .knm ({:.0} : 1)\n\
             mean: I-frame {} bytes, P-frame {} bytes",
            grouped(self.raw_bytes),
            grouped(self.bytes),
            self.raw_bytes as f64 / self.bytes.max(1) as f64,
            mean_bytes(false),
            mean_bytes(true),
        )?;
        let Seconds { generate, encode, decode, verify, measure } = self.seconds;
        writeln!(
            out,
            "seconds: generate {generate:.1}, encode {encode:.1}, decode {decode:.2}, \
             verify {verify:.2}, measure {measure:.1}"
        )?;
        let verdict = if self.verified { "all digests match" } else { "DIGESTS DO NOT MATCH" };
        writeln!(out, "verified: {verdict}")
    }
}

fn cells(comparison: &Comparison, held_still: Option<f64>) -> [String; 5] {
    let text = |value: Option<f64>, factor: f64, digits: usize| {
        value.map_or(String::new(), |value| format!("{:.digits$}", factor * value))
    };
    let millimetres = |metres| text(metres, 1e3, 2);
    [
        millimetres(comparison.get(Metric::P2sRmsWorld)),
        millimetres(held_still),
        text(comparison.get(Metric::P2sPsnr), 1.0, 1),
        millimetres(comparison.get(Metric::HausdorffWorld)),
        text(comparison.get(Metric::Msdm2), 1.0, 3),
    ]
}
