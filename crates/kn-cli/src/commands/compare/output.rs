//! The result of a comparison: table, CSV, JSON.

use crate::stream;
use crate::table::{grouped, table};
use kn_sequence::{
    CompareOptions, Comparison, FrameComparison, Metric, PointSampling, SequenceComparison,
};
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
    /// Points on each surface, uniform by area, that distances are measured at.
    samples: usize,
    /// Lines of the grid that D1 and D2 are measured along; without it they are measured at the
    /// vertices and samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    grid: Option<usize>,
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
    pub(super) fn new(measured: SequenceComparison, options: &CompareOptions) -> Self {
        let SequenceComparison { bounds, mean, mean_predicted, .. } = measured;
        let scale = BoxLengths { side: bounds.longest_side(), diagonal: bounds.diagonal() };
        let frames = measured.frames.into_iter().map(FrameRow::from).collect();
        let grid = match options.points {
            Some(PointSampling::Grid(lines)) => Some(lines),
            _ => None,
        };
        Self { mean, mean_predicted, frames, scale, samples: options.samples, grid }
    }

    pub(super) fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(
            out,
            "box of the reference: longest side {:.6}, diagonal {:.6}",
            self.scale.side, self.scale.diagonal
        )?;
        let samples = grouped(self.samples as u64);
        writeln!(out, "samples of each surface: {samples}{}", self.points())?;
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

    /// The points that D1 and D2 were measured at.
    fn points(&self) -> String {
        match (self.grid, self.mean.get(Metric::D1Psnr)) {
            (Some(lines), _) => format!("; D1 and D2 along a grid of {lines} lines, as MPEG does"),
            (None, Some(_)) => "; D1 and D2 at these and at the vertices".to_owned(),
            (None, None) => String::new(),
        }
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
