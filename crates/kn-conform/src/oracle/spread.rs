//! 5.5: what the ring of a vertex says of it: where it is expected, and how far off it may be.

/// Sums over the known vertices around a vertex, relative to the first of them.
#[derive(Default)]
pub(super) struct Ring {
    pub(super) base: Option<[i64; 3]>,
    neighbours: i64,
    pub(super) triples: i64,
    centroid: [i64; 3],
    parallel: [i64; 3],
    onward: [i64; 3],
    along: [i64; 3],
    gates: i64,
    normal: [i64; 3],
    stored_errors: i64,
}

fn each(f: impl Fn(usize) -> i64) -> [i64; 3] {
    [f(0), f(1), f(2)]
}

impl Ring {
    pub(super) fn add_neighbour(&mut self, a: [i64; 3], stored_error: i64) {
        let base = *self.base.get_or_insert(a);
        self.neighbours += 1;
        self.centroid = each(|i| self.centroid[i] + a[i] - base[i]);
        self.stored_errors += stored_error;
    }

    pub(super) fn add_triple(&mut self, [a, b, c]: [[i64; 3]; 3], valences: i64) {
        let base = self.base.unwrap_or_default();
        let [a, b, c] = [a, b, c].map(|p| each(|i| p[i] - base[i]));
        self.triples += 1;
        self.parallel = each(|i| self.parallel[i] + a[i] + b[i] - c[i]);
        self.onward = each(|i| self.onward[i] + a[i] + b[i] - 2 * c[i]);
        self.along = each(|i| self.along[i] + (b[i] - a[i]) * valences);
        self.gates += (0..3).map(|i| (b[i] - a[i]).abs()).sum::<i64>();
        let (u, v) = (each(|i| a[i] - b[i]), each(|i| c[i] - b[i]));
        let cross = each(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            u[j] * v[k] - u[k] * v[j]
        });
        self.normal = each(|i| self.normal[i] + cross[i]);
    }

    /// r[intra.geometry.unsupported]
    pub(super) fn centre(&self, base: [i64; 3]) -> [i64; 3] {
        let r = 65536 / self.neighbours;
        each(|i| base[i] + ((((self.centroid[i] * r) >> 10) + 32) >> 6))
    }

    /// min(s, 4) and clamp(valence, 4, 8), counted from 0.
    fn class(&self, valence: i64) -> (usize, usize) {
        (self.triples.min(4) as usize - 1, valence.clamp(4, 8) as usize - 4)
    }
}

/// Table 5-1.
pub(super) const WEIGHTS: [[[i64; 3]; 5]; 4] = [
    [[-15, 19, 3], [-9, 17, 4], [4, 20, 7], [28, 36, 7], [35, 38, 11]],
    [[59, 108, 1], [122, 158, 2], [154, 180, 4], [148, 164, 9], [143, 148, 14]],
    [[-5, 44, 2], [47, 90, 1], [100, 133, 2], [128, 152, 5], [134, 147, 12]],
    [[-21, 21, 1], [-3, 34, 1], [15, 47, 1], [44, 67, 4], [70, 91, 8]],
];

/// r[intra.geometry.blend], in 1/64 of a step relative to the base.
pub(super) fn blended(ring: &Ring, valence: i64) -> [i64; 3] {
    let (s, v) = ring.class(valence);
    let [o, m, e] = WEIGHTS[s][v];
    let r = |n: i64| 65536 / n;
    each(|i| {
        let predicted =
            (64 - m) * ring.parallel[i] + ((o * ring.onward[i]) >> 1) + e * ring.along[i];
        (predicted * r(ring.triples) + m * ring.centroid[i] * r(ring.neighbours)) >> 16
    })
}

/// Logarithm in eighths of an octave.
fn log(x: i128) -> i64 {
    if x <= 1 {
        return 0;
    }
    let e = i64::from(x.ilog2());
    8 * e + (((x << 3) >> e) & 7) as i64
}

/// r[intra.geometry.spread]: the running means in 1/256, by class.
pub(super) struct Means {
    tangential: [[i64; 5]; 4],
    normal: [[i64; 5]; 4],
}

impl Default for Means {
    fn default() -> Self {
        Self { tangential: [[-8 * 256; 5]; 4], normal: [[-32 * 256; 5]; 4] }
    }
}

/// r[intra.geometry.frame]
pub(super) struct Frame {
    /// p, q, d.
    pub(super) axes: [usize; 3],
    n: [i64; 3],
    s: i128,
    w: i128,
    gate: i64,
    tangential: i64,
    class: (usize, usize),
    flat: i64,
}

impl Frame {
    pub(super) fn new(ring: &Ring, valence: i64, means: &Means) -> Self {
        let class = ring.class(valence);
        let gate = log(i128::from(64 * ring.gates / ring.triples));
        let tangential = gate + (means.tangential[class.0][class.1] >> 8);
        let by_mean = gate + (means.normal[class.0][class.1] >> 8);
        let across = (by_mean + ring.stored_errors / ring.neighbours) >> 1;
        let flat = ((tangential - across - 6) >> 2).clamp(0, 10);
        let largest = ring.normal.map(i64::unsigned_abs).into_iter().max().unwrap_or(0);
        let bits = 64 - largest.leading_zeros();
        let n = ring.normal.map(|component| component >> bits.saturating_sub(10));
        let most = n.map(i64::abs).into_iter().max().unwrap_or(0);
        let d = n.iter().position(|component| component.abs() == most).unwrap_or(0);
        let axes = [(d + 1) % 3, (d + 2) % 3, d];
        let s = i128::from(n.map(|c| c * c).iter().sum::<i64>().max(1));
        Self { axes, n, s, w: (1 << flat) - 1, gate, tangential, class, flat }
    }

    /// Mean and context of the axis at a place; `errors` by axis, of the axes before.
    pub(super) fn expect(&self, place: usize, errors: [i64; 3]) -> (i64, usize) {
        let [p, q, d] = self.axes;
        let n = self.n.map(i128::from);
        let e = errors.map(i128::from);
        let (s, w) = (self.s, self.w);
        let whole = s << self.flat;
        let x = whole - w * n[p] * n[p];
        let along = s + w * n[d] * n[d];
        let (mean, variance) = match place {
            0 => (0, log(x) - log(whole)),
            1 => ((-w * n[p] * n[q] * e[p]) / x, log(x - w * n[q] * n[q]) - log(x)),
            _ => ((-w * n[d] * (n[p] * e[p] + n[q] * e[q])) / along, log(s) - log(along)),
        };
        let context = ((2 * self.tangential + variance) >> 3).clamp(0, 47);
        (mean as i64, context as usize)
    }

    /// r[intra.geometry.learn]: moves the means; gives the error to store.
    pub(super) fn learn(&self, e: [i64; 3], means: &mut Means) -> i64 {
        let length: i64 = e.iter().map(|e| e.abs()).sum();
        let dot: i128 = (0..3).map(|i| i128::from(self.n[i]) * i128::from(e[i])).sum();
        let size: i64 = self.n.iter().map(|n| n.abs()).sum();
        let error = log(dot.abs() + i128::from(8 * size)) - log(self.s) / 2;
        let tangential = &mut means.tangential[self.class.0][self.class.1];
        *tangential += (256 * (log(i128::from(length + 16)) - self.gate) - *tangential) >> 6;
        let normal = &mut means.normal[self.class.0][self.class.1];
        *normal += (256 * (error - self.gate) - *normal) >> 6;
        error
    }
}
