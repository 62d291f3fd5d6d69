//! The skirt of the tunic: a pendulum that hangs from the hips. It is evaluated as a convolution
//! with its impulse response, so that any moment needs a fixed window of the past and no state.

use super::Action;
use super::motion::Motion;
use super::random::Random;
use super::rigid::{rotation_y, wrapped};
use super::skeleton::{PELVIS, Pose};
use glam::DVec3;
use std::f64::consts::TAU;

/// Heights in the pelvis' frame between which the skirt gains its freedom.
pub(super) const SKIRT_TOP: f64 = 0.10;
pub(super) const SKIRT_HEM: f64 = -0.33;

/// Angular frequency (1.15 Hz) and damping ratio of the hanging cloth.
const OMEGA: f64 = 1.15 * TAU;
const DAMPING: f64 = 0.24;
const WINDOW: usize = 26;
const STEP: f64 = 0.04;

/// The shape of the hanging skirt at one moment, in the pelvis' frame; all zero at rest.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Skirt {
    /// Shift of the hem along x and z, metres.
    pub(super) swing: DVec3,
    /// Turn of the hem about y, radians.
    pub(super) twist: f64,
    /// Relative widening of the hem.
    pub(super) flare: f64,
    /// Seconds; the pleats wander slowly.
    pub(super) time: f64,
}

impl Skirt {
    pub(super) fn at(motion: &Motion, time: f64, frame: i64, pose: &Pose) -> Self {
        let pelvis = &pose.bones[PELVIS];
        // Cloth hangs along gravity, not along the tilted pelvis.
        let down = pelvis.rotation.transpose() * DVec3::NEG_Y;
        let hang = DVec3::new(down.x, 0.0, down.z) * 0.30;
        if motion.action == Action::Poses {
            return Self::drawn(motion.random.fork(80).fork(frame), motion.intensity, hang);
        }
        let (push, turn, spin) = driven(motion, time);
        let limit = |v: f64, most: f64| v.clamp(-most, most);
        let swing = pelvis.rotation.transpose() * push;
        let swing = DVec3::new(limit(swing.x, 0.07), 0.0, limit(swing.z, 0.07));
        Self {
            swing: swing + hang,
            twist: limit(turn, 0.5),
            flare: 0.30 * spin * spin / (spin * spin + 12.0),
            time,
        }
    }

    fn drawn(random: Random, amount: f64, hang: DVec3) -> Self {
        let push = random.vector(0) * DVec3::new(0.03, 0.0, 0.03) * amount;
        Self {
            swing: hang + push,
            twist: 0.15 * amount * random.signed(4),
            flare: 0.0,
            time: random.unit(5),
        }
    }

    /// From the skirt's own coordinates (those at rest) to the pelvis' frame.
    pub(super) fn warp(&self, at: DVec3) -> DVec3 {
        let free = freedom(at.y);
        let wide = 1.0 + self.flare * free;
        let turned = rotation_y(self.twist * free) * DVec3::new(at.x * wide, at.y, at.z * wide);
        turned + self.swing * free
    }

    /// The inverse of [`Self::warp`], exact because heights are kept.
    pub(super) fn unwarp(&self, at: DVec3) -> DVec3 {
        let free = freedom(at.y);
        let wide = 1.0 + self.flare * free;
        let turned = rotation_y(-self.twist * free) * (at - self.swing * free);
        DVec3::new(turned.x / wide, at.y, turned.z / wide)
    }
}

/// 0 at the belt, 1 at the hem.
fn freedom(y: f64) -> f64 {
    let down = ((SKIRT_TOP - y) / (SKIRT_TOP - SKIRT_HEM)).clamp(0.0, 1.1);
    down * down * (1.6 - 0.6 * down)
}

/// Response to the hips' acceleration over the past second: shift of the hem in the world
/// (metres), its turn (radians) and the present turning speed (radians per second).
fn driven(motion: &Motion, time: f64) -> (DVec3, f64, f64) {
    let hips: Vec<(DVec3, f64)> =
        (0..WINDOW + 2).map(|i| hips_at(motion, time + STEP * (1.0 - i as f64))).collect();
    let (mut push, mut turn) = (DVec3::ZERO, 0.0);
    for i in 1..=WINDOW {
        let age = STEP * i as f64;
        let response = libm::exp(-DAMPING * OMEGA * age) * libm::sin(OMEGA * age) / OMEGA * STEP;
        let (next, here, last) = (hips[i - 1], hips[i], hips[i + 1]);
        push -= (next.0 - 2.0 * here.0 + last.0) / (STEP * STEP) * response;
        turn -= (wrapped(next.1 - here.1) - wrapped(here.1 - last.1)) / (STEP * STEP) * response;
    }
    let spin = wrapped(hips[0].1 - hips[4].1) / (4.0 * STEP);
    (push, turn, spin)
}

/// The hips' place on the ground and their yaw, as the motion has them.
fn hips_at(motion: &Motion, time: f64) -> (DVec3, f64) {
    let place = motion.placement(time);
    let beats = time / motion.beat;
    let sway = match motion.action {
        Action::Stand | Action::Poses => 0.0,
        _ => motion.intensity,
    };
    let shift = 0.035 * sway * libm::sin(TAU / 2.0 * (beats + 0.2));
    let twist = 0.2 * sway * libm::sin(TAU / 2.0 * (beats + 0.55));
    (place.position + rotation_y(place.yaw) * DVec3::X * shift, place.yaw + twist)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unwarp_undoes_warp() {
        let skirt =
            Skirt { swing: DVec3::new(0.05, 0.0, -0.03), twist: 0.4, flare: 0.2, time: 0.0 };
        for y in [0.3, 0.05, -0.1, -0.33, -0.4] {
            let at = DVec3::new(0.15, y, -0.1);
            assert!((skirt.unwarp(skirt.warp(at)) - at).length() < 1e-12);
        }
    }
}
