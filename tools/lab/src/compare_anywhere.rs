//! What all metrics of two meshes cost, wherever the meshes are relative to each other:
//! `cargo run --release -p kn-lab -- compare-anywhere [VERTICES]`.

use crate::clock::cpu_seconds;
use anyhow::Result;
use kn_lab::ring::{Shape, pair};
use kn_metrics::{CompareOptions, MeshRef, Metric, compare};

/// How the second mesh of a pair is placed: its size, and the way from the first one's origin, in
/// sizes of the first one.
const PLACES: [(&str, f64, [f64; 3]); 9] = [
    ("in one place", 1.0, [0.0; 3]),
    ("a size away", 1.0, [2.0, 0.0, 0.0]),
    ("ten sizes away", 1.0, [20.0, 7.0, 3.0]),
    ("a thousand sizes away", 1.0, [2000.0, 900.0, -700.0]),
    ("a million sizes away", 1.0, [2e6, 7e5, 3e5]),
    ("a tenth in size, inside", 0.1, [0.0; 3]),
    ("a thousandth in size, inside", 1e-3, [0.0; 3]),
    ("a thousand times as large", 1e3, [0.0; 3]),
    ("a point of its own, 300 sizes away", 1.0, [0.0; 3]),
];

pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let vertices = arguments.first().map_or(Ok(50_000), |text| text.parse())?;
    println!(
        "pair                                          CPU s   P2S RMS      MSDM2    D1 dB    D2 dB"
    );
    let (ring, other) = pair(vertices);
    for (place, scale, way) in PLACES {
        let mut moved = placed(&other, scale, way);
        if place.starts_with("a point") {
            add_stray_face(&mut moved);
        }
        report(&format!("rings, {place}"), &ring, &moved)?;
    }
    let ball = sphere(vertices);
    report("spheres, a tenth in size, inside", &ball, &placed(&ball, 0.1, [0.0; 3]))?;
    report("spheres, a thousandth in size, inside", &ball, &placed(&ball, 1e-3, [0.0; 3]))?;
    let sheet = sheet(vertices);
    report("sheets, face to face, a size away", &sheet, &placed(&sheet, 1.0, NORMAL))?;
    report(
        "sheets, face to face, ten away",
        &sheet,
        &placed(&sheet, 1.0, NORMAL.map(|x| 10.0 * x)),
    )?;
    report("a cube of 12 faces and itself", &cube(), &cube())
}

fn report(name: &str, reference: &Shape, other: &Shape) -> Result<()> {
    let mesh = |shape| -> MeshRef<'_> {
        let (positions, faces): &Shape = shape;
        MeshRef::new(positions, faces)
    };
    let start = cpu_seconds();
    let found = compare(mesh(reference), mesh(other), &CompareOptions::default())?;
    let seconds = cpu_seconds() - start;
    let value = |metric| found.get(metric).unwrap_or(f64::NAN);
    println!(
        "{name:44} {seconds:6.2} {:9.4e} {:9.4} {:8.2} {:8.2}",
        value(Metric::P2sRmsWorld),
        value(Metric::Msdm2),
        value(Metric::D1Psnr),
        value(Metric::D2Psnr),
    );
    Ok(())
}

fn placed((positions, faces): &Shape, scale: f64, way: [f64; 3]) -> Shape {
    let place = |p: &[f64; 3]| [0, 1, 2].map(|axis| scale * p[axis] + way[axis]);
    (positions.iter().map(place).collect(), faces.clone())
}

fn add_stray_face((positions, faces): &mut Shape) {
    let first = positions.len() as u32;
    positions.extend([[600.0, 0.0, 0.0], [600.1, 0.0, 0.0], [600.0, 0.1, 0.0]]);
    faces.push([first, first + 1, first + 2]);
}

/// The normal of [`sheet`].
const NORMAL: [f64; 3] = [0.48, 0.6, 0.64];

/// A square of side 1 that is aligned with no axis.
fn sheet(vertices: usize) -> Shape {
    let n = (vertices as f64).sqrt() as u32;
    let (along, across) = ([0.8, 0.0, -0.6], [-0.36, 0.8, -0.48]);
    let vertex = |index: u32| {
        let (u, v) = (f64::from(index / n) / f64::from(n), f64::from(index % n) / f64::from(n));
        [0, 1, 2].map(|axis| u * along[axis] + v * across[axis])
    };
    let quads = (0..n - 1).flat_map(|i| (0..n - 1).map(move |j| i * n + j));
    let faces = quads.flat_map(|a| [[a, a + n, a + n + 1], [a, a + n + 1, a + 1]]);
    ((0..n * n).map(vertex).collect(), faces.collect())
}

/// A sphere of radius 1 without its poles.
fn sphere(vertices: usize) -> Shape {
    let n = (vertices as f64).sqrt() as u32;
    let turn = |i: f64| std::f64::consts::PI * i / f64::from(n);
    let vertex = |index: u32| {
        let (down, around) = (turn(f64::from(index / n) + 0.5), 2.0 * turn(f64::from(index % n)));
        [down.sin() * around.cos(), down.sin() * around.sin(), down.cos()]
    };
    let quads = (0..n - 1).flat_map(|i| (0..n).map(move |j| (i * n + j, i * n + (j + 1) % n)));
    let faces = quads.flat_map(|(a, b)| [[a, a + n, b + n], [a, b + n, b]]);
    ((0..n * n).map(vertex).collect(), faces.collect())
}

fn cube() -> Shape {
    let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2].map(f64::from);
    let sides =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    ((0..8).map(corner).collect(), faces.collect())
}
