//! Articulated registration: the capsules are fitted to samples of the scan by Gauss–Newton steps
//! on the joints, with closest capsules re-assigned in every step.

use super::V3;
use super::body::{
    self, Anchor, BODY, CAPSULES, HIP, JOINTS, Pose, SHOULDER, SPRINGS, place, rest_lengths,
};
use super::solve::System;
use super::surface::Samples;
use nalgebra::Matrix3;

/// A posed body.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    pub(super) pose: Pose,
    /// Size of the body relative to the template.
    pub(super) scale: f64,
    /// Radii of the capsules relative to the template, times [`Fit::scale`].
    pub(super) girths: [f64; CAPSULES],
    /// Mean squared misfit, square metres, with caps; what fits are compared by.
    pub(super) energy: f64,
}

/// Options of a registration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Schedule {
    pub(super) steps: usize,
    /// Width of the robust weight at the first and at the last step, metres.
    pub(super) widths: [f64; 2],
    /// Stiffness of the bones at the first and at the last step.
    pub(super) stiffness: [f64; 2],
    /// Whether left and right are known: knees bend and toes point forwards.
    pub(super) sided: bool,
    /// Whether capsules may grow and shrink.
    pub(super) girths: bool,
    /// Whether cloth hides the thighs, so that no surface is expected around them.
    pub(super) draped: bool,
}

/// Misfits beyond this no longer count more, metres.
const CAP: f64 = 0.12;
/// Share of the energy of model-to-scan residuals.
const COVERAGE: f64 = 0.5;

/// A capsule in its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Posed {
    pub(super) a: V3,
    pub(super) b: V3,
    pub(super) radii: [f64; 2],
}

impl Posed {
    /// Closest axis point's parameter and the vector from it to `at`.
    pub(super) fn project(&self, at: &V3) -> (f64, V3) {
        let axis = self.b - self.a;
        let t = (axis.dot(&(at - self.a)) / axis.norm_squared().max(1e-12)).clamp(0.0, 1.0);
        (t, at - self.a - axis * t)
    }

    /// Distance from the capsule's surface, negative inside.
    pub(super) fn outside(&self, at: &V3) -> f64 {
        let (t, away) = self.project(at);
        away.norm() - self.radius(t)
    }

    pub(super) fn radius(&self, t: f64) -> f64 {
        self.radii[0] + t * (self.radii[1] - self.radii[0])
    }

    /// The capsule's axis as seen from a surface point: what remains between the axis and the
    /// point pushed inwards along its normal by the radius.
    pub(super) fn medial(&self, point: &V3, normal: &V3) -> (f64, V3) {
        let (t, _) = self.project(point);
        let inner = point - normal * self.radius(t);
        self.project(&inner)
    }
}

impl Fit {
    pub(super) fn new(pose: Pose, scale: f64) -> Self {
        Self { pose, scale, girths: [1.0; CAPSULES], energy: f64::INFINITY }
    }

    pub(super) fn capsules(&self) -> [Posed; CAPSULES] {
        std::array::from_fn(|k| {
            let size = self.scale * self.girths[k];
            Posed {
                a: place(BODY[k].a, &self.pose),
                b: place(BODY[k].b, &self.pose),
                radii: BODY[k].radii.map(|r| r * size),
            }
        })
    }

    /// Fits to the samples; `anchor` is where the last frame expects the joints.
    pub(super) fn run(
        mut self,
        samples: &Samples,
        schedule: &Schedule,
        anchor: Option<&Pose>,
    ) -> Self {
        for step in 0..schedule.steps {
            let share = step as f64 / (schedule.steps.max(2) - 1) as f64;
            let at = |ends: [f64; 2]| ends[0] + share * (ends[1] - ends[0]);
            let matches = Matches::find(&self.capsules(), samples);
            if schedule.girths && share > 0.4 {
                self.adapt(samples, &matches);
            }
            let width = at(schedule.widths);
            let mut system = System::new(2e-3);
            self.pull_to_scan(&mut system, samples, &matches, width);
            self.cover(&mut system, samples, width, schedule.draped);
            self.hold_shape(&mut system, at(schedule.stiffness));
            if schedule.sided {
                self.bend_forwards(&mut system);
            }
            if let Some(expected) = anchor {
                self.stay_near(&mut system, expected);
            }
            let Some(change) = system.solve() else { break };
            self.advance(&change);
        }
        self.energy = self.misfit(samples, schedule.sided);
        self
    }

    fn advance(&mut self, change: &Pose) {
        const LONGEST: f64 = 0.15;
        for (joint, step) in self.pose.iter_mut().zip(change) {
            let length = step.norm();
            *joint += step * (LONGEST / length.max(LONGEST));
        }
        let lengths = rest_lengths();
        let (mut top, mut bottom) = (0.0, 0.0);
        for (spring, rest) in SPRINGS.iter().zip(lengths).take(20) {
            let length = (self.pose[spring.a] - self.pose[spring.b]).norm();
            top += length * rest;
            bottom += rest * rest;
        }
        let wanted = (top / bottom).clamp(0.8, 1.25);
        self.scale += 0.5 * (wanted - self.scale);
    }

