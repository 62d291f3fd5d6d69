//! Distances along the mesh: shortest paths over its edges.

use kn_mesh::adjacency::Rows;
use kn_mesh::vec3::{Vec3, distance};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A mesh as a graph of weighted edges.
pub(crate) struct EdgeGraph {
    /// `#V` rows: neighbour and length of the edge to it.
    links: Rows<(u32, f64)>,
}

impl EdgeGraph {
    /// The graph of those `edges` (`#E × 2`) of the mesh for which `keep` holds; coincident vertices are
    /// joined, since scans come cut along seams of their texture.
    pub(crate) fn new(
        positions: &[Vec3],
        edges: &[[u32; 2]],
        keep: impl Fn(u32, u32) -> bool,
    ) -> Self {
        let mut pairs = edges.to_vec();
        pairs.extend(coincident(positions));
        pairs.retain(|&[a, b]| keep(a, b));
        let links = pairs.iter().flat_map(|&[a, b]| {
            let length = distance(positions[a as usize], positions[b as usize]);
            [(a, (b, length)), (b, (a, length))]
        });
        Self { links: Rows::collect(positions.len(), links) }
    }

    pub(crate) fn vertex_count(&self) -> usize {
        self.links.len()
    }

    pub(crate) fn neighbours(&self, vertex: u32) -> &[(u32, f64)] {
        self.links.row(vertex as usize)
    }

    /// `#V` component numbers and how many there are, numbered by their lowest vertex. They are those of
    /// the graph, whose edges were chosen and whose seams are joined, and not those of the mesh.
    pub(crate) fn components(&self) -> (Vec<u32>, usize) {
        let mut component = vec![u32::MAX; self.vertex_count()];
        let mut count = 0;
        let mut stack = Vec::new();
        for seed in 0..self.vertex_count() as u32 {
            if component[seed as usize] != u32::MAX {
                continue;
            }
            component[seed as usize] = count;
            stack.push(seed);
            while let Some(vertex) = stack.pop() {
                for &(next, _) in self.neighbours(vertex) {
                    if component[next as usize] == u32::MAX {
                        component[next as usize] = count;
                        stack.push(next);
                    }
                }
            }
            count += 1;
        }
        (component, count as usize)
    }
}

/// Pairs of vertices at exactly the same place, each with the next one of its place.
fn coincident(positions: &[Vec3]) -> Vec<[u32; 2]> {
    let key = |v: u32| positions[v as usize].map(|c| (c + 0.0).to_bits());
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(|&v| (key(v), v));
    order.windows(2).filter(|pair| key(pair[0]) == key(pair[1])).map(|p| [p[0], p[1]]).collect()
}

/// A multi-source shortest-path field that grows as sources are added.
pub(crate) struct DistanceField {
    /// `#V` distances to the nearest source; infinite where none reaches.
    pub(crate) distance: Vec<f64>,
    /// `#V` the nearest source's number.
    pub(crate) nearest: Vec<u32>,
    heap: BinaryHeap<Reached>,
}

impl DistanceField {
    pub(crate) fn new(vertex_count: usize) -> Self {
        Self {
            distance: vec![f64::INFINITY; vertex_count],
            nearest: vec![u32::MAX; vertex_count],
            heap: BinaryHeap::new(),
        }
    }

    /// Adds `source` at `vertex`, `offset` away; only vertices that it is nearest to are visited.
    pub(crate) fn add_source(&mut self, graph: &EdgeGraph, source: u32, vertex: u32, offset: f64) {
        self.add_sources(graph, source, std::iter::once((vertex, offset)));
    }

    /// Adds a source that is at many vertices, each with its offset.
    pub(crate) fn add_sources(
        &mut self,
        graph: &EdgeGraph,
        source: u32,
        starts: impl Iterator<Item = (u32, f64)>,
    ) {
        starts.for_each(|(vertex, offset)| self.reach(source, vertex, offset));
        while let Some(Reached { distance, vertex }) = self.heap.pop() {
            if distance > self.distance[vertex as usize] {
                continue;
            }
            for &(next, length) in graph.neighbours(vertex) {
                self.reach(source, next, distance + length);
            }
        }
    }

    fn reach(&mut self, source: u32, vertex: u32, distance: f64) {
        if distance < self.distance[vertex as usize] {
            self.distance[vertex as usize] = distance;
            self.nearest[vertex as usize] = source;
            self.heap.push(Reached { distance, vertex });
        }
    }
}

/// Orders the heap by shortest distance, then lowest vertex.
struct Reached {
    distance: f64,
    vertex: u32,
}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        other.distance.total_cmp(&self.distance).then(other.vertex.cmp(&self.vertex))
    }
}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Reached {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Reached {}
