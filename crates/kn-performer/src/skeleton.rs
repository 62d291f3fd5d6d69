//! The bones: the proportions of the figure, and the step from a stance, which a motion asks for,
//! to a pose, the frame of every bone. Arms and legs reach their targets by two-bone inverse
//! kinematics.
//!
//! Every bone's frame has its joint as origin, z to the figure's front at rest and, in the limbs,
//! the bone along −y. World: metres, y up, the figure's left at +x when it faces +z.

use super::random::{Random, fade};
use super::rigid::{Rigid, along, rotation_x, rotation_y};
use glam::{DMat3, DVec3};

pub(super) const PELVIS: usize = 0;
pub(super) const CHEST: usize = 1;
pub(super) const HEAD: usize = 2;
/// Upper arms, left and right; the lower arm is the next bone, the hand the one after.
pub(super) const ARM: [usize; 2] = [3, 6];
/// Thighs, left and right; the leg is the next bone, the foot the one after.
pub(super) const LEG: [usize; 2] = [9, 12];
pub(super) const BALL: usize = 15;
pub(super) const BONES: usize = 16;

/// +1 for the left side, −1 for the right.
pub(super) const SIDE: [f64; 2] = [1.0, -1.0];

/// Lengths in metres, and how stout the figure is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Proportions {
    pub(super) scale: f64,
    /// Factor on every thickness.
    pub(super) girth: f64,
    pub(super) upper_arm: f64,
    pub(super) lower_arm: f64,
    pub(super) thigh: f64,
    pub(super) leg: f64,
    pub(super) ankle: f64,
}

impl Proportions {
    /// About 1.75 m tall; a few per cent up or down by seed.
    pub(super) fn seeded(seed: u64) -> Self {
        let random = Random::new(seed, 1);
        let scale = 1.0 + 0.02 * random.signed(0);
        Self {
            scale,
            girth: scale * (1.0 + 0.06 * random.signed(1)),
            upper_arm: 0.285 * scale * (1.0 + 0.02 * random.signed(2)),
            lower_arm: 0.25 * scale * (1.0 + 0.02 * random.signed(3)),
            thigh: 0.43 * scale,
            leg: 0.42 * scale,
            ankle: 0.085 * scale,
        }
    }

    /// Height of the pelvis' origin above the ground when the figure stands at ease.
    pub(super) fn pelvis_height(&self) -> f64 {
        0.965 * self.scale
    }

    fn hip(&self, side: usize) -> DVec3 {
        DVec3::new(SIDE[side] * 0.088, -0.03, 0.0) * self.scale
    }

    fn waist(&self) -> DVec3 {
        DVec3::new(0.0, 0.12, -0.01) * self.scale
    }

    fn neck(&self) -> DVec3 {
        DVec3::new(0.0, 0.385, -0.02) * self.scale
    }

    /// The shoulder in the chest's frame while the arm hangs.
    pub(super) fn shoulder(&self, side: usize) -> DVec3 {
        DVec3::new(SIDE[side] * 0.17, 0.325, -0.02) * self.scale
    }
}

/// The pose that an arm should take. All vectors are in the chest's frame, x outwards on either
/// side.
#[derive(Clone, Copy, Debug)]
pub(super) struct ArmTarget {
    /// Wrist relative to the resting shoulder, metres.
    pub(super) wrist: DVec3,
    /// The side to which the elbow points.
    pub(super) elbow: DVec3,
    /// Turn of the hand about the forearm and bend at the wrist, radians.
    pub(super) twist: f64,
    pub(super) flex: f64,
}

/// A stance: the request of a motion to the figure at one moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stance {
    /// The pelvis; it sinks below the asked height where the feet would not be reached.
    pub(super) pelvis: Rigid,
    /// Chest within the pelvis, head within the chest.
    pub(super) waist: DMat3,
    pub(super) neck: DMat3,
    pub(super) arms: [ArmTarget; 2],
    /// Ankle frames in the world.
    pub(super) feet: [Rigid; 2],
    /// Depth of breath, about −1 to 1.
    pub(super) breath: f64,
}

/// World frames of all bones.
#[derive(Clone, Debug)]
pub(super) struct Pose {
    pub(super) bones: [Rigid; BONES],
    /// Bend of elbows and knees in radians, as [left, right].
    pub(super) elbows: [f64; 2],
    pub(super) knees: [f64; 2],
    pub(super) breath: f64,
}

impl Pose {
    pub(super) fn solve(stance: &Stance, body: &Proportions) -> Self {
        let pelvis = lowered(stance, body);
        let chest = pelvis.child(body.waist(), stance.waist);
        let head = chest.child(body.neck(), stance.neck);
        let mut pose = Self {
            bones: [pelvis; BONES],
            elbows: [0.0; 2],
            knees: [0.0; 2],
            breath: stance.breath,
        };
        pose.bones[CHEST] = chest;
        pose.bones[HEAD] = head;
        for side in 0..2 {
            pose.solve_arm(&chest, &stance.arms[side], body, side);
            pose.solve_leg(&pelvis, &stance.feet[side], body, side);
        }
        let palm = DVec3::new(0.115, -0.085, 0.02) * body.scale;
        pose.bones[BALL] = pose.bones[ARM[1] + 2].child(palm, DMat3::IDENTITY);
        pose
    }

