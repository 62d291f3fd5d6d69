//! Curvature statistics of two surfaces over a neighbourhood, and the distance they give.

use super::exp::exp_in_place;

/// Sums run in this many lanes, so that the compiler can vectorise them; the order is fixed.
const LANES: usize = 4;

/// Samples side by side. Curvatures are relative to those at the centre: C − C(v), Ĉ − Ĉ(v).
/// That keeps the digits of a variance which is small beside the mean.
#[derive(Clone, Default)]
pub(super) struct Samples {
    pub(super) own: Vec<f64>,
    pub(super) other: Vec<f64>,
}

/// Gaussian weights of samples, by the distances on both surfaces.
#[derive(Default)]
pub(super) struct Weights {
    own: Vec<f64>,
    other: Vec<f64>,
}

/// Weighted sums over samples a = C − C(v), b = Ĉ − Ĉ(v).
#[derive(Default)]
pub(super) struct Moments {
    w1: [f64; LANES],
    w1_a: [f64; LANES],
    w1_aa: [f64; LANES],
    w2: [f64; LANES],
    w2_a: [f64; LANES],
    w2_b: [f64; LANES],
    w2_bb: [f64; LANES],
    w2_ab: [f64; LANES],
}

impl Samples {
    pub(super) fn clear(&mut self) {
        self.own.clear();
        self.other.clear();
    }

    #[inline]
    pub(super) fn push(&mut self, own: f64, other: f64) {
        self.own.push(own);
        self.other.push(other);
    }
}

impl Weights {
    /// Weights exp(−d² / 2σ²) with σ = h / 2 of squared distances in a sphere of squared radius h².
    pub(super) fn evaluate(&mut self, radius_squared: f64, own: &[f64], other: &[f64]) {
        let exponent = -2.0 / radius_squared;
        for (weights, distances) in [(&mut self.own, own), (&mut self.other, other)] {
            weights.clear();
            weights.extend(distances.iter().map(|distance| distance * exponent));
            exp_in_place(weights);
            // The last group of lanes is filled with samples that weigh nothing.
            weights.resize(distances.len().next_multiple_of(LANES), 0.0);
        }
    }
}

impl Moments {
    /// Adds the first samples, as many as have a weight.
    pub(super) fn add(&mut self, samples: &mut Samples, weights: &Weights) {
        let count = weights.own.len();
        for values in [&mut samples.own, &mut samples.other] {
            if values.len() < count {
                values.resize(count, 0.0);
            }
        }
        let a = samples.own.as_chunks::<LANES>().0;
        let b = samples.other.as_chunks::<LANES>().0;
        let w1 = weights.own.as_chunks::<LANES>().0;
        let w2 = weights.other.as_chunks::<LANES>().0;
        for (((a, b), w1), w2) in a.iter().zip(b).zip(w1).zip(w2) {
            self.add_lanes(a, b, w1, w2);
        }
    }

    #[inline]
    fn add_lanes(
        &mut self,
        a: &[f64; LANES],
        b: &[f64; LANES],
        w1: &[f64; LANES],
        w2: &[f64; LANES],
    ) {
        for lane in 0..LANES {
            let (a, b, w1, w2) = (a[lane], b[lane], w1[lane], w2[lane]);
            let (w1_a, w2_b) = (w1 * a, w2 * b);
            self.w1[lane] += w1;
            self.w1_a[lane] += w1_a;
            self.w1_aa[lane] += w1_a * a;
            self.w2[lane] += w2;
            self.w2_a[lane] += w2 * a;
            self.w2_b[lane] += w2_b;
            self.w2_bb[lane] += w2_b * b;
            self.w2_ab[lane] += w2_b * a;
        }
    }

    /// Lavoué 2011, equations (3) to (6), given the curvatures C(v) and Ĉ(v) at the centre.
    pub(super) fn distance(&self, own: f64, other: f64) -> f64 {
        let sum = |lanes: &[f64; LANES]| (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
        let (w1, w2) = (sum(&self.w1), sum(&self.w2));
        let (mean_a, mean_b) = (sum(&self.w1_a) / w1, sum(&self.w2_b) / w2);
        let s1 = (sum(&self.w1_aa) / w1 - mean_a * mean_a).max(0.0).sqrt();
        let s2 = (sum(&self.w2_bb) / w2 - mean_b * mean_b).max(0.0).sqrt();
        // Weighted by w2 and divided by the sum of w1: mixed, as in the reference.
        let covariance = (sum(&self.w2_ab) - mean_b * sum(&self.w2_a)) / w1;
        let (mu1, mu2) = (own + mean_a, other + mean_b);
        let luminance = (mu1 - mu2).abs() / (mu1.max(mu2) + 1.0);
        let contrast = (s1 - s2).abs() / (s1.max(s2) + 1.0);
        let structure = (s1 * s2 - covariance).abs() / (s1 * s2 + 1.0);
        (luminance + contrast + 0.5 * structure) / 2.5
    }
}
