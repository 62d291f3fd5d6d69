//! The energy of one correspondence step as a function of the node parameters, and its minimiser.

use crate::affine::{self, Affine, MAX_PARAMETERS, ZERO};
use crate::cholesky::{BlockCholesky, Elimination};
use crate::constants::minimisation::{
    DAMPING, EVALUATIONS_PER_ITERATION, LEAST_SCALE, MEMORY, TOLERANCE,
};
use crate::orthogonality;
use crate::pattern::BlockPattern;
use crate::quadratic::QuadraticForm;
use argmin::core::{ArgminError, CostFunction, Executor, Gradient, State};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use kn_bitstream::params::Combination;
use kn_deform::NodeTransform;
use nalgebra::DVector;
use std::cell::RefCell;

/// L_data + α_reg L_reg as a quadratic form, and α_orth L_orth.
#[derive(Clone, Copy)]
pub(crate) struct Energy<'a> {
    pub(crate) pattern: &'a BlockPattern,
    pub(crate) form: &'a QuadraticForm,
    /// `#N`: what each node may do.
    pub(crate) combinations: &'a [Combination],
    /// Weight of L_orth on nodes that scale or shear.
    pub(crate) orthogonality: f64,
}

/// Buffers of an evaluation.
#[derive(Debug, Default)]
struct Scratch {
    parameters: Vec<f64>,
    matrices: Vec<Affine>,
    gradient: Vec<Affine>,
}

impl Energy<'_> {
    fn is_loose(combination: Combination) -> bool {
        combination.scale || combination.shear
    }

    /// Value at `parameters` (in the factor's order) and, by the chain rule, the gradient.
    fn value_and_gradient(
        &self,
        parameters: &[f64],
        first: impl Fn(usize) -> usize,
        matrices: &mut Vec<Affine>,
        slopes: &mut Vec<Affine>,
        gradient: &mut [f64],
    ) -> f64 {
        let transform = |node: usize| {
            affine::read_parameters(&parameters[first(node)..], self.combinations[node])
        };
        matrices.clear();
        matrices.extend((0..self.combinations.len()).map(|node| affine::affine(&transform(node))));
        slopes.resize(matrices.len(), ZERO);
        let mut value = self.form.value_and_gradient(self.pattern, matrices, slopes);
        for (node, &combination) in self.combinations.iter().enumerate() {
            if Self::is_loose(combination) {
                let (m, slope) = (&matrices[node], &mut slopes[node]);
                value += orthogonality::value_and_gradient(m, self.orthogonality, slope);
            }
            let (columns, count) = affine::derivatives(&transform(node), combination);
            for p in 0..count {
                gradient[first(node) + p] = affine::dot(&columns[p], &slopes[node]);
            }
        }
        value
    }

    /// The Gauss–Newton matrix of the energy at `transforms`, factored.
    pub(crate) fn precondition(
        &self,
        elimination: &Elimination,
        transforms: &[NodeTransform],
        factor: &mut BlockCholesky,
    ) {
        factor.reset(elimination, |node| affine::parameter_count(self.combinations[node]));
        let derivatives: Vec<([Affine; MAX_PARAMETERS], usize)> = transforms
            .iter()
            .zip(self.combinations)
            .map(|(transform, &combination)| affine::derivatives(transform, combination))
            .collect();
        for node in 0..transforms.len() {
            let (own, count) = &derivatives[node];
            let range = self.pattern.range(node);
            for (block, &column) in range.zip(self.pattern.columns(node)) {
                let column = usize::from(column);
                let (others, width) = &derivatives[column];
                let mut entries = [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS];
                for j in 0..*width {
                    let product = self.form.block_product(block, &others[j]);
                    for i in 0..*count {
                        entries[i][j] = affine::dot(&own[i], &product);
                    }
                }
                if column == node {
                    self.add_orthogonality(node, &transforms[node], own, *count, &mut entries);
                    (0..*count).for_each(|i| entries[i][i] *= 1.0 + DAMPING);
                }
                // The form's Hessian is 2H.
                factor.set(elimination, [node, column], |i, j| 2.0 * entries[i][j]);
            }
        }
        factor.factor(elimination);
    }

    fn add_orthogonality(
        &self,
        node: usize,
        transform: &NodeTransform,
        columns: &[Affine],
        count: usize,
        entries: &mut [[f64; MAX_PARAMETERS]; MAX_PARAMETERS],
    ) {
        if !Self::is_loose(self.combinations[node]) {
            return;
        }
        let m = affine::affine(transform);
        let mut slopes = [[0.0; 6]; MAX_PARAMETERS];
        for (slopes, column) in slopes.iter_mut().zip(&columns[..count]) {
            *slopes = orthogonality::residual_slopes(&m, column);
        }
        for i in 0..count {
            for j in 0..count {
                let product: f64 = (0..6).map(|k| slopes[i][k] * slopes[j][k]).sum();
                entries[i][j] += self.orthogonality * product;
            }
        }
    }
}

