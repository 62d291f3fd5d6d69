//! Change of MSDM2 when nothing but the order of faces or the place in space changes, for the
//! oracle's pairs that are not within its tolerances:
//! `cargo run --release -p kn-lab -- ties`. `docs/data.md` says what the oracle is.

use anyhow::{Result, ensure};
use std::path::Path;

use kn_metrics::{DEFAULT_LEVELS, Interpolation, Msdm2Surface, msdm2};

const ORDERS: u32 = 20;

type Mesh = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// Name, original and reference scores: AtVertex, projected.
const PAIRS: [(&str, &str, [f64; 2]); 6] = [
    ("spot_translate_2", "spot", [0.62470332348, 0.613301301681]),
    ("spot_rot90", "spot", [0.641629234047, 0.638277684936]),
    ("spot_noise_n_0p003_x1e3", "spot_noise_n_0p003_x1e3_ref", [0.581173477949, 0.590619956827]),
    ("spot_noise_n_0p003_x1em6", "spot_noise_n_0p003_x1em6_ref", [0.558941724897, 0.569439278491]),
    ("multi_noise_n_0p002", "multi", [0.702443200406, 0.710071323817]),
    ("torus_scale2", "torus", [0.142797851801, 0.149620328223]),
];

pub(crate) fn run(arguments: &[String]) -> Result<()> {
    ensure!(arguments.is_empty(), "usage: ties");
    let Some(folder) = kn_testdata::oracle() else { return Ok(()) };
    println!(
        "pair, interpolation: reference | ours | over {ORDERS} orders | over {ORDERS} motions"
    );
    for (name, original, reference) in PAIRS {
        let read = |name: &str| read_off(&folder.join(format!("meshes/{name}.off")));
        let (a, b) = (read(original)?, read(name)?);
        let step = 0.01 * a.0.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        for (interpolation, reference) in
            [Interpolation::AtVertex, Interpolation::Projected].into_iter().zip(reference)
        {
            let score = |a: &Mesh, b: &Mesh| -> Result<f64> {
                let surface = |mesh: &Mesh| Msdm2Surface::new(&mesh.0, &mesh.1, DEFAULT_LEVELS);
                Ok(msdm2(&surface(a)?, &surface(b)?, interpolation).symmetric)
            };
            let ours = score(&a, &b)?;
            let orders =
                range((0..ORDERS).map(|seed| score(&ordered(&a, seed), &ordered(&b, seed))))?;
            let motions = range(
                (0..ORDERS).map(|seed| score(&moved(&a, seed, step), &moved(&b, seed, step))),
            )?;
            println!(
                "{name}, {interpolation:?}: {reference:.7} | {ours:.7} | {:.7}..{:.7} | {:.7}..{:.7}",
                orders[0], orders[1], motions[0], motions[1]
            );
        }
    }
    Ok(())
}

fn range(scores: impl Iterator<Item = Result<f64>>) -> Result<[f64; 2]> {
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for score in scores {
        let score = score?;
        range = [range[0].min(score), range[1].max(score)];
    }
    Ok(range)
}

/// An OFF file of triangles, in binary64.
fn read_off(path: &Path) -> Result<Mesh> {
    let text = std::fs::read_to_string(path)?;
    let numbers: Result<Vec<f64>, _> =
        text.split_ascii_whitespace().skip(1).map(str::parse).collect();
    let numbers = numbers?;
    let (vertices, faces) = (numbers[0] as usize, numbers[1] as usize);
    let (positions, rest) = numbers[3..].split_at(3 * vertices);
    let positions = positions.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    let faces = rest.chunks_exact(4).take(faces).map(|f| [f[1], f[2], f[3]].map(|i| i as u32));
    Ok((positions, faces.collect()))
}

fn mixed(seed: u32, index: u32) -> u32 {
    let mixed = (index ^ seed.wrapping_mul(0x85eb_ca6b)).wrapping_add(1).wrapping_mul(0x9e37_79b9);
    let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x85eb_ca6b);
    mixed ^ (mixed >> 13)
}

/// The same faces in another order, each from another of its corners.
fn ordered(mesh: &Mesh, seed: u32) -> Mesh {
    let mut faces: Vec<(u32, [u32; 3])> = mesh
        .1
        .iter()
        .copied()
        .enumerate()
        .map(|(i, mut face)| {
            let key = mixed(seed, i as u32);
            face.rotate_left((key % 3) as usize);
            (key, face)
        })
        .collect();
    faces.sort_unstable();
    (mesh.0.clone(), faces.into_iter().map(|(_, face)| face).collect())
}

/// The same mesh with its axes exchanged in turn and moved by `step` a seed: only rounding changes.
fn moved(mesh: &Mesh, seed: u32, step: f64) -> Mesh {
    let turn = seed as usize % 3;
    let shift = step * f64::from(seed);
    let position = |p: &[f64; 3]| [0, 1, 2].map(|axis| p[(axis + turn) % 3] + shift);
    (mesh.0.iter().map(position).collect(), mesh.1.clone())
}
