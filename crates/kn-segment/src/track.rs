//! The segmenter: the steps of a frame, and the state that it keeps for the next one.

use super::body::{self, JOINTS, Pose};
use super::confidence::confidence;
use super::error::SegmentError;
use super::fit::{Fit, Schedule};
use super::hem::{self, Hem};
use super::label::Draft;
use super::memory::Memory;
use super::surface::{Samples, Surface};
use super::{LABELS, OTHER, TORSO, side, start};
use kn_bitstream::params::{BodyPart, Named, UpAxis};
use std::fmt;

/// Settings of a [`Segmenter`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SegmentOptions {
    /// Axis of the positions that points up.
    pub up_axis: UpAxis,
}

/// The result of the segmentation of a frame: labels, confidences and warnings.
#[derive(Clone, Debug, PartialEq)]
pub struct Segmentation {
    /// `#V` labels in the bi-modal paper's order: 0 head, 1–3 left and 4–6 right arm (upper,
    /// lower, hand), 7 torso, 8–10 left and 11–13 right leg (thigh, leg, foot), 14 other.
    pub labels: Vec<u8>,
    /// Confidence of each label, 0 to 1; 0 where no vertex has the label.
    pub confidence: [f32; LABELS],
    /// Confidence of the whole: the mean over the 14 body parts.
    pub trust: f32,
    /// Warnings about the frame.
    pub warnings: Vec<SegmentWarning>,
}

impl Segmentation {
    /// The result for a mesh that is no person: all of it is [`OTHER`].
    pub fn nobody(vertices: usize) -> Self {
        Self {
            labels: vec![OTHER; vertices],
            confidence: [0.0; LABELS],
            trust: 0.0,
            warnings: vec![SegmentWarning::NoPerson],
        }
    }

    /// The body parts that some vertex has, with the confidence of each, 0 to 1.
    pub fn parts(&self) -> impl Iterator<Item = (BodyPart, f32)> {
        let all = BodyPart::all().into_iter().zip(self.confidence);
        all.filter(|(_, confidence)| *confidence > 0.0)
    }

    /// Whether a person was found. If not, all of the frame is [`OTHER`].
    pub fn found_a_person(&self) -> bool {
        !self.warnings.contains(&SegmentWarning::NoPerson)
    }
}

/// A warning about the segmentation of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SegmentWarning {
    /// A part of an arm could not be told from the torso, and joined it.
    Joined {
        /// The part.
        part: BodyPart,
    },
    /// Left and right could not be told apart clearly.
    SidesUnclear,
    /// The frame does not continue the last one, and the body was searched again.
    Lost,
    /// The body explains too little of the surface: no person was found.
    NoPerson,
}

impl fmt::Display for SegmentWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Joined { part } => {
                write!(f, "{part} cannot be told from the body and joined the torso")
            }
            Self::SidesUnclear => f.write_str("nothing shows clearly which side is left"),
            Self::Lost => f.write_str("the body was lost and searched anew"),
            Self::NoPerson => f.write_str("no person was found: every vertex is Other"),
        }
    }
}

/// Segments the frames of one sequence, in their order.
#[derive(Clone, Debug)]
pub struct Segmenter {
    options: SegmentOptions,
    past: Option<Past>,
}

/// The state that a frame leaves to the next one.
#[derive(Clone, Debug)]
struct Past {
    /// Template metres per world unit, fixed by the first frame.
    unit: f64,
    fit: Fit,
    /// The joints one frame earlier.
    before: Pose,
    /// Evidence so far that left is left.
    sides: f64,
    /// Running mean of the fits' energies.
    energy: f64,
    hem: Hem,
    memory: Memory,
    confidence: [f32; LABELS],
    /// Frames since the body was last searched.
    since: u32,
}

impl Past {
    /// Whether a leg is so badly explained that tracking has probably gone wrong.
    fn doubtful(&self) -> bool {
        /// Number of frames between searches, which bounds their cost.
        const PATIENCE: u32 = 8;
        const DOUBTFUL: f32 = 0.3;
        let legs = LOWER_LEGS.map(|part| self.confidence[part.index()]);
        self.since >= PATIENCE && legs.iter().any(|&trust| trust < DOUBTFUL)
    }
}

/// The parts whose doubtful fit makes the search begin anew.
const LOWER_LEGS: [BodyPart; 4] =
    [BodyPart::LeftLeg, BodyPart::LeftFoot, BodyPart::RightLeg, BodyPart::RightFoot];
/// Samples of a frame, and of the search without a past.
const SAMPLES: usize = 1000;
const COARSE_SAMPLES: usize = 400;
/// Share of the area at least that components of more than dirt's size have. A mesh of many small
/// components has no body that could be followed; raw captures have 0.9 and more.
const CLEAN: f64 = 0.5;
/// Mean confidence of a person's parts at least: people have 0.75 to 0.9, spheres, tori and tables
/// below 0.5.
const TRUSTED: f32 = 0.55;
/// Surface of the template in its clothes, square metres.
const TEMPLATE_AREA: f64 = 2.1;

