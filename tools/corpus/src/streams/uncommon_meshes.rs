//! I-frames that tell readings of chapters 4 and 5 apart which no scan tells apart.

use anyhow::Result;

use kn_bitstream::range::{
    BinaryCoder, BitModel, GammaModels, RAW_LIMIT, RangeEncoder, code_gamma,
};
use kn_mesh::GridMesh;

use super::Draft;
use super::shapes::{
    Faces, Noise, bipyramid, crowd, curled, handles, knotted, mesh, sphere, together, torus,
    turned_edges, without_vertex,
};
use super::texts::{HEADER, INDEX, intra_unit, payload_of};

/// The largest coordinate.
const EDGE: i32 = (1 << 20) - 1;

pub(crate) fn drafts() -> Result<Vec<Draft>> {
    Ok(vec![
        lattices()?,
        written(
            "waiting",
            "The order in which half-edges wait after a jump; two edges between the same vertices, so that a \
             neighbour votes twice.",
            &["intra.connectivity.add", "intra.connectivity.gate", "intra.labels.vote"],
            include_str!("waiting.txt"),
        ),
        written(
            "joined_neighbours",
            "Points of many copies, two of them in one triangle: which is settled before which is known.",
            &["intra.join.twins", "intra.geometry.twins", "intra.geometry.order"],
            include_str!("joined_neighbours.txt"),
        ),
        groups(
            "high_valences",
            "Vertices of 33, 40, 70 and 100 triangles: 32 half-edges predict, valences count up to 64, \
             all neighbours vote on a label; a hole of 100 sides.",
            &[
                "intra.geometry.ring",
                "intra.geometry.blend",
                "intra.labels.vote",
                "intra.labels.border",
            ],
            &high_valences(),
        )?,
        groups(
            "twins",
            "Points of up to six surfaces: twins become known and are settled one by one.",
            &["intra.join", "intra.join.twins", "intra.geometry.twins", "intra.labels.order"],
            &many_twins(),
        )?,
        groups(
            "handles",
            "Surfaces of genus 2 to 6 with turned edges: where half-edges wait after a jump, and that \
             each side of a triangle supports a tip, the same one too.",
            &["intra.connectivity.add", "intra.connectivity.gate", "intra.geometry.order"],
            &surfaces_with_handles(),
        )?,
        groups(
            "crowded",
            "Surfaces of genus 36 to 66 on which every vertex lacks 16 triangles or more for long: what waits \
             after a jump, when the last stack holds all.",
            &["intra.connectivity.add", "intra.connectivity.gate"],
            &crowds(),
        )?,
        groups(
            "extremes",
            "Coordinates at both ends of the grid: the longest errors, and an expectation beyond it.",
            &["intra.geometry.error", "intra.geometry.coordinate", "intra.geometry.range"],
            &extremes(),
        )?,
        groups(
            "flat",
            "All vertices in one place, or in a plane: sums of zero and a normal of zero.",
            &["intra.geometry.frame", "intra.geometry.spread"],
            &flat(),
        )?,
    ])
}

/// A stream whose text was made by another encoder: surfaces that ours takes apart.
fn written(name: &str, danger: &str, covers: &'static [&'static str], text: &str) -> Draft {
    Draft { name: name.into(), text: text.into(), danger: danger.into(), rule: None, covers }
}

/// A stream of GoFs of one frame each, with labels where the meshes have them.
pub(crate) fn groups(
    name: &str,
    danger: &str,
    covers: &'static [&'static str],
    meshes: &[GridMesh],
) -> Result<Draft> {
    let payloads = meshes.iter().map(payload_of).collect::<Result<Vec<_>, _>>()?;
    let labelled = meshes.iter().all(|mesh| !mesh.labels.is_empty());
    Ok(frames(name, danger, covers, &payloads, labelled))
}

fn frames(
    name: &str,
    danger: &str,
    covers: &'static [&'static str],
    payloads: &[Vec<u8>],
    labelled: bool,
) -> Draft {
    let units: String = payloads.iter().map(|payload| intra_unit(payload)).collect();
    let header = HEADER.replace("label_set = 1", &format!("label_set = {}", u8::from(labelled)));
    let text = format!("{header}{units}{INDEX}");
    Draft { name: name.into(), text, danger: danger.into(), rule: None, covers }
}

/// Labels without any order.
pub(crate) fn noise_labels(count: usize) -> impl FnMut(u32) -> u8 {
    let mut noise = Noise::new(5);
    move |_| noise.below(count) as u8
}

