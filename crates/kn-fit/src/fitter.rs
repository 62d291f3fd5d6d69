//! The fit of a frame.

use crate::affine::{Affine, affine};
use crate::cholesky::BlockCholesky;
use crate::energy::{Energy, minimise};
use crate::error::FitError;
use crate::group::{Group, mean_edge};
use crate::matching::{Deformed, correspond, deform, push_matches, quantile};
use crate::options::FitOptions;
use crate::quadratic::{Observations, QuadraticForm};
use crate::report::{Fit, FitReport};
use crate::source::FitSource;
use crate::target::FitTarget;
use crate::vec3::distance;
use kn_deform::{Combination, NodeTransform};

/// Fits the frames of one group of frames, one after the other; holds what stays the same through
/// the group, the buffers, and the previous frame's motion.
#[derive(Debug)]
pub struct Fitter {
    group: Group,
    form: QuadraticForm,
    factor: BlockCholesky,
    observations: Observations,
    deformed: Deformed,
    matrices: Vec<Affine>,
    previous: Option<Vec<NodeTransform>>,
}

impl Fitter {
    /// Prepares a group of frames from its I-frame.
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
            matrices: Vec::new(),
            previous: None,
        })
    }

    /// The transforms that carry `source` onto `target`. `source` is the group's mesh with the
    /// positions and nodes of the reference frame.
    ///
    /// # Errors
    /// Arrays that do not fit together, see [`FitError`].
    pub fn fit_frame(
        &mut self,
        source: &FitSource,
        target: &FitTarget,
        options: &FitOptions,
    ) -> Result<Fit, FitError> {
        source.check()?;
        let combinations: Vec<Combination> = source
            .affine
            .iter()
            .map(|&affine| if affine { options.combination } else { Combination::RT })
            .collect();
        let mut transforms =
            self.previous.clone().unwrap_or(vec![NodeTransform::IDENTITY; source.nodes.len()]);
        let mut report = FitReport::default();
        let edge = mean_edge(source.positions, source.faces);
        let trace = std::env::var("KN_TRACE").is_ok();
        let env = |name: &str, default: f64| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
        let mut alpha = env("A0", 3.0);
        let alpha_end = env("A1", options.regularisation);
        let relax = env("RELAX", 0.4);
        let tangential = env("TAU", options.tangential);
        let cosine = env("COS", 0.5);
        let back = env("BACK", 1.0);
        let iters = env("ITERS", 8.0) as u64;
        let mut full = 0;
        self.update(source, &transforms);
        let mut last = f64::INFINITY;
        loop {
            let t0 = std::time::Instant::now();
            let pairs = correspond(&self.group, source, &self.deformed, target, full > 0, cosine);
            let t1 = std::time::Instant::now();
            let sample = if full > 0 { &self.group.all } else { &self.group.sample };
            let floor = 0.05 * edge;
            let (wf, wb) = (
                (2.0 * quantile(&pairs.forward, 0.95)).max(floor),
                (2.0 * quantile(&pairs.backward, 0.95)).max(floor),
            );
            self.observations.clear();
            push_matches(source, sample, &pairs.forward, wf, tangential, &mut self.observations);
            push_matches(source, &target.sample, &pairs.backward, wb, tangential, &mut self.observations);
            let _ = back;
            self.group.push_smoothness(source.nodes, alpha, &mut self.observations);
            let t2 = std::time::Instant::now();
            self.form.assemble(&self.group.pattern, &self.observations);
            let t3 = std::time::Instant::now();
            let energy = Energy {
                pattern: &self.group.pattern,
                form: &self.form,
                combinations: &combinations,
                orthogonality: options.orthogonality * self.group.spacing * self.group.spacing / source.nodes.len() as f64,
            };
            energy.precondition(&self.group.elimination, &transforms, &mut self.factor);
            let t4 = std::time::Instant::now();
            let descent = minimise(energy, &self.group.elimination, &self.factor, iters, &mut transforms);
            let t5 = std::time::Instant::now();
            let before = std::mem::take(&mut self.deformed.positions);
            self.update(source, &transforms);
            let moved: f64 = (before.iter().zip(&self.deformed.positions).map(|(a, b)| distance(*a, *b).powi(2)).sum::<f64>() / before.len() as f64).sqrt();
            report.steps += 1;
            report.evaluations += descent.evaluations;
            let rms = |m: &crate::matching::Matches| (m.iter().flatten().map(|m| m.distance * m.distance).sum::<f64>() / m.len() as f64).sqrt();
            if trace {
                let un = |m: &crate::matching::Matches| m.iter().filter(|m| m.is_none()).count() as f64 / m.len() as f64;
                eprintln!("{:2} a={alpha:.4} full={full} fwd {:.4} un {:.3} bwd {:.4} un {:.3} E {:.5}->{:.5} ev {} moved/edge {:.4} | corr {:.1} push {:.1} asm {:.1} fac {:.1} lbfgs {:.1} deform {:.1} ms", report.steps, rms(&pairs.forward)/edge, un(&pairs.forward), rms(&pairs.backward)/edge, un(&pairs.backward), descent.before, descent.after, descent.evaluations, moved/edge,
                    (t1-t0).as_secs_f64()*1e3,(t2-t1).as_secs_f64()*1e3,(t3-t2).as_secs_f64()*1e3,(t4-t3).as_secs_f64()*1e3,(t5-t4).as_secs_f64()*1e3,t5.elapsed().as_secs_f64()*1e3);
            }
            let now = rms(&pairs.forward) + rms(&pairs.backward);
            if full > 0 {
                full += 1;
                if full > 2 { break; }
            } else if alpha <= alpha_end && (moved < 0.05 * edge || report.steps >= options.max_steps) {
                full = 1;
            } else if now > env("STALL", 0.8) * last || moved < 0.05 * edge {
                alpha = (alpha * relax).max(alpha_end);
            }
            if report.steps >= options.max_steps && full == 0 { full = 1; }
            last = now;
        }
        self.previous = Some(transforms.clone());
        Ok(Fit { transforms, report })
    }

    /// `#V × 3`: the source as the last fit deformed it.
    pub fn deformed(&self) -> &[[f64; 3]] {
        &self.deformed.positions
    }

    fn update(&mut self, source: &FitSource, transforms: &[NodeTransform]) {
        self.matrices.clear();
        self.matrices.extend(transforms.iter().map(affine));
        deform(source, &self.matrices, &mut self.deformed);
    }
}
