//! Edges and neighbours of a triangle mesh, with what each edge adds to a curvature tensor.

use super::machine::{LANES, Machine};
use crate::lanes::lanes;
use kn_mesh::adjacency::{EdgeTable, Rows, half_edge_ends};
use kn_mesh::vec3::{Vec3, cross, dot, norm, norm_squared, scale, sub};

/// The upper triangle of a symmetric matrix, filled up with zeros: xx, xy, xz, yy, and yz, zz, 0,
/// 0.
pub(super) type Symmetric = [[f64; 4]; 2];

/// An edge as one of its vertices sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbour {
    pub(super) vertex: u32,
    pub(super) edge: u32,
}

/// Up to eight neighbours of a vertex: enough for nearly all vertices.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// The edges as vectors in units of the box's side, one coordinate after the other, in
    /// binary32. Not a number where there is no neighbour.
    along: [[f32; LANES]; 3],
    /// Their squared lengths.
    squares: [f32; LANES],
    /// The largest coordinate of all edges.
    longest: f32,
    /// Whose neighbours these are.
    from: u32,
    /// A bit for each neighbour.
    pub(super) present: u8,
    pub(super) vertices: [u32; LANES],
    pub(super) edges: [u32; LANES],
}

/// The neighbours of all vertices.
#[derive(Clone, Debug)]
pub(super) struct Topology {
    /// From world units to those of the blocks, in which the box's longest side is 1.
    pub(super) to_unit: f64,
    /// `#V` rows: the neighbours of each vertex in ascending order, each once.
    blocks: Rows<Block>,
    /// Per edge its whole contribution to the tensor: (dihedral angle / length) · e eᵀ. Zero where
    /// an edge has not exactly two faces; not finite beside a face without area.
    pub(super) tensors: Vec<Symmetric>,
}

impl Topology {
    /// Indices must be in range; a side from a vertex to itself is no edge. `side` is that of the
    /// faces' box.
    pub(super) fn new(positions: &[Vec3], faces: &[[u32; 3]], side: f64) -> Self {
        let normals: Vec<Vec3> = faces
            .iter()
            .map(|face| unit_normal(face.map(|vertex| positions[vertex as usize])))
            .collect();
        let table = EdgeTable::new(positions.len(), faces);
        let tensor = |(&[low, high], around): (&[u32; 2], &[u32])| {
            let along = sub(positions[high as usize], positions[low as usize]);
            edge_tensor(sides(faces, around), along, &normals)
        };
        let tensors = table.edges.iter().zip(table.half_edges.iter()).map(tensor).collect();
        let to_unit = side.recip();
        let blocks = blocks_of(positions, to_unit, &table);
        Self { to_unit, blocks, tensors }
    }

    /// A vertex's blocks and their indices.
    #[inline(always)]
    pub(super) fn blocks(&self, vertex: usize) -> impl Iterator<Item = (usize, &Block)> {
        let range = self.blocks.range(vertex);
        range.clone().zip(&self.blocks.values[range])
    }

    /// The two ends of an edge, given eight times its block's index plus its lane.
    #[inline(always)]
    pub(super) fn ends(&self, slot: u32) -> [usize; 2] {
        let block = &self.blocks.values[slot as usize / LANES];
        [block.from as usize, block.vertices[slot as usize % LANES] as usize]
    }

    pub(super) fn neighbours(&self, vertex: usize) -> impl Iterator<Item = Neighbour> {
        self.blocks(vertex).flat_map(|(_, block)| {
            lanes(block.present)
                .map(|lane| Neighbour { vertex: block.vertices[lane], edge: block.edges[lane] })
        })
    }

    pub(super) fn is_isolated(&self, vertex: usize) -> bool {
        self.blocks.row(vertex).is_empty()
    }
}

impl Block {
    /// One to eight neighbours of a vertex.
    fn new(positions: &[Vec3], to_unit: f64, from: usize, neighbours: &[Neighbour]) -> Self {
        let mut block = Self {
            along: [[f32::NAN; LANES]; 3],
            squares: [f32::NAN; LANES],
            longest: 0.0,
            from: from as u32,
            present: u8::MAX >> (LANES - neighbours.len()),
            vertices: [neighbours[0].vertex; LANES],
            edges: [neighbours[0].edge; LANES],
        };
        for (lane, &neighbour) in neighbours.iter().enumerate() {
            let along = scale(sub(positions[neighbour.vertex as usize], positions[from]), to_unit);
            (block.vertices[lane], block.edges[lane]) = (neighbour.vertex, neighbour.edge);
            block.squares[lane] = norm_squared(along) as f32;
            for axis in 0..3 {
                let along = along[axis] as f32;
                block.along[axis][lane] = along;
                block.longest = block.longest.max(along.abs());
            }
        }
        block
    }

