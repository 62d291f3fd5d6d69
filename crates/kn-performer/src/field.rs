//! The figure of one frame as one signed field over space. It has a value, a gradient and a body
//! part at every point, also for a single body region.

use super::cloth::{SKIRT_HEM, SKIRT_TOP, Skirt};
use super::figure::{Figure, Group, Primitive, TORSO};
use super::part;
use super::random::fade;
use super::shape::{LIPSCHITZ, Shape};
use super::skeleton::{ARM, CHEST, LEG, PELVIS, Pose};
use glam::DVec3;

/// Edge radius where groups merely touch: scanners round what they see, at about this radius.
const TOUCH: f64 = 0.006;
/// Distances from a joint at which its blend begins to narrow and has become a touch.
const JOINT_START: f64 = 0.07;
const JOINT_END: f64 = 0.17;

/// The smaller of two distances, rounded over `blend` (quadratic polynomial).
pub(super) fn smooth_min(a: f64, b: f64, blend: f64) -> f64 {
    let near = (blend - (a - b).abs()).max(0.0);
    if near <= 0.0 { a.min(b) } else { a.min(b) - near * near / (4.0 * blend) }
}

pub(super) fn smooth_max(a: f64, b: f64, blend: f64) -> f64 {
    -smooth_min(-a, -b, blend)
}

/// The figure in one pose.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    pub(super) primitives: Vec<Primitive>,
    pub(super) groups: Vec<Group>,
    pub(super) pose: Pose,
    pub(super) skirt: Skirt,
    /// Wrinkles of moving cloth wander, and deepen where a joint bends: one strength a primitive.
    strength: Vec<f64>,
    drift: DVec3,
    /// The distance by which each primitive reaches beyond itself, from the blends that follow it
    /// in its group.
    reach: Vec<f64>,
}

/// Indices of the primitives that matter near a place, rising.
pub(super) type Candidates = [u16];

impl Scene {
    pub(super) fn new(figure: &Figure, pose: Pose, skirt: Skirt) -> Self {
        let mut primitives = figure.primitives.clone();
        for primitive in &mut primitives {
            breathe(primitive, pose.breath, skirt.time);
        }
        let strength = primitives.iter().map(|p| fold_strength(p, &pose)).collect();
        let drift = DVec3::new(0.31, 0.17, 0.23) * skirt.time;
        let groups = figure.groups.clone();
        let reach = groups.iter().flat_map(|g| reaches(&primitives[g.members.clone()])).collect();
        Self { primitives, groups, pose, skirt, strength, drift, reach }
    }

    pub(super) fn all(&self) -> Vec<u16> {
        (0..self.primitives.len() as u16).collect()
    }

    /// From the world to the frame in which a primitive is described.
    pub(super) fn pull(&self, index: usize, at: DVec3) -> DVec3 {
        let primitive = &self.primitives[index];
        let local = self.pose.bones[primitive.bone].pull(at);
        if primitive.hangs { self.skirt.unwarp(local) } else { local }
    }

    /// The inverse of [`Self::pull`].
    pub(super) fn push(&self, index: usize, at: DVec3) -> DVec3 {
        let primitive = &self.primitives[index];
        let local = if primitive.hangs { self.skirt.warp(at) } else { at };
        self.pose.bones[primitive.bone].apply(local)
    }

    /// The distance of a point given in the primitive's own frame.
    fn distance(&self, index: usize, local: DVec3) -> f64 {
        let primitive = &self.primitives[index];
        let plain = primitive.shape.distance(local);
        match &primitive.wrinkles {
            None => plain,
            Some(w) => plain - w.height(local, plain, self.drift, self.strength[index]),
        }
    }

    /// The field at `at`, from the given primitives only.
    pub(super) fn value(&self, at: DVec3, candidates: &Candidates) -> f64 {
        let mut whole = f64::INFINITY;
        let mut left = candidates;
        for (index, group) in self.groups.iter().enumerate() {
            let count = left.partition_point(|&c| usize::from(c) < group.members.end);
            let (members, rest) = left.split_at(count);
            left = rest;
            if !members.is_empty() {
                let blend = if index == TORSO { 0.0 } else { self.joining(group, at) };
                whole = smooth_min(whole, self.group_value(at, members), blend);
            }
        }
        whole
    }

