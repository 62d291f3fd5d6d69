//! The Lagrangian cost J = D + λR of a coded P-frame.

use crate::encode::report::CostReport;

impl CostReport {
    /// J of a frame with this D and R.
    pub(crate) fn new(distortion: f64, bytes: u64, lambda: f64) -> Self {
        Self { distortion, bytes, total: distortion + lambda * bytes as f64 }
    }

    /// J of the same frame with another λ.
    pub(crate) fn with_lambda(self, lambda: f64) -> Self {
        Self::new(self.distortion, self.bytes, lambda)
    }
}

impl std::ops::Add for CostReport {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            distortion: self.distortion + other.distortion,
            bytes: self.bytes + other.bytes,
            total: self.total + other.total,
        }
    }
}

/// The candidate of least J, the first of equals.
pub(crate) fn cheapest<T>(
    candidates: impl IntoIterator<Item = T>,
    cost: impl Fn(&T) -> CostReport,
) -> Option<T> {
    candidates.into_iter().min_by(|a, b| cost(a).total.total_cmp(&cost(b).total))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_choice_has_the_least_j(
            frames in prop::collection::vec((0.0..1.0_f64, 0..2000_u64), 1..9),
            lambda in 0.0..1e-3_f64,
        ) {
            let costs = frames.iter().map(|&(d, r)| CostReport::new(d, r, lambda));
            let best = cheapest(costs.clone(), |cost| *cost).expect("there are some");
            for cost in costs {
                prop_assert!(best.total <= cost.total);
            }
        }
    }

    #[test]
    fn bytes_count_as_much_as_lambda_says() {
        let [poor, good] = [(0.34, 400), (0.33, 700)];
        let best = |lambda| {
            let costs = [poor, good].map(|(d, r)| CostReport::new(d, r, lambda));
            cheapest(costs, |cost| *cost).map(|cost| cost.bytes)
        };
        assert_eq!((best(1e-5), best(1e-4)), (Some(700), Some(400)));
    }
}
