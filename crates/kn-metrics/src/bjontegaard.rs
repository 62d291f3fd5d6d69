//! Bjøntegaard delta rate between two rate-distortion curves.
//!
//! Source: G. Bjøntegaard, «Calculation of average PSNR differences between RD-curves», VCEG-M33
//! (2001). Both interpolations are computed: the cubic polynomial of the original, and the
//! piecewise cubic (PCHIP) that is usual today.

/// Smallest share of common quality range at which a delta says enough about the curves.
const SMALL_OVERLAP: f64 = 0.75;

/// The reason why there is no delta.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BdError {
    /// A rate that is not positive and finite, or a quality that is not finite.
    #[error("point {index} of the {curve} curve: rates must be positive, all values finite")]
    BadPoint {
        /// "anchor" or "test".
        curve: &'static str,
        /// Index of the point.
        index: usize,
    },
    /// A curve has fewer than two points that are not dominated.
    #[error("the {curve} curve has {left} points that no other point dominates; two are needed")]
    TooFewPoints {
        /// "anchor" or "test".
        curve: &'static str,
        /// Number of points that are left.
        left: usize,
    },
    /// The curves have no quality in common.
    #[error("the curves do not overlap in quality")]
    NoOverlap,
}

/// A point of a rate-distortion curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatePoint {
    /// Bytes or bits, in the same unit on both curves.
    pub rate: f64,
    /// Quality, of which more is better: decibels, or 1 − MSDM2.
    pub quality: f64,
}

/// The Bjøntegaard delta rate: how much more rate the test curve needs than the anchor for the same
/// quality, on average.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BdRate {
    /// Per cent, from piecewise cubic interpolation; negative where the test curve saves.
    pub pchip: f64,
    /// Per cent, from one cubic fitted to each curve; needs four points on both.
    pub cubic: Option<f64>,
    /// The common range of qualities divided by the whole range, 0..=1.
    pub overlap: f64,
    /// Numbers of points left out because another has more quality for no more rate.
    pub dominated: Dominated,
}

/// Numbers of points of both curves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dominated {
    /// Number of points of the anchor.
    pub anchor: usize,
    /// Number of points of the test curve.
    pub test: usize,
}

impl BdRate {
    /// Whether the curves share too little quality for a value that can be trusted.
    pub fn overlap_is_small(&self) -> bool {
        self.overlap < SMALL_OVERLAP
    }
}

/// The Bjøntegaard delta rate of `test` against `anchor`, points in any order.
///
/// # Errors
/// A value is not finite, a curve has fewer than two useful points, or no quality is common.
pub fn bd_rate(anchor: &[RatePoint], test: &[RatePoint]) -> Result<BdRate, BdError> {
    let (anchor, anchor_dominated) = Curve::new("anchor", anchor)?;
    let (test, test_dominated) = Curve::new("test", test)?;
    let (low, high) = (anchor.low().max(test.low()), anchor.high().min(test.high()));
    if low >= high {
        return Err(BdError::NoOverlap);
    }
    let whole = anchor.high().max(test.high()) - anchor.low().min(test.low());
    let per_cent = |difference: f64| 100.0 * (libm::exp10(difference / (high - low)) - 1.0);
    let pchip = test.pchip_integral(low, high) - anchor.pchip_integral(low, high);
    let cubic = match (anchor.cubic_integral(low, high), test.cubic_integral(low, high)) {
        (Some(anchor), Some(test)) => Some(per_cent(test - anchor)),
        _ => None,
    };
    Ok(BdRate {
        pchip: per_cent(pchip),
        cubic,
        overlap: (high - low) / whole,
        dominated: Dominated { anchor: anchor_dominated, test: test_dominated },
    })
}