    fn group_value(&self, at: DVec3, members: &Candidates) -> f64 {
        let mut value = f64::INFINITY;
        let mut frame = (usize::MAX, at);
        for index in members.iter().map(|&m| usize::from(m)) {
            let primitive = &self.primitives[index];
            // Members of one bone follow each other and share their frame.
            if primitive.hangs || frame.0 != primitive.bone {
                let own = if primitive.hangs { usize::MAX } else { primitive.bone };
                frame = (own, self.pull(index, at));
            }
            let distance = self.distance(index, frame.1);
            value = if primitive.carves {
                smooth_max(value, -distance, primitive.blend)
            } else {
                smooth_min(value, distance, primitive.blend)
            };
        }
        value
    }

    /// Blend radius between a group and the torso: wide at their joint, a touch elsewhere.
    fn joining(&self, group: &Group, at: DVec3) -> f64 {
        let away = (at - self.pose.bones[group.joint].origin).length();
        TOUCH
            + (group.blend - TOUCH).max(0.0)
                * (1.0 - fade((away - JOINT_START) / (JOINT_END - JOINT_START)))
    }

    /// Those of `candidates` that can change the field where it is at most `band` from zero,
    /// within `radius` of `centre`.
    pub(super) fn nearby(
        &self,
        centre: DVec3,
        radius: f64,
        band: f64,
        candidates: &Candidates,
    ) -> Vec<u16> {
        let mut near = Vec::with_capacity(candidates.len());
        let limit = band + LIPSCHITZ * radius;
        for group in &self.groups {
            let away = (centre - self.pose.bones[group.joint].origin).length();
            let joint = if away < JOINT_END + radius { group.blend } else { TOUCH };
            for &candidate in candidates {
                let index = usize::from(candidate);
                if group.members.contains(&index) {
                    let distance = self.primitives[index].shape.distance(self.pull(index, centre));
                    if distance < limit + joint.max(self.reach[index]) {
                        near.push(candidate);
                    }
                }
            }
        }
        near
    }

    /// One body region alone: a limb (or the head) with the torso around its joint only, or the
    /// torso with the roots of the limbs. What merely touches it is left out, so that a hidden
    /// point of a limb stays on the limb.
    pub(super) fn region_value(&self, at: DVec3, region: usize) -> f64 {
        let mut whole = f64::INFINITY;
        for (index, group) in self.groups.iter().enumerate() {
            let fading = self.fading(region, index, at);
            if fading < 0.5 {
                let joined = &self.groups[region.max(index)];
                let blend = if index == region { 0.0 } else { self.joining(joined, at) };
                let members: Vec<u16> = group.members.clone().map(|i| i as u16).collect();
                whole = smooth_min(whole, self.group_value(at, &members) + fading, blend);
            }
        }
        whole
    }

    /// The addition to the distance of group `index` when `region` is looked at alone: nothing
    /// for the region itself, more and more away from the joint for a neighbour, and 0.5 m or
    /// more for what is to be left out.
    pub(super) fn fading(&self, region: usize, index: usize, at: DVec3) -> f64 {
        let joined = &self.groups[region.max(index)];
        if index == region {
            return 0.0;
        }
        if region.min(index) != TORSO || joined.blend <= 0.0 {
            return 0.5;
        }
        let away = (at - self.pose.bones[joined.joint].origin).length();
        0.5 * fade((away - 0.10) / 0.12)
    }

