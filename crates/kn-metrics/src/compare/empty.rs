//! Comparisons with empty frames.

use super::{CompareError, CompareOptions, Comparison, Metric};
use crate::p2s::psnr;

/// The sides of a comparison that are empty: meshes without vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmptySide {
    /// The reference or the distorted mesh alone.
    One,
    /// Both meshes.
    Both,
}

/// The comparison of two frames of which at least one is empty, by convention.
///
/// Two empty frames are equal: their distances and MSDM2 are 0, their decibels infinite, and they
/// do not count in means. Where one frame is empty, nothing of the other is found: every distance is
/// the diagonal of the box, as the decibels have it too, and MSDM2 is 1.
///
/// # Errors
/// The options name no box, or one without extent.
pub fn compare_empty(
    empty: EmptySide,
    options: &CompareOptions,
) -> Result<Comparison, CompareError> {
    let bounds = options.bounds.filter(|bounds| bounds.diagonal() > 0.0);
    let bounds = bounds.ok_or(CompareError::NoExtent)?;
    let relative = if empty == EmptySide::Both { 0.0 } else { 1.0 };
    let distance = relative * bounds.diagonal();
    let decibels = psnr(distance * distance, bounds.longest_side());
    let mut comparison = Comparison::default();
    comparison.of_nothing = empty == EmptySide::Both;
    for metric in Metric::ALL {
        let (value, is_measured) = match metric {
            Metric::P2sRms | Metric::Hausdorff => (relative, true),
            Metric::P2sRmsWorld | Metric::HausdorffWorld => (distance, true),
            Metric::P2sPsnr => (decibels, true),
            Metric::Msdm2 | Metric::Msdm2Forward | Metric::Msdm2Backward => {
                (relative, options.msdm2)
            }
            Metric::Msdm2Projected => (relative, options.msdm2 && options.projected),
            Metric::D1Psnr | Metric::D2Psnr => (decibels, options.points.is_some()),
        };
        if is_measured {
            comparison.set(metric, value);
        }
    }
    Ok(comparison)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kn_mesh::BoundingBox;

    #[test]
    fn values_of_empty_frames_are_finite_or_infinitely_good() {
        let bounds = BoundingBox { min: [0.0; 3], max: [3.0, 4.0, 12.0] };
        let options = CompareOptions::default().with_bounds(bounds);
        let one = compare_empty(EmptySide::One, &options).expect("a box");
        assert_eq!(one.iter().count(), Metric::ALL.len());
        assert_eq!((one.get(Metric::P2sRms), one.get(Metric::Msdm2)), (Some(1.0), Some(1.0)));
        assert_eq!(one.get(Metric::HausdorffWorld), Some(13.0));
        let decibels = one.get(Metric::D1Psnr).expect("measured");
        assert!((decibels - 10.0 * (3.0_f64 * 144.0 / 169.0).log10()).abs() < 1e-12);
        let both = compare_empty(EmptySide::Both, &options).expect("a box");
        assert_eq!((both.get(Metric::P2sRms), both.get(Metric::Msdm2)), (Some(0.0), Some(0.0)));
        assert_eq!(both.get(Metric::P2sPsnr), Some(f64::INFINITY));
        assert!(both.iter().all(|(_, value)| !value.is_nan()));
    }

    #[test]
    fn two_empty_frames_do_not_count_in_means() {
        let bounds = BoundingBox { min: [0.0; 3], max: [1.0; 3] };
        let options = CompareOptions::distances().with_bounds(bounds);
        let both = compare_empty(EmptySide::Both, &options).expect("a box");
        let one = compare_empty(EmptySide::One, &options).expect("a box");
        assert_eq!(Comparison::mean([&both, &one]), Some(one));
        assert_eq!(Comparison::mean([&both, &both]), Some(both));
    }

    #[test]
    fn a_box_is_needed() {
        let error = compare_empty(EmptySide::Both, &CompareOptions::default());
        assert_eq!(error, Err(CompareError::NoExtent));
    }
}
