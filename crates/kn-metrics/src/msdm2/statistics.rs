//! Curvature statistics of two surfaces over a neighbourhood, and the distance they give.

use super::machine::{Machine, QUAD, Quad};

/// Four samples. Curvatures are relative to those at the centre: a = C − C(v), b = Ĉ − Ĉ(v). That
/// keeps the digits of a variance which is small beside the mean.
#[derive(Clone, Copy)]
pub(super) struct Samples<M: Machine> {
    /// Gaussian weights, by the distance on the distorted mesh and on the original.
    pub(super) weights: [Quad<M>; 2],
    pub(super) a: Quad<M>,
    pub(super) b: Quad<M>,
}

/// Weighted sums over samples.
pub(super) struct Moments<M: Machine> {
    w1: Quad<M>,
    w1_a: Quad<M>,
    w1_aa: Quad<M>,
    w2: Quad<M>,
    w2_a: Quad<M>,
    w2_b: Quad<M>,
    w2_bb: Quad<M>,
    w2_ab: Quad<M>,
}

impl<M: Machine> Samples<M> {
    /// Sets the weights behind the first `lanes` to zero.
    #[inline(always)]
    pub(super) fn keep(&mut self, machine: M, lanes: usize) {
        let mut kept = [0.0; QUAD];
        kept[..lanes].fill(1.0);
        let kept = Quad::new(machine, &kept);
        let [w1, w2] = self.weights;
        self.weights = [w1 * kept, w2 * kept];
    }
}

impl<M: Machine> Moments<M> {
    #[inline(always)]
    pub(super) fn new(machine: M) -> Self {
        let zero = Quad::splat(machine, 0.0);
        Self {
            w1: zero,
            w1_a: zero,
            w1_aa: zero,
            w2: zero,
            w2_a: zero,
            w2_b: zero,
            w2_bb: zero,
            w2_ab: zero,
        }
    }

    #[inline(always)]
    pub(super) fn add(&mut self, samples: &Samples<M>) {
        let Samples { weights: [w1, w2], a, b } = *samples;
        let (w1_a, w2_b) = (w1 * a, w2 * b);
        self.w1 += w1;
        self.w1_a += w1_a;
        self.w1_aa += w1_a * a;
        self.w2 += w2;
        self.w2_a += w2 * a;
        self.w2_b += w2_b;
        self.w2_bb += w2_b * b;
        self.w2_ab += w2_b * a;
    }

    /// Lavoué 2011, equations (3) to (6), given the curvatures C(v) and Ĉ(v) at the centre.
    #[inline(always)]
    pub(super) fn distance(&self, own: f64, other: f64) -> f64 {
        let (w1, w2) = (sum(self.w1), sum(self.w2));
        let (mean_a, mean_b) = (sum(self.w1_a) / w1, sum(self.w2_b) / w2);
        let s1 = (sum(self.w1_aa) / w1 - mean_a * mean_a).max(0.0).sqrt();
        let s2 = (sum(self.w2_bb) / w2 - mean_b * mean_b).max(0.0).sqrt();
        // Weighted by w2 and divided by the sum of w1: mixed, as in the reference.
        let covariance = (sum(self.w2_ab) - mean_b * sum(self.w2_a)) / w1;
        let (mu1, mu2) = (own + mean_a, other + mean_b);
        let luminance = (mu1 - mu2).abs() / (mu1.max(mu2) + 1.0);
        let contrast = (s1 - s2).abs() / (s1.max(s2) + 1.0);
        let structure = (s1 * s2 - covariance).abs() / (s1 * s2 + 1.0);
        (luminance + contrast + 0.5 * structure) / 2.5
    }
}

#[inline(always)]
fn sum<M: Machine>(quad: Quad<M>) -> f64 {
    let [a, b, c, d] = quad.array();
    (a + b) + (c + d)
}
