//! Edges and neighbours of a triangle mesh, with what each edge adds to a curvature tensor.

use glam::Vec4;

use crate::vec3::{Vec3, cross, dot, length, scale, sub};

/// The upper triangle of a symmetric matrix: xx, xy, xz, yy, yz, zz.
pub(super) type Symmetric = [f64; 6];

/// An edge as one of its vertices sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbour {
    pub(super) vertex: u32,
    pub(super) edge: u32,
}

/// Neighbours of a block: enough for nearly all vertices, and two vectors of four.
const LANES: usize = 8;

/// Up to eight neighbours of a vertex.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// Unit vectors along the edges, one coordinate of four lanes at a time, in binary32. Not a
    /// number where there is no neighbour, zero where the edge has no length.
    directions: [[Vec4; 3]; 2],
    neighbours: [Neighbour; LANES],
}

/// Who is next to whom.
#[derive(Clone, Debug)]
pub(super) struct Topology {
    /// `#V + 1` starts into `blocks`.
    starts: Vec<u32>,
    /// The neighbours of each vertex in ascending order, each once.
    blocks: Vec<Block>,
    /// Per edge its whole contribution to the tensor: (dihedral angle / length) · e eᵀ. Zero where
    /// an edge has not exactly two faces; not finite beside a face without area.
    pub(super) tensors: Vec<Symmetric>,
}

/// A face's side, filed under its lower vertex.
#[derive(Clone, Copy, Default)]
struct Side {
    high: u32,
    face: u32,
    /// Whether the face runs from the lower to the higher vertex.
    forward: bool,
}

impl Topology {
    /// Indices must be in range; a side from a vertex to itself is no edge.
    pub(super) fn new(positions: &[Vec3], faces: &[[u32; 3]]) -> Self {
        let (starts, mut sides) = sides_by_lower_vertex(positions.len(), faces);
        let normals: Vec<Vec3> = faces
            .iter()
            .map(|face| unit_normal(face.map(|vertex| positions[vertex as usize])))
            .collect();
        let mut edges = Vec::with_capacity(sides.len() / 2);
        let mut tensors = Vec::with_capacity(sides.len() / 2);
        for low in 0..positions.len() {
            let sides = &mut sides[starts[low] as usize..starts[low + 1] as usize];
            sides.sort_unstable_by_key(|side| (side.high, side.face));
            for around in sides.chunk_by(|a, b| a.high == b.high) {
                let high = around[0].high;
                let along = sub(positions[high as usize], positions[low]);
                edges.push([low as u32, high]);
                tensors.push(edge_tensor(around, along, &normals));
            }
        }
        let (starts, neighbours) = neighbours_of(positions.len(), &edges);
        let (starts, blocks) = blocks_of(positions, &starts, &neighbours);
        Self { starts, blocks, tensors }
    }

