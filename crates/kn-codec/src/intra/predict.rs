//! Where a vertex is expected, from the known vertices around it (`spec/05-intra.md`).

use super::conquest::{next, prev};
use super::surface::Surface;

/// Fractional bits of predicted coordinates.
pub(super) const FRACTION: u32 = 6;
/// Triangles around a vertex beyond this many do not predict it.
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

/// A prediction, in 1/64 of a grid step from `base`, and what its error is expected from.
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
}

/// Sums over what is known around a vertex, all relative to `base`.
#[derive(Default)]
struct Around {
    parallelogram: [i64; 3],
    onward: [i64; 3],
    along: [i64; 3],
    centroid: [i64; 3],
}

/// Predicts `vertex` from `positions` (`#M × 3`) of the vertices that are `known`. `visit` is
/// called for every known neighbour.
#[inline]
pub(super) fn predict(
    surface: &Surface,
    known: &[bool],
    positions: &[[i32; 3]],
    vertex: u32,
    mut visit: impl FnMut(u32),
) -> Prediction {
    let origin = &surface.conquest.origin;
    let mut found = Prediction::default();
    let mut around = Around::default();
    for h in surface.fan(vertex).take(MOST) {
        let a = origin[next(h) as usize];
        if !known[a as usize] {
            continue;
        }
        if found.neighbours == 0 {
            found.base = positions[a as usize];
        }
        visit(a);
        found.neighbours += 1;
        let at_a = difference(positions[a as usize], found.base);
        add(&mut around.centroid, at_a);
        let b = origin[prev(h) as usize];
        let c = surface.across(next(h));
        if !known[b as usize] || !known[c as usize] {
            continue;
        }
        found.support += 1;
        let at_b = difference(positions[b as usize], found.base);
        let at_c = difference(positions[c as usize], found.base);
        let skew = surface.conquest.valence[a as usize].min(64) as i64
            - surface.conquest.valence[b as usize].min(64) as i64;
        around.add_gate(&mut found, [at_a, at_b, at_c], skew);
    }
    found.offset = around.blend(&found, surface.conquest.valence[vertex as usize]);
    found
}

impl Around {
    #[inline]
    fn add_gate(&mut self, found: &mut Prediction, [a, b, c]: [[i64; 3]; 3], skew: i64) {
        let mut length = 0;
        for k in 0..3 {
            self.parallelogram[k] += a[k] + b[k] - c[k];
            self.onward[k] += a[k] + b[k] - 2 * c[k];
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
    fn blend(&self, found: &Prediction, valence: u32) -> [i64; 3] {
        let per_neighbour = RECIPROCAL[found.neighbours];
        if found.support == 0 {
            return self.centroid.map(|sum| (sum * per_neighbour) >> (16 - FRACTION));
        }
        let per_gate = RECIPROCAL[found.support];
        let [onward, centroid, along] =
            WEIGHTS[found.support.min(4) - 1][valence.clamp(4, 8) as usize - 4];
        std::array::from_fn(|k| {
            let gates = (64 - centroid) * self.parallelogram[k]
                + ((onward * self.onward[k]) >> 1)
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
