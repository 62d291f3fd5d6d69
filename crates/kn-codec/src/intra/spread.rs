//! The expected size of residuals: smaller along the surface's normal than within the surface, and
//! similar for neighbours (`spec/05-intra.md`). Lengths are logarithms in eighths of
//! an octave, of sixty-fourths of a grid step.

use super::predict::Prediction;

/// Bits of a normal's largest component.
const NORMAL_BITS: u32 = 10;
/// Fractional bits of a running mean.
const MEAN_BITS: u32 = 8;
/// A running mean moves by 1/64 of its distance to a new value.
const MEAN_SHIFT: u32 = 6;
/// The difference between the means of tangential and normal errors where both are equally
/// uncertain.
const EVEN: i32 = 6;
/// Octaves of variance by which the tangent plane and the normal may differ.
const MOST_FLAT: i32 = 10;
/// Number of contexts for expected magnitudes, half an octave each.
pub(super) const MAGNITUDES: usize = 48;

/// Eight times the binary logarithm of `x`, mantissa linearly; 0 for 0.
#[inline]
pub(super) fn log8(x: u64) -> i32 {
    let x = x.max(1);
    let octave = x.ilog2();
    let mantissa = if octave >= 3 { x >> (octave - 3) } else { x << (3 - octave) };
    (8 * octave + (mantissa & 7) as u32) as i32
}

/// Running means of the errors seen so far, by support (1, 2, 3, more) and valence.
#[derive(Clone, Debug)]
pub(super) struct Spread {
    tangential: [[i32; 5]; 4],
    normal: [[i32; 5]; 4],
}

impl Default for Spread {
    fn default() -> Self {
        // Errors begin at half a gate's length, and a sixteenth along the normal.
        Self { tangential: [[-8 << MEAN_BITS; 5]; 4], normal: [[-32 << MEAN_BITS; 5]; 4] }
    }
}

/// The spread expected of one vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Expected {
    class: (usize, usize),
    gate: i32,
    tangential: i32,
    /// The normal, and which axes are coded first, second, last (the normal's largest).
    normal: [i64; 3],
    pub(super) axes: [usize; 3],
    square: i64,
    /// Octaves of variance by which the plane is wider than the normal: 2^flat − 1 weighs it.
    flat: i32,
}

impl Spread {
    /// The expected size of the residual of a vertex with `prediction` and `valence`.
    #[inline]
    pub(super) fn expect(&self, prediction: &Prediction, valence: u8) -> Expected {
        let class = (prediction.support.clamp(1, 4) - 1, valence.clamp(4, 8) as usize - 4);
        let gate = log8((prediction.gates << 6) / prediction.support.max(1) as u64);
        let tangential = gate + (self.tangential[class.0][class.1] >> MEAN_BITS);
        let own = gate + (self.normal[class.0][class.1] >> MEAN_BITS);
        let normal = (own + prediction.errors / prediction.neighbours.max(1) as i32) >> 1;
        let flat = ((tangential - normal - EVEN) >> 2).clamp(0, MOST_FLAT);
        let direction = shortened(prediction.normal);
        let square = direction.iter().map(|n| n * n).sum::<i64>().max(1);
        let largest = dominant(direction);
        let axes = [(largest + 1) % 3, (largest + 2) % 3, largest];
        Expected { class, gate, tangential, normal: direction, axes, square, flat }
    }

    /// Learns from the error, in 1/64, and returns its length along the normal for the neighbours.
    #[inline]
    pub(super) fn observe(&mut self, expected: &Expected, error: [i64; 3]) -> i32 {
        let length: u64 = error.iter().map(|e| e.unsigned_abs()).sum();
        let n = expected.normal;
        let along = (n[0] * error[0] + n[1] * error[1] + n[2] * error[2]).unsigned_abs();
        let sum: u64 = n.iter().map(|n| n.unsigned_abs()).sum();
        let normal = log8(along + 8 * sum) - log8(expected.square as u64) / 2;
        let (support, valence) = expected.class;
        approach(&mut self.tangential[support][valence], log8(length + 16) - expected.gate);
        approach(&mut self.normal[support][valence], normal - expected.gate);
        normal
    }
}

