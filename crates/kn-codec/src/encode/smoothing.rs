//! The encoder's choice of how strongly an I-frame is smoothed.

use crate::decode::Reconstruction;
use kn_bitstream::MAX_SMOOTHING;
use kn_fit::FitTarget;

/// Vertices that the choice looks at, about.
const SAMPLES: usize = 4000;
/// How much farther from the scan a smoothed surface may be than the unsmoothed one. MSDM2 still
/// falls beyond the strength with the smallest distance; see `docs/notes/smoothing.md`.
const TOLERANCE: f64 = 1.03;

/// The greatest strength whose surface is no farther from the scan than without smoothing. `scan` is
/// in grid steps; `unit` reference units make a grid step. The reconstruction has decoded the
/// I-frame; its reference is left at some strength.
///
/// Where the scan was on the grid from the start, nothing is smoothed.
pub(crate) fn choose_smoothing(
    reconstruction: &mut Reconstruction,
    scan: &FitTarget,
    unit: f64,
) -> u8 {
    let mut error = |strength| {
        reconstruction.smooth(strength);
        let reference = reconstruction.reference();
        let stride = (reference.len() / SAMPLES).max(1);
        let points: Vec<[f64; 3]> =
            reference.iter().step_by(stride).map(|p| p.map(|c| f64::from(c) / unit)).collect();
        scan.rms_distance(&points)
    };
    let bound = TOLERANCE * error(0);
    (1..=MAX_SMOOTHING).rev().find(|&strength| error(strength) <= bound).unwrap_or(0)
}
