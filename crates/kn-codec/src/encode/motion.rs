//! Coding of the motion of P-frames: fit, choice by J = D + λR, quantisation.

use crate::decode::{Reconstruction, Slot};
use crate::encode::choices::{CombinationChoice, TranslationChoice};
use crate::encode::config::EncoderConfig;
use crate::encode::cost::cheapest;
use crate::encode::failure::{EarlierFrames, FitFailure};
use crate::encode::frame_settings::FrameSettings;
use crate::encode::quantise::{StepComponents, StepRange, Steps, quantise_parameters};
use crate::encode::report::CostReport;
use crate::encode::scan::Scan;
use crate::encode::translation::code_translations;
use crate::encode::tuning::{StepTuning, Tuning};
use kn_bitstream::params::Combination;
use kn_bitstream::{BitWriter, MotionFrame, SequenceHeader};
use kn_deform::NodeTransform;
use kn_fit::{Fit, FitError, FitOptions, FitSource, Fitter};

/// Codes the P-frames of a GoF, one after the other.
pub(crate) struct MotionEncoder {
    config: EncoderConfig,
    tuning: Tuning,
    /// Reference units in a grid step.
    unit: f64,
    fitter: Option<Fitter>,
    /// The GoF's earlier frames, which the next one is compared with.
    earlier: EarlierFrames,
    /// The combination of the GoF's frames, where it is known.
    combination: Option<Combination>,
    /// The steps with which the search begins in this frame.
    steps: Option<Steps>,
    /// `#V × 3`, the reference in grid steps.
    reference: Vec<[f64; 3]>,
    /// `#N × 3`, the nodes in grid steps.
    nodes: Vec<[f64; 3]>,
}

/// The motion of a P-frame, ready to be written.
#[derive(Debug)]
pub(crate) struct CodedMotion {
    pub(crate) motion: MotionFrame,
    pub(crate) combination: Combination,
    /// The cost; `None` where nothing was chosen by cost.
    pub(crate) cost: Option<CostReport>,
    /// RMS distance of the fit, grid steps.
    pub(crate) fit_rms: f64,
}

impl MotionEncoder {
    pub(crate) fn new(config: &EncoderConfig, tuning: Tuning, header: &SequenceHeader) -> Self {
        Self {
            config: config.clone(),
            tuning,
            unit: f64::from(1_u32 << header.fraction_bits),
            fitter: None,
            earlier: EarlierFrames::default(),
            combination: None,
            steps: None,
            reference: Vec::new(),
            nodes: Vec::new(),
        }
    }

    /// Begins a GoF; `combination` where one was chosen for all of it.
    pub(crate) fn begin(&mut self, combination: Option<Combination>) {
        self.fitter = None;
        self.earlier = EarlierFrames::default();
        self.steps = None;
        self.combination = combination;
    }

    /// Codes the motion from the decoded frame in `from` to `scan`, or returns why the motion does
    /// not explain the scan.
    ///
    /// # Errors
    /// The fit fails.
    pub(crate) fn encode(
        &mut self,
        decoded: &mut Reconstruction,
        from: Slot,
        scan: &Scan,
        settings: &FrameSettings,
    ) -> Result<Result<CodedMotion, FitFailure>, FitError> {
        let candidates = self.candidates(decoded);
        let fits = self.fit(decoded, from, scan, &candidates)?;
        let explained = match self.explained(&fits) {
            Ok(explained) => explained,
            Err(failure) => return Ok(Err(failure)),
        };
        let mut frame = self.frame(decoded, from, scan, settings);
        let begin = self.steps.unwrap_or(frame.range.usual);
        let trials = explained.into_iter().map(|index| {
            let fit = &fits[index];
            (frame.trial(&frame.in_reference_units(fit), candidates[index], begin), fit)
        });
        let trials: Vec<(Trial, &Fit)> = trials.collect();
        let lambda = settings.component_lambda;
        let Some((trial, fit)) = cheapest(trials, |(trial, _)| trial.cost.with_lambda(lambda))
        else {
            return Err(FitError::Length { what: "combinations", found: 0, expected: 1 });
        };
        let trial = frame.cheapest_steps(&frame.in_reference_units(fit), trial);
        self.steps = Some(trial.steps);
        if self.config.motion.combination == CombinationChoice::FirstP {
            self.combination = Some(trial.combination);
        }
        Ok(Ok(CodedMotion {
            combination: trial.combination,
            cost: self.config.motion.is_by_cost().then_some(trial.cost),
            fit_rms: fit.report.source_to_target.rms,
            motion: trial.motion,
        }))
    }

    /// The indices of the fits that explain the frame, or the failure of the first where none does.
    fn explained(&mut self, fits: &[Fit]) -> Result<Vec<usize>, FitFailure> {
        let (tuning, earlier) = (&self.tuning.failure, &self.earlier);
        let failures: Vec<_> = fits.iter().map(|fit| tuning.judge(&fit.report, earlier)).collect();
        fits.iter().for_each(|fit| self.earlier.remember(&fit.report));
        let explained: Vec<usize> =
            (0..fits.len()).filter(|&index| failures[index].is_none()).collect();
        match failures.first() {
            Some(&Some(failure)) if explained.is_empty() => Err(failure),
            _ => Ok(explained),
        }
    }

