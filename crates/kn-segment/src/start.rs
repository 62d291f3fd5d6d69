//! The start of a fit without a last frame: the template in several poses.

use super::V3;
use super::body::{self, JOINTS, Pose, SHOULDER};
use super::fit::{Fit, Schedule};
use super::surface::Samples;

/// Directions of upper and lower arm in the body's frame (x outwards, y up, z forwards).
const ARMS: [[[f64; 3]; 2]; 9] = [
    [[0.35, -0.93, 0.0], [0.3, -0.9, 0.25]],
    [[0.95, -0.2, 0.1], [0.95, -0.2, 0.2]],
    [[0.3, -0.3, 0.9], [0.0, -0.1, 1.0]],
    [[0.3, 0.95, 0.1], [0.1, 0.95, 0.1]],
    [[0.25, -0.95, 0.0], [0.1, 0.1, 0.95]],
    [[0.7, -0.7, -0.1], [-0.7, -0.5, 0.4]],
    [[0.5, -0.6, 0.5], [-0.8, 0.2, 0.5]],
    [[0.4, -0.6, -0.6], [0.1, -0.7, -0.4]],
    [[0.9, 0.2, 0.2], [-0.4, 0.85, 0.2]],
];
const COARSE_ARMS: [usize; 3] = [0, 1, 2];
const YAWS: usize = 4;

/// Both arms by direction; bone lengths are the template's.
fn with_arm(pose: &mut Pose, side: usize, arm: usize, frame: &[V3; 3], scale: f64) {
    let out = if side == 0 { 1.0 } else { -1.0 };
    let way =
        |d: [f64; 3]| (frame[0] * (d[0] * out) + frame[1] * d[1] + frame[2] * d[2]).normalize();
    let [upper, lower] = ARMS[arm].map(way);
    let shoulder = SHOULDER[side];
    pose[shoulder + 1] = pose[shoulder] + upper * (0.285 * scale);
    pose[shoulder + 2] = pose[shoulder + 1] + lower * (0.25 * scale);
    pose[shoulder + 3] = pose[shoulder + 2] + lower * (0.14 * scale);
}

/// The template standing in the middle of the samples, turned by `yaw`.
fn standing(samples: &Samples, yaw: f64, arm: usize, scale: f64) -> Pose {
    let (s, c) = (libm::sin(yaw), libm::cos(yaw));
    let turn = |p: &V3| V3::new(c * p.x + s * p.z, p.y, c * p.z - s * p.x);
    let frame = [turn(&V3::x()), V3::y(), turn(&V3::z())];
    let foot = base(samples);
    let mut pose = body::rest();
    for joint in 0..JOINTS {
        pose[joint] = foot + turn(&pose[joint]) * scale;
    }
    for side in 0..2 {
        with_arm(&mut pose, side, arm, &frame, scale);
    }
    pose
}

/// Below the median of the samples, at their lowest height.
fn base(samples: &Samples) -> V3 {
    let quantile = |axis: usize, share: f64| {
        let mut values: Vec<f64> = samples.points.iter().map(|p| p[axis]).collect();
        values.sort_unstable_by(f64::total_cmp);
        values[((values.len() - 1) as f64 * share) as usize]
    };
    V3::new(quantile(0, 0.5), quantile(1, 0.003), quantile(2, 0.5))
}

const COARSE: Schedule = Schedule {
    steps: 14,
    widths: [0.4, 0.12],
    stiffness: [0.05, 0.2],
    sided: false,
    girths: false,
    draped: false,
};
const LIMBS: Schedule = Schedule {
    steps: 7,
    widths: [0.25, 0.1],
    stiffness: [0.1, 0.2],
    sided: false,
    girths: false,
    draped: false,
};

/// The best body found for a frame without a past; left and right are still open.
pub(super) fn search(samples: &Samples, scale: f64) -> Fit {
    let mut best: Option<Fit> = None;
    for turn in 0..YAWS {
        let yaw = std::f64::consts::PI * turn as f64 / YAWS as f64;
        for arm in COARSE_ARMS {
            let start = Fit::new(standing(samples, yaw, arm, scale), scale);
            keep_better(&mut best, start.run(samples, &COARSE, None));
        }
    }
    // Strides far apart can be taken by the wrong legs.
    if let Some(pose) = best.as_ref().map(|found| body::crossed(&found.pose)) {
        keep_better(&mut best, Fit::new(pose, scale).run(samples, &LIMBS, None));
    }
    let best = best.unwrap_or_else(|| Fit::new(standing(samples, 0.0, 0, scale), scale));
    raise_arms(samples, best, &[1.0, -1.0])
}

/// Tries all attitudes of each arm, as if the body faced forwards (1) and backwards (−1).
pub(super) fn raise_arms(samples: &Samples, fit: Fit, ways: &[f64]) -> Fit {
    (0..2).fold(fit, |best, side| raise_arm(samples, best, side, ways))
}

fn keep_better(best: &mut Option<Fit>, candidate: Fit) {
    if best.as_ref().is_none_or(|b| candidate.energy < b.energy) {
        *best = Some(candidate);
    }
}

fn raise_arm(samples: &Samples, fit: Fit, side: usize, ways: &[f64]) -> Fit {
    let left = body::leftwards(&fit.pose);
    let front = body::facing(&fit.pose);
    let up = front.cross(&left);
    let mut best = Some(fit.clone());
    for arm in 0..ARMS.len() {
        for &way in ways {
            let mut start = fit.clone();
            with_arm(&mut start.pose, side, arm, &[left, up, front * way], fit.scale);
            keep_better(&mut best, start.run(samples, &LIMBS, None));
        }
    }
    best.unwrap_or(fit)
}
