//! The result of a comparison: table, CSV, JSON.

use crate::distortion::{Distortion, Perceptual, Scale};
use crate::sequence::Frame;
use crate::stream;
use crate::table::{grouped, table};
use kn_codec::FrameKind;
use serde::Serialize;
use std::io::{self, Write};

/// What was measured.
#[derive(Debug, Serialize)]
pub(super) struct Comparison {
    /// Over all frames.
    mean: Distortion,
    /// Over the P-frames, where the other side is a stream that has some.
    #[serde(skip_serializing_if = "Option::is_none")]
    mean_predicted: Option<Distortion>,
    frames: Vec<FrameRow>,
    /// What relative values refer to.
    #[serde(rename = "box")]
    scale: Scale,
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
    distortion: Distortion,
}

impl FrameRow {
    /// What was measured on `other`.
    pub(super) fn new(other: &Frame, distortion: Distortion) -> Self {
        let kind = other.kind.map(stream::kind_letter);
        Self { index: other.index, kind, bytes: other.bytes, distortion }
    }

    fn is_predicted(&self) -> bool {
        self.kind == Some(stream::kind_letter(FrameKind::Predicted))
    }
}

/// Column titles of the table, after the frame's own.
const TITLES: [&str; 7] =
    ["P2S RMS", "of diagonal", "PSNR dB", "Hausdorff", "of diagonal", "MSDM2", "projected"];

impl Comparison {
    /// Takes the means; `None` without frames.
    pub(super) fn new(frames: Vec<FrameRow>, scale: Scale) -> Option<Self> {
        let mean = Distortion::mean(frames.iter().map(|frame| &frame.distortion))?;
        let predicted = frames.iter().filter(|frame| frame.is_predicted());
        let mean_predicted = Distortion::mean(predicted.map(|frame| &frame.distortion));
        Some(Self { mean, mean_predicted, frames, scale })
    }

    pub(super) fn write_table(&self, out: &mut impl Write) -> io::Result<()> {
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
            table.add_row(own.into_iter().chain(cells(&frame.distortion)));
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
        writeln!(
            out,
            "frame,kind,bytes,p2s_rms,p2s_rms_world,p2s_psnr,hausdorff,hausdorff_world,\
             msdm2,msdm2_ab,msdm2_ba,msdm2_projected"
        )?;
        for frame in &self.frames {
            let d = &frame.distortion;
            let kind = frame.kind.unwrap_or("");
            let bytes = frame.bytes.map_or(String::new(), |bytes| bytes.to_string());
            write!(out, "{},{kind},{bytes},{},{},", frame.index, d.p2s_rms, d.p2s_rms_world)?;
            write!(out, "{},{},{}", d.p2s_psnr, d.hausdorff, d.hausdorff_world)?;
            match &d.perceptual {
                Some(p) => writeln!(
                    out,
                    ",{},{},{},{}",
                    p.msdm2, p.msdm2_ab, p.msdm2_ba, p.msdm2_projected
                )?,
                None => writeln!(out, ",,,,")?,
            }
        }
        Ok(())
    }
}

fn cells(distortion: &Distortion) -> [String; 7] {
    let perceptual = |value: fn(&Perceptual) -> f64| {
        distortion.perceptual.as_ref().map_or(String::new(), |p| format!("{:.4}", value(p)))
    };
    [
        format!("{:.6}", distortion.p2s_rms_world),
        format!("{:.2}e-4", distortion.p2s_rms * 1e4),
        format!("{:.2}", distortion.p2s_psnr),
        format!("{:.6}", distortion.hausdorff_world),
        format!("{:.1}e-4", distortion.hausdorff * 1e4),
        perceptual(|p| p.msdm2),
        perceptual(|p| p.msdm2_projected),
    ]
}