    fn frame<'a>(
        &self,
        decoded: &'a mut Reconstruction,
        from: Slot,
        scan: &'a Scan,
        settings: &'a FrameSettings,
    ) -> Frame<'a> {
        let (quantisers, tuning) = (settings.quantisers, self.tuning.steps);
        let usual = Steps::new(&quantisers, &tuning, self.unit, reach(decoded, from));
        Frame {
            digests: self.config.sequence.digests,
            translation: self.config.motion.translation,
            is_by_cost: self.config.motion.is_by_cost(),
            range: StepRange { quantisers, usual, farthest: tuning.farthest },
            tuning,
            lambda: settings.lambda,
            unit: self.unit,
            decoded,
            from,
            scan,
        }
    }

    /// The combinations that are tried in this frame.
    fn candidates(&self, decoded: &Reconstruction) -> Vec<Combination> {
        match (self.config.motion.combination, self.combination) {
            (CombinationChoice::Fixed(combination), _) | (_, Some(combination)) => {
                vec![combination]
            }
            // Rigid nodes have rotation and translation, whatever the combination.
            _ if decoded.nodes().affine_count() == 0 => vec![Combination::RT],
            // One frame does not show what the others lose without rotation in a chain of frames.
            _ => Combination::ALL.into_iter().filter(|combination| combination.rotation).collect(),
        }
    }

    /// Fits the frame with every candidate. The transforms are in grid steps.
    fn fit(
        &mut self,
        decoded: &Reconstruction,
        from: Slot,
        scan: &Scan,
        candidates: &[Combination],
    ) -> Result<Vec<Fit>, FitError> {
        let reference = decoded.reference(from);
        reference_to_grid_steps(&reference.positions, self.unit, &mut self.reference);
        reference_to_grid_steps(&reference.nodes, self.unit, &mut self.nodes);
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
            none => none.insert(Fitter::new(&source)?),
        };
        let options = FitOptions {
            part_start: self.config.motion.part_start,
            measures: Some(self.tuning.failure.measures),
            ..FitOptions::default()
        };
        match candidates {
            &[combination] => {
                let options = FitOptions { combination, ..options };
                fitter.fit_frame(&source, &scan.target, &options).map(|fit| vec![fit])
            }
            _ => fitter.fit_combinations(&source, &scan.target, &options, candidates),
        }
    }
}

/// A frame, and the data that candidates for its motion are judged by.
struct Frame<'a> {
    digests: bool,
    translation: TranslationChoice,
    is_by_cost: bool,
    range: StepRange,
    tuning: StepTuning,
    lambda: f64,
    /// Reference units in a grid step.
    unit: f64,
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
        motion.header.positions_digest = self.digests.then_some(0);
        let before = self.decoded.translations();
        let (choice, step) = (self.translation, steps.translation);
        code_translations(transforms, before, choice, step, self.decoded.limit(), &mut motion);
        let affine = &self.decoded.nodes().affine;
        quantise_parameters(transforms, affine, combination, steps, &mut motion);
        let cost = self.cost(&motion);
        Trial { motion, combination, steps, cost }
    }

    fn cost(&mut self, motion: &MotionFrame) -> CostReport {
        if !self.is_by_cost {
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
        CostReport::new(distortion, bytes, self.lambda)
    }

    /// Tries finer and coarser steps, one kind of component after the other, as long as J falls.
    fn cheapest_steps(&mut self, transforms: &[NodeTransform], first: Trial) -> Trial {
        let mut best = first;
        for _ in 0..self.tuning.rounds {
            let before = best.steps;
            for some in
                [StepComponents::Translation, StepComponents::Rotation, StepComponents::Stretch]
            {
                let carried = best.motion.enabled.scale || best.motion.enabled.shear;
                if some != StepComponents::Stretch || carried {
                    best = self.cheapest_of(transforms, some, best);
                }
            }
            if best.steps == before {
                break;
            }
        }
        best
    }

    fn cheapest_of(
        &mut self,
        transforms: &[NodeTransform],
        some: StepComponents,
        first: Trial,
    ) -> Trial {
        let begin = first.steps;
        let mut best = first;
        for stride in [self.tuning.stride, -self.tuning.stride] {
            while let Some(steps) = self.range.coarser(best.steps, some, stride) {
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

/// Converts reference units, of which `unit` make a grid step, to grid steps.
pub(crate) fn reference_to_grid_steps(
    reference: &[[i32; 3]],
    unit: f64,
    positions: &mut Vec<[f64; 3]>,
) {
    positions.clear();
    positions.extend(reference.iter().map(|p| p.map(|c| f64::from(c) / unit)));
}

/// The mean distance between a vertex and the nodes that move it, in reference units, weighted by
/// influence. Every sixteenth vertex is measured.
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
