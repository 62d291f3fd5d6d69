//! The template: joints as points, springs between them, and capsules around the bones. All
//! lengths are metres of a body 1.75 m tall, y up, facing +z, its left at +x.

use super::V3;
use kn_bitstream::params::BodyPart;
use kn_bitstream::params::BodyPart::*;

/// Number of joints.
pub(super) const JOINTS: usize = 21;
pub(super) const WAIST: usize = 0;
pub(super) const CHEST: usize = 1;
pub(super) const NECK: usize = 2;
pub(super) const JAW: usize = 3;
pub(super) const CROWN: usize = 4;
/// Shoulder of each side; elbow, wrist and knuckles follow it.
pub(super) const SHOULDER: [usize; 2] = [5, 9];
/// Hip of each side; knee, ankle and toes follow it.
pub(super) const HIP: [usize; 2] = [13, 17];

/// The places of the joints, in template metres times the body's scale.
pub(super) type Pose = [V3; JOINTS];

const REST: [[f64; 3]; JOINTS] = [
    [0.0, 1.09, 0.0],
    [0.0, 1.30, 0.0],
    [0.0, 1.46, -0.02],
    [0.0, 1.56, 0.01],
    [0.0, 1.665, 0.01],
    [0.17, 1.41, -0.02],
    [0.21, 1.13, -0.03],
    [0.24, 0.88, 0.0],
    [0.25, 0.74, 0.02],
    [-0.17, 1.41, -0.02],
    [-0.21, 1.13, -0.03],
    [-0.24, 0.88, 0.0],
    [-0.25, 0.74, 0.02],
    [0.09, 0.93, -0.005],
    [0.10, 0.50, 0.005],
    [0.105, 0.085, -0.02],
    [0.12, 0.035, 0.13],
    [-0.09, 0.93, -0.005],
    [-0.10, 0.50, 0.005],
    [-0.105, 0.085, -0.02],
    [-0.12, 0.035, 0.13],
];

/// A point that is a weighted sum of joints.
pub(super) type Anchor = &'static [(usize, f64)];

/// A tapered capsule of the template.
pub(super) struct Capsule {
    /// Label of its body part.
    pub(super) part: u8,
    pub(super) a: Anchor,
    pub(super) b: Anchor,
    /// Radius at `a` and at `b`.
    pub(super) radii: [f64; 2],
}

const fn bone(part: BodyPart, a: Anchor, b: Anchor, ra: f64, rb: f64) -> Capsule {
    Capsule { part: part.label(), a, b, radii: [ra, rb] }
}

/// Number of capsules.
pub(super) const CAPSULES: usize = 21;

/// Index of the first torso capsule; the torso's come last.
pub(super) const FIRST_TORSO: usize = 16;

/// Capsules of the left and the right thigh.
pub(super) const THIGHS: [usize; 2] = [8, 12];

pub(super) static BODY: [Capsule; CAPSULES] = [
    bone(Head, &[(JAW, 1.0)], &[(CROWN, 1.0)], 0.080, 0.085),
    bone(Head, &[(NECK, 1.0)], &[(JAW, 1.0)], 0.062, 0.058),
    bone(LeftUpperArm, &[(5, 1.0)], &[(6, 1.0)], 0.060, 0.045),
    bone(LeftLowerArm, &[(6, 1.0)], &[(7, 1.0)], 0.044, 0.030),
    bone(LeftHand, &[(7, 1.0)], &[(8, 1.0)], 0.030, 0.028),
    bone(RightUpperArm, &[(9, 1.0)], &[(10, 1.0)], 0.060, 0.045),
    bone(RightLowerArm, &[(10, 1.0)], &[(11, 1.0)], 0.044, 0.030),
    bone(RightHand, &[(11, 1.0)], &[(12, 1.0)], 0.030, 0.028),
    bone(LeftThigh, &[(13, 1.0)], &[(14, 1.0)], 0.088, 0.062),
    bone(LeftLeg, &[(14, 1.0)], &[(15, 1.0)], 0.060, 0.045),
    bone(LeftFoot, &[(15, 1.0)], &[(16, 1.0)], 0.045, 0.035),
    bone(LeftFoot, &[(15, 1.0)], &[(15, 1.37), (14, -0.12), (16, -0.25)], 0.042, 0.036),
    bone(RightThigh, &[(17, 1.0)], &[(18, 1.0)], 0.088, 0.062),
    bone(RightLeg, &[(18, 1.0)], &[(19, 1.0)], 0.060, 0.045),
    bone(RightFoot, &[(19, 1.0)], &[(20, 1.0)], 0.045, 0.035),
    bone(RightFoot, &[(19, 1.0)], &[(19, 1.37), (18, -0.12), (20, -0.25)], 0.042, 0.036),
    // Shoulder girdle, then a left and a right column in chest and pelvis.
    bone(Torso, &[(5, 0.75), (9, 0.25)], &[(5, 0.25), (9, 0.75)], 0.070, 0.070),
    bone(
        Torso,
        &[(5, 0.45), (9, 0.05), (CHEST, 0.5)],
        &[(WAIST, 1.0), (13, 0.35), (17, -0.35)],
        0.105,
        0.105,
    ),
    bone(
        Torso,
        &[(9, 0.45), (5, 0.05), (CHEST, 0.5)],
        &[(WAIST, 1.0), (17, 0.35), (13, -0.35)],
        0.105,
        0.105,
    ),
    bone(Torso, &[(WAIST, 1.0), (13, 0.35), (17, -0.35)], &[(13, 0.85), (17, 0.15)], 0.105, 0.115),
    bone(Torso, &[(WAIST, 1.0), (17, 0.35), (13, -0.35)], &[(17, 0.85), (13, 0.15)], 0.105, 0.115),
];

