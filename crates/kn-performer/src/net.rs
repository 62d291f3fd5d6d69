//! The surface as a surface net over the lattice: a vertex in every cell that the surface passes,
//! and a quad around every lattice edge that it cuts. Then each vertex is moved onto the zero of
//! the field.

use super::field::{Scene, value_and_gradient};
use super::lattice::{LEAF, Lattice, NONE, SIDE, local, octant};
use glam::DVec3;
use kn_mesh::VertexMap;
use kn_mesh::adjacency::Components;
use rayon::prelude::*;

/// Corners of a cell's twelve edges.
const EDGES: [[usize; 2]; 12] = [
    [0, 1],
    [2, 3],
    [4, 5],
    [6, 7], // along x
    [0, 2],
    [1, 3],
    [4, 6],
    [5, 7], // along y
    [0, 4],
    [1, 5],
    [2, 6],
    [3, 7], // along z
];

/// A closed triangle mesh, before scanning.
#[derive(Clone, Debug, Default)]
pub(super) struct Surface {
    pub(super) positions: Vec<DVec3>,
    pub(super) normals: Vec<DVec3>,
    pub(super) faces: Vec<[u32; 3]>,
    /// The lattice leaf that knows which primitives matter at each vertex.
    pub(super) leaves: Vec<u32>,
}

impl Surface {
    /// Keeps the pieces of surface with at least `share` of all vertices: what a scanner sees, not
    /// the walls of voids between leg and tunic.
    pub(super) fn keep_large_pieces(&mut self, share: f64) {
        let pieces = Components::new(self.positions.len(), &self.faces);
        let mut sizes = vec![0_usize; pieces.count];
        for &piece in pieces.of_vertex.iter().filter(|&&piece| piece != Components::ISOLATED) {
            sizes[piece as usize] += 1;
        }
        let least = (share * self.positions.len() as f64) as usize;
        let piece = |face: &[u32; 3]| pieces.of_vertex[face[0] as usize] as usize;
        self.faces.retain(|face| sizes[piece(face)] >= least);
    }

    /// Drops vertices without a face.
    pub(super) fn compact(&mut self) {
        let used = VertexMap::of_used(self.positions.len(), &self.faces);
        self.positions = used.gather(&self.positions);
        self.normals = used.gather(&self.normals);
        self.leaves = used.gather(&self.leaves);
        used.renumber(&mut self.faces);
    }
}

/// Index of the vertex in every cell, or [`NONE`].
struct Cells {
    vertex: Vec<[u32; LEAF]>,
}

/// The surface of a well-composed lattice.
pub(super) fn extract(scene: &Scene, lattice: &Lattice) -> Surface {
    let per_leaf: Vec<Vec<(usize, DVec3, DVec3)>> = (0..lattice.leaves.len())
        .into_par_iter()
        .map(|leaf| leaf_vertices(scene, lattice, leaf))
        .collect();
    let mut surface = Surface::default();
    let mut cells = Cells { vertex: vec![[NONE; LEAF]; lattice.leaves.len()] };
    for (leaf, vertices) in per_leaf.into_iter().enumerate() {
        for (cell, position, normal) in vertices {
            cells.vertex[leaf][cell] = surface.positions.len() as u32;
            surface.positions.push(position);
            surface.normals.push(normal);
            surface.leaves.push(leaf as u32);
        }
    }
    surface.faces = (0..lattice.leaves.len())
        .into_par_iter()
        .flat_map_iter(|leaf| leaf_faces(lattice, &cells, &surface.positions, leaf))
        .collect();
    surface
}

fn leaf_vertices(scene: &Scene, lattice: &Lattice, leaf: usize) -> Vec<(usize, DVec3, DVec3)> {
    let known = &lattice.leaves[leaf];
    let vertex = |(cell, values): (usize, [f64; 8])| {
        let at = local(cell);
        let corner = [0, 1, 2].map(|a| known.key[a] * SIDE + at[a]);
        let across = lattice.frame.rotation * (crossing(&values) * lattice.step);
        let start = lattice.point(corner) + across;
        let (position, normal) = drawn(scene, &known.candidates, start, lattice.step);
        (cell, position, normal)
    };
    lattice.cut_cells(leaf).map(vertex).collect()
}

/// Mean of the points where the surface cuts the cell's edges, in cell units.
fn crossing(values: &[f64; 8]) -> DVec3 {
    let corner = |i: usize| octant([0; 3], i as i32).map(f64::from);
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    for [a, b] in EDGES {
        if (values[a] < 0.0) != (values[b] < 0.0) {
            let share = values[a] / (values[a] - values[b]);
            sum += DVec3::from(corner(a)).lerp(DVec3::from(corner(b)), share);
            count += 1.0;
        }
    }
    sum / f64::max(count, 1.0)
}

/// One Newton step onto the surface, and the normal there. Half a cell is as far as it may go:
/// more would fold the net where the field is rougher than the lattice.
fn drawn(scene: &Scene, candidates: &[u16], start: DVec3, step: f64) -> (DVec3, DVec3) {
    let (value, gradient) = value_and_gradient(start, |at| scene.value(at, candidates));
    let normal = gradient.normalize_or(DVec3::Y);
    let way = value / gradient.length().max(0.3);
    (start - normal * way.clamp(-0.5 * step, 0.5 * step), normal)
}

fn leaf_faces(lattice: &Lattice, cells: &Cells, positions: &[DVec3], leaf: usize) -> Vec<[u32; 3]> {
    let mut faces = Vec::new();
    // An edge is cut only where a cell of this leaf is: the edge's lower end is the cell's corner.
    let places = if lattice.is_cut(leaf) { 0..LEAF } else { 0..0 };
    for place in places {
        let inside = lattice.leaves[leaf].values[place] < 0.0;
        for axis in 0..3 {
            if let Some(quad) = quad(lattice, cells, leaf, place, axis) {
                let ring = if inside { quad } else { [quad[3], quad[2], quad[1], quad[0]] };
                faces.extend(halves(ring, positions));
            }
        }
    }
    faces
}

/// The vertices of the four cells around the lattice edge from `place` along `axis`, seen
/// anticlockwise from the edge's far end; `None` where the surface does not cut the edge.
fn quad(
    lattice: &Lattice,
    cells: &Cells,
    leaf: usize,
    place: usize,
    axis: usize,
) -> Option<[u32; 4]> {
    if !lattice.cuts(leaf, place, axis) {
        return None;
    }
    let at = local(place);
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut ring = [NONE; 4];
    for (slot, (back_u, back_v)) in ring.iter_mut().zip([(1, 1), (0, 1), (0, 0), (1, 0)]) {
        let mut cell = at;
        cell[u] -= back_u;
        cell[v] -= back_v;
        let (leaf, cell) = lattice.find(leaf, cell)?;
        *slot = cells.vertex[leaf][cell];
        if *slot == NONE {
            return None;
        }
    }
    Some(ring)
}

/// Two triangles of a quad, cut along its shorter diagonal.
fn halves([a, b, c, d]: [u32; 4], positions: &[DVec3]) -> [[u32; 3]; 2] {
    let length = |i: u32, j: u32| (positions[i as usize] - positions[j as usize]).length_squared();
    if length(a, c) <= length(b, d) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
}
