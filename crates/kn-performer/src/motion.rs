//! The choreography: the stance of the figure at any moment, in closed form, so that frame 100,000
//! costs as much as frame 0 and there is no state.

use super::gestures::{arm_at, random_arm, spread_arm};
use super::random::{Random, fade};
use super::rigid::{Rigid, rotation_x, rotation_y, rotation_z, wrapped};
use super::skeleton::{Proportions, SIDE, Stance};
use super::{Action, PerformerConfig};
use glam::{DMat3, DVec3};
use std::f64::consts::{PI, TAU};

/// Share of a foot's two-beat cycle that it stays on the ground.
const PLANTED: f64 = 0.58;

/// The place of the figure on the ground, and the direction that it faces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    /// Metres, y = 0.
    pub(super) position: DVec3,
    /// Radians about y; 0 faces +z.
    pub(super) yaw: f64,
}

/// One seeded choreography.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub(super) action: Action,
    /// Amplitude of everything that moves; 0 stands still, 1 is natural.
    pub(super) intensity: f64,
    /// Seconds from one step to the next.
    pub(super) beat: f64,
    pub(super) holds_ball: bool,
    pub(super) random: Random,
}

impl Motion {
    pub(super) fn new(config: &PerformerConfig) -> Self {
        let random = Random::new(config.seed, 2);
        let beat = match config.action {
            Action::Walk => 0.54,
            Action::Turn => 0.42,
            Action::Dance | Action::Stand | Action::Poses => 0.48,
        };
        Self {
            action: config.action,
            intensity: config.intensity,
            beat: beat * (1.0 + 0.06 * random.signed(0)),
            holds_ball: config.ball,
            random,
        }
    }

    /// The stance that all material coordinates refer to: arms half raised, so that no joint ever
    /// turns far from it.
    pub(super) fn rest(body: &Proportions) -> Stance {
        Stance { arms: [spread_arm(body); 2], ..Self::home(body) }
    }

    /// Standing at ease.
    fn home(body: &Proportions) -> Stance {
        Stance {
            pelvis: Rigid { rotation: DMat3::IDENTITY, origin: DVec3::Y * body.pelvis_height() },
            waist: DMat3::IDENTITY,
            neck: DMat3::IDENTITY,
            arms: [random_arm(None, body); 2],
            feet: [0, 1].map(|side| foot_home(ORIGIN, side, body)),
            breath: 0.0,
        }
    }

    /// The stance at `time` seconds; `frame` is what [`Action::Poses`] draws its pose from.
    pub(super) fn stance(&self, time: f64, frame: i64, body: &Proportions) -> Stance {
        match self.action {
            Action::Poses => self.posed(frame, body),
            Action::Stand => self.standing(time, body),
            Action::Walk | Action::Turn | Action::Dance => self.stepping(time, body),
        }
    }

    /// The way of the figure over the ground, without the weight's shift from foot to foot.
    pub(super) fn placement(&self, time: f64) -> Placement {
        let beats = time / self.beat;
        match self.action {
            Action::Walk => {
                // A circle of 1.3 m: any length of walk stays in one box.
                let angle = self.intensity * 1.15 * time / 1.3;
                let (s, c) = (libm::sin(angle), libm::cos(angle));
                Placement { position: DVec3::new(1.3 * c, 0.0, -1.3 * s), yaw: angle + PI }
            }
            Action::Turn => {
                let yaw = self.intensity * (2.2 * time + 0.25 * libm::sin(1.3 * time));
                Placement { position: 0.05 * self.wander(time, 0.9), yaw }
            }
            Action::Dance => {
                let sway = 0.45 * libm::sin(0.41 * time + TAU * self.random.unit(10))
                    + 0.25 * libm::sin(1.07 * time + TAU * self.random.unit(11));
                let yaw = self.intensity * sway + self.spin(beats);
                Placement { position: 0.25 * self.intensity * self.wander(time, 1.1), yaw }
            }
            Action::Stand | Action::Poses => ORIGIN,
        }
    }

