//! The result and the report of a fit.

use crate::group::Group;
use crate::matching::{Correspondences, Match};
use crate::measures::FitMeasures;
use crate::sample::Sample;
use crate::target::FitTarget;
use kn_deform::NodeTransform;

/// A fitted frame.
#[derive(Clone, Debug)]
pub struct Fit {
    /// `#N`, one transform per key node; components that are not enabled have their neutral value.
    pub transforms: Vec<NodeTransform>,
    /// Report of the fit.
    pub report: FitReport,
}

/// Convergence and residuals of a fit. Distances are in units of the positions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FitReport {
    /// Number of correspondence steps.
    pub steps: usize,
    /// Number of evaluations of the energy in all steps.
    pub evaluations: usize,
    /// Whether the last step moved the surface by less than the tolerance.
    pub converged: bool,
    /// Distances from the deformed source to the target's surface.
    pub source_to_target: Residuals,
    /// Distances from the target to the deformed source's surface.
    pub target_to_source: Residuals,
    /// Measures of what the motion does not explain, where [`crate::FitOptions::measures`] asks for
    /// them.
    pub measures: Option<FitMeasures>,
}

/// Distances of one direction, weighted by area where it says so.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residuals {
    /// RMS distance, weighted by area.
    pub rms: f64,
    /// Median distance.
    pub median: f64,
    /// 95th percentile of the distances.
    pub p95: f64,
    /// Largest distance.
    pub max: f64,
    /// Share of the area that has no partner, because of its normal or because the closest point
    /// lies on a border of the other mesh.
    pub unmatched: f64,
}

impl FitReport {
    /// Fills in the residuals.
    pub(crate) fn measure(&mut self, group: &Group, target: &FitTarget, matches: &Correspondences) {
        self.source_to_target = Residuals::of(&matches.forward, &group.all);
        self.target_to_source = Residuals::of(&matches.backward, &target.sample);
    }
}

impl Residuals {
    fn of(matches: &[Match], sample: &Sample) -> Self {
        let mut distances: Vec<f64> = matches.iter().map(|found| found.distance).collect();
        distances.sort_unstable_by(f64::total_cmp);
        let Some(&max) = distances.last() else { return Self::default() };
        let quantile = |share: f64| distances[((distances.len() - 1) as f64 * share) as usize];
        let pairs = || matches.iter().zip(&sample.weights);
        Self {
            rms: pairs().map(|(m, w)| w * m.distance * m.distance).sum::<f64>().sqrt(),
            median: quantile(0.5),
            p95: quantile(0.95),
            max,
            unmatched: pairs().filter(|(m, _)| !m.accepted).map(|(_, w)| w).sum(),
        }
    }
}