#[inline]
fn approach(mean: &mut i32, value: i32) {
    *mean += ((value << MEAN_BITS) - *mean) >> MEAN_SHIFT;
}

/// `normal` with its largest component cut to [`NORMAL_BITS`] bits.
#[inline]
fn shortened(normal: [i64; 3]) -> [i64; 3] {
    let largest = normal.iter().map(|n| n.unsigned_abs()).max().unwrap_or(0).max(1);
    let shift = (largest.ilog2() + 1).saturating_sub(NORMAL_BITS);
    normal.map(|n| n >> shift)
}

/// Axis of the largest component, the lowest of equals.
#[inline]
fn dominant(normal: [i64; 3]) -> usize {
    let size = normal.map(i64::unsigned_abs);
    if size[0] >= size[1] && size[0] >= size[2] {
        0
    } else if size[1] >= size[2] {
        1
    } else {
        2
    }
}

impl Expected {
    /// Errors are taken as jointly Gaussian, with variance 2^flat in the plane for 1 along the
    /// normal. For the axis coded `place`-th: the mean of its error, in 1/64, given those of
    /// the axes before, and the context of its magnitude.
    #[inline]
    pub(super) fn conditional(&self, place: usize, error: [i64; 3]) -> (i64, usize) {
        let [p, q, d] = self.axes;
        let n = self.normal;
        let weight = (1i64 << self.flat) - 1;
        let whole = self.square << self.flat;
        let first = whole - weight * n[p] * n[p];
        let (mean, variance) = match place {
            0 => (0, log8(first as u64) - log8(whole as u64)),
            1 => {
                let both = first - weight * n[q] * n[q];
                let mean = -weight * n[p] * n[q] * error[p] / first;
                (mean, log8(both as u64) - log8(first as u64))
            }
            _ => {
                let precision = self.square + weight * n[d] * n[d];
                let mean = -weight * n[d] * (n[p] * error[p] + n[q] * error[q]) / precision;
                (mean, log8(self.square as u64) - log8(precision as u64))
            }
        };
        let context = (2 * self.tangential + variance) >> 3;
        (mean, context.clamp(0, MAGNITUDES as i32 - 1) as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms_count_eighths_of_an_octave() {
        assert_eq!([0, 1, 2, 3, 8, 9, 15, 16].map(log8), [0, 0, 8, 12, 24, 25, 31, 32]);
        assert_eq!(log8(u64::MAX), 8 * 63 + 7);
    }

    #[test]
    fn an_axis_along_the_normal_is_expected_close_once_the_others_are_known() {
        let prediction = Prediction {
            normal: [0, 0, 1 << 30],
            gates: 2 * 64,
            support: 2,
            neighbours: 1,
            ..Prediction::default()
        };
        let expected = Spread::default().expect(&prediction, 6);
        assert_eq!(expected.axes, [0, 1, 2]);
        let [x, y, z] = [0, 1, 2].map(|place| expected.conditional(place, [640, -640, 0]));
        assert_eq!((x, y, z.0), ((0, x.1), (0, x.1), 0));
        assert!(z.1 + 4 < x.1, "{} against {}", z.1, x.1);
    }

    #[test]
    fn on_a_slope_the_last_axis_follows_the_others() {
        let normal = [-(1 << 20), 0, 1 << 20];
        let prediction =
            Prediction { normal, gates: 4096, support: 1, neighbours: 1, ..Prediction::default() };
        let mut spread = Spread::default();
        (0..500).for_each(|_| {
            spread.observe(&spread.clone().expect(&prediction, 6), [900, 900, 900]);
        });
        let expected = spread.expect(&prediction, 6);
        assert_eq!(expected.axes, [1, 2, 0], "of equals the lowest axis is last");
        let (mean, _) = expected.conditional(2, [0, 0, 640]);
        assert!((600..=640).contains(&mean), "{mean}");
    }
}