    fn pull_to_scan(&self, system: &mut System, samples: &Samples, matches: &Matches, width: f64) {
        let each = 1.0 / samples.points.len().max(1) as f64;
        for found in &matches.0 {
            let shape = &BODY[found.capsule];
            let away = found.away;
            let robust = 1.0 / (1.0 + away.norm_squared() / (width * width));
            let weight = each * robust * robust;
            let mut metric = Matrix3::identity() * weight;
            if found.t > 0.0 && found.t < 1.0 {
                let axis = place(shape.b, &self.pose) - place(shape.a, &self.pose);
                let unit = axis.try_normalize(1e-9).unwrap_or_else(V3::y);
                metric -= unit * unit.transpose() * (0.98 * weight);
            } else {
                metric *= 0.5;
            }
            let (terms, count) = blend(shape.a, shape.b, found.t);
            system.add(&terms[..count], &(-away), &metric);
        }
    }

    /// Model to scan: every piece of a bone wants surface around it.
    fn cover(&self, system: &mut System, samples: &Samples, width: f64, draped: bool) {
        let capsules = self.capsules();
        let total = coverage_points() as f64;
        for (k, capsule) in capsules.iter().enumerate() {
            if draped && body::THIGHS.contains(&k) {
                continue;
            }
            for t in steps_along(k) {
                let Some(away) = nearest_medial(capsule, t, samples) else { continue };
                let robust = 1.0 / (1.0 + away.norm_squared() / (4.0 * width * width));
                let metric = Matrix3::identity() * (COVERAGE * robust * robust / total);
                let (terms, count) = blend(BODY[k].a, BODY[k].b, t);
                system.add(&terms[..count], &away, &metric);
            }
        }
    }

    fn hold_shape(&self, system: &mut System, stiffness: f64) {
        for (spring, rest) in SPRINGS.iter().zip(rest_lengths()) {
            let between = self.pose[spring.a] - self.pose[spring.b];
            let length = between.norm().max(1e-9);
            let unit = between / length;
            let residual = unit * (length - rest * self.scale);
            let metric = unit * unit.transpose() * (stiffness * spring.stiffness);
            system.add(&[(spring.a, 1.0), (spring.b, -1.0)], &residual, &metric);
        }
    }

    fn bend_forwards(&self, system: &mut System) {
        let front = body::facing(&self.pose);
        let metric = front * front.transpose() * 0.2;
        for hip in HIP {
            let (knee, ankle, toes) = (hip + 1, hip + 2, hip + 3);
            let bend = [(knee, 1.0), (hip, -0.5), (ankle, -0.5)];
            let forwards = self.along(&bend, &front);
            if forwards < 0.0 {
                system.add(&bend, &(front * forwards), &metric);
            }
            let point = [(toes, 1.0), (ankle, -1.0)];
            let short = self.along(&point, &front) - 0.05 * self.scale;
            if short < 0.0 {
                system.add(&point, &(front * short), &metric);
            }
        }
    }

    fn along(&self, terms: &[(usize, f64)], direction: &V3) -> f64 {
        terms.iter().map(|&(j, w)| w * self.pose[j].dot(direction)).sum()
    }

    fn stay_near(&self, system: &mut System, expected: &Pose) {
        let metric = Matrix3::identity() * 2e-3;
        for j in 0..JOINTS {
            system.add(&[(j, 1.0)], &(self.pose[j] - expected[j]), &metric);
        }
    }

    /// Lets the capsules follow the thickness of what they hold, alike on both sides.
    fn adapt(&mut self, samples: &Samples, matches: &Matches) {
        let capsules = self.capsules();
        let (mut sums, mut counts) = ([0.0; CAPSULES], [0.0; CAPSULES]);
        for (i, found) in matches.0.iter().enumerate() {
            let (t, away) = capsules[found.capsule].project(&samples.points[i]);
            let ratio = away.norm() / capsules[found.capsule].radius(t);
            if t > 0.0 && t < 1.0 && ratio < 2.0 {
                sums[found.capsule] += ratio;
                counts[found.capsule] += 1.0;
            }
        }
        for k in 0..CAPSULES {
            let twin = body_twin(k);
            let (sum, count) = (sums[k] + sums[twin], counts[k] + counts[twin]);
            // As if ten samples had the template's radius.
            let wanted = (self.girths[k] * sum + 10.0) / (count + 10.0);
            self.girths[k] += 0.3 * (wanted.clamp(0.75, 1.5) - self.girths[k]);
        }
    }

