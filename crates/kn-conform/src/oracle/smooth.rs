//! 8.5, written out.

use std::collections::BTreeMap;

/// μ and ω of the strengths 1 to 5.
pub(super) const STRENGTHS: [(f64, f64); 5] =
    [(0.125, 0.875), (0.25, 0.75), (0.5, 0.625), (1.0, 0.4375), (2.0, 0.28125)];

/// Positions (#V × 3) of a decoded I-frame to its reference.
pub(super) fn smooth(
    decoded: &[[i64; 3]],
    faces: &[[u32; 3]],
    strength: usize,
    half_step: i64,
) -> Vec<[i64; 3]> {
    if strength == 0 {
        return decoded.to_vec();
    }
    let (mu, omega) = STRENGTHS[strength - 1];
    let neighbours = neighbours(decoded.len(), faces);
    let y: Vec<[f64; 3]> = decoded.iter().map(|v| v.map(|c| c as f64)).collect();
    let mut x = y.clone();
    for _pass in 0..3 {
        let m = umbrella(&umbrella(&x, &neighbours), &neighbours);
        for v in 0..x.len() {
            for i in 0..3 {
                x[v][i] += omega * ((y[v][i] - x[v][i]) - mu * m[v][i]);
            }
        }
    }
    let half = half_step as f64;
    let place = |v: usize, i: usize| {
        let moved = (x[v][i] - y[v][i]).max(-half).min(half);
        decoded[v][i] + moved.round_ties_even() as i64
    };
    (0..x.len()).map(|v| [place(v, 0), place(v, 1), place(v, 2)]).collect()
}

/// N(v), empty for a vertex that stays.
fn neighbours(vertex_count: usize, faces: &[[u32; 3]]) -> Vec<Vec<usize>> {
    // How often each other vertex follows or precedes this one around a face.
    let mut meetings = vec![BTreeMap::<usize, u32>::new(); vertex_count];
    for face in faces {
        for k in 0..3 {
            let (a, b) = (face[k] as usize, face[(k + 1) % 3] as usize);
            *meetings[a].entry(b).or_default() += 1;
            *meetings[b].entry(a).or_default() += 1;
        }
    }
    let ring = |met: BTreeMap<usize, u32>| {
        if met.values().all(|&times| times == 2) { met.into_keys().collect() } else { Vec::new() }
    };
    meetings.into_iter().map(ring).collect()
}

/// U(f): what lies between a value and the mean of its neighbours.
fn umbrella(f: &[[f64; 3]], neighbours: &[Vec<usize>]) -> Vec<[f64; 3]> {
    let at = |v: usize, i: usize| {
        if neighbours[v].is_empty() {
            return 0.0;
        }
        let mut sum = 0.0;
        for &n in &neighbours[v] {
            sum += f[n][i];
        }
        sum / neighbours[v].len() as f64 - f[v][i]
    };
    (0..f.len()).map(|v| [at(v, 0), at(v, 1), at(v, 2)]).collect()
}
