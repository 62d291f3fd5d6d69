//! Weights of a vertex's key nodes, from their squared distances.

use crate::elementary::exp_neg;
use kn_bitstream::params::{WeightScheme, Weights};

/// The nodes of one vertex, nearest first, and what lies beyond them.
pub(crate) struct Distances<'a> {
    /// Squared distances in grid steps, exact, not yet floored; replicas included.
    pub(crate) squared: &'a [f64],
    /// Squared distance of the nearest candidate that is not used, where there is one.
    pub(crate) next_squared: Option<f64>,
}

/// Writes the normalised weights of one vertex (length Q, sum 1 up to rounding).
pub(crate) fn normalised_weights(how: Weights, distances: &Distances<'_>, weights: &mut [f64]) {
    match (how.scheme(), how.sigma()) {
        (WeightScheme::InverseSquare, _) => inverse_square(distances, weights),
        (WeightScheme::Sumner, _) => sumner(distances, weights),
        (WeightScheme::Gaussian, sigma) => gaussian(sigma.unwrap_or(1), distances, weights),
    }
    let mut sum = 0.0;
    for weight in weights.iter() {
        sum += *weight;
    }
    if sum > 0.0 {
        weights.iter_mut().for_each(|weight| *weight /= sum);
    } else {
        // All nodes at the radius where Sumner's weight vanishes: none is nearer, so all are equal.
        weights.fill(1.0 / weights.len() as f64);
    }
}

/// Distances are floored at one grid step: a node on its vertex would weigh infinitely much.
fn floored(squared: f64) -> f64 {
    squared.max(1.0)
}

fn inverse_square(distances: &Distances<'_>, weights: &mut [f64]) {
    for (weight, &squared) in weights.iter_mut().zip(distances.squared) {
        *weight = 1.0 / floored(squared);
    }
}

fn sumner(distances: &Distances<'_>, weights: &mut [f64]) {
    let farthest = distances.squared[distances.squared.len() - 1];
    let radius = match distances.next_squared {
        Some(next) => floored(next).sqrt(),
        // The paper leaves open what d_{Q+1} is where nodes are short: twice the farthest used.
        None => 2.0 * floored(farthest).sqrt(),
    };
    for (weight, &squared) in weights.iter_mut().zip(distances.squared) {
        let linear = 1.0 - floored(squared).sqrt() / radius;
        *weight = linear * linear;
    }
}

fn gaussian(sigma: u32, distances: &Distances<'_>, weights: &mut [f64]) {
    let sigma = f64::from(sigma);
    let denominator = 2.0 * (sigma * sigma);
    let nearest = floored(distances.squared[0]);
    for (weight, &squared) in weights.iter_mut().zip(distances.squared) {
        // Relative to the nearest node, whose weight is then 1: far vertices never underflow.
        *weight = exp_neg((floored(squared) - nearest) / denominator);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weigh(how: Weights, squared: &[f64], next_squared: Option<f64>) -> Vec<f64> {
        let mut weights = vec![0.0; squared.len()];
        normalised_weights(how, &Distances { squared, next_squared }, &mut weights);
        weights
    }

    #[test]
    fn inverse_squares_are_normalised_and_floored() {
        assert_eq!(weigh(Weights::INVERSE_SQUARE, &[0.0, 1.0], None), [0.5, 0.5]);
        assert_eq!(weigh(Weights::INVERSE_SQUARE, &[1.0, 3.0], None), [0.75, 0.25]);
    }

    #[test]
    fn sumner_vanishes_at_the_next_node() {
        let weights = weigh(Weights::SUMNER, &[4.0, 16.0], Some(16.0));
        assert_eq!(weights, [1.0, 0.0]);
        assert_eq!(weigh(Weights::SUMNER, &[16.0, 16.0], Some(16.0)), [0.5, 0.5]);
        assert_eq!(weigh(Weights::SUMNER, &[16.0, 16.0], None), [0.5, 0.5]);
    }

    #[test]
    fn gaussian_weights_never_underflow_together() {
        let weights = weigh(Weights::gaussian(1), &[1e12, 1e12 + 2.0], None);
        let ratio = weights[1] / weights[0];
        assert!((ratio - 1.0 / std::f64::consts::E).abs() < 1e-12);
    }
}