fn high_valences() -> Vec<GridMesh> {
    let parts = [bipyramid(100), bipyramid(33), bipyramid(40), sphere(70, 2)];
    let patches = &mut |v: u32| (v / 7 % 12) as u8;
    let pyramid = |v: u32| match v {
        100 => [0, 0, 3000],
        101 => [0, 0, -3000],
        _ => {
            let turn = f64::from(v) * std::f64::consts::TAU / 100.0;
            [libm::cos(turn), libm::sin(turn), 0.001 * f64::from(v % 5)]
                .map(|x| (x * 2000.0) as i32)
        }
    };
    let open = without_vertex(&parts[0], 100);
    vec![
        mesh(together(&parts), |v| curled(v, 5000.0, 500), Some(&mut noise_labels(12))),
        mesh(together(&[open, parts[3].clone()]), |v| curled(v, 200.0, 5), Some(patches)),
        mesh(parts[0].clone(), pyramid, Some(&mut noise_labels(3))),
    ]
}

fn many_twins() -> Vec<GridMesh> {
    let mut noise = Noise::new(1);
    let first = knotted(together(&[torus(6, 7), sphere(5, 3)]), &[6, 3, 2, 3, 5], &mut noise);
    let parts = together(&[sphere(5, 3), sphere(4, 4), bipyramid(40)]);
    let second = knotted(parts, &[4; 8], &mut noise);
    let third = knotted(handles(4, 4, 5), &[3; 9], &mut noise);
    vec![
        mesh(first, |v| curled(v, 3000.0, 100), Some(&mut noise_labels(5))),
        mesh(second, |v| curled(v, 400.0, 9), Some(&mut |v: u32| (v / 7 % 4) as u8)),
        mesh(third, |v| curled(v, 500.0, 9), Some(&mut noise_labels(2))),
    ]
}

fn surfaces_with_handles() -> Vec<GridMesh> {
    let build = |(seed, count): (u64, u32)| {
        let mut noise = Noise::new(seed);
        let size = |noise: &mut Noise| 3 + noise.below(4) as u32;
        let faces = handles(count, size(&mut noise) + 1, size(&mut noise) + 1);
        let turns = noise.below(300);
        let faces = turned_edges(faces, turns, &mut noise);
        mesh(faces, |v| curled(v, 500.0, 9), Some(&mut noise_labels(3)))
    };
    [(1, 2), (2, 4), (3, 6), (4, 6), (5, 5), (6, 3), (7, 6), (8, 4)].map(build).into()
}

/// After a jump the second gate comes first as a rule, and brings `before(e)` back; not where more than 15
/// triangles are lacking everywhere.
fn crowds() -> Vec<GridMesh> {
    let mut noise = Noise::new(9);
    let mut build = |(size, turns): (u32, usize)| {
        let faces = turned_edges(crowd(size), turns, &mut noise);
        mesh(faces, |v| curled(v, 500.0, 9), None)
    };
    vec![build((10, 0)), build((12, 5)), build((13, 200))]
}

fn extremes() -> Vec<GridMesh> {
    let mut noise = Noise::new(77);
    let mut corner = |_| {
        [(); 3].map(|()| {
            let inside = if noise.below(4) == 0 { noise.below(1 << 20) as i32 } else { 0 };
            (EDGE - inside) * if noise.below(2) == 0 { 1 } else { -1 }
        })
    };
    let mut corners = mesh(torus(9, 10), &mut corner, None);
    corners.positions.extend([[EDGE; 3], [-EDGE; 3], [EDGE, -EDGE, 0]]);
    let mut noise = Noise::new(78);
    let far = |_| {
        let end = if noise.below(2) == 0 { EDGE } else { -EDGE };
        [EDGE - noise.below(3) as i32, noise.below(30) as i32 - EDGE, end]
    };
    vec![corners, mesh(torus(9, 10), far, None)]
}

/// Triangles so large that errors of a few steps are far below what they let expect.
fn nearly_plane(vertex: u32) -> [i32; 3] {
    let mut noise = Noise::new(u64::from(vertex) + 1);
    [3000 * (vertex % 12) as i32, 3000 * (vertex / 12) as i32, noise.around(3)]
}

fn flat() -> Vec<GridMesh> {
    let row = |width: u32, step: u32| {
        move |v: u32| [v % width * step, 0, v / width * step].map(|x| x as i32)
    };
    let plane: Faces = torus(6, 6);
    vec![
        mesh(plane.clone(), |_| [5, -7, 9], None),
        mesh(plane, row(6, 100), None),
        mesh(sphere(8, 5), row(8, 1), None),
        mesh(torus(12, 12), nearly_plane, None),
    ]
}

