//! Chapter 8 as it is written, in the same order of operations, and not made for speed.

/// The parameters of influence in the sequence header.
#[derive(Clone, Debug, Default)]
pub(crate) struct Settings {
    pub(crate) nodes_per_vertex: usize,
    pub(crate) weight_scheme: i128,
    pub(crate) fallback: bool,
    pub(crate) sigma: i128,
}

/// A key node as chapters 6 and 7 give it.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// In reference units; moves with every frame.
    pub(crate) position: [i64; 3],
    pub(crate) region: i64,
    pub(crate) label: u8,
    pub(crate) affine: bool,
}

/// Values of a node in one frame.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    /// In reference units.
    pub(crate) translation: [i64; 3],
    pub(crate) angles: [f64; 3],
    pub(crate) scale: [f64; 3],
    /// xy, xz, yz.
    pub(crate) shear: [f64; 3],
}

/// 8.1: HalfPiHead, HalfPiTail, TwoOverPi.
pub(crate) const SINCOS_CONSTANTS: [u64; 3] =
    [0x3FF9_21FB_5440_0000, 0x3DD0_B461_1A62_6331, 0x3FE4_5F30_6DC9_C883];
/// 8.1: Log2E, Ln2Head, Ln2Tail.
pub(crate) const EXP_CONSTANTS: [u64; 3] =
    [0x3FF7_1547_652B_82FE, 0x3FE6_2E42_FEE0_0000, 0x3DEA_39EF_3579_3C76];

/// 8.1: P and C.
pub(crate) const SINE: [f64; 7] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
];
pub(crate) const COSINE: [f64; 7] = [
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
];

/// Slots of a vertex: node and weight.
pub(crate) type Slots = Vec<(usize, f64)>;

/// 8.2, for a vertex and nodes in grid steps; `None` where strict mode finds no node.
pub(crate) fn bind(
    vertex: [i64; 3],
    region: i64,
    nodes: &[([i64; 3], i64)],
    settings: &Settings,
) -> Option<Slots> {
    let squared = |node: usize| -> i64 {
        (0..3).map(|axis| (vertex[axis] - nodes[node].0[axis]).pow(2)).sum()
    };
    let mut candidates: Vec<usize> = (0..nodes.len()).filter(|&n| nodes[n].1 == region).collect();
    if candidates.is_empty() && settings.fallback {
        candidates = (0..nodes.len()).collect();
    }
    candidates.sort_by_key(|&node| (squared(node), node));
    let nearest = *candidates.first()?;
    let q = settings.nodes_per_vertex;
    let missing = q.saturating_sub(candidates.len());
    let mut slots = vec![nearest; missing];
    slots.extend(candidates.iter().take(q));
    let floored = |node: usize| squared(node).max(1) as f64;
    let distances: Vec<f64> = slots.iter().map(|&node| floored(node)).collect();
    let beyond = candidates.get(q).map(|&node| floored(node));
    let weights = normalise(raw_weights(&distances, beyond, settings));
    Some(slots.into_iter().zip(weights).collect())
}

fn raw_weights(distances: &[f64], beyond: Option<f64>, settings: &Settings) -> Vec<f64> {
    let sigma = settings.sigma as f64;
    let last = distances[distances.len() - 1];
    let reach = beyond.map_or(2.0 * last.sqrt(), f64::sqrt);
    let weight = |&d: &f64| match settings.weight_scheme {
        0 => 1.0 / d,
        1 => (1.0 - d.sqrt() / reach) * (1.0 - d.sqrt() / reach),
        _ => expneg((d - distances[0]) / (2.0 * (sigma * sigma))),
    };
    distances.iter().map(weight).collect()
}

fn normalise(raw: Vec<f64>) -> Vec<f64> {
    let mut sum = 0.0;
    for weight in &raw {
        sum += weight;
    }
    let count = raw.len() as f64;
    raw.into_iter().map(|weight| if sum == 0.0 { 1.0 / count } else { weight / sum }).collect()
}

fn horner(coefficients: &[f64], z: f64) -> f64 {
    let mut p = coefficients[coefficients.len() - 1];
    for coefficient in coefficients[..coefficients.len() - 1].iter().rev() {
        p = coefficient + z * p;
    }
    p
}