    /// The body part at `at`: the label of the nearest solid, and within a limb the bone on whose
    /// side of the joints the point lies. Folds are left out of it, so that borders are clean.
    pub(super) fn label(&self, at: DVec3, candidates: &Candidates) -> u8 {
        let solids = candidates.iter().map(|&c| usize::from(c));
        let solids = solids.filter(|&i| !self.primitives[i].carves);
        let distance = |i: usize| self.primitives[i].shape.distance(self.pull(i, at));
        let Some((nearest, _)) =
            solids.map(|i| (i, distance(i))).min_by(|a, b| a.1.total_cmp(&b.1))
        else {
            return part::TORSO;
        };
        let limbs = [ARM[0], ARM[1], LEG[0], LEG[1]];
        let labels = [part::LEFT_ARM, part::RIGHT_ARM, part::LEFT_LEG, part::RIGHT_LEG];
        let label = self.primitives[nearest].label;
        let limb = labels.iter().position(|parts| parts.contains(&label));
        limb.map_or(label, |limb| labels[limb][self.section(at, limbs[limb])])
    }

    /// The bone, of the three of a limb, that a point of it belongs to; planes that halve the angle
    /// at each joint divide them.
    fn section(&self, at: DVec3, first: usize) -> usize {
        let bones = &self.pose.bones[first..first + 3];
        let foot = LEG.contains(&first);
        let way = |i: usize| match (i, foot) {
            // A foot points forwards; it begins at a level plane through the ankle.
            (2, true) => -bones[1].rotation.y_axis,
            _ => -bones[i].rotation.y_axis,
        };
        let beyond = |i: usize| (at - bones[i].origin).dot(way(i - 1) + way(i)) > 0.0;
        if !beyond(1) {
            0
        } else if !beyond(2) {
            1
        } else {
            2
        }
    }
}

/// Value (of second order) and gradient by differences at the corners of a small tetrahedron.
pub(super) fn value_and_gradient(at: DVec3, field: impl Fn(DVec3) -> f64) -> (f64, DVec3) {
    const STEP: f64 = 2e-4;
    const CORNERS: [DVec3; 4] = [
        DVec3::new(1.0, -1.0, -1.0),
        DVec3::new(-1.0, -1.0, 1.0),
        DVec3::new(-1.0, 1.0, -1.0),
        DVec3::new(1.0, 1.0, 1.0),
    ];
    let (mut sum, mut gradient) = (0.0, DVec3::ZERO);
    for corner in CORNERS {
        let value = field(at + corner * STEP);
        sum += value;
        gradient += corner * value;
    }
    (sum / 4.0, gradient / (4.0 * STEP))
}

/// The parts of a solid's shape that change from frame to frame.
fn breathe(primitive: &mut Primitive, breath: f64, time: f64) {
    let Shape::Loft(loft) = &mut primitive.shape else { return };
    if primitive.bone == CHEST {
        for station in &mut loft.stations {
            // Deepest at the breastbone, none at neck and waist.
            let share = (station.y * (0.4 - station.y)).max(0.0) / 0.04;
            station.rz += 0.004 * breath * share;
            station.rx += 0.002 * breath * share;
        }
    }
    if let Some(pleats) = &mut loft.pleats {
        for (i, wave) in pleats.waves.iter_mut().enumerate() {
            wave.2 += 0.7 * libm::sin((0.6 + 0.23 * i as f64) * time);
        }
    }
}

/// The widest blend that each member of a group takes part in, its own or a later member's; the
/// depth of wrinkles on top.
fn reaches(members: &[Primitive]) -> Vec<f64> {
    let mut widest: f64 = 0.0;
    let mut reaches: Vec<f64> = Vec::with_capacity(members.len());
    for member in members.iter().rev() {
        widest = widest.max(member.blend);
        reaches.push(widest + 0.012);
    }
    reaches.reverse();
    reaches
}

fn fold_strength(primitive: &Primitive, pose: &Pose) -> f64 {
    for side in 0..2 {
        if (ARM[side]..ARM[side] + 2).contains(&primitive.bone) {
            return 0.8 + 0.3 * pose.elbows[side];
        }
        if (LEG[side]..LEG[side] + 2).contains(&primitive.bone) {
            return 0.8 + 0.4 * pose.knees[side];
        }
    }
    if primitive.bone == PELVIS { 1.0 + 0.2 * (SKIRT_TOP - SKIRT_HEM) } else { 1.0 }
}
