//! The figure at rest: the bone and the body part of each solid.

use super::cloth::{SKIRT_HEM, SKIRT_TOP};
use super::random::Random;
use super::shape::{Loft, Pleats, Shape, Station, Wrinkles, station};
use super::skeleton::{ARM, BALL, CHEST, HEAD, LEG, PELVIS, Proportions, SIDE};
use super::{PerformerConfig, part};
use glam::DVec3;
use std::f64::consts::TAU;
use std::ops::Range;

/// One solid of the figure.
#[derive(Clone, Debug)]
pub(super) struct Primitive {
    pub(super) bone: usize,
    pub(super) label: u8,
    pub(super) shape: Shape,
    /// Radius of the blend with the solids before it in its group, metres.
    pub(super) blend: f64,
    /// Taken away from the group instead of added to it.
    pub(super) carves: bool,
    pub(super) wrinkles: Option<Wrinkles>,
    /// Moves with the skirt's own warp on top of its bone.
    pub(super) hangs: bool,
}

/// Solids that blend with each other. Groups meet smoothly only around the joint that connects
/// them; elsewhere they merely touch, as a hand touches a hip.
#[derive(Clone, Debug)]
pub(super) struct Group {
    pub(super) members: Range<usize>,
    /// Bone at whose origin the group joins the torso.
    pub(super) joint: usize,
    /// Radius of the blend at the joint, metres.
    pub(super) blend: f64,
}

/// Index of the torso's group; the others follow in the order head, left arm, right arm, left leg,
/// right leg, ball.
pub(super) const TORSO: usize = 0;

#[derive(Clone, Debug)]
pub(super) struct Figure {
    pub(super) body: Proportions,
    pub(super) primitives: Vec<Primitive>,
    pub(super) groups: Vec<Group>,
}

impl Figure {
    pub(super) fn new(config: &PerformerConfig) -> Self {
        let body = Proportions::seeded(config.seed);
        let mut sculptor = Sculptor {
            body,
            random: Random::new(config.seed, 4),
            tunic: config.tunic,
            primitives: Vec::new(),
            groups: Vec::new(),
        };
        sculptor.group(PELVIS, 0.0, Sculptor::torso);
        sculptor.group(HEAD, 0.02, Sculptor::head);
        for side in 0..2 {
            sculptor.group(ARM[side], 0.05, |s| s.arm(side));
        }
        let hip_blend = if config.tunic { 0.012 } else { 0.05 };
        for side in 0..2 {
            sculptor.group(LEG[side], hip_blend, |s| s.leg(side));
        }
        if config.ball {
            sculptor.group(BALL, 0.0, Sculptor::ball);
        }
        Self { body, primitives: sculptor.primitives, groups: sculptor.groups }
    }
}

struct Sculptor {
    body: Proportions,
    random: Random,
    tunic: bool,
    primitives: Vec<Primitive>,
    groups: Vec<Group>,
}

impl Sculptor {
    fn group(&mut self, joint: usize, blend: f64, fill: impl FnOnce(&mut Self)) {
        let first = self.primitives.len();
        fill(self);
        self.groups.push(Group { members: first..self.primitives.len(), joint, blend });
    }

    fn add(&mut self, bone: usize, label: u8, blend: f64, shape: Shape) -> &mut Primitive {
        let plain =
            Primitive { bone, label, shape, blend, carves: false, wrinkles: None, hangs: false };
        self.primitives.push(plain);
        let last = self.primitives.len() - 1;
        &mut self.primitives[last]
    }

