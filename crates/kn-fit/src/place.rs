//! Farthest-point placement of key nodes on the surface.

use crate::constants::placement::{AFFINE_DENSITY, OWN_NODE};
use crate::error::FitError;
use crate::error::Side;
use crate::geodesic::{DistanceField, EdgeGraph};
use crate::source::{check_length, check_mesh};
use crate::surface::vertex_areas;
use kn_mesh::adjacency::EdgeTable;
use kn_mesh::vec3::{Vec3, add, distance, scale};

/// Up to `count` vertices (`#N` indices, in the order of choice), spread evenly along the surface.
///
/// Pieces are what mesh edges connect within one region; each region has at least one node and
/// each piece that is large enough has one before any piece gets a second, as far as `count`
/// goes. Where `affine` (`#V`) says so nodes stand closer together. `regions` (`#V`) and `affine`
/// may be absent. The same input gives the same nodes.
///
/// # Errors
/// A mesh without a surface, a coordinate that is not finite, a face out of range, or `regions` or
/// `affine` of another length than the positions.
pub fn place_farthest(
    positions: &[[f64; 3]],
    faces: &[[u32; 3]],
    regions: Option<&[u8]>,
    affine: Option<&[bool]>,
    count: usize,
) -> Result<Vec<u32>, FitError> {
    check_mesh(positions, faces, Side::Source)?;
    if let Some(affine) = affine {
        check_length("affine", affine.len(), positions.len())?;
    }
    if let Some(regions) = regions {
        check_length("regions", regions.len(), positions.len())?;
    }
    let region = |v: u32| regions.map_or(0, |regions| regions[v as usize]);
    let edges = EdgeTable::new(positions.len(), faces).edges;
    let graph = EdgeGraph::new(positions, &edges, |a, b| region(a) == region(b));
    let mut chosen = seeds(positions, faces, &graph, region, count);
    let mut field = DistanceField::new(positions.len());
    for (number, &vertex) in chosen.iter().enumerate() {
        field.add_source(&graph, number as u32, vertex, 0.0);
    }
    while chosen.len() < count {
        let Some(vertex) = farthest(&field, affine) else { break };
        field.add_source(&graph, chosen.len() as u32, vertex, 0.0);
        chosen.push(vertex);
    }
    Ok(chosen)
}

/// The reached vertex that is farthest from all nodes, the lowest index among equals; where nodes
/// are affine, distances count more.
fn farthest(field: &DistanceField, affine: Option<&[bool]>) -> Option<u32> {
    let mut best = (0.0, None);
    for (vertex, &distance) in field.distance.iter().enumerate() {
        let closer = affine.is_some_and(|affine| affine[vertex]);
        let distance = if closer { AFFINE_DENSITY * distance } else { distance };
        if distance.is_finite() && distance > best.0 {
            best = (distance, Some(vertex as u32));
        }
    }
    best.1
}

/// One piece of the surface.
struct Piece {
    area: f64,
    centroid: Vec3,
    region: u8,
    /// The vertex nearest to the centroid, and its squared distance.
    middle: (f64, u32),
}

/// The first nodes: the middle of each region's largest piece, then of every other piece that is
/// large enough.
fn seeds(
    positions: &[Vec3],
    faces: &[[u32; 3]],
    graph: &EdgeGraph,
    region: impl Fn(u32) -> u8,
    count: usize,
) -> Vec<u32> {
    let areas = vertex_areas(positions, faces);
    let mut pieces = pieces(positions, &areas, graph, region);
    let total: f64 = pieces.iter().map(|piece| piece.area).sum();
    let enough = OWN_NODE * total / count.max(1) as f64;
    // A stable sort keeps equal areas in the order of their lowest vertex.
    pieces.sort_by(|a, b| b.area.total_cmp(&a.area));
    let mut has_node = [false; 256];
    let (mut first, mut others) = (Vec::new(), Vec::new());
    for piece in &pieces {
        if !std::mem::replace(&mut has_node[usize::from(piece.region)], true) {
            first.push(piece.middle.1);
        } else if piece.area >= enough {
            others.push(piece.middle.1);
        }
    }
    first.extend(others);
    first.truncate(count);
    first
}

