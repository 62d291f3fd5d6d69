//! The fit of a frame.

use crate::cholesky::BlockCholesky;
use crate::coarse;
use crate::constants::matches::{LEAST_WIDTH, REACH_WEIGHT, WIDTH};
use crate::constants::minimisation::{FIRST_FACTORS, ITERATIONS, REFACTOR};
use crate::constants::starts::CLEARLY;
use crate::deformed::Deformed;
use crate::energy::{Energy, minimise};
use crate::error::{FitError, Side};
use crate::group::{Group, mean_edge};
use crate::matching::{Correspondences, Hints, Matches, push_matches, quantile};
use crate::measures::Outcome;
use crate::options::{FitOptions, PartStart};
use crate::parts;
use crate::quadratic::{Observations, QuadraticForm};
use crate::report::{Fit, FitReport};
use crate::schedule::{Schedule, Stage};
use crate::source::FitSource;
use crate::target::FitTarget;
use kn_bitstream::params::Combination;
use kn_deform::NodeTransform;
use kn_mesh::vec3::Vec3;

/// The effort of one minimisation.
#[derive(Clone, Copy)]
struct Effort {
    /// α_orth relative to its last value.
    stiffness: f64,
    /// Whether the variables of L-BFGS are made anew for this energy.
    refactor: bool,
    iterations: u64,
}

/// With the last matches, for one combination after the other.
const LAST: Effort = Effort { stiffness: 1.0, refactor: true, iterations: 30 };

/// Fits the frames of one GoF, one after the other. It holds the data that are the same in all
/// frames of the GoF, the buffers, and the motion of the previous frame.
#[derive(Debug)]
pub struct Fitter {
    group: Group,
    form: QuadraticForm,
    factor: BlockCholesky,
    observations: Observations,
    deformed: Deformed,
    hints: Hints,
    previous: Option<Vec<NodeTransform>>,
}

/// One frame's task.
#[derive(Clone, Copy)]
struct Frame<'a> {
    source: &'a FitSource<'a>,
    target: &'a FitTarget,
    options: &'a FitOptions,
    /// `#N`: what each node may do.
    combinations: &'a [Combination],
}

impl Fitter {
    /// Prepares a GoF from its I-frame.
    ///
    /// # Errors
    /// Arrays that do not fit together, see [`FitError`].
    pub fn new(source: &FitSource) -> Result<Self, FitError> {
        let group = Group::new(source)?;
        Ok(Self {
            form: QuadraticForm::new(&group.pattern),
            group,
            factor: BlockCholesky::default(),
            observations: Observations::default(),
            deformed: Deformed::default(),
            hints: Hints::default(),
            previous: None,
        })
    }

    /// Fits the transforms that carry `source` onto `target`. `source` is the GoF's mesh with the
    /// positions and nodes of the reference frame; faces, influence and affine nodes must be those
    /// that the fitter was made for. The next frame starts from this one's motion.
    ///
    /// # Errors
    /// Arrays that do not fit together, see [`FitError`]. A frame that is hard to fit is no error:
    /// see [`FitReport::measures`].
    pub fn fit_frame(
        &mut self,
        source: &FitSource,
        target: &FitTarget,
        options: &FitOptions,
    ) -> Result<Fit, FitError> {
        self.check(source)?;
        let combinations = combinations(source, options.combination);
        let frame = Frame { source, target, options, combinations: &combinations };
        let (transforms, mut report) = self.track(frame)?;
        self.measure(frame, &mut report)?;
        self.previous = Some(transforms.clone());
        Ok(Fit { transforms, report })
    }

    /// Fits a frame once for each combination, with one search for correspondences: the matches
    /// come from the fit with `options.combination`, then each combination minimises the energy
    /// that they leave with its own components (the paper: a disabled component is disabled while
    /// fitting). The next frame starts from the motion of `options.combination`.
    ///
    /// # Errors
    /// Arrays that do not fit together, see [`FitError`].
    pub fn fit_combinations(
        &mut self,
        source: &FitSource,
        target: &FitTarget,
        options: &FitOptions,
        candidates: &[Combination],
    ) -> Result<Vec<Fit>, FitError> {
        self.check(source)?;
        let shared = combinations(source, options.combination);
        let frame = Frame { source, target, options, combinations: &shared };
        let (transforms, shared_report) = self.track(frame)?;
        let mut fits = Vec::with_capacity(candidates.len());
        for &candidate in candidates {
            let own = combinations(source, candidate);
            let frame = Frame { combinations: &own, ..frame };
            let mut transforms = transforms.clone();
            let mut report = shared_report.clone();
            report.evaluations += self.minimise(frame, LAST, &mut transforms);
            self.deformed.update(source, &transforms);
            self.measure(frame, &mut report)?;
            fits.push(Fit { transforms, report });
        }
        self.previous = Some(transforms);
        Ok(fits)
    }

