//! Near regions (8.2) as the text says it: a search from every region on its own.

use std::collections::{BTreeMap, BTreeSet};

/// Of every vertex the near regions: pairs of the way to the region, in grid steps, and its number.
pub(crate) fn near_regions(
    vertices: &[[i64; 3]],
    regions: &[i64],
    faces: &[[u32; 3]],
) -> Vec<Vec<(i64, i64)>> {
    let edges = edges(vertices, faces);
    let mut near = vec![Vec::new(); vertices.len()];
    for &region in &BTreeSet::from_iter(regions.iter().copied()) {
        let ways = ways(region, regions, &edges);
        for (vertex, way) in ways.into_iter().enumerate() {
            if let Some(way) = way.filter(|_| regions[vertex] != region) {
                near[vertex].push((way, region));
            }
        }
    }
    for near in &mut near {
        near.sort_unstable();
        near.truncate(2);
    }
    near
}

/// Of every vertex the vertices at the other ends of its edges, with the lengths of these.
fn edges(vertices: &[[i64; 3]], faces: &[[u32; 3]]) -> Vec<BTreeMap<usize, i64>> {
    let mut edges = vec![BTreeMap::new(); vertices.len()];
    for face in faces {
        let [a, b, c] = face.map(|vertex| vertex as usize);
        for (v, w) in [(a, b), (b, c), (c, a)] {
            let squared: i64 = (0..3).map(|k| (vertices[v][k] - vertices[w][k]).pow(2)).sum();
            let length = squared.isqrt().max(1);
            edges[v].insert(w, length);
            edges[w].insert(v, length);
        }
    }
    edges
}

/// Of every vertex the least sum of lengths on the way to a vertex of the region.
fn ways(region: i64, regions: &[i64], edges: &[BTreeMap<usize, i64>]) -> Vec<Option<i64>> {
    let mut ways = vec![None; regions.len()];
    let start = (0..regions.len()).filter(|&vertex| regions[vertex] == region);
    let mut waiting: BTreeSet<(i64, usize)> = start.map(|vertex| (0, vertex)).collect();
    while let Some((way, vertex)) = waiting.pop_first() {
        if ways[vertex].is_some() || way >= 1 << 21 {
            continue;
        }
        ways[vertex] = Some(way);
        waiting.extend(edges[vertex].iter().map(|(&next, length)| (way + length, next)));
    }
    ways
}
