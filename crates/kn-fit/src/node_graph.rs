//! The neighbours of the key nodes in the smoothness term.

use crate::geodesic::{DistanceField, EdgeGraph};
use kn_mesh::vec3::{Vec3, distance};
use rayon::prelude::*;

/// Neighbouring nodes, each pair once, the lower index first.
///
/// Two nodes are neighbours where their cells meet along the mesh: an arm that touches the torso
/// in space is not its neighbour. Pieces of the surface that nothing connects are attached by
/// their nearest nodes.
pub(crate) fn neighbours(positions: &[Vec3], graph: &EdgeGraph, nodes: &[Vec3]) -> Vec<(u16, u16)> {
    let mut field = DistanceField::new(positions.len());
    let starts: Vec<(f64, u32)> = nodes.par_iter().map(|&n| nearest(positions, n)).collect();
    for (number, &(offset, vertex)) in starts.iter().enumerate() {
        field.add_source(graph, number as u32, vertex, offset);
    }
    let mut pairs = Vec::new();
    for vertex in 0..positions.len() as u32 {
        let own = field.nearest[vertex as usize];
        for &(other, _) in graph.neighbours(vertex) {
            let other = field.nearest[other as usize];
            if own < other && other != u32::MAX {
                pairs.push((own as u16, other as u16));
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    attach_pieces(nodes, &mut pairs);
    pairs
}

/// The distance of the nearest vertex, and the vertex.
fn nearest(positions: &[Vec3], point: Vec3) -> (f64, u32) {
    let mut best = (f64::INFINITY, 0);
    for (vertex, &position) in positions.iter().enumerate() {
        let candidate = (distance(position, point), vertex as u32);
        if candidate < best {
            best = candidate;
        }
    }
    best
}

/// Joins the pieces of the graph to the one of node 0, always the nearest pair of nodes first.
fn attach_pieces(nodes: &[Vec3], pairs: &mut Vec<(u16, u16)>) {
    let mut attached = vec![false; nodes.len()];
    let mut pending = vec![0];
    while let Some(seed) = pending.pop() {
        spread(seed, pairs, &mut attached);
        let mut best: Option<(f64, usize, usize)> = None;
        for a in (0..nodes.len()).filter(|&a| attached[a]) {
            for b in (0..nodes.len()).filter(|&b| !attached[b]) {
                let candidate = (distance(nodes[a], nodes[b]), a, b);
                if best.is_none_or(|best| candidate < best) {
                    best = Some(candidate);
                }
            }
        }
        if let Some((_, a, b)) = best {
            pairs.push((a.min(b) as u16, a.max(b) as u16));
            pending.push(b);
        }
    }
}

/// Marks all nodes that pairs connect with `seed`.
fn spread(seed: usize, pairs: &[(u16, u16)], attached: &mut [bool]) {
    attached[seed] = true;
    let mut grew = true;
    while grew {
        grew = false;
        for &(a, b) in pairs {
            let (a, b) = (usize::from(a), usize::from(b));
            if attached[a] != attached[b] {
                attached[a] = true;
                attached[b] = true;
                grew = true;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kn_mesh::adjacency::EdgeTable;

    #[test]
    fn strips_side_by_side_are_joined_once() {
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        for strip in 0..2 {
            let base = positions.len() as u32;
            for x in 0..10 {
                positions.push([f64::from(x), f64::from(strip) * 2.0, 0.0]);
                positions.push([f64::from(x), f64::from(strip) * 2.0 + 1.0, 0.0]);
            }
            for x in 0..9 {
                let a = base + 2 * x;
                faces.push([a, a + 1, a + 2]);
                faces.push([a + 1, a + 3, a + 2]);
            }
        }
        // Strip 0 has the nodes 0, 1, 2 and strip 1 the nodes 3, 4, 5.
        let nodes: Vec<Vec3> =
            [0, 8, 18, 20, 28, 38].iter().map(|&v: &usize| positions[v]).collect();
        let edges = EdgeTable::new(positions.len(), &faces).edges;
        let graph = EdgeGraph::new(&positions, &edges, |_, _| true);
        let pairs = neighbours(&positions, &graph, &nodes);
        assert_eq!(pairs[..4], [(0, 1), (1, 2), (3, 4), (4, 5)]);
        assert_eq!(pairs.len(), 5);
    }
}
