//! Left and right, told by toes, knees and elbows, which point forwards.

use super::V3;
use super::body::{self, HIP, Pose, SHOULDER};
use super::fit::Fit;
use super::surface::Samples;

/// Evidence that the body faces where its pose says: positive for, negative against; about ±3 when
/// both feet are clear.
pub(super) fn evidence(fit: &Fit, samples: &Samples) -> f64 {
    let front = body::facing(&fit.pose);
    let clip = |x: f64| x.clamp(-1.0, 1.0);
    let mut sum = 0.0;
    for side in 0..2 {
        let foot = foot_offset(&fit.pose, side, samples, fit.scale);
        sum += 1.5 * clip(foot.dot(&front) / 0.05);
        let knee = bend(&fit.pose, HIP[side]);
        sum += 0.5 * clip(knee.dot(&front) / 0.06);
        let elbow = bend(&fit.pose, SHOULDER[side]);
        sum -= 0.5 * clip(elbow.dot(&front) / 0.10);
    }
    sum
}

/// The vector from the middle of the ends of a limb to its middle joint.
fn bend(pose: &Pose, root: usize) -> V3 {
    pose[root + 1] - (pose[root] + pose[root + 2]) * 0.5
}

/// Mean offset of the foot's surface from the ankle, across the leg.
pub(super) fn foot_offset(pose: &Pose, side: usize, samples: &Samples, scale: f64) -> V3 {
    let (knee, ankle) = (pose[HIP[side] + 1], pose[HIP[side] + 2]);
    let other = pose[HIP[1 - side] + 2];
    let down = (ankle - knee).try_normalize(1e-9).unwrap_or_else(|| -V3::y());
    let (mut sum, mut count) = (V3::zeros(), 0.0);
    for point in &samples.points {
        let from = point - ankle;
        let depth = from.dot(&down);
        let own = from.norm_squared() <= (point - other).norm_squared();
        if own && depth > -0.03 * scale && from.norm() < 0.24 * scale {
            sum += from - down * depth;
            count += 1.0;
        }
    }
    if count > 0.0 { sum / count } else { V3::zeros() }
}

/// Turns the toes to where the foot's surface is.
pub(super) fn point_toes(fit: &mut Fit, samples: &Samples) {
    for side in 0..2 {
        let ankle = HIP[side] + 2;
        let offset = foot_offset(&fit.pose, side, samples, fit.scale);
        if let Some(way) = offset.try_normalize(0.01 * fit.scale) {
            let down = (fit.pose[ankle] - fit.pose[ankle - 1])
                .try_normalize(1e-9)
                .unwrap_or_else(|| -V3::y());
            fit.pose[ankle + 1] = fit.pose[ankle] + (way * 0.15 + down * 0.05) * fit.scale;
        }
    }
}
