//! A known motion with other influence or other affine nodes.

use crate::error::FitError;
use crate::fitter::{Fitter, combinations, restrict};
use crate::options::FitOptions;
use crate::source::FitSource;
use crate::target::FitTarget;
use kn_deform::NodeTransform;
use kn_mesh::vec3::Vec3;

/// Goes on from `transforms` (`#N`), which nearly fit: they may come from a fit with other influence
/// or with other affine nodes. Returns the positions (`#V × 3`) of `source` as it is then deformed.
///
/// # Errors
/// The errors of [`Fitter::new`].
pub fn refit(
    source: &FitSource,
    target: &FitTarget,
    options: &FitOptions,
    transforms: &[NodeTransform],
) -> Result<Vec<Vec3>, FitError> {
    let mut fitter = Fitter::new(source)?;
    let start = restrict(transforms, &combinations(source, options.combination));
    fitter.continue_frame(source, target, options, start)?;
    Ok(fitter.deformed().to_vec())
}