/// A pair of joints that keep their distance.
pub(super) struct Spring {
    pub(super) a: usize,
    pub(super) b: usize,
    pub(super) stiffness: f64,
}

const fn spring(a: usize, b: usize, stiffness: f64) -> Spring {
    Spring { a, b, stiffness }
}

/// Bones first (stiff), then what holds the trunk in shape (softer).
pub(super) static SPRINGS: [Spring; 37] = [
    spring(5, 6, 1.0),
    spring(6, 7, 1.0),
    spring(7, 8, 1.0),
    spring(9, 10, 1.0),
    spring(10, 11, 1.0),
    spring(11, 12, 1.0),
    spring(13, 14, 1.0),
    spring(14, 15, 1.0),
    spring(15, 16, 1.0),
    spring(17, 18, 1.0),
    spring(18, 19, 1.0),
    spring(19, 20, 1.0),
    spring(13, 17, 1.0),
    spring(5, 9, 1.0),
    spring(NECK, JAW, 1.0),
    spring(JAW, CROWN, 1.0),
    spring(WAIST, CHEST, 1.0),
    spring(CHEST, NECK, 1.0),
    spring(WAIST, 13, 1.0),
    spring(WAIST, 17, 1.0),
    spring(CHEST, 5, 0.6),
    spring(CHEST, 9, 0.6),
    spring(NECK, 5, 0.6),
    spring(NECK, 9, 0.6),
    spring(WAIST, 5, 0.3),
    spring(WAIST, 9, 0.3),
    spring(WAIST, NECK, 0.6),
    spring(CHEST, 13, 0.15),
    spring(CHEST, 17, 0.15),
    spring(5, 13, 0.08),
    spring(9, 17, 0.08),
    spring(NECK, CROWN, 0.5),
    spring(CHEST, CROWN, 0.08),
    spring(5, CROWN, 0.05),
    spring(9, CROWN, 0.05),
    // Toes neither point down nor up much.
    spring(14, 16, 0.05),
    spring(18, 20, 0.05),
];

/// The joints of the template standing at ease, metres.
pub(super) fn rest() -> Pose {
    REST.map(V3::from)
}

/// Rest lengths of [`SPRINGS`], metres.
pub(super) fn rest_lengths() -> [f64; SPRINGS.len()] {
    let pose = rest();
    std::array::from_fn(|i| (pose[SPRINGS[i].a] - pose[SPRINGS[i].b]).norm())
}

/// The point of an anchor.
pub(super) fn place(anchor: Anchor, pose: &Pose) -> V3 {
    anchor.iter().fold(V3::zeros(), |sum, &(joint, weight)| sum + pose[joint] * weight)
}

/// The unit direction from the body's right to its left.
pub(super) fn leftwards(pose: &Pose) -> V3 {
    let across = pose[SHOULDER[0]] - pose[SHOULDER[1]] + pose[HIP[0]] - pose[HIP[1]];
    across.try_normalize(1e-9).unwrap_or_else(V3::x)
}

/// The unit direction in which the body faces.
pub(super) fn facing(pose: &Pose) -> V3 {
    let up = pose[NECK] - (pose[HIP[0]] + pose[HIP[1]]) * 0.5;
    leftwards(pose).cross(&up).try_normalize(1e-9).unwrap_or_else(V3::z)
}

/// The same body with left and right exchanged.
pub(super) fn mirrored(pose: &Pose) -> Pose {
    let mut other = *pose;
    for i in 0..4 {
        other.swap(SHOULDER[0] + i, SHOULDER[1] + i);
        other.swap(HIP[0] + i, HIP[1] + i);
    }
    other
}

/// The same body with each hip on the other's leg.
pub(super) fn crossed(pose: &Pose) -> Pose {
    let mut other = *pose;
    for i in 1..4 {
        other.swap(HIP[0] + i, HIP[1] + i);
    }
    other
}
