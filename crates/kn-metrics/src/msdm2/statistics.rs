//! Curvature statistics of two surfaces over a neighbourhood, and the distance they give.

use super::exp::exp_of_negative;
use super::machine::QUAD;

/// Sums run in the lanes of a quad; the order is fixed.
const LANES: usize = QUAD;

/// Samples side by side: those at vertices first, then those where edges leave the sphere.
/// Curvatures are relative to those at the centre: C − C(v), Ĉ − Ĉ(v). That keeps the digits of a
/// variance which is small beside the mean.
#[derive(Clone, Default)]
pub(super) struct Samples {
    blocks: Vec<SampleBlock>,
    /// How many blocks of samples at vertices.
    inside: usize,
}

/// Exponents of both Gaussian weights, and both curvatures.
pub(super) type Sample = [f64; 4];

/// The samples of all lanes, one number after the other. Where edges leave the sphere the first is
/// the weight itself, since it is nearly always the same.
pub(super) type SampleBlock = [[f64; LANES]; 4];

/// Samples without weight: at vertices, and where edges leave the sphere.
const NO_VERTEX: SampleBlock =
    [[f64::NEG_INFINITY; LANES], [f64::NEG_INFINITY; LANES], [0.0; LANES], [0.0; LANES]];
pub(super) const NO_EDGE: Sample = [0.0, f64::NEG_INFINITY, 0.0, 0.0];

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
    /// Makes room for samples at so many vertices.
    #[inline(always)]
    pub(super) fn start(&mut self, inside: usize) {
        self.inside = inside.div_ceil(LANES);
        self.blocks.clear();
        self.blocks.resize(self.inside, NO_VERTEX);
    }

    /// Sets one of the samples at vertices.
    #[inline(always)]
    pub(super) fn set_inside(&mut self, index: usize, sample: Sample) {
        set(&mut self.blocks[index / LANES], index % LANES, sample);
    }

    /// The blocks of so many samples where edges leave the sphere, to be filled.
    #[inline(always)]
    pub(super) fn leaving(&mut self, count: usize) -> &mut [SampleBlock] {
        self.blocks.resize(self.inside + count.div_ceil(LANES), NO_VERTEX);
        &mut self.blocks[self.inside..]
    }

    /// Weighted sums over all samples.
    #[inline(always)]
    pub(super) fn moments(&self) -> Moments {
        let mut moments = Moments::default();
        let (inside, leaving) = self.blocks.split_at(self.inside);
        for [w1, w2, a, b] in inside {
            moments.add(a, b, &weights(w1), &weights(w2));
        }
        for [w1, w2, a, b] in leaving {
            moments.add(a, b, w1, &weights(w2));
        }
        moments
    }
}

/// A loop, since `map` over an array stays a call of its own that keeps no vector in a register.
#[inline(always)]
fn weights(exponents: &[f64; LANES]) -> [f64; LANES] {
    let mut weights = [0.0; LANES];
    for lane in 0..LANES {
        weights[lane] = exp_of_negative(exponents[lane]);
    }
    weights
}

/// Sets one lane.
#[inline(always)]
pub(super) fn set([w1, w2, a, b]: &mut SampleBlock, lane: usize, sample: Sample) {
    [w1[lane], w2[lane], a[lane], b[lane]] = sample;
}

impl Moments {
    #[inline(always)]
    fn add(&mut self, a: &[f64; LANES], b: &[f64; LANES], w1: &[f64; LANES], w2: &[f64; LANES]) {
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