const TRACK: Schedule = Schedule {
    steps: 12,
    widths: [0.15, 0.06],
    stiffness: [0.2, 0.5],
    sided: true,
    girths: true,
    draped: false,
};
const FIRST: Schedule = Schedule { steps: 8, sided: false, ..TRACK };
const DRAPED: Schedule = Schedule { steps: 8, widths: [0.08, 0.06], draped: true, ..TRACK };

impl Segmenter {
    /// Makes a segmenter for a new sequence.
    pub fn new(options: SegmentOptions) -> Self {
        Self { options, past: None }
    }

    /// Segments the next frame: `positions` is `#V × 3`, `faces` `#F × 3`, welded; several
    /// components, holes and dirt are fine.
    ///
    /// # Errors
    /// A mesh without vertices, faces or area; a position that is not finite; a face index out of
    /// range. The segmenter then still stands at the last good frame, as it does after a mesh most
    /// of which is small components.
    pub fn segment(
        &mut self,
        positions: &[[f64; 3]],
        faces: &[[u32; 3]],
    ) -> Result<Segmentation, SegmentError> {
        let mut surface = Surface::new(positions, faces, self.options.up_axis)?;
        if surface.clean_share() < CLEAN {
            return Ok(Segmentation::nobody(positions.len()));
        }
        let past = self.past.as_ref();
        let unit = past.map_or_else(|| (TEMPLATE_AREA / surface.area()).sqrt(), |past| past.unit);
        surface.rescale(unit);
        let samples = surface.samples(SAMPLES);
        // Pieces of just the share that dirt has may be dirt in another unit.
        if samples.points.is_empty() {
            return Ok(Segmentation::nobody(positions.len()));
        }

        let (mut fit, way) = pose(&surface, &samples, past);
        let hem = undress(&surface, &samples, &mut fit, past);
        let continued = past.filter(|_| way != Way::Found);
        let sides = decide_sides(&mut fit, &samples, continued);
        let (mut labels, capsules) = label(&surface, &fit, &hem, past);

        let trust = steady(confidence(&surface, &fit, &hem, &labels), past);
        let memory = Memory::new(&surface, capsules, &labels);
        let before = continued.map_or(fit.pose, |past| past.fit.pose);
        let energy = past.map_or(fit.energy, |past| 0.9 * past.energy + 0.1 * fit.energy);
        let mut warnings = doubts(past.is_some() && way == Way::Found, sides);
        let since = if way == Way::Tracked {
            past.map_or(0, |past| past.since).saturating_add(1)
        } else {
            0
        };
        let confidence = trust;
        self.past = Some(Past { unit, fit, before, sides, energy, hem, memory, confidence, since });

        let mut confidence = trust;
        join(&mut labels, &mut confidence, &mut warnings);
        let whole = confidence[..usize::from(OTHER)].iter().sum::<f32>() / f32::from(OTHER);
        if whole < TRUSTED {
            return Ok(Segmentation { trust: whole, ..Segmentation::nobody(labels.len()) });
        }
        Ok(Segmentation { labels, confidence, trust: whole, warnings })
    }
}

/// Exchanges left and right where the evidence of this and earlier frames is against them; returns
/// the evidence for what is kept.
fn decide_sides(fit: &mut Fit, samples: &Samples, past: Option<&Past>) -> f64 {
    /// Evidence of about one clear frame; less does not overturn what was said before.
    const AGAINST: f64 = -3.0;
    /// The share of a frame's evidence that remains in the next one.
    const FADING: f64 = 0.9;
    let sides = past.map_or(0.0, |past| FADING * past.sides) + side::evidence(fit, samples);
    if sides < AGAINST {
        fit.pose = body::mirrored(&fit.pose);
    }
    if sides < AGAINST { -sides } else { sides }
}

/// Confidence moves slowly, so that a part does not join and leave the torso by turns.
fn steady(now: [f32; LABELS], past: Option<&Past>) -> [f32; LABELS] {
    const SHARE: f32 = 0.3;
    let Some(past) = past else { return now };
    std::array::from_fn(|part| SHARE * now[part] + (1.0 - SHARE) * past.confidence[part])
}

fn doubts(lost: bool, sides: f64) -> Vec<SegmentWarning> {
    /// Two thirds of what one clear foot shows.
    const CLEAR: f64 = 1.0;
    let lost = lost.then_some(SegmentWarning::Lost);
    let unclear = (sides < CLEAR).then_some(SegmentWarning::SidesUnclear);
    lost.into_iter().chain(unclear).collect()
}

/// The way in which a frame's body was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    /// It continues the last frame's.
    Tracked,
    /// It does, and a search found nothing better.
    Checked,
    /// It was searched.
    Found,
}

