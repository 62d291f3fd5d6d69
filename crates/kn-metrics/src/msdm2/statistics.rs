//! Curvature statistics of two surfaces over a neighbourhood, and the distance they give.

use super::exp::exp_in_place;

/// Sums run in this many lanes, so that the compiler can vectorise them; the order is fixed.
const LANES: usize = 4;

/// Samples side by side: those at vertices first, then those where edges leave the sphere.
/// Curvatures are relative to those at the centre: C − C(v), Ĉ − Ĉ(v). That keeps the digits of a
/// variance which is small beside the mean.
#[derive(Default)]
pub(super) struct Samples {
    inside: usize,
    count: usize,
    columns: [Vec<f64>; 4],
}

/// One sample: exponents of both Gaussian weights or the weights themselves, and both curvatures.
pub(super) type Sample = [f64; 4];

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
    /// Takes `inside` samples at vertices, with the exponents of both weights, and as many others
    /// as there are, with the first weight itself and the exponent of the second.
    #[inline]
    pub(super) fn fill(
        &mut self,
        inside: (usize, impl Iterator<Item = Sample>),
        leaving: (usize, impl Iterator<Item = Sample>),
    ) {
        self.inside = inside.0;
        self.count = inside.0 + leaving.0;
        let padded = self.count.next_multiple_of(LANES);
        for column in &mut self.columns {
            column.resize(padded, 0.0);
            column[self.count..].fill(0.0);
        }
        let [w1, w2, a, b] = &mut self.columns;
        let rows = w1.iter_mut().zip(w2).zip(a.iter_mut().zip(b));
        for (((w1, w2), (a, b)), sample) in rows.zip(inside.1.chain(leaving.1)) {
            [*w1, *w2, *a, *b] = sample;
        }
    }

    /// Weighted sums over all samples. Replaces the exponents.
    pub(super) fn moments(&mut self) -> Moments {
        let [w1, w2, a, b] = &mut self.columns;
        exp_in_place(&mut w1[..self.inside]);
        exp_in_place(&mut w2[..self.count]);
        let mut moments = Moments::default();
        let [w1, w2, a, b] = [w1, w2, a, b].map(|column| column.as_chunks::<LANES>().0);
        for (((a, b), w1), w2) in a.iter().zip(b).zip(w1).zip(w2) {
            moments.add_lanes(a, b, w1, w2);
        }
        moments
    }

    /// How many samples there are.
    #[cfg(test)]
    pub(super) fn count(&self) -> usize {
        self.count
    }
}

impl Moments {
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
