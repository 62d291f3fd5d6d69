//! Rate-distortion curves of every codec on every sequence.

use super::results::{CellResult, CellRow, Share};
use kn_metrics::Metric;
use kn_metrics::RatePoint;

/// A number that curves are drawn and compared in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quality {
    Msdm2,
    P2s,
    D1,
    D2,
}

impl Quality {
    pub(super) const ALL: [Self; 4] = [Self::Msdm2, Self::P2s, Self::D1, Self::D2];

    pub(super) fn metric(self) -> Metric {
        match self {
            Self::Msdm2 => Metric::Msdm2,
            Self::P2s => Metric::P2sPsnr,
            Self::D1 => Metric::D1Psnr,
            Self::D2 => Metric::D2Psnr,
        }
    }

    /// Its name for people.
    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Msdm2 => "MSDM2",
            Self::P2s => "P2S PSNR",
            Self::D1 => "D1 PSNR",
            Self::D2 => "D2 PSNR",
        }
    }

    /// The unit with a leading space.
    pub(super) fn unit(self) -> &'static str {
        match self {
            Self::Msdm2 => "",
            Self::P2s | Self::D1 | Self::D2 => " dB",
        }
    }

    pub(super) fn digits(self) -> usize {
        match self {
            Self::Msdm2 => 4,
            Self::P2s | Self::D1 | Self::D2 => 2,
        }
    }

    /// Whether a larger value is better.
    pub(super) fn is_larger_better(self) -> bool {
        self != Self::Msdm2
    }

    /// Marks the points of a line, by rising rate, whose value no cheaper point reaches.
    pub(super) fn front(self, line: &[(f64, f64, &str)]) -> Vec<bool> {
        let mut best = f64::NEG_INFINITY;
        let is_better = |point: &(f64, f64, &str)| {
            let value = self.increasing(point.1);
            let better = value > best;
            best = best.max(value);
            better
        };
        line.iter().map(is_better).collect()
    }

    /// The value that enters the Bjøntegaard delta. Larger is better.
    fn increasing(self, value: f64) -> f64 {
        if self.is_larger_better() { value } else { 1.0 - value }
    }
}

/// A point of a curve.
#[derive(Clone, Debug)]
pub(super) struct Point {
    pub(super) name: String,
    /// Bytes a frame: of all frames, and of P-frames where the codec has some.
    bytes: [Option<f64>; 2],
    /// By quality, of all frames and of P-frames.
    values: [[Option<f64>; 4]; 2],
}

impl Point {
    /// A point of another codec, which is known by its means only.
    pub(super) fn foreign(name: String, bytes: f64, values: [Option<f64>; 4]) -> Self {
        Self { name, bytes: [Some(bytes), None], values: [values, [None; 4]] }
    }

    fn of_cell(name: &str, result: &CellResult) -> Self {
        let shares = [Share::All, Share::Predicted];
        let value = |share| {
            let finite = |value: &f64| value.is_finite();
            Quality::ALL.map(|quality| result.mean(quality.metric(), share).filter(finite))
        };
        Self {
            name: name.into(),
            bytes: shares.map(|share| result.bytes_per_frame(share)),
            values: shares.map(value),
        }
    }

    pub(super) fn bytes(&self, share: Share) -> Option<f64> {
        self.bytes[share as usize]
    }

    pub(super) fn value(&self, quality: Quality, share: Share) -> Option<f64> {
        self.values[share as usize][quality as usize]
    }
}

/// The points of one codec on one sequence.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    pub(super) sequence: String,
    pub(super) codec: String,
    /// Whether the numbers come from a CSV table.
    pub(super) foreign: bool,
    pub(super) points: Vec<Point>,
}

impl Curve {
    /// Rates and values of the points that have both, by rising rate.
    pub(super) fn line(&self, quality: Quality, share: Share) -> Vec<(f64, f64, &str)> {
        let pair = |point| -> Option<(f64, f64, &str)> {
            let point: &Point = point;
            Some((point.bytes(share)?, point.value(quality, share)?, &point.name))
        };
        let mut line: Vec<_> = self.points.iter().filter_map(pair).collect();
        line.sort_by(|a, b| a.0.total_cmp(&b.0));
        line
    }

    /// The point as a Bjøntegaard delta takes it.
    pub(super) fn rate_points(&self, quality: Quality, share: Share) -> Vec<RatePoint> {
        let point = |(rate, value, _)| RatePoint { rate, quality: quality.increasing(value) };
        self.line(quality, share).into_iter().map(point).collect()
    }
}

/// Curves of the cells, in their order: sequence by sequence, codec by codec.
pub(super) fn of_cells(cells: &[CellRow]) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    for cell in cells {
        let point = Point::of_cell(&cell.point, &cell.result);
        let same = |curve: &&mut Curve| {
            curve.sequence == cell.sequence && curve.codec == cell.codec && !curve.foreign
        };
        match curves.iter_mut().find(same) {
            Some(curve) => curve.points.push(point),
            None => curves.push(Curve {
                sequence: cell.sequence.clone(),
                codec: cell.codec.clone(),
                foreign: false,
                points: vec![point],
            }),
        }
    }
    curves
}

/// The qualities that any curve has.
pub(super) fn qualities(curves: &[Curve]) -> Vec<Quality> {
    let has =
        |quality: &Quality| curves.iter().any(|curve| !curve.line(*quality, Share::All).is_empty());
    Quality::ALL.into_iter().filter(has).collect()
}

/// The codecs, each once, in their order.
pub(super) fn codecs(curves: &[Curve]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for curve in curves {
        if !names.contains(&curve.codec.as_str()) {
            names.push(&curve.codec);
        }
    }
    names
}
