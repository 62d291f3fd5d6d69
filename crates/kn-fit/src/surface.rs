//! Areas and normals of a triangle mesh.

use kn_mesh::vec3::{Vec3, add, cross, norm, sub, unit};

/// Twice the area of a face, along its normal.
pub(crate) fn face_cross(positions: &[Vec3], face: [u32; 3]) -> Vec3 {
    let [a, b, c] = face.map(|v| positions[v as usize]);
    cross(sub(b, a), sub(c, a))
}

/// `#V` unit normals, faces weighted by area; zero where a vertex has no face with an area.
pub(crate) fn vertex_normals(positions: &[Vec3], faces: &[[u32; 3]], normals: &mut Vec<Vec3>) {
    normals.clear();
    normals.resize(positions.len(), [0.0; 3]);
    for &face in faces {
        let normal = face_cross(positions, face);
        for v in face {
            normals[v as usize] = add(normals[v as usize], normal);
        }
    }
    for normal in normals {
        *normal = unit(*normal);
    }
}

/// `#V`, a third of the area of the faces around each vertex.
pub(crate) fn vertex_areas(positions: &[Vec3], faces: &[[u32; 3]]) -> Vec<f64> {
    let mut areas = vec![0.0; positions.len()];
    for &face in faces {
        let share = norm(face_cross(positions, face)) / 6.0;
        for v in face {
            areas[v as usize] += share;
        }
    }
    areas
}

/// The diagonal of the axis-aligned box.
pub(crate) fn diagonal(positions: &[Vec3]) -> f64 {
    let side = |axis: usize| {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for position in positions {
            low = low.min(position[axis]);
            high = high.max(position[axis]);
        }
        high - low
    };
    norm([side(0), side(1), side(2)])
}
