//! The motion of the arms: a small set of gestures and the transitions between them.

use super::Action;
use super::motion::Motion;
use super::random::{Random, fade};
use super::skeleton::{ArmTarget, Proportions};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Wrist (in arm lengths from the shoulder) and elbow in the chest's frame, x outwards; then the
/// hand's twist and flex in radians.
struct Gesture([f64; 3], [f64; 3], f64, f64);

const HANG: Gesture = Gesture([0.24, -0.93, 0.14], [0.35, 0.0, -1.0], 0.1, 0.15);

/// The dancer's gestures. Several touch the body: hips, head and the other arm, where scans grow
/// together.
const GESTURES: [Gesture; 12] = [
    HANG,
    Gesture([0.20, -0.70, 0.16], [1.0, 0.1, -0.55], 0.3, 1.0), // hand on the hip
    Gesture([0.93, 0.05, 0.14], [0.1, -0.8, -0.6], 1.3, 0.1),  // out to the side
    Gesture([0.22, 0.92, 0.12], [1.0, 0.0, 0.1], 0.2, -0.1),   // overhead
    Gesture([-0.05, 0.0, 0.92], [0.6, -1.0, 0.0], 1.2, 0.0),   // to the front
    Gesture([-0.38, -0.22, 0.56], [1.0, -0.6, 0.1], 0.6, 0.3), // across the chest
    Gesture([0.32, 0.58, 0.62], [1.0, -0.3, 0.0], 0.5, -0.2),  // up and front
    Gesture([0.26, -0.28, 0.56], [0.6, -1.0, -0.3], 0.2, 0.2), // guard
    Gesture([0.42, -0.72, -0.42], [0.5, 0.4, -1.0], 0.2, 0.1), // back
    Gesture([-0.02, 0.36, 0.26], [1.0, 0.1, 0.2], -0.2, 0.4),  // hand at the head
    Gesture([0.74, 0.50, 0.10], [0.4, -0.6, -0.6], 1.0, -0.3), // up to the side
    Gesture([-0.18, -0.45, 0.52], [1.0, -0.4, -0.3], 0.4, 0.2), // hands before the belly
];

/// Gestures that a hand with a ball can make.
const WITH_BALL: [usize; 6] = [2, 4, 6, 7, 10, 7];

/// The arm of `side` at `time` seconds.
pub(super) fn arm_at(motion: &Motion, time: f64, side: usize, body: &Proportions) -> ArmTarget {
    match motion.action {
        Action::Walk => walking(motion, time, side, body),
        Action::Turn => turning(motion, time, side, body),
        _ => dancing(motion, time, side, body),
    }
}

/// Arms swing against the legs.
fn walking(motion: &Motion, time: f64, side: usize, body: &Proportions) -> ArmTarget {
    if motion.holds_ball && side == 1 {
        return target(&GESTURES[7], body);
    }
    let swing = libm::sin(PI * (time / motion.beat + 0.1 + side as f64));
    let mut arm = target(&HANG, body);
    let length = arm_length(body);
    arm.wrist +=
        motion.intensity * length * DVec3::new(-0.06 * swing, 0.06 * swing * swing, 0.42 * swing);
    arm
}

/// Arms held out, floating up and down.
fn turning(motion: &Motion, time: f64, side: usize, body: &Proportions) -> ArmTarget {
    let low = if motion.holds_ball && side == 1 { &GESTURES[7] } else { &HANG };
    let open = mix(&target(low, body), &target(&GESTURES[2], body), 0.72);
    let wave = libm::sin(1.7 * time + 2.1 * side as f64);
    let mut arm = mix(&target(low, body), &open, motion.intensity.min(1.0));
    arm.wrist += 0.12 * motion.intensity * wave * DVec3::new(-0.2, 1.0, 0.3);
    arm
}

/// A new gesture every two beats, the arms one beat apart.
fn dancing(motion: &Motion, time: f64, side: usize, body: &Proportions) -> ArmTarget {
    let beats = time / motion.beat;
    let count = (beats - side as f64) / 2.0;
    let index = count.floor();
    let now = chosen(motion, index as i64, side, body);
    let next = chosen(motion, index as i64 + 1, side, body);
    // Two thirds of the time on the way, with a small overshoot from the wave below.
    let mut arm = mix(&now, &next, fade((count - index) / 0.72));
    let wave = |speed: f64, i: i64| {
        libm::sin(speed * TAU * beats + TAU * motion.random.unit(61 + i + 3 * side as i64))
    };
    let flutter = DVec3::new(wave(0.5, 0), wave(1.0, 1), wave(0.5, 2));
    arm.wrist += 0.035 * flutter;
    arm.flex += 0.25 * wave(1.0, 2);
    let hang = target(&HANG, body);
    let mut arm = mix(&hang, &arm, motion.intensity);
    arm.wrist = outside_torso(arm.wrist, body);
    arm
}