/// Qualities, ascending, and the logarithms of the rates, ascending too; at least two.
struct Curve {
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Curve {
    /// The curve without dominated points, and how many those were.
    fn new(curve: &'static str, points: &[RatePoint]) -> Result<(Self, usize), BdError> {
        let usable = |p: &RatePoint| p.rate > 0.0 && p.rate.is_finite() && p.quality.is_finite();
        if let Some(index) = points.iter().position(|point| !usable(point)) {
            return Err(BdError::BadPoint { curve, index });
        }
        let mut sorted = points.to_vec();
        sorted.sort_by(|a, b| a.rate.total_cmp(&b.rate).then(b.quality.total_cmp(&a.quality)));
        let mut best = f64::NEG_INFINITY;
        sorted.retain(|point| {
            let better = point.quality > best;
            best = best.max(point.quality);
            better
        });
        if sorted.len() < 2 {
            return Err(BdError::TooFewPoints { curve, left: sorted.len() });
        }
        let x = sorted.iter().map(|point| point.quality).collect();
        let y = sorted.iter().map(|point| libm::log10(point.rate)).collect();
        Ok((Self { x, y }, points.len() - sorted.len()))
    }

    fn low(&self) -> f64 {
        self.x[0]
    }

    fn high(&self) -> f64 {
        self.x[self.x.len() - 1]
    }

    /// The integral of the monotone piecewise cubic through the points.
    fn pchip_integral(&self, low: f64, high: f64) -> f64 {
        let slopes = self.pchip_slopes();
        let mut sum = 0.0;
        for i in 0..self.x.len() - 1 {
            let (from, to) = (low.max(self.x[i]), high.min(self.x[i + 1]));
            if from >= to {
                continue;
            }
            let h = self.x[i + 1] - self.x[i];
            let rise = (self.y[i + 1] - self.y[i]) / h;
            // y = y₀ + d₀ s + c s² + b s³ with s from the left point.
            let c = (3.0 * rise - 2.0 * slopes[i] - slopes[i + 1]) / h;
            let b = (slopes[i] + slopes[i + 1] - 2.0 * rise) / (h * h);
            let integral =
                |s: f64| s * (self.y[i] + s * (slopes[i] / 2.0 + s * (c / 3.0 + s * b / 4.0)));
            sum += integral(to - self.x[i]) - integral(from - self.x[i]);
        }
        sum
    }

    /// Fritsch and Carlson's slopes with the three-point formula at the ends.
    fn pchip_slopes(&self) -> Vec<f64> {
        let n = self.x.len();
        let h: Vec<f64> = self.x.windows(2).map(|x| x[1] - x[0]).collect();
        let rise: Vec<f64> = (0..n - 1).map(|i| (self.y[i + 1] - self.y[i]) / h[i]).collect();
        if n == 2 {
            return vec![rise[0]; 2];
        }
        let mut slopes = vec![0.0; n];
        for i in 1..n - 1 {
            if rise[i - 1] * rise[i] > 0.0 {
                let (w1, w2) = (2.0 * h[i] + h[i - 1], h[i] + 2.0 * h[i - 1]);
                slopes[i] = (w1 + w2) / (w1 / rise[i - 1] + w2 / rise[i]);
            }
        }
        slopes[0] = end_slope(h[0], h[1], rise[0], rise[1]);
        slopes[n - 1] = end_slope(h[n - 2], h[n - 3], rise[n - 2], rise[n - 3]);
        slopes
    }

    /// The integral of the cubic that fits the points best; `None` with fewer than four.
    fn cubic_integral(&self, low: f64, high: f64) -> Option<f64> {
        if self.x.len() < 4 {
            return None;
        }
        // Qualities brought to −1..=1 keep the normal equations well conditioned.
        let (middle, half) = (0.5 * (self.low() + self.high()), 0.5 * (self.high() - self.low()));
        let mut normal = [[0.0; 5]; 4];
        for (x, y) in self.x.iter().zip(&self.y) {
            let x = (x - middle) / half;
            let powers = [1.0, x, x * x, x * x * x];
            for i in 0..4 {
                for j in 0..4 {
                    normal[i][j] += powers[i] * powers[j];
                }
                normal[i][4] += powers[i] * y;
            }
        }
        let [a, b, c, d] = solve(normal);
        let integral = |x: f64| {
            let x = (x - middle) / half;
            half * x * (a + x * (b / 2.0 + x * (c / 3.0 + x * d / 4.0)))
        };
        Some(integral(high) - integral(low))
    }
}

/// The one-sided slope from two intervals, kept monotone.
fn end_slope(h0: f64, h1: f64, rise0: f64, rise1: f64) -> f64 {
    let slope = ((2.0 * h0 + h1) * rise0 - h0 * rise1) / (h0 + h1);
    if slope * rise0 <= 0.0 {
        0.0
    } else if rise0 * rise1 < 0.0 && slope.abs() > 3.0 * rise0.abs() {
        3.0 * rise0
    } else {
        slope
    }
}

/// Gaussian elimination with pivoting.
fn solve(mut rows: [[f64; 5]; 4]) -> [f64; 4] {
    for column in 0..4 {
        let mut pivot = column;
        for row in column + 1..4 {
            if rows[row][column].abs() > rows[pivot][column].abs() {
                pivot = row;
            }
        }
        rows.swap(column, pivot);
        for row in 0..4 {
            if row != column {
                let factor = rows[row][column] / rows[column][column];
                for k in column..5 {
                    rows[row][k] -= factor * rows[column][k];
                }
            }
        }
    }
    [0, 1, 2, 3].map(|i| rows[i][4] / rows[i][i])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: &[(f64, f64)]) -> Vec<RatePoint> {
        points.iter().map(|&(rate, quality)| RatePoint { rate, quality }).collect()
    }