    /// `#V × 3`: the source as the last fit deformed it.
    pub fn deformed(&self) -> &[[f64; 3]] {
        &self.deformed.positions
    }

    /// `#V × 3`: the source as these transforms deform it.
    pub(crate) fn deform(&mut self, source: &FitSource, transforms: &[NodeTransform]) -> &[Vec3] {
        self.deformed.update(source, transforms);
        &self.deformed.positions
    }

    fn check(&self, source: &FitSource) -> Result<(), FitError> {
        source.check()?;
        let (found, expected) = (source.nodes.len(), self.group.pattern.node_count());
        if found != expected {
            return Err(FitError::Length { what: "nodes", found, expected });
        }
        let (found, expected) = (source.positions.len(), self.group.boundary.len());
        if found != expected {
            return Err(FitError::Length { what: "positions", found, expected });
        }
        Ok(())
    }

    /// Goes on from `transforms`, which nearly fit.
    pub(crate) fn continue_frame(
        &mut self,
        source: &FitSource,
        target: &FitTarget,
        options: &FitOptions,
        mut transforms: Vec<NodeTransform>,
    ) -> Result<Vec<NodeTransform>, FitError> {
        self.check(source)?;
        let combinations = combinations(source, options.combination);
        let frame = Frame { source, target, options, combinations: &combinations };
        self.hints.reset(source.positions.len(), target.sample.vertices.len());
        self.deformed.update(source, &transforms);
        self.descend(frame, Schedule::continuing(options.regularisation), &mut transforms)?;
        Ok(transforms)
    }

    /// From the best start to rest. A fit that ends farther from the target than it began is given
    /// up for its start.
    fn track(&mut self, frame: Frame) -> Result<(Vec<NodeTransform>, FitReport), FitError> {
        let Frame { source, target, options, .. } = frame;
        self.hints.reset(source.positions.len(), target.sample.vertices.len());
        let start = self.start(frame);
        self.deformed.update(source, &start);
        let before = coarse::correspond(&self.group, &self.deformed, target, 0.0).gap();
        let mut transforms = start.clone();
        let schedule = Schedule::new(options.regularisation, options.max_steps);
        let mut report = self.descend(frame, schedule, &mut transforms)?;
        let after = coarse::correspond(&self.group, &self.deformed, target, 0.0).gap();
        if after > before {
            // Samples lie too far apart to judge a small motion: the surfaces decide.
            let fitted = self.on_surfaces(frame, false, None)?.gap();
            self.deformed.update(source, &start);
            if self.on_surfaces(frame, false, None)?.gap() < fitted {
                report.converged = false;
                return Ok((start, report));
            }
            self.deformed.update(source, &transforms);
        }
        Ok((transforms, report))
    }

    /// The loop of matching and minimising; `self.deformed` must be up to date.
    fn descend(
        &mut self,
        frame: Frame,
        mut schedule: Schedule,
        transforms: &mut [NodeTransform],
    ) -> Result<FitReport, FitError> {
        let Frame { source, options, .. } = frame;
        let edge = mean_edge(source.positions, source.faces);
        let mut report = FitReport::default();
        let (mut factored_at, mut kept) = (f64::INFINITY, None);
        loop {
            let (stage, keeps) = (schedule.stage, kept.is_some());
            let matches = match stage {
                Stage::Coarse => {
                    let weight = schedule.reach_weight();
                    coarse::correspond(&self.group, &self.deformed, frame.target, weight)
                }
                Stage::Sampled => self.on_surfaces(frame, false, kept.take())?,
                Stage::Full => self.on_surfaces(frame, true, kept.take())?,
            };
            self.assemble(frame, &matches, stage, schedule.regularisation);
            let refactor =
                schedule.steps < FIRST_FACTORS || schedule.regularisation < REFACTOR * factored_at;
            if refactor {
                factored_at = schedule.regularisation;
            }
            // L_orth relaxes together with L_reg.
            let stiffness = schedule.regularisation / options.regularisation.max(f64::MIN_POSITIVE);
            let effort = Effort { stiffness, refactor, iterations: ITERATIONS };
            report.evaluations += self.minimise(frame, effort, transforms);
            self.deformed.update(source, transforms);
            if !schedule.advance(matches.residual(), self.deformed.moved() / edge) {
                break;
            }
            // Matches from the target serve two steps, since they cost a tree over the source.
            if stage != Stage::Coarse && !keeps {
                kept = Some(matches.backward);
            }
        }
        report.steps = schedule.steps;
        report.converged = schedule.converged;
        Ok(report)
    }

