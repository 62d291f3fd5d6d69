//! The encoder's choice of how strongly an I-frame is smoothed.

use crate::decode::Reconstruction;
use crate::encode::tuning::SmoothingTuning;
use kn_bitstream::MAX_SMOOTHING;
use kn_metrics::TriangleTree;

/// The greatest strength whose surface is as near to the scan as without smoothing, or at most
/// [`SmoothingTuning::tolerance`] times as far. `scan` is in grid steps; `unit` reference units
/// make a grid step. The reconstruction has decoded the I-frame; its reference is left at some
/// strength.
///
/// A scan that was on the grid from the start is not smoothed.
pub(crate) fn choose_smoothing(
    reconstruction: &mut Reconstruction,
    scan: &TriangleTree,
    unit: f64,
    tuning: &SmoothingTuning,
) -> u8 {
    let mut error = |strength| {
        reconstruction.smooth(strength);
        let reference = reconstruction.last_positions();
        let faces = &reconstruction.intra().faces;
        let stride = (faces.len() / tuning.samples).max(1);
        // Vertices alone would make noise look larger than it is on the surface between them.
        let centroid = |face: &[u32; 3]| -> [f64; 3] {
            let corners = face.map(|vertex| reference[vertex as usize].map(f64::from));
            std::array::from_fn(|k| (corners[0][k] + corners[1][k] + corners[2][k]) / (3.0 * unit))
        };
        let points: Vec<[f64; 3]> = faces.iter().step_by(stride).map(centroid).collect();
        let closest = scan.closest_all(&points);
        let sum: f64 = closest.iter().map(|closest| closest.distance_squared).sum();
        (sum / points.len().max(1) as f64).sqrt()
    };
    let bound = tuning.tolerance * error(0);
    (1..=MAX_SMOOTHING).rev().find(|&strength| error(strength) <= bound).unwrap_or(0)
}