    fn published() -> (Vec<RatePoint>, Vec<RatePoint>) {
        (
            curve(&[(9487.76, 40.037), (4593.60, 38.615), (2486.44, 36.845), (1358.24, 34.851)]),
            curve(&[(9787.80, 40.121), (4469.00, 38.651), (2451.52, 36.970), (1356.24, 34.987)]),
        )
    }

    #[test]
    fn gives_the_published_values() {
        let (anchor, test) = published();
        let found = bd_rate(&anchor, &test).unwrap();
        assert!((found.cubic.unwrap() - -4.420463).abs() < 1e-5, "{found:?}");
        assert!((found.pchip - -4.417485).abs() < 1e-5, "{found:?}");
        assert!(!found.overlap_is_small() && found.dominated == Dominated::default());
    }

    #[test]
    fn a_constant_factor_is_found_exactly() {
        let (anchor, _) = published();
        let cheaper: Vec<_> =
            anchor.iter().map(|p| RatePoint { rate: 0.8 * p.rate, ..*p }).collect();
        let found = bd_rate(&anchor, &cheaper).unwrap();
        assert!((found.pchip + 20.0).abs() < 1e-9 && (found.cubic.unwrap() + 20.0).abs() < 1e-9);
        assert_eq!(found.overlap, 1.0);
    }

    #[test]
    fn dominated_points_are_dropped() {
        let (anchor, test) = published();
        let mut more = test.clone();
        more.extend(curve(&[(9000.0, 37.0), (1356.24, 34.0)]));
        let found = bd_rate(&anchor, &more).unwrap();
        assert_eq!(found.dominated, Dominated { anchor: 0, test: 2 });
        assert_eq!(found.pchip, bd_rate(&anchor, &test).unwrap().pchip);
    }

    #[test]
    fn two_points_make_a_line() {
        let anchor = curve(&[(100.0, 30.0), (1000.0, 40.0)]);
        let test = curve(&[(100.0, 35.0), (1000.0, 45.0)]);
        let found = bd_rate(&anchor, &test).unwrap();
        assert!((found.pchip - 100.0 * (10f64.powf(-0.5) - 1.0)).abs() < 1e-9);
        assert_eq!(found.cubic, None);
        assert!((found.overlap - 1.0 / 3.0).abs() < 1e-12 && found.overlap_is_small());
    }

    #[test]
    fn useless_curves_are_refused() {
        let (anchor, _) = published();
        let apart = curve(&[(1.0, 10.0), (2.0, 20.0)]);
        assert_eq!(bd_rate(&anchor, &apart), Err(BdError::NoOverlap));
        let falling = curve(&[(1.0, 30.0), (2.0, 20.0)]);
        assert_eq!(
            bd_rate(&anchor, &falling),
            Err(BdError::TooFewPoints { curve: "test", left: 1 })
        );
        let zero = curve(&[(1.0, 30.0), (0.0, 20.0)]);
        assert_eq!(bd_rate(&zero, &anchor), Err(BdError::BadPoint { curve: "anchor", index: 1 }));
        assert!(bd_rate(&[], &anchor).is_err());
    }
}
