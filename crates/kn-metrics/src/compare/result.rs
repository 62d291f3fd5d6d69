//! The result of a comparison: a value for each metric that was computed.

use std::fmt;
use std::str::FromStr;

use kn_mesh::BoundingBox;

use crate::p2s::P2s;

/// A metric: a number that says how much two meshes differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Metric {
    /// Point-to-surface RMS of the worse direction, relative to the diagonal of the box.
    P2sRms,
    /// Point-to-surface RMS of the worse direction, in world units.
    P2sRmsWorld,
    /// Point-to-surface PSNR, 10·log10(3·side²/rms²) with the longest side of the box; infinite
    /// where the surfaces are equal.
    P2sPsnr,
    /// The largest distance found, relative to the diagonal of the box.
    Hausdorff,
    /// The largest distance found, in world units.
    HausdorffWorld,
    /// MSDM2, the mean of both directions: 0 for equal meshes, below 1.
    Msdm2,
    /// MSDM2 of the distorted mesh against the reference.
    Msdm2Forward,
    /// MSDM2 of the reference against the distorted mesh.
    Msdm2Backward,
    /// MSDM2 with the curvature at the closest points, the mean of both directions. It does not
    /// depend on the order of faces.
    Msdm2Projected,
    /// D1, point to point, in decibels, on the points of [`PointSampling`](crate::PointSampling).
    D1Psnr,
    /// D2, point to plane, in decibels, on the same points.
    D2Psnr,
}

impl Metric {
    /// All metrics.
    pub const ALL: [Self; 11] = [
        Self::P2sRms,
        Self::P2sRmsWorld,
        Self::P2sPsnr,
        Self::Hausdorff,
        Self::HausdorffWorld,
        Self::Msdm2,
        Self::Msdm2Forward,
        Self::Msdm2Backward,
        Self::Msdm2Projected,
        Self::D1Psnr,
        Self::D2Psnr,
    ];

    /// Name of the metric in JSON and CSV.
    pub fn name(self) -> &'static str {
        match self {
            Self::P2sRms => "p2s_rms",
            Self::P2sRmsWorld => "p2s_rms_world",
            Self::P2sPsnr => "p2s_psnr",
            Self::Hausdorff => "hausdorff",
            Self::HausdorffWorld => "hausdorff_world",
            Self::Msdm2 => "msdm2",
            Self::Msdm2Forward => "msdm2_ab",
            Self::Msdm2Backward => "msdm2_ba",
            Self::Msdm2Projected => "msdm2_projected",
            Self::D1Psnr => "d1_psnr",
            Self::D2Psnr => "d2_psnr",
        }
    }
}

impl fmt::Display for Metric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The error for a name that is not the name of a metric.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no metric '{name}'")]
pub struct UnknownMetric {
    name: String,
}

impl FromStr for Metric {
    type Err = UnknownMetric;

    fn from_str(name: &str) -> Result<Self, UnknownMetric> {
        let known = Self::ALL.into_iter().find(|metric| metric.name() == name);
        known.ok_or_else(|| UnknownMetric { name: name.to_owned() })
    }
}

/// The metrics of two meshes, or their means over several pairs of meshes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    values: [Option<f64>; Metric::ALL.len()],
    /// Both sides are empty.
    pub(super) of_nothing: bool,
}

impl Comparison {
    /// The value of a metric; `None` where it was not computed.
    pub fn get(&self, metric: Metric) -> Option<f64> {
        self.values[metric as usize]
    }

    /// The metrics that were computed, with their values.
    pub fn iter(&self) -> impl Iterator<Item = (Metric, f64)> + '_ {
        Metric::ALL.into_iter().filter_map(|metric| Some((metric, self.get(metric)?)))
    }

    /// Whether both sides are empty, so that there was nothing to measure.
    pub fn is_of_nothing(&self) -> bool {
        self.of_nothing
    }

    /// Means over several comparisons, for instance over the frames of a sequence. The result has
    /// the metrics that all of them have. Comparisons of two empty frames do not count, unless all
    /// are. Returns `None` without comparisons.
    pub fn mean<'c>(all: impl IntoIterator<Item = &'c Self>) -> Option<Self> {
        let mut all: Vec<&Self> = all.into_iter().collect();
        let of_nothing = all.iter().all(|one| one.of_nothing);
        all.retain(|one| one.of_nothing == of_nothing);
        let mean = |metric| {
            let sum: Option<f64> = all.iter().map(|one| one.get(metric)).sum();
            sum.map(|sum| sum / all.len() as f64)
        };
        (!all.is_empty()).then(|| Self { values: Metric::ALL.map(mean), of_nothing })
    }

    pub(super) fn set(&mut self, metric: Metric, value: f64) {
        self.values[metric as usize] = Some(value);
    }

    pub(super) fn set_distance(&mut self, distance: &P2s, bounds: &BoundingBox) {
        let (side, diagonal) = (bounds.longest_side(), bounds.diagonal());
        self.set(Metric::P2sRms, distance.rms() / diagonal);
        self.set(Metric::P2sRmsWorld, distance.rms());
        self.set(Metric::P2sPsnr, distance.psnr(side));
        self.set(Metric::Hausdorff, distance.hausdorff() / diagonal);
        self.set(Metric::HausdorffWorld, distance.hausdorff());
    }
}

impl FromIterator<(Metric, f64)> for Comparison {
    /// A comparison with these values, for instance read from a file; of a metric that is there
    /// twice the last value counts.
    fn from_iter<I: IntoIterator<Item = (Metric, f64)>>(values: I) -> Self {
        let mut comparison = Self::default();
        values.into_iter().for_each(|(metric, value)| comparison.set(metric, value));
        comparison
    }
}
