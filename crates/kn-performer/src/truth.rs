//! The true motion of points of the surface between two frames.
//!
//! Every point belongs to a material point of the figure at rest. A frame carries it along with
//! the bones by smooth weights that are bound at rest, then along the field's gradient onto the
//! same signed distance that it has at rest. From frame to frame the way leads through the rest
//! pose, so that going a → b → c and a → c agree.

use super::field::{Scene, value_and_gradient};
use super::figure::TORSO;
use super::random::fade;
use super::skeleton::BALL;
use glam::DVec3;
use kn_bitstream::params::{BodyPart, Region};

/// Width over which neighbouring bones share a material point, metres.
const SHARING: f64 = 0.02;
/// Rounds of the search for a material point; each shrinks the error to about a third.
const ROUNDS: usize = 8;
/// Metres of error at which the search is content.
const CONTENT: f64 = 2e-5;

/// The motion of one body region between two scenes.
pub(super) struct Flow<'a> {
    pub(super) rest: &'a Scene,
    pub(super) from: &'a Scene,
    pub(super) to: &'a Scene,
}

/// The group of solids that carries a body part; the torso where the figure has no such group.
fn region(scene: &Scene, label: u8) -> usize {
    let region = match BodyPart::from_label(label).map(BodyPart::region) {
        Some(Region::Head) => 1,
        Some(Region::LeftArm) => 2,
        Some(Region::RightArm) => 3,
        Some(Region::LeftLeg) => 4,
        Some(Region::RightLeg) => 5,
        Some(Region::Other) => 6,
        Some(Region::Torso) | None => TORSO,
    };
    if region < scene.groups.len() { region } else { TORSO }
}

impl Flow<'_> {
    /// The place in the target scene of the surface point `at` of the source scene.
    pub(super) fn carry(&self, at: DVec3, label: u8) -> DVec3 {
        let region = region(self.rest, label);
        if self.rest.groups[region].joint == BALL {
            return self.to.pose.bones[BALL].apply(self.from.pose.bones[BALL].pull(at));
        }
        let material = self.material(at, region);
        self.forward(material, region, self.to)
    }

    /// The point at rest that the source scene carries to `at`, by fixed-point iteration.
    fn material(&self, at: DVec3, region: usize) -> DVec3 {
        let weights = weights(self.from, at, region);
        let mut guess = blend(&weights, |i| self.rest.push(i, self.from.pull(i, at)));
        let mut best = (f64::INFINITY, guess);
        for _ in 0..ROUNDS {
            let miss = at - self.forward(guess, region, self.from);
            let length = miss.length();
            if length < best.0 {
                best = (length, guess);
            }
            if length < CONTENT {
                break;
            }
            guess += blend(&weights, |i| self.unturned(i, miss));
        }
        best.1
    }

    /// A direction of the source scene, turned back to rest with the bone of a primitive.
    fn unturned(&self, index: usize, way: DVec3) -> DVec3 {
        let bone = self.rest.primitives[index].bone;
        let turned = self.from.pose.bones[bone].rotation.transpose() * way;
        self.rest.pose.bones[bone].rotation * turned
    }

    /// The place of the material point `at` in `scene`.
    fn forward(&self, at: DVec3, region: usize, scene: &Scene) -> DVec3 {
        let level = self.rest.region_value(at, region);
        let weights = weights(self.rest, at, region);
        let mut place = blend(&weights, |i| scene.push(i, self.rest.pull(i, at)));
        for _ in 0..3 {
            let (value, gradient) = value_and_gradient(place, |x| scene.region_value(x, region));
            let way = (value - level) / gradient.length_squared().max(0.1);
            place -= gradient * way.clamp(-0.02, 0.02);
            if (value - level).abs() < 1e-6 {
                break;
            }
        }
        place
    }
}

fn blend(weights: &[(usize, f64)], of: impl Fn(usize) -> DVec3) -> DVec3 {
    weights.iter().map(|&(index, weight)| of(index) * weight).sum()
}

/// The primitives that carry a point, with weights that fall off exponentially with distance and
/// add up to 1.
fn weights(scene: &Scene, at: DVec3, region: usize) -> Vec<(usize, f64)> {
    let mut distances = Vec::new();
    for (index, group) in scene.groups.iter().enumerate() {
        let fading = scene.fading(region, index, at);
        if fading >= 0.5 {
            continue;
        }
        for member in group.members.clone().filter(|&m| !scene.primitives[m].carves) {
            let plain = scene.primitives[member].shape.distance(scene.pull(member, at));
            distances.push((member, plain + fading));
        }
    }
    let least = distances.iter().map(|d| d.1).fold(f64::INFINITY, f64::min);
    distances.retain(|d| d.1 < least + 12.0 * SHARING);
    for distance in &mut distances {
        // The last factor lets a weight end at exactly zero where the list is cut.
        let beyond = distance.1 - least;
        distance.1 = libm::exp(-beyond / SHARING) * (1.0 - fade(beyond / (12.0 * SHARING)));
    }
    let sum: f64 = distances.iter().map(|d| d.1).sum();
    distances.iter_mut().for_each(|d| d.1 /= sum);
    distances
}