/// A lattice as the encoder finds it, and one that it never would.
fn lattices() -> Result<Draft> {
    let heights = |i: u32, j: u32| (3 * i + 5 * j + i * j) % 20;
    let at = |v: u32| [v / 20, heights(v / 20, v % 20), v % 20].map(|x| 5 * x as i32 - 31);
    let quads = (0..19).flat_map(|i| (0..19).map(move |j| 20 * i + j));
    let faces = quads.flat_map(|a| [[a, a + 20, a + 21], [a, a + 21, a + 1]]).collect();
    let found = payload_of(&mesh(faces, at, None))?;
    assert_eq!(found[0] & 2, 2, "the encoder finds the lattice");
    let strange = lattice_payload(
        [
            &[-EDGE, -EDGE + 9, 0, 1, 2, 4, 7, 11, 19, 28, 300_000, EDGE],
            &[5],
            &[-3, 4, 5, 13, 14, 1000],
        ],
        &[[0, 0, 0], [11, 0, 5], [10, 0, 2], [3, 0, 2], [3, 0, 2], [9, 0, 4]].repeat(2),
    );
    Ok(frames(
        "lattice",
        "Each axis has its list of values and one value may be all; gaps above 8 are escaped, one of \
         2^19 in two parts; what is predicted are ranks.",
        &["intra.geometry.lattice", "intra.geometry.isolated", "range.gamma"],
        &[found, strange],
        false,
    ))
}

/// A payload of isolated vertices at `ranks` in the lists of `values`.
pub(crate) fn lattice_payload(values: [&[i32]; 3], ranks: &[[i32; 3]]) -> Vec<u8> {
    let mut geometry = Vec::new();
    let mut coder = RangeEncoder::new(&mut geometry);
    write_lists(&mut coder, values);
    let mut errors = Errors::default();
    let mut last = [0; 3];
    for rank in ranks {
        for axis in 0..3 {
            errors.write(&mut coder, rank[axis] - last[axis]);
        }
        last = *rank;
    }
    coder.finish();
    let mut payload = vec![2, 0];
    let count = ranks.len() as u8;
    // Vertices, all of them isolated; nothing else but the geometry, in less than 128 bytes.
    payload.extend([count, count, 0, 0, 0, 0, 0, geometry.len() as u8, 0]);
    payload.extend(geometry);
    payload
}

fn write_lists(coder: &mut RangeEncoder<'_>, values: [&[i32]; 3]) {
    let mut counts = GammaModels::default();
    let mut escaped = GammaModels::default();
    let mut longer = [[[BitModel::default(); 8]; 9]; 9];
    for values in values {
        code_gamma(coder, &mut counts, values.len() as u32);
        let least = (values.first().unwrap_or(&0) + (1 << 20)) as u32;
        coder.raw(least >> RAW_LIMIT, 5);
        coder.raw(least, RAW_LIMIT);
        let [mut near, mut far] = [0; 2];
        for pair in values.windows(2) {
            let gap = (pair[1] - pair[0]) as usize;
            for (at, model) in (1..).zip(&mut longer[near][far]) {
                if !coder.bit(model, gap > at) {
                    break;
                }
            }
            if gap > 8 {
                code_gamma(coder, &mut escaped, gap as u32 - 9);
            }
            [near, far] = [gap.min(8), near];
        }
    }
}

/// The models of unsupported vertices (`intra.geometry.error`).
#[derive(Default)]
struct Errors {
    is_zero: BitModel,
    is_negative: BitModel,
    longer: [BitModel; 22],
    second: [BitModel; 22],
    third: [[BitModel; 2]; 22],
}

impl Errors {
    /// For errors of at most 18 bits.
    fn write(&mut self, coder: &mut RangeEncoder<'_>, error: i32) {
        if coder.bit(&mut self.is_zero, error == 0) {
            return;
        }
        coder.bit(&mut self.is_negative, error < 0);
        let value = error.unsigned_abs();
        let n = value.ilog2() as usize;
        for place in 0..=n {
            coder.bit(&mut self.longer[place], place < n);
        }
        let second = n > 0 && coder.bit(&mut self.second[n], value >> (n - 1) & 1 == 1);
        if n > 1 {
            coder.bit(&mut self.third[n][usize::from(second)], value >> (n - 2) & 1 == 1);
            coder.raw(value, n as u32 - 2);
        }
    }
}
