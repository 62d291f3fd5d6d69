//! The result of a comparison: table, CSV, JSON.

use crate::stream;
use crate::table::{grouped, table};
use kn_sequence::{Comparison, FrameComparison, Metric, SequenceComparison};
use serde::Serialize;
use std::io::{self, Write};

/// The measured values of a comparison.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    /// Over all frames.
    mean: Comparison,
    /// Over the P-frames, where the other side is a stream that has some.
    #[serde(skip_serializing_if = "Option::is_none")]
    mean_predicted: Option<Comparison>,
    frames: Vec<FrameRow>,
    /// The box that relative values refer to.
    #[serde(rename = "box")]
    scale: BoxLengths,
}

/// Lengths of the reference's box in world units.
#[derive(Debug, Serialize)]
struct BoxLengths {
    side: f64,
    diagonal: f64,
}

/// One frame.
#[derive(Debug, Serialize)]
pub(super) struct FrameRow {
    index: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    kind: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bytes: Option<u64>,
    #[serde(flatten)]
    comparison: Comparison,
}

impl From<FrameComparison> for FrameRow {
    fn from(frame: FrameComparison) -> Self {
        let FrameComparison { index, bytes, comparison, .. } = frame;
        Self { index, kind: frame.kind.map(stream::kind_letter), bytes, comparison }
    }
}

/// Column titles of the table, after the frame's own.
const TITLES: [&str; 9] = [
    "P2S RMS",
    "of diagonal",
    "PSNR dB",
    "Hausdorff",
    "of diagonal",
    "MSDM2",
    "projected",
    "D1 dB",
    "D2 dB",
];

impl Report {
    pub(super) fn new(measured: SequenceComparison) -> Self {
        let SequenceComparison { bounds, mean, mean_predicted, .. } = measured;
        let scale = BoxLengths { side: bounds.longest_side(), diagonal: bounds.diagonal() };
        let frames = measured.frames.into_iter().map(FrameRow::from).collect();
        Self { mean, mean_predicted, frames, scale }
    }

    pub(super) fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(
            out,
            "box of the reference: longest side {:.6}, diagonal {:.6}",
            self.scale.side, self.scale.diagonal
        )?;
        let titles: Vec<&str> = ["frame", "kind", "bytes"].into_iter().chain(TITLES).collect();
        let mut table = table(&titles);
        for frame in &self.frames {
            let own = [
                frame.index.to_string(),
                frame.kind.unwrap_or("").to_owned(),
                frame.bytes.map_or(String::new(), grouped),
            ];
            table.add_row(own.into_iter().chain(cells(&frame.comparison)));
        }
        let means = [("mean", Some(&self.mean)), ("mean P", self.mean_predicted.as_ref())];
        for (name, mean) in means {
            if let Some(mean) = mean {
                let own = [name.to_owned(), String::new(), String::new()];
                table.add_row(own.into_iter().chain(cells(mean)));
            }
        }
        writeln!(out, "{table}")
    }

    pub(super) fn write_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        let names = Metric::ALL.map(Metric::name).join(",");
        writeln!(out, "frame,kind,bytes,{names}")?;
        for frame in &self.frames {
            let kind = frame.kind.unwrap_or("");
            let bytes = frame.bytes.map_or(String::new(), |bytes| bytes.to_string());
            let value = |metric| {
                frame.comparison.get(metric).map_or(String::new(), |value| value.to_string())
            };
            writeln!(out, "{},{kind},{bytes},{}", frame.index, Metric::ALL.map(value).join(","))?;
        }
        Ok(())
    }
}

fn cells(comparison: &Comparison) -> [String; 9] {
    let value = |metric: Metric, digits: usize| {
        comparison.get(metric).map_or(String::new(), |value| format!("{value:.digits$}"))
    };
    let relative = |metric: Metric, digits: usize| {
        let scaled = comparison.get(metric).map(|value| 1e4 * value);
        scaled.map_or(String::new(), |value| format!("{value:.digits$}e-4"))
    };
    [
        value(Metric::P2sRmsWorld, 6),
        relative(Metric::P2sRms, 2),
        value(Metric::P2sPsnr, 2),
        value(Metric::HausdorffWorld, 6),
        relative(Metric::Hausdorff, 1),
        value(Metric::Msdm2, 4),
        value(Metric::Msdm2Projected, 4),
        value(Metric::D1Psnr, 2),
        value(Metric::D2Psnr, 2),
    ]
}