    /// All edges, each times the vector to its start, in the blocks' units; and a bound on what
    /// rounding moves such a product by.
    #[inline(always)]
    pub(super) fn products<M: Machine>(&self, machine: M, to: [f32; 3]) -> (M::Numbers, f32) {
        let mut products = machine.splat(0.0);
        for axis in 0..3 {
            let along = machine.load(&self.along[axis]);
            products = machine.add(products, machine.mul(along, machine.splat(to[axis])));
        }
        let reach = to[0].abs() + to[1].abs() + to[2].abs();
        (products, 1e-6 * self.longest * reach + f32::MIN_POSITIVE)
    }

    /// A bit for each neighbour that is surely elsewhere than the edges' start.
    #[inline(always)]
    pub(super) fn apart<M: Machine>(&self, machine: M) -> u8 {
        machine.above(machine.load(&self.squares), f32::MIN_POSITIVE)
    }

    /// The excess of the neighbours' squared distances over that of the edges' start, in the
    /// blocks' units, given the products with the vector to that start.
    #[inline(always)]
    pub(super) fn gains<M: Machine>(&self, machine: M, products: M::Numbers) -> M::Numbers {
        machine.add(machine.load(&self.squares), machine.add(products, products))
    }
}

/// Cuts each vertex's neighbours into blocks, `#V` rows.
fn blocks_of(positions: &[Vec3], to_unit: f64, table: &EdgeTable) -> Rows<Block> {
    let mut blocks = Rows::default();
    blocks.restart();
    blocks.offsets.reserve(positions.len());
    blocks.values.reserve(positions.len());
    let mut neighbours = Vec::new();
    for (vertex, edges) in table.of_vertices(positions.len()).iter().enumerate() {
        neighbours.clear();
        neighbours.extend(edges.iter().map(|&edge| {
            let [low, high] = table.edges[edge as usize];
            Neighbour { vertex: if low as usize == vertex { high } else { low }, edge }
        }));
        for some in neighbours.chunks(LANES) {
            blocks.values.push(Block::new(positions, to_unit, vertex, some));
        }
        blocks.end_row();
    }
    blocks
}

/// A face beside an edge.
#[derive(Clone, Copy)]
struct Side {
    face: u32,
    /// Whether the face runs from the lower to the higher vertex.
    forward: bool,
}

/// The two faces of an edge with exactly two, given its half-edges.
fn sides(faces: &[[u32; 3]], half_edges: &[u32]) -> Option<[Side; 2]> {
    let side = |&half_edge: &u32| {
        let [from, to] = half_edge_ends(faces, half_edge);
        Side { face: half_edge / 3, forward: from < to }
    };
    let [one, other] = half_edges else { return None };
    Some([side(one), side(other)])
}

/// Not a number for a face without area.
fn unit_normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    let normal = cross(sub(b, a), sub(c, a));
    scale(normal, 1.0 / norm(normal))
}

/// The tensor that an edge between two faces adds if it lies inside the sphere as a whole.
fn edge_tensor(sides: Option<[Side; 2]>, along: Vec3, normals: &[Vec3]) -> Symmetric {
    let Some([one, other]) = sides else { return [[0.0; 4]; 2] };
    // n1 is the face on the side of the half-edge that runs against `along`. Two faces that run
    // the same way, which a half-edge structure cannot hold, count in the order of their indices.
    let (first, second) = if one.forward && !other.forward { (other, one) } else { (one, other) };
    let (n1, n2) = (normals[first.face as usize], normals[second.face as usize]);
    let length = norm(along);
    let angle = libm::asin(dot(cross(n1, n2), scale(along, 1.0 / length)).clamp(-1.0, 1.0));
    let [x, y, z] = along;
    let rows = [[x * x, x * y, x * z, y * y], [y * z, z * z, 0.0, 0.0]];
    rows.map(|row| row.map(|product| angle / length * product))
}
