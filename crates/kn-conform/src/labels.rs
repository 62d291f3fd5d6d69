//! The labels of a GoF's key nodes (6.5), as the text says it.

use crate::oracle::{Payload, decode_mesh};
use crate::value::TraceLine;

/// The label of every node of the last key nodes, from all elements so far; `None` where they
/// cannot be found.
pub fn node_labels(trace: &[TraceLine]) -> Option<Vec<u8>> {
    let last = |name: &str| trace.iter().rposition(|line| line.name == name);
    let payload = Payload::of(|name| Some(&trace[last(name)?].value))?;
    let mesh = decode_mesh(&payload).ok()?;
    let nodes = &trace[last("node_count")?..];
    let values = |name: &str| -> Vec<i64> {
        let of_name = nodes.iter().filter(|line| line.name == name);
        of_name.map(|line| line.value.number() as i64).collect()
    };
    let vertices: Vec<[i64; 3]> = mesh.positions.iter().map(|p| p.map(i64::from)).collect();
    let points = node_points(&values("node_vertex_gap"), &values("node_delta"), &vertices)?;
    let label = |&point: &[i64; 3]| {
        let vertex = closest(point, &vertices)?;
        Some(mesh.labels.get(vertex).copied().unwrap_or(0))
    };
    points.iter().map(label).collect()
}

/// 6.5: positions of the nodes in grid steps, from gaps or from deltas; `None` for a vertex that
/// does not exist.
pub(crate) fn node_points(
    gaps: &[i64],
    deltas: &[i64],
    vertices: &[[i64; 3]],
) -> Option<Vec<[i64; 3]>> {
    let mut points = Vec::new();
    let mut vertex = -1;
    for gap in gaps {
        vertex += 1 + gap;
        points.push(*vertices.get(usize::try_from(vertex).ok()?)?);
    }
    let mut point = [0; 3];
    for delta in deltas.chunks_exact(3) {
        point = [0, 1, 2].map(|axis| point[axis] + delta[axis]);
        points.push(point);
    }
    Some(points)
}

/// 6.5: the closest vertex, of equally close ones the lowest.
pub(crate) fn closest(point: [i64; 3], vertices: &[[i64; 3]]) -> Option<usize> {
    let squared =
        |vertex: &[i64; 3]| -> i64 { (0..3).map(|axis| (vertex[axis] - point[axis]).pow(2)).sum() };
    (0..vertices.len()).min_by_key(|&index| (squared(&vertices[index]), index))
}