fn chosen(motion: &Motion, index: i64, side: usize, body: &Proportions) -> ArmTarget {
    // In a third of the cases the right arm repeats what the left has just done.
    let repeats = motion.random.fork(60).unit(index) < 0.35;
    let random = motion.random.fork(62 + if repeats { 0 } else { side as i64 });
    let pick = if motion.holds_ball && side == 1 {
        WITH_BALL[random.below(index, WITH_BALL.len())]
    } else {
        random.below(index, GESTURES.len())
    };
    let mut arm = target(&GESTURES[pick], body);
    arm.wrist += 0.03 * random.vector(index + 1_000_000);
    arm
}

/// The arm of a random pose: its home (`None`) or a place around it that leaves the body free.
pub(super) fn random_arm(draw: Option<(Random, f64)>, body: &Proportions) -> ArmTarget {
    let Some((random, amount)) = draw else {
        return target(&Gesture([0.45, -0.84, 0.08], [0.35, 0.0, -1.0], 0.1, 0.1), body);
    };
    let mut arm = target(&Gesture([0.62, -0.42, 0.32], [0.5, -0.5, -1.0], 0.4, 0.1), body);
    let mut stray = random.vector(0);
    if stray.length_squared() > 1.0 {
        stray = stray.normalize();
    }
    arm.wrist += 0.19 * body.scale * amount * stray;
    arm.flex += 0.4 * amount * random.signed(5);
    arm.twist += 0.6 * amount * random.signed(6);
    arm
}

/// The arm half raised to the side.
pub(super) fn spread_arm(body: &Proportions) -> ArmTarget {
    target(&Gesture([0.88, -0.36, 0.08], [0.2, -0.6, -1.0], 0.3, 0.1), body)
}

fn arm_length(body: &Proportions) -> f64 {
    body.upper_arm + body.lower_arm
}

fn target(gesture: &Gesture, body: &Proportions) -> ArmTarget {
    ArmTarget {
        wrist: DVec3::from(gesture.0) * arm_length(body),
        elbow: DVec3::from(gesture.1),
        twist: gesture.2,
        flex: gesture.3,
    }
}

fn mix(a: &ArmTarget, b: &ArmTarget, share: f64) -> ArmTarget {
    // Wrists swing around the shoulder instead of cutting through the body, and the more a way
    // would pass the shoulder, the farther outside and in front.
    let (ra, rb) = (a.wrist.length(), b.wrist.length());
    let opposed = 0.5 - 0.5 * a.wrist.dot(b.wrist) / (ra * rb).max(1e-6);
    let bulge = DVec3::new(0.35, 0.0, 0.75) * (ra + rb) * opposed * opposed * share * (1.0 - share);
    let straight = a.wrist.lerp(b.wrist, share) + bulge;
    let radius = ra + share * (rb - ra);
    let round = straight.normalize_or(DVec3::Z) * radius;
    ArmTarget {
        wrist: straight.lerp(round, 0.6),
        elbow: a.elbow.lerp(b.elbow, share),
        twist: a.twist + share * (b.twist - a.twist),
        flex: a.flex + share * (b.flex - a.flex),
    }
}

/// Pushes a wrist out of an upright ellipse around the chest's axis.
fn outside_torso(wrist: DVec3, body: &Proportions) -> DVec3 {
    let axis = DVec3::new(-0.17, 0.0, 0.02) * body.scale;
    let near = wrist - axis;
    let radii = DVec3::new(0.23, 1.0, 0.20) * body.girth;
    let reach =
        ((near.x / radii.x) * (near.x / radii.x) + (near.z / radii.z) * (near.z / radii.z)).sqrt();
    let beside = 1.0 - fade((wrist.y - 0.02) / 0.12);
    if !(1e-6..1.0).contains(&reach) {
        return wrist;
    }
    let push = 1.0 + (1.0 / reach - 1.0) * beside;
    axis + DVec3::new(near.x * push, near.y, near.z * push)
}