    /// Scan to model, model to scan, and what anatomy forbids.
    fn misfit(&self, samples: &Samples, sided: bool) -> f64 {
        let capsules = self.capsules();
        let matches = Matches::find(&capsules, samples);
        let capped = |v: &V3| v.norm_squared().min(CAP * CAP);
        let scan: f64 = matches.0.iter().map(|m| capped(&m.away)).sum();
        let mut model = 0.0;
        for (k, capsule) in capsules.iter().enumerate() {
            for t in steps_along(k) {
                model += nearest_medial(capsule, t, samples).map_or(CAP * CAP, |v| capped(&v));
            }
        }
        let scan = scan / samples.points.len().max(1) as f64;
        let model = COVERAGE * model / coverage_points() as f64;
        scan + model + self.twist() + if sided { self.contortion() } else { 0.0 }
    }

    /// The cost of hips that face away from the shoulders, and of crossed knees.
    fn twist(&self) -> f64 {
        let across = |a: usize, b: usize| (self.pose[a] - self.pose[b]).try_normalize(1e-9);
        let high = across(SHOULDER[0], SHOULDER[1]);
        let middle = across(HIP[0], HIP[1]);
        let low = across(HIP[0] + 1, HIP[1] + 1);
        let (Some(high), Some(middle), Some(low)) = (high, middle, low) else { return 0.0 };
        let trunk = (0.5 - high.dot(&middle)).max(0.0);
        let legs = (-0.2 - low.dot(&middle)).max(0.0);
        0.01 * trunk * trunk + 0.001 * legs * legs
    }

    fn contortion(&self) -> f64 {
        let front = body::facing(&self.pose);
        let mut sum = 0.0;
        for hip in HIP {
            let knee = self.along(&[(hip + 1, 1.0), (hip, -0.5), (hip + 2, -0.5)], &front);
            let toes = self.along(&[(hip + 3, 1.0), (hip + 2, -1.0)], &front) - 0.05 * self.scale;
            sum += knee.min(0.0) * knee.min(0.0) + toes.min(0.0) * toes.min(0.0);
        }
        0.05 * sum
    }
}

/// The closest capsule of every sample.
pub(super) struct Matches(pub(super) Vec<Match>);

#[derive(Clone, Copy)]
pub(super) struct Match {
    pub(super) capsule: usize,
    t: f64,
    /// From the axis to the sample's inner point.
    away: V3,
}

impl Matches {
    pub(super) fn find(capsules: &[Posed; CAPSULES], samples: &Samples) -> Self {
        let closest = |(point, normal): (&V3, &V3)| {
            let mut best = Match { capsule: 0, t: 0.0, away: V3::repeat(1e3) };
            for (k, capsule) in capsules.iter().enumerate() {
                let (t, away) = capsule.medial(point, normal);
                if away.norm_squared() < best.away.norm_squared() {
                    best = Match { capsule: k, t, away };
                }
            }
            best
        };
        Self(samples.points.iter().zip(&samples.normals).map(closest).collect())
    }
}

/// From the closest inner point of the scan to the axis point at `t`.
fn nearest_medial(capsule: &Posed, t: f64, samples: &Samples) -> Option<V3> {
    let at = capsule.a + (capsule.b - capsule.a) * t;
    let radius = capsule.radius(t);
    let mut best: Option<V3> = None;
    for (point, normal) in samples.points.iter().zip(&samples.normals) {
        let away = at - (point - normal * radius);
        if best.is_none_or(|b| away.norm_squared() < b.norm_squared()) {
            best = Some(away);
        }
    }
    best
}

/// Axis points of capsule `k` that want surface around them; more on what reaches out.
fn steps_along(k: usize) -> impl Iterator<Item = f64> {
    let count = if k < body::FIRST_TORSO { 4 } else { 2 };
    (0..count).map(move |i| (f64::from(i) + 0.5) / f64::from(count))
}

fn coverage_points() -> usize {
    (0..CAPSULES).map(|k| steps_along(k).count()).sum()
}

/// The capsule on the other side, itself for those in the middle.
fn body_twin(k: usize) -> usize {
    match k {
        2..=4 => k + 3,
        5..=7 => k - 3,
        8..=11 => k + 4,
        12..=15 => k - 4,
        17 | 19 => k + 1,
        18 | 20 => k - 1,
        _ => k,
    }
}

/// Joints and weights of the axis point at `t`.
fn blend(a: Anchor, b: Anchor, t: f64) -> ([(usize, f64); 6], usize) {
    let mut terms = [(0, 0.0); 6];
    let mut count = 0;
    for (anchor, share) in [(a, 1.0 - t), (b, t)] {
        for &(joint, weight) in anchor {
            terms[count] = (joint, share * weight);
            count += 1;
        }
    }
    (terms, count)
}
