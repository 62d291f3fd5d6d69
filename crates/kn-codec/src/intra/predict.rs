//! Prediction of a vertex from the known vertices around it (`spec/05-intra.md`).

use super::surface::Surface;
use super::traversal::Known;

/// Fractional bits of predicted coordinates.
pub(super) const FRACTION: u32 = 6;
/// Largest number of triangles around a vertex that predict it.
const MOST: usize = 32;

/// `RECIPROCAL[n]` = ⌊65536 / n⌋.
const RECIPROCAL: [i64; MOST + 1] = {
    let mut table = [0; MOST + 1];
    let mut n = 1;
    while n <= MOST {
        table[n] = 65_536 / n as i64;
        n += 1;
    }
    table
};

/// Weights in 1/64, by number of parallelograms (1, 2, 3, more) and valence (4 or less … 8 or
/// more): how far to go on in the direction of the known triangles, how far towards the centroid
/// of the known neighbours, and how far along the gate per unit of difference between the valences
/// of its ends. Fitted by least squares, see docs/notes/intra.md.
const WEIGHTS: [[[i64; 3]; 5]; 4] = [
    [[-15, 19, 3], [-9, 17, 4], [4, 20, 7], [28, 36, 7], [35, 38, 11]],
    [[59, 108, 1], [122, 158, 2], [154, 180, 4], [148, 164, 9], [143, 148, 14]],
    [[-5, 44, 2], [47, 90, 1], [100, 133, 2], [128, 152, 5], [134, 147, 12]],
    [[-21, 21, 1], [-3, 34, 1], [15, 47, 1], [44, 67, 4], [70, 91, 8]],
];

/// A prediction, in 1/64 of a grid step from `base`, with the values that its error is expected
/// from.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Prediction {
    /// A known point near by.
    pub(super) base: [i32; 3],
    pub(super) offset: [i64; 3],
    /// Sum of the normals of the predicting triangles, area-weighted.
    pub(super) normal: [i64; 3],
    /// Sum of the lengths (1-norm) of the gates.
    pub(super) gates: u64,
    /// Number of parallelograms.
    pub(super) support: usize,
    /// Number of known neighbours.
    pub(super) neighbours: usize,
    /// Sum of the errors stored with them.
    pub(super) errors: i32,
}

/// A vertex's position and, in eighths of an octave, its error along the surface's normal.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Point {
    pub(super) position: [i32; 3],
    pub(super) error: i32,
}

/// Sums over the known vertices around a vertex, all relative to `base`.
#[derive(Default)]
struct Around {
    /// Over the gates of the predicting triangles: both ends; the tip behind; and the way from one
    /// end to the other, as often as its valence is the smaller.
    ends: [i64; 3],
    behind: [i64; 3],
    along: [i64; 3],
    /// Over the neighbours.
    centroid: [i64; 3],
}

/// The places of the ones in a number, ascending.
struct Ones(u64);

impl Iterator for Ones {
    type Item = usize;

    #[inline]
    fn next(&mut self) -> Option<usize> {
        let place = self.0.trailing_zeros() as usize;
        (self.0 != 0).then(|| {
            self.0 &= self.0 - 1;
            place
        })
    }
}

/// Predicts `vertex` from the `points` (`#M`) of the vertices that are `known`.
#[inline]
pub(super) fn predict(
    surface: &Surface,
    known: &Known,
    points: &[Point],
    vertex: u32,
) -> Prediction {
    let ring = surface.ring(vertex);
    // Which spokes are known, and one more of a longer ring: it ends the last triangle.
    let mut mask = 0u64;
    for (place, spoke) in ring.iter().take(MOST + 1).enumerate() {
        mask |= u64::from(known.contains(spoke.neighbour)) << place;
    }
    let neighbours = mask & ((1 << MOST) - 1);
    let first_again = if ring.len() <= MOST { (mask & 1) << ring.len() } else { 0 };
    let followed = neighbours & ((mask | first_again) >> 1);
    let mut found = Prediction { neighbours: neighbours.count_ones() as usize, ..<_>::default() };
    if neighbours == 0 {
        return found;
    }
    found.base = points[ring[neighbours.trailing_zeros() as usize].neighbour as usize].position;
    let mut around = Around::default();
    for place in Ones(neighbours) {
        let point = &points[ring[place].neighbour as usize];
        found.errors += point.error;
        add(&mut around.centroid, difference(point.position, found.base));
    }
    for place in Ones(followed) {
        let (a, c) = (ring[place].neighbour, ring[place].across);
        if known.contains(c) {
            let b = ring.get(place + 1).unwrap_or(&ring[0]).neighbour;
            let [at_a, at_b, at_c] =
                [a, b, c].map(|v| difference(points[v as usize].position, found.base));
            let skew = i64::from(surface.valence(a)) - i64::from(surface.valence(b));
            around.add_gate(&mut found, [at_a, at_b, at_c], skew);
        }
    }
    found.offset = around.blend(&found, surface.valence(vertex));
    found
}

impl Around {
    #[inline]
    fn add_gate(&mut self, found: &mut Prediction, [a, b, c]: [[i64; 3]; 3], skew: i64) {
        found.support += 1;
        let mut length = 0;
        for k in 0..3 {
            self.ends[k] += a[k] + b[k];
            self.behind[k] += c[k];
            self.along[k] += (b[k] - a[k]) * skew;
            length += (b[k] - a[k]).unsigned_abs();
        }
        found.gates += length;
        let (u, v) = (minus(a, b), minus(c, b));
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            found.normal[k] += u[i] * v[j] - u[j] * v[i];
        }
    }

    /// Weighs the sums, in 1/64 of a step.
    #[inline]
    fn blend(&self, found: &Prediction, valence: u8) -> [i64; 3] {
        let per_neighbour = RECIPROCAL[found.neighbours];
        if found.support == 0 {
            return self.centroid.map(|sum| (sum * per_neighbour) >> (16 - FRACTION));
        }
        let per_gate = RECIPROCAL[found.support];
        let [onward, centroid, along] =
            WEIGHTS[found.support.min(4) - 1][valence.clamp(4, 8) as usize - 4];
        std::array::from_fn(|k| {
            let parallelogram = self.ends[k] - self.behind[k];
            let gates = (64 - centroid) * parallelogram
                + ((onward * (parallelogram - self.behind[k])) >> 1)
                + along * self.along[k];
            (gates * per_gate + centroid * self.centroid[k] * per_neighbour) >> 16
        })
    }
}

#[inline]
fn difference(a: [i32; 3], b: [i32; 3]) -> [i64; 3] {
    [i64::from(a[0] - b[0]), i64::from(a[1] - b[1]), i64::from(a[2] - b[2])]
}

#[inline]
fn minus(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
fn add(sum: &mut [i64; 3], term: [i64; 3]) {
    for k in 0..3 {
        sum[k] += term[k];
    }
}