    /// Of no motion and the previous frame's motion the one with the lower residual; the parts'
    /// rigid alignments where they clearly do better, since it is fast limbs that need them and
    /// borders between parts lie elsewhere in every frame.
    fn start(&mut self, frame: Frame) -> Vec<NodeTransform> {
        let Frame { source, target, options, combinations } = frame;
        let still = vec![NodeTransform::IDENTITY; source.nodes.len()];
        let again = self.previous.as_ref().map(|motion| restrict(motion, combinations));
        let aligned = match options.part_start {
            PartStart::Off => None,
            PartStart::On | PartStart::Auto => {
                parts::align(&self.group, source, target, combinations)
            }
        };
        let (again, aligned) = match (again, aligned) {
            (None, None) => return still,
            (_, Some(aligned)) if options.part_start == PartStart::On => return aligned,
            others => others,
        };
        let mut best = (self.residual(frame, &still), still);
        for (candidate, share) in [(again, 1.0), (aligned, CLEARLY)] {
            let Some(candidate) = candidate else { continue };
            let residual = self.residual(frame, &candidate);
            if residual < share * best.0 {
                best = (residual, candidate);
            }
        }
        best.1
    }

    /// Measures the distance of coarse samples from the target under these transforms.
    fn residual(&mut self, frame: Frame, transforms: &[NodeTransform]) -> f64 {
        self.deformed.update(frame.source, transforms);
        coarse::correspond(&self.group, &self.deformed, frame.target, REACH_WEIGHT).residual()
    }

    /// Matches of every vertex of the source, or of its samples.
    fn on_surfaces(
        &mut self,
        frame: Frame,
        every: bool,
        kept: Option<Matches>,
    ) -> Result<Correspondences, FitError> {
        let sample = if every { &self.group.all } else { &self.group.sample };
        let meshes = (frame.source, frame.target);
        let (deformed, hints) = (&self.deformed, &mut self.hints);
        Correspondences::on_surfaces(&self.group, sample, meshes, deformed, hints, kept)
            .map_err(|source| FitError::Tree { mesh: Side::Source, source })
    }

    /// L_data + α_reg L_reg with these matches.
    fn assemble(
        &mut self,
        frame: Frame,
        matches: &Correspondences,
        stage: Stage,
        regularisation: f64,
    ) {
        let own = if stage == Stage::Full { &self.group.all } else { &self.group.sample };
        let least = LEAST_WIDTH * self.group.spacing;
        let tangential = frame.options.tangential;
        self.observations.clear();
        for (matches, sample) in
            [(&matches.forward, own), (&matches.backward, &frame.target.sample)]
        {
            let width = (WIDTH * quantile(matches, 0.95)).max(least);
            let (shares, observations) = (&sample.weights, &mut self.observations);
            push_matches(frame.source, matches, shares, width, tangential, observations);
        }
        self.group.push_smoothness(frame.source.nodes, regularisation, &mut self.observations);
        self.form.assemble(&self.group.pattern, &self.observations);
    }

    /// Lowers the assembled energy.
    fn minimise(
        &mut self,
        frame: Frame,
        effort: Effort,
        transforms: &mut [NodeTransform],
    ) -> usize {
        // L_orth has no unit, the other terms are squared lengths: per node, in its spacing.
        let unit = self.group.spacing * self.group.spacing / transforms.len() as f64;
        let energy = Energy {
            pattern: &self.group.pattern,
            form: &self.form,
            combinations: frame.combinations,
            orthogonality: effort.stiffness * frame.options.orthogonality * unit,
        };
        let elimination = &self.group.elimination;
        if effort.refactor {
            energy.precondition(elimination, transforms, &mut self.factor);
        }
        minimise(energy, elimination, &self.factor, effort.iterations, transforms)
    }

    /// Residuals to the surfaces, and what is missing where the options ask for that.
    fn measure(&mut self, frame: Frame, report: &mut FitReport) -> Result<(), FitError> {
        let matches = self.on_surfaces(frame, true, None)?;
        report.measure(&self.group, frame.target, &matches);
        let (group, deformed, target) = (&self.group, &self.deformed, frame.target);
        let outcome = Outcome { group, deformed, target, matches: &matches };
        report.measures = frame.options.measures.map(|options| outcome.measure(&options));
        Ok(())
    }
}

/// The combination of each node.
fn combinations(source: &FitSource, affine: Combination) -> Vec<Combination> {
    source.affine.iter().map(|&a| if a { affine } else { Combination::RT }).collect()
}

/// Transforms with what the combinations do not have at its neutral value.
fn restrict(transforms: &[NodeTransform], combinations: &[Combination]) -> Vec<NodeTransform> {
    let restrict = |(transform, combination): (&NodeTransform, &Combination)| NodeTransform {
        rotation: if combination.rotation { transform.rotation } else { [0.0; 3] },
        scale: if combination.scale { transform.scale } else { [1.0; 3] },
        shear: if combination.shear { transform.shear } else { [0.0; 3] },
        translation: transform.translation,
    };
    transforms.iter().zip(combinations).map(restrict).collect()
}