/// The energy in the variables q of p = p₀ + L⁻ᵀ q, where its Hessian is near the identity.
struct Preconditioned<'a> {
    energy: Energy<'a>,
    elimination: &'a Elimination,
    factor: &'a BlockCholesky,
    /// p₀, in the factor's order.
    origin: &'a [f64],
    most_evaluations: usize,
    state: RefCell<Evaluated>,
}

/// argmin asks for value and gradient one after the other: the last evaluation is kept.
#[derive(Default)]
struct Evaluated {
    at: Option<DVector<f64>>,
    value: f64,
    gradient: DVector<f64>,
    scratch: Scratch,
    count: usize,
}

impl Preconditioned<'_> {
    fn evaluate<T>(&self, q: &DVector<f64>, read: impl Fn(&Evaluated) -> T) -> T {
        let mut state = self.state.borrow_mut();
        if state.at.as_ref() != Some(q) {
            let state = &mut *state;
            let Scratch { parameters, matrices, gradient } = &mut state.scratch;
            self.parameters(q, parameters);
            let slope = state.gradient.as_mut_slice();
            let first = |node| self.factor.variable(self.elimination, node);
            state.value =
                self.energy.value_and_gradient(parameters, first, matrices, gradient, slope);
            self.factor.solve_lower(self.elimination, slope);
            match &mut state.at {
                Some(at) => at.copy_from(q),
                None => state.at = Some(q.clone()),
            }
            state.count += 1;
        }
        read(&state)
    }

    fn parameters(&self, q: &DVector<f64>, parameters: &mut Vec<f64>) {
        parameters.clear();
        parameters.extend_from_slice(q.as_slice());
        self.factor.solve_upper(self.elimination, parameters);
        parameters.iter_mut().zip(self.origin).for_each(|(p, origin)| *p += origin);
    }
}

impl CostFunction for &Preconditioned<'_> {
    type Param = DVector<f64>;
    type Output = f64;

    fn cost(&self, q: &Self::Param) -> Result<f64, argmin::core::Error> {
        let (value, count) = self.evaluate(q, |state| (state.value, state.count));
        // argmin's line search has no bound of its own and may turn in circles where rounding
        // decides or a value is not a number; an error ends it and keeps the best point.
        if value.is_finite() && count <= self.most_evaluations {
            Ok(value)
        } else {
            let text = String::from("the line search got lost");
            Err(ArgminError::ConditionViolated { text }.into())
        }
    }
}

impl Gradient for &Preconditioned<'_> {
    type Param = DVector<f64>;
    type Gradient = DVector<f64>;

    fn gradient(&self, q: &Self::Param) -> Result<Self::Gradient, argmin::core::Error> {
        Ok(self.evaluate(q, |state| state.gradient.clone()))
    }
}

/// Lowers the energy from `transforms`, in place, by at most `iterations` of L-BFGS. `factor` must
/// come from [`Energy::precondition`] with the same combinations, at this or a nearby state.
/// A step that does not lower the energy leaves `transforms` as they are. Returns the number of
/// evaluations.
pub(crate) fn minimise(
    energy: Energy<'_>,
    elimination: &Elimination,
    factor: &BlockCholesky,
    iterations: u64,
    transforms: &mut [NodeTransform],
) -> usize {
    let mut origin = vec![0.0; factor.len()];
    for (node, transform) in transforms.iter().enumerate() {
        let first = factor.variable(elimination, node);
        affine::write_parameters(transform, energy.combinations[node], &mut origin[first..]);
    }
    let state =
        RefCell::new(Evaluated { gradient: DVector::zeros(factor.len()), ..Evaluated::default() });
    let most_evaluations = EVALUATIONS_PER_ITERATION * iterations as usize;
    let origin = &origin[..];
    let problem = Preconditioned { energy, elimination, factor, origin, most_evaluations, state };
    let zero = DVector::zeros(factor.len());
    let before = problem.evaluate(&zero, |state| state.value);
    let best = run(&problem, zero, before, iterations);
    if let Some((q, value)) = best
        && value < before
    {
        let mut parameters = Vec::new();
        problem.parameters(&q, &mut parameters);
        for (node, transform) in transforms.iter_mut().enumerate() {
            let first = factor.variable(elimination, node);
            *transform = affine::read_parameters(&parameters[first..], energy.combinations[node]);
            // A reflection never occurs.
            transform.scale = transform.scale.map(|factor| factor.max(LEAST_SCALE));
        }
    }
    problem.state.borrow().count
}