    /// A point given for a figure of 1.75 m.
    fn at(&self, x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z) * self.body.scale
    }

    fn cone(&self, a: DVec3, b: DVec3, ra: f64, rb: f64) -> Shape {
        Shape::Cone { a, b, ra: ra * self.body.girth, rb: rb * self.body.girth }
    }

    fn ellipsoid(&self, centre: DVec3, x: f64, y: f64, z: f64) -> Shape {
        Shape::Ellipsoid { centre, radii: self.at(x, y, z) }
    }

    fn loft(&self, stations: &[Station], rounding: f64, boxy: f64) -> Loft {
        let (scale, girth) = (self.body.scale, self.body.girth);
        let sized = |s: &Station| station(s.y * scale, s.rx * girth, s.rz * girth, s.z * scale);
        let stations = stations.iter().map(sized).collect();
        Loft { stations, rounding, boxy, hollow: 0.0, wall: 0.0, pleats: None }
    }

    fn wrinkles(&self, depth: f64, frequency: [f64; 3]) -> Option<Wrinkles> {
        let random = self.random.fork(self.primitives.len() as i64);
        Some(Wrinkles { depth, frequency: DVec3::from(frequency), random })
    }

    fn torso(&mut self) {
        let ease = if self.tunic { 1.0 } else { 0.94 };
        let chest = self.loft(
            &[
                station(0.405, 0.052, 0.050, -0.022),
                station(0.375, 0.085, 0.064, -0.022),
                station(0.335, 0.142 * ease, 0.086 * ease, -0.018),
                station(0.260, 0.172 * ease, 0.110 * ease, -0.006),
                station(0.165, 0.166 * ease, 0.122 * ease, 0.006),
                station(0.050, 0.148 * ease, 0.112 * ease, 0.006),
                station(-0.060, 0.148 * ease, 0.112 * ease, 0.004),
            ],
            0.015,
            0.35,
        );
        let folds = self.wrinkles(if self.tunic { 0.0075 } else { 0.005 }, [10.0, 5.5, 10.0]);
        self.add(CHEST, part::TORSO, 0.0, Shape::Loft(chest)).wrinkles = folds;
        if self.tunic {
            self.skirt();
            self.belt();
        } else {
            self.hips();
        }
    }

    fn skirt(&mut self) {
        let mut skirt = self.loft(
            &[
                station(0.220, 0.138, 0.104, -0.006),
                station(SKIRT_TOP, 0.150, 0.116, -0.004),
                station(0.000, 0.172, 0.136, -0.004),
                station(-0.120, 0.190, 0.153, 0.0),
                station(-0.240, 0.205, 0.172, 0.002),
                station(SKIRT_HEM, 0.220, 0.190, 0.004),
            ],
            0.008,
            0.15,
        );
        (skirt.hollow, skirt.wall) = (0.04, 0.024);
        let phase = |i: i64| TAU * self.random.unit(i);
        let scale = self.body.scale;
        skirt.pleats = Some(Pleats {
            depth: 0.017,
            waves: [
                (7.0, 0.50, phase(0)),
                (9.0, 0.42, phase(1)),
                (13.0, 0.25, phase(2)),
                (4.0, 0.35, phase(3)),
            ],
            top: (SKIRT_TOP + 0.02) * scale,
            hem: SKIRT_HEM * scale,
        });
        let folds = self.wrinkles(0.006, [11.0, 4.5, 11.0]);
        let cloth = self.add(PELVIS, part::TORSO, 0.07, Shape::Loft(skirt));
        (cloth.wrinkles, cloth.hangs) = (folds, true);
        // What a lifted thigh pushes up is tunic, not trouser.
        for side in 0..2 {
            let (top, low) = (self.at(0.0, 0.02, 0.0), self.at(0.0, -0.19, 0.01));
            let shape = self.cone(top, low, 0.108, 0.103);
            self.add(LEG[side], part::TORSO, 0.05, shape);
        }
    }

    /// A cord over the waist: the edge that the light catches.
    fn belt(&mut self) {
        let belt = self.loft(
            &[
                station(0.112, 0.156, 0.122, -0.004),
                station(0.095, 0.160, 0.126, -0.004),
                station(0.078, 0.158, 0.124, -0.004),
            ],
            0.010,
            0.15,
        );
        self.add(PELVIS, part::TORSO, 0.008, Shape::Loft(belt));
    }

    fn hips(&mut self) {
        let hips = self.loft(
            &[
                station(0.220, 0.134, 0.100, -0.006),
                station(0.100, 0.148, 0.110, -0.006),
                station(0.000, 0.168, 0.124, -0.012),
                station(-0.080, 0.160, 0.124, -0.016),
                station(-0.130, 0.085, 0.090, -0.012),
            ],
            0.02,
            0.15,
        );
        let folds = self.wrinkles(0.003, [12.0, 10.0, 12.0]);
        self.add(PELVIS, part::TORSO, 0.07, Shape::Loft(hips)).wrinkles = folds;
    }

    fn head(&mut self) {
        let skin = |s: &mut Self, blend, shape| {
            s.add(HEAD, part::HEAD, blend, shape);
        };
        let neck = self.cone(self.at(0.0, -0.04, -0.004), self.at(0.0, 0.09, 0.012), 0.057, 0.052);
        skin(self, 0.0, neck);
        let skull = self.ellipsoid(self.at(0.0, 0.178, 0.012), 0.075, 0.096, 0.095);
        skin(self, 0.02, skull);
        let jaw = self.ellipsoid(self.at(0.0, 0.112, 0.046), 0.055, 0.068, 0.056);
        skin(self, 0.035, jaw);
        let chin = Shape::ball(self.at(0.0, 0.060, 0.082), 0.017);
        skin(self, 0.025, chin);
        for x in [0.037, -0.037] {
            let cheek = Shape::ball(self.at(x, 0.128, 0.074), 0.025);
            skin(self, 0.02, cheek);
        }
        let brow = self.ellipsoid(self.at(0.0, 0.176, 0.094), 0.044, 0.010, 0.014);
        skin(self, 0.014, brow);
        for x in [0.031, -0.031] {
            let socket = self.ellipsoid(self.at(x, 0.157, 0.116), 0.017, 0.010, 0.014);
            self.add(HEAD, part::HEAD, 0.012, socket).carves = true;
        }
        let nose = self.cone(self.at(0.0, 0.160, 0.102), self.at(0.0, 0.124, 0.117), 0.007, 0.014);
        skin(self, 0.012, nose);
        let mouth = self.ellipsoid(self.at(0.0, 0.090, 0.097), 0.024, 0.011, 0.011);
        skin(self, 0.008, mouth);
        for x in [0.077, -0.077] {
            let ear = self.ellipsoid(self.at(x, 0.142, 0.002), 0.011, 0.032, 0.020);
            skin(self, 0.010, ear);
        }
        self.hair();
    }

    fn hair(&mut self) {
        let cap = self.ellipsoid(self.at(0.0, 0.200, -0.008), 0.085, 0.098, 0.106);
        let locks = self.wrinkles(0.007, [22.0, 14.0, 16.0]);
        self.add(HEAD, part::HEAD, 0.004, cap).wrinkles = locks;
        if self.random.unit(5) < 0.5 {
            let bun = Shape::ball(self.at(0.0, 0.235, -0.115), 0.042);
            let locks = self.wrinkles(0.005, [26.0, 26.0, 26.0]);
            self.add(HEAD, part::HEAD, 0.012, bun).wrinkles = locks;
        }
    }

    fn arm(&mut self, side: usize) {
        let labels = if side == 0 { part::LEFT_ARM } else { part::RIGHT_ARM };
        let [upper, lower, hand] = [ARM[side], ARM[side] + 1, ARM[side] + 2];
        let loose = if self.tunic { 1.0 } else { 0.88 };
        let sleeve = self.loft(
            &[
                station(0.034, 0.038, 0.042, 0.0),
                station(0.004, 0.057, 0.060, 0.0),
                station(-0.045, 0.066 * loose, 0.069 * loose, 0.0),
                station(-0.120, 0.066 * loose, 0.067 * loose, -0.002),
                station(-0.205, 0.071 * loose, 0.070 * loose, -0.006),
            ],
            0.008,
            0.0,
        );
        let folds = self.wrinkles(0.0055, [14.0, 13.0, 14.0]);
        self.add(upper, labels[0], 0.0, Shape::Loft(sleeve)).wrinkles = folds;
        let elbow = DVec3::NEG_Y * self.body.upper_arm;
        let bare = self.cone(self.at(0.0, -0.06, 0.0), elbow, 0.050, 0.039);
        self.add(upper, labels[0], 0.004, bare);
        let wrist = DVec3::NEG_Y * self.body.lower_arm;
        let muscle = self.at(0.0, -0.075, 0.004);
        let forearm = self.cone(DVec3::ZERO, muscle, 0.039, 0.043);
        self.add(lower, labels[1], 0.025, forearm);
        let forearm = self.cone(muscle, wrist, 0.043, 0.026);
        self.add(lower, labels[1], 0.015, forearm);
        self.hand(hand, labels[2], SIDE[side]);
    }

    fn hand(&mut self, bone: usize, label: u8, out: f64) {
        let palm = self.ellipsoid(self.at(0.0, -0.052, 0.002), 0.0175, 0.056, 0.042);
        self.add(bone, label, 0.022, palm);
        let curl = 0.5 + 0.5 * self.random.unit(20 + bone as i64);
        for (z, length) in [(0.030, 0.070), (0.010, 0.080), (-0.010, 0.075), (-0.029, 0.058)] {
            let knuckle = self.at(0.0, -0.088, z);
            let bent = -out * 0.012 * curl;
            let joint = self.at(bent, -0.088 - 0.55 * length, z * 1.04);
            let tip = self.at(3.2 * bent, -0.088 - length, z * 1.06);
            let first = self.cone(knuckle, joint, 0.0105, 0.0092);
            self.add(bone, label, 0.010, first);
            let second = self.cone(joint, tip, 0.0092, 0.0078);
            self.add(bone, label, 0.006, second);
        }
        let (ball, joint) = (self.at(0.0, -0.025, 0.024), self.at(-out * 0.014, -0.062, 0.056));
        let thumb = self.cone(ball, joint, 0.017, 0.0118);
        self.add(bone, label, 0.014, thumb);
        let tip = self.at(-out * 0.022, -0.095, 0.066);
        let thumb = self.cone(joint, tip, 0.0118, 0.0090);
        self.add(bone, label, 0.005, thumb);
    }

    fn leg(&mut self, side: usize) {
        let labels = if side == 0 { part::LEFT_LEG } else { part::RIGHT_LEG };
        let [thigh, shin, foot] = [LEG[side], LEG[side] + 1, LEG[side] + 2];
        let knee = DVec3::NEG_Y * self.body.thigh;
        let middle = self.at(-0.006 * SIDE[side], -0.17, 0.006);
        let folds = self.wrinkles(0.004, [11.0, 16.0, 11.0]);
        let upper = self.cone(self.at(0.0, 0.0, -0.006), middle, 0.090, 0.084);
        self.add(thigh, labels[0], 0.0, upper).wrinkles = folds;
        let lower = self.cone(middle, knee, 0.084, 0.061);
        self.add(thigh, labels[0], 0.02, lower).wrinkles = folds;
        let trouser = self.loft(
            &[
                station(0.030, 0.056, 0.056, 0.002),
                station(-0.040, 0.060, 0.062, -0.002),
                station(-0.130, 0.060, 0.066, -0.014),
                station(-0.260, 0.054, 0.058, -0.010),
                station(-0.365, 0.054, 0.058, -0.006),
            ],
            0.010,
            0.0,
        );
        let folds = self.wrinkles(0.0055, [10.0, 19.0, 10.0]);
        self.add(shin, labels[1], 0.03, Shape::Loft(trouser)).wrinkles = folds;
        let ankle = DVec3::NEG_Y * self.body.leg;
        let bare = self.cone(self.at(0.0, -0.34, -0.004), ankle, 0.045, 0.039);
        self.add(shin, labels[1], 0.004, bare);
        self.foot(foot, labels[2], SIDE[side]);
    }

    fn foot(&mut self, bone: usize, label: u8, out: f64) {
        let heel = self.ellipsoid(self.at(0.0, -0.048, -0.040), 0.037, 0.042, 0.044);
        self.add(bone, label, 0.020, heel);
        let instep =
            self.cone(self.at(0.0, -0.008, -0.004), self.at(0.0, -0.046, 0.085), 0.041, 0.032);
        self.add(bone, label, 0.025, instep);
        let sole = self.ellipsoid(self.at(0.004 * out, -0.062, 0.050), 0.041, 0.030, 0.105);
        self.add(bone, label, 0.02, sole);
        let toes = self.ellipsoid(self.at(-0.002 * out, -0.062, 0.125), 0.044, 0.028, 0.058);
        self.add(bone, label, 0.025, toes);
        // A ball of two metres is as good as flat under a shoe.
        let depth = self.body.ankle - 0.002;
        let ground = Shape::ball(DVec3::NEG_Y * (depth + 2.0), 2.0);
        self.add(bone, label, 0.008, ground).carves = true;
    }

    fn ball(&mut self) {
        let ball = Shape::ball(DVec3::ZERO, 0.105);
        self.add(BALL, part::OTHER, 0.0, ball);
    }
}