/// The body in this frame.
fn pose(surface: &Surface, samples: &Samples, past: Option<&Past>) -> (Fit, Way) {
    /// A tracked fit this much worse than usual gets its arms, or the whole body, checked against
    /// a search, which must be clearly better to win: identities are worth more than millimetres.
    const UNUSUAL: f64 = 1.1;
    const SUSPICIOUS: f64 = 1.6;
    const CLEARLY: f64 = 0.85;
    const BETTER: f64 = 0.95;
    let Some(past) = past else { return (search(surface, samples, None), Way::Found) };
    let tracked = track(samples, past);
    let worse = tracked.energy / past.energy.max(1e-12);
    if worse > SUSPICIOUS || past.doubtful() {
        let found = search(surface, samples, Some(&past.fit));
        let better = found.energy < CLEARLY * tracked.energy;
        return if better { (found, Way::Found) } else { (tracked, Way::Checked) };
    }
    if worse > UNUSUAL {
        let other = rearm(surface, samples, &tracked);
        let better = other.energy < BETTER * tracked.energy;
        return (if better { other } else { tracked }, Way::Tracked);
    }
    (tracked, Way::Tracked)
}

/// The same body with its arms searched anew.
fn rearm(surface: &Surface, samples: &Samples, fit: &Fit) -> Fit {
    let coarse = surface.samples(COARSE_SAMPLES);
    // Energies of coarse samples are compared with each other, never with those of fine ones.
    let start = fit.clone().run(&coarse, &Schedule { steps: 0, ..TRACK }, None);
    start::raise_arms(&coarse, start, &[1.0]).run(samples, &Schedule { steps: 6, ..TRACK }, None)
}

/// The better of two fits: from where the joints were, and from where they were heading.
fn track(samples: &Samples, past: &Past) -> Fit {
    /// Joints overshoot where a motion ends, so they are expected a little short.
    const MOMENTUM: f64 = 0.7;
    let last = &past.fit;
    let heading = std::array::from_fn::<_, JOINTS, _>(|j| {
        last.pose[j] + (last.pose[j] - past.before[j]) * MOMENTUM
    });
    let ahead = Fit { pose: heading, ..last.clone() };
    let ahead = ahead.run(samples, &TRACK, Some(&heading));
    let still = last.clone().run(samples, &TRACK, Some(&last.pose));
    if ahead.energy <= still.energy { ahead } else { still }
}

/// The body wherever it is; it faces where the last frame's did unless its feet say otherwise.
fn search(surface: &Surface, samples: &Samples, last: Option<&Fit>) -> Fit {
    /// Evidence of facing as before.
    const HABIT: f64 = 2.5;
    let coarse = surface.samples(COARSE_SAMPLES);
    let scale = last.map_or(1.0, |last| last.scale);
    let mut found = start::search(&coarse, scale).run(samples, &FIRST, None);
    let front = body::facing(&found.pose);
    let habit = last.map_or(0.0, |last| HABIT * front.dot(&body::facing(&last.pose)));
    if side::evidence(&found, samples) + habit < 0.0 {
        found.pose = body::mirrored(&found.pose);
    }
    side::point_toes(&mut found, samples);
    found.run(samples, &TRACK, None)
}

/// Finds the hem and, where cloth hangs, fits again to what is not cloth.
fn undress(surface: &Surface, samples: &Samples, fit: &mut Fit, past: Option<&Past>) -> Hem {
    let measure = |fit: &Fit| {
        let draft = Draft::new(surface, fit);
        let hem = hem::find(surface, fit, |v| draft.part(v) >= TORSO);
        past.map_or(hem, |past| hem.follow(&past.hem))
    };
    let hem = measure(fit);
    if !hem.hangs() {
        return hem;
    }
    let bare = hem.under(fit, samples);
    // The energy stays that of the whole surface, or frames could not be compared.
    let energy = fit.energy;
    *fit = fit.clone().run(&bare, &DRAPED, None);
    fit.energy = energy;
    measure(fit)
}

fn label(surface: &Surface, fit: &Fit, hem: &Hem, past: Option<&Past>) -> (Vec<u8>, Vec<u8>) {
    let mut draft = Draft::new(surface, fit);
    if hem.hangs() {
        draft.drape(surface, fit, hem);
    }
    draft.hold(surface);
    if let Some(past) = past {
        draft.remember(&past.memory.recall(&past.fit, fit, surface));
    }
    draft.settle(surface)
}

/// Joins lower arms and hands of low confidence to the torso.
fn join(labels: &mut [u8], confidence: &mut [f32; LABELS], warnings: &mut Vec<SegmentWarning>) {
    const DOUBTFUL: f32 = 0.2;
    for part in
        [BodyPart::LeftLowerArm, BodyPart::LeftHand, BodyPart::RightLowerArm, BodyPart::RightHand]
    {
        let (trust, label) = (&mut confidence[part.index()], part.label());
        if *trust < DOUBTFUL && labels.contains(&label) {
            *trust = 0.0;
            labels.iter_mut().filter(|l| **l == label).for_each(|l| *l = TORSO);
            warnings.push(SegmentWarning::Joined { part });
        }
    }
    debug_assert!(labels.iter().all(|&l| l <= OTHER));
}