fn pieces(
    positions: &[Vec3],
    areas: &[f64],
    graph: &EdgeGraph,
    region: impl Fn(u32) -> u8,
) -> Vec<Piece> {
    let (component, component_count) = graph.components();
    let empty =
        |_| Piece { area: 0.0, centroid: [0.0; 3], region: 0, middle: (f64::INFINITY, u32::MAX) };
    let mut pieces: Vec<Piece> = (0..component_count).map(empty).collect();
    for (vertex, &area) in areas.iter().enumerate() {
        let piece = &mut pieces[component[vertex] as usize];
        piece.area += area;
        piece.centroid = add(piece.centroid, scale(positions[vertex], area));
        piece.region = region(vertex as u32);
    }
    for piece in &mut pieces {
        piece.centroid = scale(piece.centroid, 1.0 / piece.area.max(f64::MIN_POSITIVE));
    }
    for (vertex, &position) in positions.iter().enumerate() {
        let piece = &mut pieces[component[vertex] as usize];
        let candidate = (distance(position, piece.centroid), vertex as u32);
        if candidate < piece.middle {
            piece.middle = candidate;
        }
    }
    // A piece without area (an isolated vertex) has no middle worth a node.
    pieces.retain(|piece| piece.area > 0.0);
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flat grid of `n × n` quads at height `z`.
    fn plate(n: u32, z: f64, positions: &mut Vec<Vec3>, faces: &mut Vec<[u32; 3]>) {
        let base = positions.len() as u32;
        for y in 0..=n {
            for x in 0..=n {
                positions.push([f64::from(x), f64::from(y), z]);
            }
        }
        for y in 0..n {
            for x in 0..n {
                let a = base + y * (n + 1) + x;
                faces.push([a, a + 1, a + n + 2]);
                faces.push([a, a + n + 2, a + n + 1]);
            }
        }
    }

    #[test]
    fn nodes_spread_over_a_plate() {
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        plate(20, 0.0, &mut positions, &mut faces);
        let nodes = place_farthest(&positions, &faces, None, None, 16).expect("a plate");
        assert_eq!(nodes.len(), 16);
        for (i, &a) in nodes.iter().enumerate() {
            for &b in &nodes[..i] {
                let apart = distance(positions[a as usize], positions[b as usize]);
                assert!(apart > 3.0, "{a} and {b} are {apart} apart");
            }
        }
    }

    #[test]
    fn affine_nodes_stand_closer() {
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        plate(40, 0.0, &mut positions, &mut faces);
        let affine: Vec<bool> = positions.iter().map(|p| p[0] > 20.0).collect();
        let nodes = place_farthest(&positions, &faces, None, Some(&affine), 80).expect("a plate");
        let right = nodes.iter().filter(|&&v| affine[v as usize]).count();
        // The square of 1.5 is 2.25 times as many; the border between both halves blurs it.
        assert!((48..60).contains(&right), "{right} of 80");
    }

    #[test]
    fn each_piece_and_each_region_has_a_node() {
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        plate(20, 0.0, &mut positions, &mut faces);
        plate(10, 1.0, &mut positions, &mut faces);
        let regions: Vec<u8> = positions.iter().map(|p| u8::from(p[0] > 15.5)).collect();
        let nodes = place_farthest(&positions, &faces, Some(&regions), None, 3).expect("plates");
        let upper = nodes.iter().filter(|&&v| positions[v as usize][2] == 1.0).count();
        let right = nodes.iter().filter(|&&v| regions[v as usize] == 1).count();
        assert_eq!((nodes.len(), upper, right), (3, 1, 1));
    }

    #[test]
    fn there_are_never_more_nodes_than_vertices() {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let nodes = place_farthest(&positions, &[[0, 1, 2]], None, None, 100).expect("a triangle");
        assert_eq!(nodes.len(), 3);
    }
}
