//! Motion of P-frames: fit, choose by J = D + λR, quantise.

use crate::decode::{Reconstruction, Slot};
use crate::encode::choices::{CombinationChoice, StepChoice};
use crate::encode::config::EncoderConfig;
use crate::encode::cost::cheapest;
use crate::encode::quantise::{StepGroup, Steps, quantise_parameters};
use crate::encode::report::CostReport;
use crate::encode::scan::Scan;
use crate::encode::translation::code_translations;
use kn_bitstream::params::Combination;
use kn_bitstream::{BitWriter, MotionFrame, SequenceHeader};
use kn_deform::NodeTransform;
use kn_fit::{Fit, FitFailure, FitOptions, FitSource, Fitter};

/// A step is chosen in so many rounds over its components ...
const ROUNDS: usize = 2;
/// ... and changes by half an octave at a time.
const STRIDE: i8 = 2;

/// Codes the P-frames of a group, one after the other.
pub(crate) struct MotionEncoder {
    config: EncoderConfig,
    /// Reference units in a grid step.
    unit: f64,
    fitter: Option<Fitter>,
    /// The combination of the group's frames, where it is known.
    combination: Option<Combination>,
    /// P-frames of the group that are still to come, this one among them.
    frames_left: usize,
    /// Where the search for this frame's steps begins.
    steps: Option<Steps>,
    /// `#V × 3`, the reference in grid steps.
    reference: Vec<[f64; 3]>,
    /// `#N × 3`, the nodes in grid steps.
    nodes: Vec<[f64; 3]>,
}

/// A P-frame as it is to be coded.
#[derive(Debug)]
pub(crate) struct CodedMotion {
    pub(crate) motion: MotionFrame,
    pub(crate) combination: Combination,
    /// Where anything was chosen by cost.
    pub(crate) cost: Option<CostReport>,
    /// RMS distance of the fit, grid steps.
    pub(crate) fit_rms: f64,
}

impl MotionEncoder {
    pub(crate) fn new(config: &EncoderConfig, header: &SequenceHeader) -> Self {
        Self {
            config: config.clone(),
            unit: f64::from(1_u32 << header.fraction_bits),
            fitter: None,
            combination: None,
            frames_left: 0,
            steps: None,
            reference: Vec::new(),
            nodes: Vec::new(),
        }
    }

    /// Begins a group with so many P-frames; `combination` where one was chosen for all of it.
    pub(crate) fn begin(&mut self, frames: usize, combination: Option<Combination>) {
        self.frames_left = frames;
        self.fitter = None;
        self.steps = None;
        self.combination = combination;
    }

    /// The motion from the decoded frame in `from` to `scan`, or why there is none.
    ///
    /// # Errors
    /// What the fit says.
    pub(crate) fn encode(
        &mut self,
        decoded: &mut Reconstruction,
        from: Slot,
        scan: &Scan,
    ) -> Result<Result<CodedMotion, FitFailure>, String> {
        let candidates = self.candidates(decoded);
        let fits = self.fit(decoded, from, scan, &candidates)?;
        let sound: Vec<_> =
            candidates.iter().zip(&fits).filter(|(_, fit)| fit.report.failure.is_none()).collect();
        if let (true, Some(failure)) = (sound.is_empty(), fits[0].report.failure) {
            return Ok(Err(failure));
        }
        let usual = Steps::new(&self.config, self.unit, reach(decoded, from));
        let begin = self.steps.unwrap_or(usual);
        let lambda = self.config.lambda * inherited(self.frames_left);
        self.frames_left = self.frames_left.saturating_sub(1);
        let mut frame = Frame { config: &self.config, unit: self.unit, usual, decoded, from, scan };
        let trials = sound.into_iter().map(|(&combination, fit)| {
            (frame.trial(&frame.in_reference_units(fit), combination, begin), fit)
        });
        let trials: Vec<(Trial, &Fit)> = trials.collect();
        let Some((trial, fit)) = cheapest(trials, |(trial, _)| trial.cost.with_lambda(lambda))
        else {
            return Err("there is no combination to choose".into());
        };
        let trial = frame.cheapest_steps(&frame.in_reference_units(fit), trial);
        self.steps = Some(trial.steps);
        if self.config.combination == CombinationChoice::FirstP {
            self.combination = Some(trial.combination);
        }
        Ok(Ok(CodedMotion {
            combination: trial.combination,
            cost: is_by_cost(&self.config).then_some(trial.cost),
            fit_rms: fit.report.source_to_target.rms,
            motion: trial.motion,
        }))
    }

    /// The combinations that this frame may have.
    fn candidates(&self, decoded: &Reconstruction) -> Vec<Combination> {
        match (self.config.combination, self.combination) {
            (CombinationChoice::Fixed(combination), _) | (_, Some(combination)) => {
                vec![combination]
            }
            // Rigid nodes have rotation and translation, whatever the combination.
            _ if decoded.nodes().affine_count() == 0 => vec![Combination::RT],
            // One frame does not show what the others lose without rotation in a chain of frames.
            _ => Combination::ALL.into_iter().filter(|combination| combination.rotation).collect(),
        }
    }