    fn solve_arm(&mut self, chest: &Rigid, target: &ArmTarget, body: &Proportions, side: usize) {
        let mirror = DVec3::new(SIDE[side], 1.0, 1.0);
        let raise = fade(0.5 + target.wrist.y / (body.upper_arm + body.lower_arm));
        // The shoulder blade follows a raised arm up and inwards.
        let lift = DVec3::new(-0.02 * SIDE[side], 0.045, 0.0) * raise * body.scale;
        let shoulder = chest.apply(body.shoulder(side) + lift);
        let wrist = chest.apply(body.shoulder(side) + target.wrist * mirror);
        let pole = chest.rotation * (target.elbow * mirror);
        let limb = Limb { root: shoulder, lengths: [body.upper_arm, body.lower_arm], pole };
        let (upper, lower, bend) = limb.reach(wrist, -1.0);
        let hand = rotation_y(SIDE[side] * target.twist)
            * rotation_x(0.0)
            * super::rigid::rotation_z(-SIDE[side] * target.flex);
        self.bones[ARM[side]] = upper;
        self.bones[ARM[side] + 1] = lower;
        self.bones[ARM[side] + 2] = lower.child(DVec3::NEG_Y * body.lower_arm, hand);
        self.elbows[side] = bend;
    }

    fn solve_leg(&mut self, pelvis: &Rigid, ankle: &Rigid, body: &Proportions, side: usize) {
        let front = pelvis.rotation * DVec3::Z + ankle.rotation * DVec3::Z;
        let outwards = pelvis.rotation * DVec3::X * SIDE[side];
        let root = pelvis.apply(body.hip(side));
        let limb = Limb { root, lengths: [body.thigh, body.leg], pole: front + 0.3 * outwards };
        let (thigh, leg, bend) = limb.reach(ankle.origin, 1.0);
        self.bones[LEG[side]] = thigh;
        self.bones[LEG[side] + 1] = leg;
        self.bones[LEG[side] + 2] =
            Rigid { rotation: ankle.rotation, origin: leg.apply(DVec3::NEG_Y * body.leg) };
        self.knees[side] = bend;
    }
}

/// The asked pelvis, as much lower as both feet need to stay within reach.
fn lowered(stance: &Stance, body: &Proportions) -> Rigid {
    let reach = 0.99 * (body.thigh + body.leg);
    let mut pelvis = stance.pelvis;
    for side in 0..2 {
        let hip = stance.pelvis.apply(body.hip(side));
        let away = stance.feet[side].origin - hip;
        let across = away.x * away.x + away.z * away.z;
        let drop = -away.y - (reach * reach - across).max(0.04).sqrt();
        pelvis.origin.y = pelvis.origin.y.min(stance.pelvis.origin.y - drop);
    }
    pelvis
}

/// Two bones from a root towards a target, the middle joint on the side of the pole.
struct Limb {
    root: DVec3,
    lengths: [f64; 2],
    pole: DVec3,
}

impl Limb {
    /// Frames of both bones and the bend between them. `hinge` is +1 where the front (z) of the
    /// bones is the side of the pole (knees), −1 where it is the other (elbows).
    fn reach(&self, target: DVec3, hinge: f64) -> (Rigid, Rigid, f64) {
        let [a, b] = self.lengths;
        let way = target - self.root;
        let distance = way.length().clamp(0.35 * (a + b), 0.995 * (a + b));
        let direction = way.normalize_or(DVec3::NEG_Y);
        let side = along(direction, self.pole) * DVec3::Z;
        let cosine = ((a * a + distance * distance - b * b) / (2.0 * a * distance)).min(1.0);
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let upper_way = direction * cosine + side * sine;
        let middle = self.root + upper_way * a;
        let lower_way = self.root + direction * distance - middle;
        let upper = Rigid { rotation: along(upper_way, side * hinge), origin: self.root };
        // The front of the lower bone is perpendicular to the same hinge.
        let front = (upper.rotation * DVec3::X).cross(-lower_way);
        let lower = Rigid { rotation: along(lower_way, front), origin: middle };
        let bend = libm::acos(upper_way.dot(lower_way.normalize()).clamp(-1.0, 1.0));
        (upper, lower, bend)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limbs_reach_their_targets_and_keep_their_lengths() {
        let limb =
            Limb { root: DVec3::new(0.2, 1.4, 0.0), lengths: [0.29, 0.25], pole: DVec3::NEG_Z };
        for target in [DVec3::new(0.3, 1.1, 0.3), DVec3::new(0.4, 1.7, 0.1)] {
            let (upper, lower, bend) = limb.reach(target, -1.0);
            assert!((upper.apply(DVec3::NEG_Y * 0.29) - lower.origin).length() < 1e-12);
            assert!((lower.apply(DVec3::NEG_Y * 0.25) - target).length() < 1e-9);
            assert!((upper.rotation.x_axis - lower.rotation.x_axis).length() < 1e-9);
            assert!(bend > 0.1 && bend < 3.0);
        }
    }

    #[test]
    fn what_is_out_of_reach_leaves_everything_finite() {
        let limb = Limb { root: DVec3::ZERO, lengths: [0.3, 0.3], pole: DVec3::Z };
        for target in [DVec3::ZERO, DVec3::Z * 9.0, DVec3::NEG_Y * 1e-9] {
            let (upper, lower, bend) = limb.reach(target, 1.0);
            assert!(upper.rotation.is_finite() && lower.rotation.is_finite() && bend.is_finite());
        }
    }
}
