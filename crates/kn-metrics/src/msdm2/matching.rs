//! The face of the original that a vertex belongs to, and the interpolation of curvature there.

use super::Msdm2Surface;
use crate::tree::Closest;
use kn_mesh::vec3::{Vec3, norm, sub};

/// The closest points with the faces that MSDM2 prefers.
///
/// Of equally close faces the lowest is taken, except at a corner, where a face that starts with
/// this corner goes first. The reference starts its search from the first corners of all faces and
/// keeps the face of the nearest one; in its published matches no such vertex has another face.
pub(super) fn preferred(original: &Msdm2Surface, matches: &[Closest]) -> Vec<Closest> {
    let preferred = |&closest: &Closest| {
        let face = original.faces[closest.face as usize];
        let corner = closest.barycentric.iter().position(|&weight| weight == 1.0);
        match corner.and_then(|corner| original.first_faces[face[corner] as usize]) {
            Some(face) => Closest { face, barycentric: [1.0, 0.0, 0.0], ..closest },
            None => closest,
        }
    };
    matches.iter().map(preferred).collect()
}

/// Weights of a matched face's corners: the areas that the vertex forms with the opposite sides,
/// by Heron's formula as in the reference, over their sum. Equal weights if all are zero.
pub(super) fn opposite_areas(original: &Msdm2Surface, closest: &Closest, vertex: Vec3) -> Vec3 {
    let [a, b, c] = original.faces[closest.face as usize].map(|v| original.positions[v as usize]);
    let to = [a, b, c].map(|corner| norm(sub(corner, vertex)));
    let areas = [
        heron(to[1], to[2], norm(sub(c, b))),
        heron(to[2], to[0], norm(sub(a, c))),
        heron(to[0], to[1], norm(sub(b, a))),
    ];
    let whole = areas[0] + areas[1] + areas[2];
    if whole > 0.0 { areas.map(|area| area / whole) } else { [1.0 / 3.0; 3] }
}

fn heron(a: f64, b: f64, c: f64) -> f64 {
    let half = 0.5 * (a + b + c);
    (half * (half - a) * (half - b) * (half - c)).max(0.0).sqrt()
}