    /// A fit for every candidate; transforms are in grid steps.
    fn fit(
        &mut self,
        decoded: &Reconstruction,
        from: Slot,
        scan: &Scan,
        candidates: &[Combination],
    ) -> Result<Vec<Fit>, String> {
        let reference = decoded.reference(from);
        to_grid_steps(&reference.positions, self.unit, &mut self.reference);
        to_grid_steps(&reference.nodes, self.unit, &mut self.nodes);
        let intra = decoded.intra();
        let source = FitSource {
            positions: &self.reference,
            faces: &intra.faces,
            influence: decoded.influence(),
            nodes: &self.nodes,
            affine: &decoded.nodes().affine,
            labels: (!intra.labels.is_empty()).then_some(&intra.labels[..]),
        };
        let fitter = match &mut self.fitter {
            Some(fitter) => fitter,
            none => none.insert(Fitter::new(&source).map_err(|error| error.to_string())?),
        };
        let options = FitOptions { part_start: self.config.part_start, ..FitOptions::default() };
        let fits = match candidates {
            &[combination] => {
                let options = FitOptions { combination, ..options };
                fitter.fit_frame(&source, &scan.target, &options).map(|fit| vec![fit])
            }
            _ => fitter.fit_combinations(&source, &scan.target, &options, candidates),
        };
        fits.map_err(|error| error.to_string())
    }
}

/// What bytes count where components are chosen, in a frame that is the first of so many P-frames:
/// what its motion leaves unexplained stays so in those after it, on average in half of them.
fn inherited(frames: usize) -> f64 {
    2.0 / (frames + 1) as f64
}

/// Whether any choice of the encoder compares costs of P-frames.
pub(crate) fn is_by_cost(config: &EncoderConfig) -> bool {
    config.motion_step == StepChoice::Cost
        || !matches!(config.combination, CombinationChoice::Fixed(_))
}

/// A frame and what candidates for its motion are judged by.
struct Frame<'a> {
    config: &'a EncoderConfig,
    unit: f64,
    usual: Steps,
    decoded: &'a mut Reconstruction,
    /// The reference that it is deformed from.
    from: Slot,
    scan: &'a Scan,
}

/// One way to code a frame.
struct Trial {
    motion: MotionFrame,
    combination: Combination,
    steps: Steps,
    cost: CostReport,
}

impl Frame<'_> {
    /// `#N` transforms.
    fn in_reference_units(&self, fit: &Fit) -> Vec<NodeTransform> {
        let scaled = |transform: &NodeTransform| NodeTransform {
            translation: transform.translation.map(|t| t * self.unit),
            ..*transform
        };
        fit.transforms.iter().map(scaled).collect()
    }

    fn trial(
        &mut self,
        transforms: &[NodeTransform],
        combination: Combination,
        steps: Steps,
    ) -> Trial {
        let mut motion = MotionFrame::default();
        motion.header.positions_digest = self.config.digests.then_some(0);
        let before = self.decoded.translations();
        let (choice, step) = (self.config.translation, steps.translation);
        code_translations(transforms, before, choice, step, self.decoded.limit(), &mut motion);
        let affine = &self.decoded.nodes().affine;
        quantise_parameters(transforms, affine, combination, steps, &mut motion);
        let cost = self.cost(&motion);
        Trial { motion, combination, steps, cost }
    }

    fn cost(&mut self, motion: &MotionFrame) -> CostReport {
        if !is_by_cost(self.config) {
            return CostReport::new(0.0, 0, 0.0);
        }
        let mut bits = BitWriter::new();
        motion.write(&mut bits, &self.decoded.motion_context());
        let bytes = bits.into_bytes().len() as u64;
        // What the decoder would refuse costs more than anything else.
        let look = |positions: &[[i32; 3]], faces: &[[u32; 3]]| {
            self.scan.distortion(positions, self.unit, faces)
        };
        let distortion = self.decoded.preview(motion, self.from, look).unwrap_or(f64::INFINITY);
        CostReport::new(distortion, bytes, self.config.lambda)
    }

    /// Finer and coarser steps, one group of components after the other, as long as J falls.
    fn cheapest_steps(&mut self, transforms: &[NodeTransform], first: Trial) -> Trial {
        let mut best = first;
        for _ in 0..ROUNDS {
            let before = best.steps;
            for group in [StepGroup::Translation, StepGroup::Rotation, StepGroup::Stretch] {
                let carried = best.motion.enabled.scale || best.motion.enabled.shear;
                if group != StepGroup::Stretch || carried {
                    best = self.cheapest_in_group(transforms, group, best);
                }
            }
            if best.steps == before {
                break;
            }
        }
        best
    }

    fn cheapest_in_group(
        &mut self,
        transforms: &[NodeTransform],
        group: StepGroup,
        first: Trial,
    ) -> Trial {
        let begin = first.steps;
        let mut best = first;
        for stride in [STRIDE, -STRIDE] {
            while let Some(steps) = best.steps.coarser(group, stride, self.config, self.usual) {
                let trial = self.trial(transforms, best.combination, steps);
                if trial.cost.total >= best.cost.total {
                    break;
                }
                best = trial;
            }
            if best.steps != begin {
                break;
            }
        }
        best
    }
}

fn to_grid_steps(reference: &[[i32; 3]], unit: f64, positions: &mut Vec<[f64; 3]>) {
    positions.clear();
    positions.extend(reference.iter().map(|p| p.map(|c| f64::from(c) / unit)));
}

/// How far from its node a vertex is moved by it, in reference units: the weighted mean distance
/// over every sixteenth vertex and its nodes.
fn reach(decoded: &Reconstruction, from: Slot) -> f64 {
    let influence = decoded.influence();
    let reference = decoded.reference(from);
    let nodes = &reference.nodes;
    let q = influence.nodes_per_vertex;
    let (mut sum, mut total) = (0.0, 0.0);
    for (vertex, position) in reference.positions.iter().enumerate().step_by(16) {
        for slot in vertex * q..(vertex + 1) * q {
            let node = nodes[usize::from(influence.nodes[slot])];
            let squared: f64 =
                (0..3).map(|k| f64::from(position[k] - node[k])).map(|d| d * d).sum();
            sum += influence.weights[slot] * squared.sqrt();
            total += influence.weights[slot];
        }
    }
    if total > 0.0 { sum / total } else { 1.0 }
}
