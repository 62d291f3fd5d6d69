//! Small meshes for the corpus.

use kn_mesh::Mesh;

/// A coordinate as a scanner's file has it: rounded to binary32.
fn single(x: f64) -> f64 {
    f64::from(x as f32)
}

/// A stretched sphere of `rings` × `sectors` vertices and two poles, 2 high about the origin.
pub(crate) fn ellipsoid(rings: u32, sectors: u32) -> Mesh {
    use std::f64::consts::{PI, TAU};
    let mut mesh = Mesh::default();
    mesh.positions.push([0.0, 1.0, 0.0]);
    for ring in 1..=rings {
        let polar = PI * f64::from(ring) / f64::from(rings + 1);
        for sector in 0..sectors {
            let around = TAU * f64::from(sector) / f64::from(sectors);
            let (sin, cos) = (libm::sin(polar), libm::cos(polar));
            let (x, z) = (0.5 * sin * libm::cos(around), 0.3 * sin * libm::sin(around));
            mesh.positions.push([x, cos, z].map(single));
        }
    }
    mesh.positions.push([0.0, -1.0, 0.0]);
    let at = |ring: u32, sector: u32| 1 + ring * sectors + sector % sectors;
    let last = rings * sectors + 1;
    for sector in 0..sectors {
        mesh.faces.push([0, at(0, sector + 1), at(0, sector)]);
        for ring in 0..rings - 1 {
            let [a, b] = [at(ring, sector), at(ring, sector + 1)];
            let [c, d] = [at(ring + 1, sector), at(ring + 1, sector + 1)];
            mesh.faces.extend([[a, b, d], [a, d, c]]);
        }
        mesh.faces.push([last, at(rings - 1, sector), at(rings - 1, sector + 1)]);
    }
    mesh
}

/// A closed surface of genus 1.
pub(crate) fn torus(around: u32, across: u32) -> Mesh {
    use std::f64::consts::TAU;
    let mut mesh = Mesh::default();
    for i in 0..around {
        for j in 0..across {
            let (u, v) = (f64::from(i) / f64::from(around), f64::from(j) / f64::from(across));
            let radius = 1.0 + 0.4 * libm::cos(TAU * v);
            let (x, z) = (radius * libm::cos(TAU * u), radius * libm::sin(TAU * u));
            mesh.positions.push([x, 0.4 * libm::sin(TAU * v), z].map(single));
            let at = |i: u32, j: u32| i % around * across + j % across;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            mesh.faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// Labels by height and side: head, torso, left and right thigh.
pub(crate) fn label(mesh: &mut Mesh) {
    let label = |[x, y, _]: &[f64; 3]| match (*y, *x) {
        (y, _) if y > 0.6 => 0,
        (y, x) if y < -0.4 => {
            if x >= 0.0 {
                8
            } else {
                11
            }
        }
        _ => 7,
    };
    mesh.labels = mesh.positions.iter().map(label).collect();
}

/// The mesh at a time: it drifts, sways more the higher it is, and twists.
pub(crate) fn moved(mesh: &Mesh, time: f64) -> Mesh {
    let move_point = |&[x, y, z]: &[f64; 3]| {
        let angle = 0.1 * time * y;
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        let (x, z) = (cos * x + sin * z, cos * z - sin * x);
        let sway = 0.05 * libm::sin(time) * (1.0 + y);
        [x + sway, y + 0.02 * time, z * (1.0 + 0.05 * time)].map(single)
    };
    mesh.with_positions(mesh.positions.iter().map(move_point).collect())
}

/// The mesh without the faces that touch its upper pole: open, with a boundary.
pub(crate) fn opened(mesh: &Mesh) -> Mesh {
    let mut opened = mesh.clone();
    opened.retain_faces(|face| !face.contains(&0));
    opened
}

/// Two meshes in one, the second beside the first.
pub(crate) fn twins(mesh: &Mesh) -> Mesh {
    let mut both = mesh.clone();
    let count = mesh.positions.len() as u32;
    both.positions.extend(mesh.positions.iter().map(|[x, y, z]| [single(x + 1.5), *y, *z]));
    both.faces.extend(mesh.faces.iter().map(|face| face.map(|vertex| vertex + count)));
    both.labels.extend_from_slice(&mesh.labels);
    both
}

/// The mesh with another axis for each: y becomes z after one turn, x after two.
pub(crate) fn turned(mesh: &Mesh, turns: usize) -> Mesh {
    let mut turned = mesh.clone();
    turned.positions.iter_mut().for_each(|position| position.rotate_right(turns));
    turned
}
