//! What a fit says about itself.

use crate::group::Group;
use crate::matching::{Correspondences, Match};
use crate::sample::Sample;
use crate::target::FitTarget;
use kn_deform::NodeTransform;

/// A point is far when its distance exceeds this share of the diagonal of the target's box ...
const FAR: f64 = 0.025;
/// ... and a frame is not explained when far points stand for this share of the area.
const UNEXPLAINED: f64 = 0.004;

/// A fitted frame.
#[derive(Clone, Debug)]
pub struct Fit {
    /// `#N`, one transform per key node; components that are not enabled have their neutral value.
    pub transforms: Vec<NodeTransform>,
    /// How well it went.
    pub report: FitReport,
}

/// Convergence and residuals of a fit. Distances are in units of the positions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FitReport {
    /// Correspondence steps taken.
    pub steps: usize,
    /// Evaluations of the energy, all steps together.
    pub evaluations: usize,
    /// Whether the last step moved the surface by less than the tolerance.
    pub converged: bool,
    /// From the deformed source to the target's surface.
    pub source_to_target: Residuals,
    /// From the target to the deformed source's surface.
    pub target_to_source: Residuals,
    /// Why the motion does not explain the frame, where it does not.
    pub failure: Option<FitFailure>,
}

/// Distances of one direction, weighted by area where it says so.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residuals {
    /// Root of the area-weighted mean square.
    pub rms: f64,
    /// Half of the points are nearer.
    pub median: f64,
    /// 95 % of the points are nearer.
    pub p95: f64,
    /// The farthest point.
    pub max: f64,
    /// Share of the area that found no partner: its normal or the border of the other mesh spoke
    /// against the closest point.
    pub unmatched: f64,
}

/// Why the encoder should think about a new I-frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FitFailure {
    /// A part of the source has no target near it: a lost limb, a ball let go.
    SourceUnexplained {
        /// Its share of the source's area.
        share: f64,
        /// The source's vertex that is farthest from the target.
        vertex: u32,
    },
    /// A part of the target has no source near it: something new, or a limb that the source did
    /// not follow.
    TargetUnexplained {
        /// Its share of the target's area.
        share: f64,
        /// The target's vertex that is farthest from the source.
        vertex: u32,
    },
}

impl FitReport {
    /// Fills in the residuals and what follows from them.
    pub(crate) fn measure(&mut self, group: &Group, target: &FitTarget, matches: &Correspondences) {
        self.source_to_target = Residuals::of(&matches.forward, &group.all);
        self.target_to_source = Residuals::of(&matches.backward, &target.sample);
        let limit = FAR * target.diagonal;
        let lost = far(&matches.forward, &group.all, limit);
        let new = far(&matches.backward, &target.sample, limit);
        self.failure = if lost.0 >= UNEXPLAINED && lost.0 >= new.0 {
            Some(FitFailure::SourceUnexplained { share: lost.0, vertex: lost.1 })
        } else if new.0 >= UNEXPLAINED {
            Some(FitFailure::TargetUnexplained { share: new.0, vertex: new.1 })
        } else {
            None
        };
    }
}

/// The share of the area that is farther than `limit`, and the farthest vertex.
fn far(matches: &[Match], sample: &Sample, limit: f64) -> (f64, u32) {
    let (mut share, mut farthest) = (0.0, (limit, 0));
    for ((found, &vertex), &weight) in matches.iter().zip(&sample.vertices).zip(&sample.weights) {
        if found.distance > limit {
            share += weight;
        }
        if found.distance > farthest.0 {
            farthest = (found.distance, vertex);
        }
    }
    (share, farthest.1)
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

impl std::fmt::Display for FitFailure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::SourceUnexplained { share, vertex } => write!(
                f,
                "{:.1} % of the reference, around its vertex {vertex}, is not in the frame",
                100.0 * share
            ),
            Self::TargetUnexplained { share, vertex } => write!(
                f,
                "{:.1} % of the frame, around its vertex {vertex}, is not explained by the reference",
                100.0 * share
            ),
        }
    }
}
