//! What a fit says about itself.

use kn_deform::NodeTransform;

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

/// Distances of one direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residuals {
    /// Root of the mean square.
    pub rms: f64,
    /// Half of the points are nearer.
    pub median: f64,
    /// 95 % of the points are nearer.
    pub p95: f64,
    /// The farthest point.
    pub max: f64,
    /// Share of the points that found no partner: normal or boundary rejected it, or it is too far.
    pub unmatched: f64,
}

/// Why the encoder should think about a new I-frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FitFailure {
    /// A connected piece of the source has no target near it: a lost limb, a ball let go.
    SourceUnexplained {
        /// Its share of the source's area.
        share: f64,
        /// Its vertex that is farthest from the target.
        vertex: u32,
    },
    /// A connected piece of the target has no source near it: something new, or a limb that the
    /// source did not follow.
    TargetUnexplained {
        /// Its share of the target's area.
        share: f64,
        /// Its vertex that is farthest from the source.
        vertex: u32,
    },
    /// The energy could not be lowered from any start.
    NoDescent,
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
            Self::NoDescent => f.write_str("no start led to a lower energy"),
        }
    }
}
