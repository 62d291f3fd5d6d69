//! The hem of a skirt or a long shirt. Above it the surface around the thighs is torso.
//!
//! Cloth that hangs around both legs covers the gap between them; two legs do not. The depth to
//! which the gap is covered, in front and behind, is the hem's, if the cloth also stands off the
//! thighs there: trousers cover the gap down to the crotch but lie on.

use super::V3;
use super::body::{self, HIP};
use super::fit::{Fit, Matches, Posed};
use super::surface::{Samples, Surface};

/// Height of a level, metres.
const LEVEL: f64 = 0.02;
/// Levels looked at, from the hips down.
const LEVELS: usize = 35;
/// By how much more cloth stands off the thighs above its hem than legs do below it, metres.
const STEP: f64 = 0.018;

/// The lower edge of cloth around both thighs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hem {
    /// Depth under the hips in front and behind, metres.
    pub(super) depths: [f64; 2],
    /// The drop of the cloth's distance from the thighs at the hem, metres.
    pub(super) drop: f64,
}

impl Hem {
    /// Whether the edge is one of hanging cloth and not the crotch of trousers.
    pub(super) fn hangs(&self) -> bool {
        self.drop > STEP || (self.drop > 0.5 * STEP && self.depths[0].min(self.depths[1]) > 0.38)
    }

    /// The samples that are not cloth over the thighs.
    pub(super) fn under(&self, fit: &Fit, samples: &Samples) -> Samples {
        let matches = Matches::find(&fit.capsules(), samples);
        let (top, front) = (top(fit), body::facing(&fit.pose));
        let cloth = |i: usize| {
            let depth = self.depth(samples.normals[i].dot(&front));
            let above = top - samples.points[i].y < depth - LEVEL;
            above && body::THIGHS.contains(&matches.0[i].capsule)
        };
        samples.filtered(|i| !cloth(i))
    }

    /// A hem that moves with the last frame's.
    pub(super) fn follow(mut self, last: &Hem) -> Self {
        for (depth, before) in self.depths.iter_mut().zip(last.depths) {
            *depth = before + 0.5 * (*depth - before).clamp(-0.1, 0.1);
        }
        // People keep their clothes on: what hangs is decided over many frames.
        self.drop = 0.96 * last.drop + 0.04 * self.drop;
        self
    }

    /// Depth for a vertex whose normal has this share towards the front.
    pub(super) fn depth(&self, frontal: f64) -> f64 {
        let share = 0.5 + 0.5 * frontal.clamp(-1.0, 1.0);
        self.depths[1] + share * (self.depths[0] - self.depths[1])
    }
}

/// Measures the gap between the legs. `body` tells which vertices are torso or legs.
pub(super) fn find(surface: &Surface, fit: &Fit, body: impl Fn(usize) -> bool) -> Hem {
    let mut levels = Levels::new(fit);
    for v in (0..surface.points.len()).filter(|&v| body(v)) {
        levels.add(&surface.points[v], &surface.normals[v], surface.areas[v]);
    }
    let depths = levels.covered.map(|side| {
        // A single open level may be a hand in the way or a hole.
        let open = |i: usize| side[i..].iter().take(3).all(|c| *c < 0.35);
        let end = (0..LEVELS).find(|&i| open(i)).unwrap_or(LEVELS);
        LEVEL * (end as f64 - 1.0 + side[end.saturating_sub(1)].min(1.0)).max(0.0)
    });
    let edge = ((depths[0].max(depths[1])) / LEVEL) as usize;
    let above = levels.loose(edge.saturating_sub(5), edge.saturating_sub(1));
    let below = levels.loose(edge + 3, edge + 8);
    Hem { depths, drop: (above - below).max(0.0) }
}

/// Centre of the leg of `side` at `depth` under the hips.
fn leg_at(fit: &Fit, side: usize, depth: f64) -> V3 {
    let [hip, knee, ankle] = [0, 1, 2].map(|i| fit.pose[HIP[side] + i]);
    let height = top(fit) - depth;
    let along =
        |a: V3, b: V3| a + (b - a) * ((a.y - height) / (a.y - b.y).max(1e-3)).clamp(0.0, 1.0);
    if height > knee.y { along(hip, knee) } else { along(knee, ankle) }
}

/// Height of the hips.
pub(super) fn top(fit: &Fit) -> f64 {
    0.5 * (fit.pose[HIP[0]].y + fit.pose[HIP[1]].y)
}

/// The surface around the thighs, level by level.
struct Levels {
    top: f64,
    front: V3,
    /// Left and right leg.
    legs: Vec<[V3; 2]>,
    /// Thighs and lower legs.
    limbs: [Posed; 4],
    /// Share of the gap that is covered, in front and behind.
    covered: [[f64; LEVELS]; 2],
    /// Sums of distance from the thighs and of area, at the outside.
    outer: [[f64; 2]; LEVELS],
}

impl Levels {
    fn new(fit: &Fit) -> Self {
        let middle = |i: usize| (i as f64 + 0.5) * LEVEL;
        let capsules = fit.capsules();
        Self {
            top: top(fit),
            front: body::facing(&fit.pose),
            legs: (0..LEVELS).map(|i| [0, 1].map(|side| leg_at(fit, side, middle(i)))).collect(),
            limbs: [0, 1, 2, 3].map(|i| capsules[body::THIGHS[i % 2] + i / 2]),
            covered: [[0.0; LEVELS]; 2],
            outer: [[0.0; 2]; LEVELS],
        }
    }

    fn add(&mut self, point: &V3, normal: &V3, area: f64) {
        const GAP: [f64; 2] = [0.3, 0.7];
        let level = ((self.top - point.y) / LEVEL).floor();
        if !(level >= 0.0 && level < LEVELS as f64) {
            return;
        }
        let level = level as usize;
        let [left, right] = self.legs[level];
        let apart = (left - right).norm().max(0.05);
        let across = (left - right) / apart;
        let place = (point - right).dot(&across) / apart;
        let sideways = normal.dot(&across).abs();
        if place > GAP[0] && place < GAP[1] && sideways < 0.6 {
            let side = usize::from(normal.dot(&self.front) < 0.0);
            self.covered[side][level] += area / ((GAP[1] - GAP[0]) * apart * LEVEL);
        } else if (point - (left + right) * 0.5).dot(normal) > 0.03 {
            let off = self.limbs.iter().map(|limb| limb.outside(point)).fold(f64::MAX, f64::min);
            self.outer[level][0] += off.min(0.1) * area;
            self.outer[level][1] += area;
        }
    }

    /// Mean distance from the thighs between two levels.
    fn loose(&self, from: usize, to: usize) -> f64 {
        let rows = &self.outer[from.min(LEVELS)..to.min(LEVELS)];
        let (sum, area) = rows.iter().fold((0.0, 0.0), |s, row| (s.0 + row[0], s.1 + row[1]));
        if area > 0.0 { sum / area } else { 0.0 }
    }
}