    /// A whole turn over three beats in about every third phrase of eight; a finished turn is the
    /// same as none, so only the present phrase counts.
    fn spin(&self, beats: f64) -> f64 {
        let phrase = (beats / 8.0).floor();
        let draw = self.random.fork(12).unit(phrase as i64);
        if draw > 0.34 || self.intensity < 0.5 {
            return 0.0;
        }
        let sense = if draw > 0.17 { 1.0 } else { -1.0 };
        sense * TAU * fade((beats - 8.0 * phrase - 4.0) / 3.0)
    }

    fn wander(&self, time: f64, speed: f64) -> DVec3 {
        let phase = |i| TAU * self.random.unit(i);
        let x = libm::sin(0.83 * speed * time + phase(20));
        let z = libm::sin(0.59 * speed * time + phase(21));
        DVec3::new(x, 0.0, 0.7 * z)
    }

    fn stepping(&self, time: f64, body: &Proportions) -> Stance {
        let beats = time / self.beat;
        let place = self.placement(time);
        let facing = rotation_y(place.yaw);
        let groove = match self.action {
            Action::Walk => 0.5,
            Action::Turn => 0.4,
            _ => 1.0,
        } * self.intensity;
        // One sway to each side in two beats, one bounce in every beat.
        let sway = libm::sin(PI * (beats + 0.2));
        let bounce = libm::cos(TAU * beats);
        let twist = libm::sin(PI * (beats + 0.55));
        let lean = libm::sin(0.37 * time + TAU * self.random.unit(30));
        let shift = facing * DVec3::X * (0.035 * groove * sway);
        let crouch = 0.004 + groove * (0.014 * bounce + 0.010);
        let pelvis = Rigid {
            rotation: facing
                * rotation_y(0.16 * groove * twist)
                * rotation_z(-0.085 * groove * sway)
                * rotation_x(0.04 * groove * bounce),
            origin: place.position + shift + DVec3::Y * (body.pelvis_height() - crouch),
        };
        let waist = rotation_y(-0.30 * groove * twist)
            * rotation_z(0.13 * groove * sway)
            * rotation_x(0.05 + groove * (0.05 * lean - 0.03 * bounce));
        let neck = rotation_y(0.14 * groove * twist + 0.3 * groove * lean)
            * rotation_x(0.06 * groove * bounce - 0.03)
            * rotation_z(-0.06 * groove * sway);
        Stance {
            pelvis,
            waist,
            neck,
            arms: [0, 1].map(|side| arm_at(self, time, side, body)),
            feet: [0, 1].map(|side| self.foot(beats, side, body)),
            breath: libm::sin(1.9 * time),
        }
    }

    /// A foot stands where the figure is in the middle of its stance, then swings to the next
    /// such place: planted feet do not slide, whatever the way.
    fn foot(&self, beats: f64, side: usize, body: &Proportions) -> Rigid {
        let cycles = (beats - side as f64) / 2.0;
        let cycle = cycles.floor();
        let phase = cycles - cycle;
        let here = self.plant(cycle as i64, side, body);
        if phase < PLANTED {
            // The heel comes up at the end of the stance.
            let heel = self.intensity.min(1.0) * fade((phase / PLANTED - 0.72) / 0.28);
            return raised(here, 0.035 * heel, 0.28 * heel);
        }
        let swing = (phase - PLANTED) / (1.0 - PLANTED);
        let next = self.plant(cycle as i64 + 1, side, body);
        let share = fade(swing);
        let yaw = here.1 + share * wrapped(next.1 - here.1);
        let arc = libm::sin(PI * swing) * self.intensity.min(1.0);
        let height = 0.075 * arc + 0.035 * self.intensity.min(1.0) * (1.0 - share);
        let pitch = 0.28 * self.intensity.min(1.0) * (1.0 - share) - 0.16 * arc * share;
        raised((here.0.lerp(next.0, share), yaw), height, pitch)
    }