/// The best point that L-BFGS found. Its own termination status says nothing that the value does
/// not: a failed line search ends a run as quietly as convergence.
fn run(
    problem: &Preconditioned<'_>,
    start: DVector<f64>,
    value: f64,
    iterations: u64,
) -> Option<(DVector<f64>, f64)> {
    let solver = LBFGS::new(MoreThuenteLineSearch::new(), MEMORY)
        // In these variables half the squared gradient is what is left to gain.
        .with_tolerance_grad((TOLERANCE * value.max(0.0)).sqrt())
        .and_then(|solver| solver.with_tolerance_cost(TOLERANCE * value.abs()))
        .ok()?;
    let result = Executor::new(problem, solver)
        .configure(|state| state.param(start).max_iters(iterations))
        .ctrlc(false)
        .run()
        .ok()?;
    let value = result.state().get_best_cost();
    let best = result.state().get_best_param()?;
    (value.is_finite() && best.iter().all(|c| c.is_finite())).then(|| (best.clone(), value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::PairSet;
    use crate::quadratic::Observations;

    const COMBINATIONS: [Combination; 3] =
        [Combination::RT, Combination::RTSH, Combination::new(false, true, false)];

    fn truth() -> Vec<NodeTransform> {
        vec![
            NodeTransform {
                rotation: [0.2, -0.4, 0.3],
                translation: [1.0, 2.0, -1.0],
                ..NodeTransform::IDENTITY
            },
            NodeTransform {
                rotation: [-0.3, 0.1, 0.5],
                scale: [1.1, 0.9, 1.05],
                shear: [0.1, -0.05, 0.08],
                translation: [0.5, 0.0, 2.0],
            },
            NodeTransform { scale: [1.2, 1.0, 0.9], ..NodeTransform::IDENTITY },
        ]
    }

    /// Observations that the true transforms satisfy exactly, each shared by two nodes.
    fn problem() -> (BlockPattern, QuadraticForm) {
        let mut pairs = PairSet::new(3);
        let mut observations = Observations::default();
        let matrices: Vec<Affine> = truth().iter().map(affine::affine).collect();
        for i in 0..120_usize {
            let (a, b) = ([0, 1, 2][i % 3], [1, 2, 0][i % 3]);
            pairs.add_clique(&[a, b]);
            let w = 0.2 + 0.6 * (i % 7) as f64 / 7.0;
            let x = [(i % 5) as f64 - 2.0, (i % 11) as f64 - 5.0, (i % 13) as f64 - 6.0];
            let lever = |w: f64| [w * x[0], w * x[1], w * x[2], w];
            let terms = [(a, lever(w)), (b, lever(1.0 - w))];
            let offset = std::array::from_fn(|row| {
                let product = |&(node, y): &(u16, [f64; 4])| -> f64 {
                    (0..4).map(|k| matrices[usize::from(node)][row][k] * y[k]).sum()
                };
                terms.iter().map(product).sum()
            });
            observations.push(&terms, [1.0, 0.5, 0.8, 0.1, 0.0, 0.2], offset);
        }
        let pattern = BlockPattern::new(&pairs, 3);
        let mut form = QuadraticForm::new(&pattern);
        form.assemble(&pattern, &observations);
        (pattern, form)
    }

    #[test]
    fn gradient_matches_finite_differences() {
        let (pattern, form) = problem();
        let energy = Energy {
            pattern: &pattern,
            form: &form,
            combinations: &COMBINATIONS,
            orthogonality: 3.0,
        };
        let first = |node: usize| [0, 6, 18][node];
        let parameters: Vec<f64> = (0..24).map(|i| 0.9 + 0.05 * f64::from(i % 7)).collect();
        let value = |parameters: &[f64], gradient: &mut [f64]| {
            let (mut m, mut s) = (Vec::new(), Vec::new());
            energy.value_and_gradient(parameters, first, &mut m, &mut s, gradient)
        };
        let mut gradient = vec![0.0; 24];
        value(&parameters, &mut gradient);
        for p in 0..24 {
            let at = |delta: f64| {
                let mut moved = parameters.clone();
                moved[p] += delta;
                value(&moved, &mut [0.0; 24])
            };
            let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
            assert!((slope - gradient[p]).abs() < 1e-6 * (1.0 + slope.abs()), "parameter {p}");
        }
    }

    #[test]
    fn the_minimiser_finds_the_transforms() {
        let (pattern, form) = problem();
        let energy = Energy {
            pattern: &pattern,
            form: &form,
            combinations: &COMBINATIONS,
            orthogonality: 0.0,
        };
        let elimination = Elimination::new(&pattern);
        let mut factor = BlockCholesky::default();
        let mut transforms = vec![NodeTransform::IDENTITY; 3];
        for _ in 0..6 {
            energy.precondition(&elimination, &transforms, &mut factor);
            minimise(energy, &elimination, &factor, 20, &mut transforms);
        }
        for (found, truth) in transforms.iter().zip(truth()) {
            let (found, truth) = (affine::affine(found), affine::affine(&truth));
            for i in 0..3 {
                for j in 0..4 {
                    assert!((found[i][j] - truth[i][j]).abs() < 1e-3, "{found:?} {truth:?}");
                }
            }
        }
    }
}
