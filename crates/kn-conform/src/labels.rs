//! The labels of a group's key nodes (6.5), as the text says it.

use kn_bitstream::{BitReader, IntraFrame, KeyNodes, KeyNodesContext, NodeSites, SequenceHeader};
use kn_codec::intra::{IntraDecoder, IntraLimits, decode_intra};
use kn_mesh::GridMesh;

use crate::interpret::GroupPayloads;

/// The label of every key node, `None` for payloads that cannot be read.
pub fn node_labels(payloads: &GroupPayloads) -> Option<Vec<u8>> {
    let header = SequenceHeader::read(&mut BitReader::new(&payloads.sequence_header)).ok()?;
    let level = header.limits()?;
    let intra = IntraFrame::read(&mut BitReader::new(&payloads.intra_frame)).ok()?;
    let limits = IntraLimits { max_vertices: level.max_vertices, max_faces: level.max_faces };
    let mut mesh = GridMesh::default();
    decode_intra(intra.payload, &limits, &mut IntraDecoder::default(), &mut mesh).ok()?;
    let context = KeyNodesContext {
        label_count: header.labels.label_count(),
        weight_scheme: header.weight_scheme,
        vertex_count: mesh.positions.len() as u32,
        max_nodes: level.max_nodes,
    };
    let nodes = KeyNodes::read(&mut BitReader::new(&payloads.key_nodes), &context).ok()?;
    let points = match &nodes.sites {
        NodeSites::Points(points) => points.clone(),
        NodeSites::Vertices(vertices) => {
            vertices.iter().map(|&vertex| mesh.positions[vertex as usize]).collect()
        }
    };
    Some(points.iter().map(|&point| label_at(&mesh, point)).collect())
}

/// The label of the closest vertex, of equally close ones the one with the lowest index.
fn label_at(mesh: &GridMesh, point: [i32; 3]) -> u8 {
    let squared = |vertex: &[i32; 3]| -> i64 {
        let difference = |axis: usize| i64::from(vertex[axis]) - i64::from(point[axis]);
        (0..3).map(|axis| difference(axis) * difference(axis)).sum()
    };
    let closest = mesh.positions.iter().enumerate().min_by_key(|(_, vertex)| squared(vertex));
    closest.and_then(|(vertex, _)| mesh.labels.get(vertex).copied()).unwrap_or(0)
}