    #[inline]
    pub(super) fn blocks(&self, vertex: usize) -> &[Block] {
        &self.blocks[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    pub(super) fn neighbours(&self, vertex: usize) -> impl Iterator<Item = Neighbour> {
        let used = |block: &Block| {
            block.neighbours.into_iter().take(block.ahead([0.0; 3]).count_ones() as usize)
        };
        self.blocks(vertex).iter().flat_map(used)
    }

    pub(super) fn is_isolated(&self, vertex: usize) -> bool {
        self.blocks(vertex).is_empty()
    }
}

impl Block {
    /// A bit for each neighbour, but not for most of those whose edges lead against `direction`;
    /// exact tests are left to the caller. `direction` is in units that binary32 holds.
    #[inline]
    pub(super) fn ahead(&self, direction: Vec3) -> u32 {
        let [x, y, z] = direction.map(|x| x as f32);
        // Rounding moves the product by less than half of this.
        let slack = Vec4::splat(-1e-6 * (x.abs() + y.abs() + z.abs()));
        let [low, high] = self.directions.each_ref().map(|along| {
            (along[0] * x + along[1] * y + along[2] * z).cmpge(slack).bitmask()
        });
        low | high << (LANES / 2)
    }

    /// The neighbour of a lane below eight.
    #[inline]
    pub(super) fn neighbour(&self, lane: u32) -> Neighbour {
        self.neighbours[lane as usize % LANES]
    }
}

/// Cuts each vertex's neighbours into blocks: (`#V + 1` starts, blocks).
fn blocks_of(
    positions: &[Vec3],
    starts: &[u32],
    neighbours: &[Neighbour],
) -> (Vec<u32>, Vec<Block>) {
    let mut block_starts = Vec::with_capacity(starts.len());
    let mut blocks = Vec::with_capacity(starts.len());
    block_starts.push(0);
    for (vertex, range) in starts.windows(2).enumerate() {
        for some in neighbours[range[0] as usize..range[1] as usize].chunks(LANES) {
            let mut block =
                Block { directions: [[Vec4::NAN; 3]; 2], neighbours: [some[0]; LANES] };
            for (lane, &neighbour) in some.iter().enumerate() {
                let along = sub(positions[neighbour.vertex as usize], positions[vertex]);
                let length = length(along);
                block.neighbours[lane] = neighbour;
                for axis in 0..3 {
                    let unit = if length > 0.0 { along[axis] / length } else { 0.0 };
                    block.directions[lane / 4][axis][lane % 4] = unit as f32;
                }
            }
            blocks.push(block);
        }
        block_starts.push(blocks.len() as u32);
    }
    (block_starts, blocks)
}

/// All sides of all faces by counting sort: (`#V + 1` starts, sides).
fn sides_by_lower_vertex(vertex_count: usize, faces: &[[u32; 3]]) -> (Vec<u32>, Vec<Side>) {
    let sides = || {
        faces.iter().enumerate().flat_map(|(index, &[a, b, c])| {
            [[a, b], [b, c], [c, a]].into_iter().filter(|[from, to]| from != to).map(
                move |[from, to]| {
                    let side = Side { high: from.max(to), face: index as u32, forward: from < to };
                    (from.min(to), side)
                },
            )
        })
    };
    group(vertex_count, sides)
}

/// Both ends of every edge, by vertex.
fn neighbours_of(vertex_count: usize, edges: &[[u32; 2]]) -> (Vec<u32>, Vec<Neighbour>) {
    let ends = || {
        edges.iter().enumerate().flat_map(|(edge, &[low, high])| {
            let edge = edge as u32;
            [(low, Neighbour { vertex: high, edge }), (high, Neighbour { vertex: low, edge })]
        })
    };
    group(vertex_count, ends)
}

/// Counting sort: the items of group g are at `starts[g]..starts[g + 1]`, in their order.
fn group<T: Copy, I: Iterator<Item = (u32, T)>>(
    groups: usize,
    items: impl Fn() -> I,
) -> (Vec<u32>, Vec<T>) {
    let mut starts = vec![0u32; groups + 1];
    items().for_each(|(group, _)| starts[group as usize + 1] += 1);
    for group in 0..groups {
        starts[group + 1] += starts[group];
    }
    let Some((_, first)) = items().next() else { return (starts, Vec::new()) };
    let mut sorted = vec![first; starts[groups] as usize];
    let mut next = starts.clone();
    for (group, item) in items() {
        let place = &mut next[group as usize];
        sorted[*place as usize] = item;
        *place += 1;
    }
    (starts, sorted)
}

/// Not a number for a face without area.
fn unit_normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    let normal = cross(sub(b, a), sub(c, a));
    scale(normal, 1.0 / length(normal))
}

/// What an edge between two faces adds if it lies inside the sphere as a whole.
fn edge_tensor(around: &[Side], along: Vec3, normals: &[Vec3]) -> Symmetric {
    let &[one, other] = around else { return [0.0; 6] };
    // n1 is the face on the side of the half-edge that runs against `along`. Two faces that run
    // the same way, which a half-edge structure cannot hold, count in the order of their indices.
    let (first, second) = if one.forward && !other.forward { (other, one) } else { (one, other) };
    let (n1, n2) = (normals[first.face as usize], normals[second.face as usize]);
    let length = length(along);
    let angle = libm::asin(dot(cross(n1, n2), scale(along, 1.0 / length)).clamp(-1.0, 1.0));
    let [x, y, z] = along;
    [x * x, x * y, x * z, y * y, y * z, z * z].map(|product| angle / length * product)
}