    /// Ankle position and yaw of a foot's stance number `cycle`.
    fn plant(&self, cycle: i64, side: usize, body: &Proportions) -> (DVec3, f64) {
        let middle = self.beat * (2.0 * cycle as f64 + side as f64 + PLANTED);
        let mut place = self.placement(middle);
        let random = self.random.fork(40 + side as i64);
        if self.action == Action::Dance {
            let step = random.vector(cycle) * DVec3::new(0.11, 0.0, 0.10);
            let apart = DVec3::X * SIDE[side] * 0.05;
            place.position += rotation_y(place.yaw) * (step + apart) * self.intensity;
            place.yaw += 0.2 * random.signed(3 * cycle + 1) * self.intensity;
        }
        let home = foot_home(place, side, body);
        (home.origin, place.yaw + SIDE[side] * TOES_OUT)
    }

    /// Breathing and a slow sway over standing feet.
    fn standing(&self, time: f64, body: &Proportions) -> Stance {
        let a = self.intensity;
        let wave = |speed: f64, i: i64| libm::sin(speed * time + TAU * self.random.unit(i));
        let mut stance = Self::home(body);
        stance.pelvis.origin +=
            a * DVec3::new(0.012 * wave(0.9, 50), -0.004, 0.008 * wave(0.7, 51));
        stance.pelvis.rotation =
            rotation_z(0.02 * a * wave(0.9, 50)) * rotation_y(0.03 * a * wave(0.5, 52));
        stance.waist =
            rotation_y(0.05 * a * wave(0.6, 53)) * rotation_x(0.02 + 0.015 * a * wave(1.6, 54));
        stance.neck = rotation_y(0.25 * a * wave(0.45, 55)) * rotation_x(0.06 * a * wave(0.8, 56));
        for side in 0..2 {
            let drift = DVec3::new(wave(0.8, 57), 0.5 * wave(1.1, 58), wave(0.9, 59 + side as i64));
            stance.arms[side].wrist += 0.015 * a * drift;
        }
        stance.breath = a * wave(1.6, 54);
        stance
    }

    /// An independent pose for every frame. A wrist strays by at most 0.14 of the height from its
    /// home, so that between two poses it moves by less than 0.3 of it.
    fn posed(&self, frame: i64, body: &Proportions) -> Stance {
        let random = self.random.fork(70).fork(frame);
        let a = self.intensity;
        let mut stance = Self::home(body);
        let facing = rotation_y(0.25 * a * random.signed(0));
        stance.pelvis.rotation = facing * rotation_z(0.06 * a * random.signed(1));
        stance.pelvis.origin += a * DVec3::new(
            0.03 * random.signed(2),
            -0.03 * random.unit(3),
            0.03 * random.signed(4),
        );
        stance.waist =
            rotation_y(0.25 * a * random.signed(5)) * rotation_x(0.15 * a * random.signed(6));
        stance.neck =
            rotation_y(0.4 * a * random.signed(7)) * rotation_x(0.2 * a * random.signed(8));
        for side in 0..2 {
            stance.arms[side] = random_arm(Some((random.fork(9 + side as i64), a)), body);
            let step = random.vector(20 + side as i64) * DVec3::new(0.06, 0.0, 0.12) * a;
            stance.feet[side].origin += step + DVec3::X * SIDE[side] * 0.06;
            stance.feet[side].origin.y += 0.16 * a * random.unit(80 + side as i64);
        }
        // One foot stays on the ground.
        let standing = random.below(90, 2);
        stance.feet[standing].origin.y = body.ankle;
        stance
    }
}

const ORIGIN: Placement = Placement { position: DVec3::ZERO, yaw: 0.0 };

/// Radians by which the feet point outwards.
const TOES_OUT: f64 = 0.18;

/// The ankle of a foot that stands at its place under the hip.
fn foot_home(place: Placement, side: usize, body: &Proportions) -> Rigid {
    let home = DVec3::new(SIDE[side] * 0.105 * body.scale, body.ankle, -0.02);
    Rigid {
        rotation: rotation_y(place.yaw + SIDE[side] * TOES_OUT),
        origin: place.position + rotation_y(place.yaw) * home,
    }
}

fn raised((origin, yaw): (DVec3, f64), height: f64, pitch: f64) -> Rigid {
    Rigid { rotation: rotation_y(yaw) * rotation_x(pitch), origin: origin + DVec3::Y * height }
}
