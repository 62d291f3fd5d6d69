//! Labels of the vertices from a posed body: the closest part, smoothed over the surface, each part
//! in one piece.

use super::body::{self, BODY, CAPSULES};
use super::fit::{Fit, Posed};
use super::hem::{self, Hem};
use super::object::{self, Object};
use super::pieces::unite;
use super::surface::Surface;
use super::{LABELS, OTHER, TORSO};

/// Cost of every label at a vertex, metres.
type Costs = [f32; LABELS];

/// Weight of the distance from the capsule's surface against the distance of the inner point from
/// its axis.
const SURFACE: f64 = 0.5;
const SMOOTHING: usize = 8;
/// The distance by which another part must be closer before a place changes its label, metres.
const LOYALTY: f32 = 0.015;

/// Vertices before they are labelled: their distances from every part.
pub(super) struct Draft {
    /// `#V`
    costs: Vec<Costs>,
    /// `#V` closest capsule.
    capsules: Vec<u8>,
    posed: [Posed; CAPSULES],
}

impl Draft {
    pub(super) fn new(surface: &Surface, fit: &Fit) -> Self {
        let posed = fit.capsules();
        let all = 0..surface.points.len();
        let (costs, capsules) = all.map(|v| part_costs(surface, &posed, v)).unzip();
        Self { costs, capsules, posed }
    }

    /// Index of the closest capsule.
    pub(super) fn capsule(&self, v: usize) -> usize {
        usize::from(self.capsules[v])
    }

    /// The part of the closest capsule.
    pub(super) fn part(&self, v: usize) -> u8 {
        BODY[self.capsule(v)].part
    }

    /// Gives what hangs around the thighs to the torso.
    pub(super) fn drape(&mut self, surface: &Surface, fit: &Fit, hem: &Hem) {
        /// Above the hem by this much, everything is cloth; nearer, what stands off the thigh.
        const BAND: f64 = 0.03;
        const OFF: f64 = 0.035;
        /// The turned-in edge of the cloth, which covers the gap but not the thighs.
        const LOWER: f64 = 0.015;
        let (top, front) = (hem::top(fit), body::facing(&fit.pose));
        for v in 0..self.costs.len() {
            let own = self.part(v);
            let depth = hem.depth(surface.normals[v].dot(&front));
            let above = depth - (top - surface.points[v].y) - LOWER;
            if own <= TORSO || above <= -BAND {
                continue;
            }
            let off = body::THIGHS.map(|k| self.posed[k].outside(&surface.points[v]));
            let cloth = if above > BAND { 0.0 } else { OFF - off[0].min(off[1]).max(0.0) };
            let slot = &mut self.costs[v][usize::from(TORSO)];
            *slot = slot.min(cloth.max(0.0) as f32);
            if above > BAND {
                self.costs[v][usize::from(own)] += 0.05;
            }
        }
    }

    /// Gives what is held to [`OTHER`].
    pub(super) fn hold(&mut self, surface: &Surface) {
        let Some(found) = object::find(surface, self, &self.posed) else { return };
        for v in 0..self.costs.len() {
            let outside = self.posed[self.capsule(v)].outside(&surface.points[v]);
            let holding = object::holds(self.part(v));
            if let Some(cost) = Object::cost(&found, &surface.points[v], outside, holding) {
                self.costs[v][usize::from(OTHER)] = cost as f32;
            }
        }
    }

    /// Leans towards the labels that the same places had in the last frame.
    pub(super) fn remember(&mut self, recalled: &[Option<u8>]) {
        for (costs, label) in self.costs.iter_mut().zip(recalled) {
            if let Some(label) = label {
                costs[usize::from(*label)] -= LOYALTY;
            }
        }
    }

    /// Smooth labels, each part in one piece; and the closest capsule of each vertex.
    pub(super) fn settle(mut self, surface: &Surface) -> (Vec<u8>, Vec<u8>) {
        for _ in 0..SMOOTHING {
            self.costs = smoothed(surface, &self.costs);
        }
        let mut labels: Vec<u8> = self.costs.iter().map(cheapest).collect();
        unite(surface, &mut labels);
        (labels, self.capsules)
    }
}

/// The cost of every label at vertex `v`, and the closest capsule.
fn part_costs(surface: &Surface, posed: &[Posed; CAPSULES], v: usize) -> (Costs, u8) {
    let (point, normal) = (&surface.points[v], &surface.normals[v]);
    let mut costs = [f32::MAX; LABELS];
    costs[usize::from(OTHER)] = 1.0;
    let mut closest = (f64::MAX, 0);
    for (k, (shape, capsule)) in BODY.iter().zip(posed).enumerate() {
        let cost = distance(capsule, point, normal);
        if cost < closest.0 {
            closest = (cost, k as u8);
        }
        let slot = &mut costs[usize::from(shape.part)];
        *slot = slot.min(cost as f32);
    }
    (costs, closest.1)
}

/// The misfit of a capsule at a surface point, metres.
pub(super) fn distance(capsule: &Posed, point: &super::V3, normal: &super::V3) -> f64 {
    let (_, inner) = capsule.medial(point, normal);
    SURFACE * capsule.outside(point).max(-0.05) + (1.0 - SURFACE) * inner.norm()
}

fn smoothed(surface: &Surface, costs: &[Costs]) -> Vec<Costs> {
    let mean = |v: usize| {
        let row = surface.around(v);
        let mut sum = costs[v];
        for &u in row {
            for (s, c) in sum.iter_mut().zip(&costs[u as usize]) {
                *s += c;
            }
        }
        sum.map(|s| s / (row.len() + 1) as f32)
    };
    (0..costs.len()).map(mean).collect()
}

/// The label of least cost, the lowest of equals.
fn cheapest(costs: &Costs) -> u8 {
    let mut best = 0;
    for label in 1..LABELS {
        if costs[label] < costs[best] {
            best = label;
        }
    }
    best as u8
}