/// 8.1: (sine, cosine).
pub(crate) fn sincos(a: f64) -> (f64, f64) {
    let [head, tail, two_over_pi] = SINCOS_CONSTANTS.map(f64::from_bits);
    let k = (a * two_over_pi).round_ties_even();
    let r = (a - k * head) - k * tail;
    let z = r * r;
    let s = r + r * (z * horner(&SINE, z));
    let c = 1.0 + z * horner(&COSINE, z);
    match (k as i64).rem_euclid(4) {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// 8.1: E, the inverse factorials up to 12.
pub(crate) fn exponential() -> Vec<f64> {
    let mut coefficients = vec![1.0];
    let mut factorial = 1.0;
    for n in 1..=12 {
        factorial *= f64::from(n);
        coefficients.push(1.0 / factorial);
    }
    coefficients
}

/// 8.1: e^(−x) for x ≥ 0.
pub(crate) fn expneg(x: f64) -> f64 {
    if x > 700.0 {
        return 0.0;
    }
    let [log2_e, head, tail] = EXP_CONSTANTS.map(f64::from_bits);
    let k = (x * log2_e).round_ties_even();
    let r = -((x - k * head) - k * tail);
    // 2^(−k) is a normal number: k is at most 1010.
    horner(&exponential(), r) * f64::from_bits(((1023 - k as i64) as u64) << 52)
}

/// 8.3: the rows of A.
pub(crate) fn matrix(motion: &Motion) -> [[f64; 3]; 3] {
    let [(sx, cx), (sy, cy), (sz, cz)] = motion.angles.map(sincos);
    let rotation = [
        [cz * cy, (cz * sy) * sx - sz * cx, (cz * sy) * cx + sz * sx],
        [sz * cy, (sz * sy) * sx + cz * cx, (sz * sy) * cx - cz * sx],
        [-sy, cy * sx, cy * cx],
    ];
    let [xy, xz, yz] = motion.shear;
    rotation.map(|row| {
        let p = [0, 1, 2].map(|axis| row[axis] * motion.scale[axis]);
        [p[0], p[0] * xy + p[1], (p[0] * xz + p[1] * yz) + p[2]]
    })
}

/// A by rows, and b.
pub(crate) type Transform = ([[f64; 3]; 3], [f64; 3]);

/// 8.3: A and b of a node.
pub(crate) fn transform(node: &Node, motion: &Motion) -> Transform {
    let a = matrix(motion);
    let n = node.position.map(|coordinate| coordinate as f64);
    let mut b = [0.0; 3];
    for i in 0..3 {
        let moved = (node.position[i] + motion.translation[i]) as f64;
        b[i] = moved - ((a[i][0] * n[0] + a[i][1] * n[1]) + a[i][2] * n[2]);
    }
    (a, b)
}

/// 8.4: a vertex's new reference position; `None` outside the range.
pub(crate) fn blend(
    x: [i64; 3],
    slots: &Slots,
    transforms: &[Transform],
    fraction_bits: u32,
) -> Option<[i64; 3]> {
    let x = x.map(|coordinate| coordinate as f64);
    let bound = (1_i64 << (20 + fraction_bits)) as f64 - 0.5;
    let mut position = [0; 3];
    for i in 0..3 {
        let mut sum = 0.0;
        for &(node, weight) in slots {
            let (a, b) = &transforms[node];
            sum += weight * (((a[i][0] * x[0] + a[i][1] * x[1]) + a[i][2] * x[2]) + b[i]);
        }
        if sum.abs() >= bound || sum.is_nan() {
            return None;
        }
        position[i] = sum.round_ties_even() as i64;
    }
    Some(position)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polynomials_are_sine_cosine_and_exponential() {
        for step in -4000..=4000 {
            let angle = f64::from(step) / 1000.0;
            let (sine, cosine) = sincos(angle);
            assert!((sine - libm::sin(angle)).abs() < 2e-15, "sin {angle}");
            assert!((cosine - libm::cos(angle)).abs() < 2e-15, "cos {angle}");
            let x = 8.0 * (angle + 4.0);
            assert!((expneg(x) / libm::exp(-x) - 1.0).abs() < 2e-15, "exp −{x}");
        }
    }
}
