//! Areas, normals, borders and edges of a triangle mesh.

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

/// The lower and the higher vertex of an edge, and the number of faces that have it.
pub(crate) type Edge = (u32, u32, u32);

/// The undirected edges of a mesh, each once, in rising order.
pub(crate) fn edges(faces: &[[u32; 3]]) -> Vec<Edge> {
    // Both vertices in one number sort twice as fast as a pair.
    let mut halves: Vec<u64> = faces
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
        .filter(|&(a, b)| a != b)
        .map(|(a, b)| u64::from(a.min(b)) << 32 | u64::from(a.max(b)))
        .collect();
    halves.sort_unstable();
    let mut edges: Vec<Edge> = Vec::with_capacity(halves.len() / 2);
    for half in halves {
        let (a, b) = ((half >> 32) as u32, half as u32);
        match edges.last_mut() {
            Some(last) if (last.0, last.1) == (a, b) => last.2 += 1,
            _ => edges.push((a, b, 1)),
        }
    }
    edges
}

/// `#V`, whether a vertex lies on an edge that only one face has.
pub(crate) fn boundary_vertices(vertex_count: usize, edges: &[Edge]) -> Vec<bool> {
    let mut boundary = vec![false; vertex_count];
    for &(a, b, faces) in edges {
        if faces == 1 {
            boundary[a as usize] = true;
            boundary[b as usize] = true;
        }
    }
    boundary
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
