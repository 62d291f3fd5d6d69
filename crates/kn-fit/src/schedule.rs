//! The schedule of a fit: from stiff and coarse steps to relaxed and exact ones.

use crate::constants::matches::{REACH_FADES, REACH_WEIGHT};
use crate::constants::steps::{
    COARSE_LEAST, COARSE_STEPS, CONTINUING_STEPS, FULL_STEPS, RELAXATION, STALL, STIFF, STILL,
};

/// The kind of matches that a step works with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    /// Samples, nearest in position, normal and reach together.
    Coarse,
    /// Samples to the closest points of the other surface.
    Sampled,
    /// Every vertex of the source, samples of the target.
    Full,
}

/// The state of the schedule.
#[derive(Debug)]
pub(crate) struct Schedule {
    pub(crate) stage: Stage,
    /// α_reg of the next step.
    pub(crate) regularisation: f64,
    /// Steps taken.
    pub(crate) steps: usize,
    /// Whether the samples came to rest before the full steps.
    pub(crate) converged: bool,
    final_regularisation: f64,
    max_steps: usize,
    /// Steps with every vertex that are still to come.
    full_left: usize,
    last_residual: f64,
}

impl Schedule {
    pub(crate) fn new(final_regularisation: f64, max_steps: usize) -> Self {
        Self {
            stage: Stage::Coarse,
            regularisation: STIFF.max(final_regularisation),
            steps: 0,
            converged: false,
            final_regularisation,
            max_steps,
            full_left: FULL_STEPS,
            last_residual: f64::INFINITY,
        }
    }

    /// For a motion that is nearly right: few steps on the surfaces, as relaxed as at the end.
    pub(crate) fn continuing(final_regularisation: f64) -> Self {
        Self {
            stage: Stage::Sampled,
            regularisation: final_regularisation,
            full_left: 0,
            ..Self::new(final_regularisation, CONTINUING_STEPS)
        }
    }

    /// The weight of a difference in reach in the next matches.
    pub(crate) fn reach_weight(&self) -> f64 {
        REACH_WEIGHT * REACH_FADES.powi(self.steps as i32)
    }

    /// Takes note of a step: the residual that it started from and how far it moved the surface,
    /// in mean edges. Whether there is another one.
    pub(crate) fn advance(&mut self, residual: f64, moved: f64) -> bool {
        self.steps += 1;
        let relaxed = self.regularisation <= self.final_regularisation;
        match self.stage {
            Stage::Full => self.full_left -= 1,
            _ if relaxed && moved < STILL && self.stage == Stage::Sampled => {
                self.converged = true;
                self.stage = Stage::Full;
            }
            _ if self.steps + self.full_left >= self.max_steps => self.stage = Stage::Full,
            _ => {
                if moved < STILL || residual > STALL * self.last_residual {
                    let relaxed = RELAXATION * self.regularisation;
                    let least = match self.stage {
                        Stage::Coarse => COARSE_LEAST.max(self.final_regularisation),
                        _ => self.final_regularisation,
                    };
                    self.regularisation = relaxed.max(least);
                }
                if self.steps >= COARSE_STEPS {
                    self.stage = Stage::Sampled;
                }
            }
        }
        self.last_residual = residual;
        self.stage != Stage::Full || self.full_left > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_that_rests_ends_with_full_steps() {
        let mut schedule = Schedule::new(0.01, 100);
        let mut stages = vec![schedule.stage];
        while schedule.advance(1.0, 0.0) {
            stages.push(schedule.stage);
        }
        assert_eq!(stages[..COARSE_STEPS], [Stage::Coarse; COARSE_STEPS]);
        assert_eq!(stages[stages.len() - FULL_STEPS..], [Stage::Full; FULL_STEPS]);
        assert!(schedule.converged);
        assert_eq!(schedule.regularisation, 0.01);
    }

    #[test]
    fn a_fit_that_never_rests_ends_too() {
        let mut schedule = Schedule::new(0.01, 12);
        let mut residual = 1.0;
        while schedule.advance(residual, 10.0) {
            residual *= 0.5;
        }
        assert_eq!(schedule.steps, 12);
        assert!(!schedule.converged);
    }
}
