//! Chapter 5, read literally: the mesh of an I-frame from its payload.
//!
//! The code is written from the text of the specification and not made for speed. It shares no code
//! with kn-codec.

use kn_bitstream::Rule;
use kn_mesh::GridMesh;

use super::conquest::{Conquest, connectivity};
use super::geometry::geometry;
use super::labels::labels;
use crate::value::Value;

/// The elements of `intra_payload()`.
pub(crate) struct Payload<'p> {
    has_labels: bool,
    pub(super) lattice: bool,
    pub(super) vertices: u64,
    pub(super) isolated: u64,
    pub(super) raw_faces: u64,
    /// The other faces.
    pub(super) conquered: u64,
    pub(super) components: u64,
    pub(super) joins: u64,
    /// Connectivity, geometry, labels.
    sections: [&'p [u8]; 3],
}

impl<'p> Payload<'p> {
    /// The payload whose elements `element` finds by name; `None` where one is missing, or where
    /// counts that are not checked contradict each other.
    pub(crate) fn of(element: impl Fn(&str) -> Option<&'p Value>) -> Option<Self> {
        let number = |name: &str| Some(element(name)?.number() as u64);
        let section = |name: &str| match element(name)? {
            Value::Bytes(bytes) => Some(&bytes[..]),
            _ => None,
        };
        let (vertices, isolated) = (number("vertex_count")?, number("isolated_count")?);
        let (faces, raw_faces) = (number("face_count")?, number("raw_face_count")?);
        vertices.checked_sub(isolated)?;
        Some(Self {
            has_labels: number("labels_present")? == 1,
            lattice: number("lattice_present")? == 1,
            vertices,
            isolated,
            raw_faces,
            conquered: faces.checked_sub(raw_faces)?,
            components: number("component_count")?,
            joins: number("join_count")?,
            sections: [
                section("connectivity_section")?,
                section("geometry_section")?,
                section("label_section")?,
            ],
        })
    }
}

/// The connectivity that the decoding of positions and labels walks over.
pub(super) struct Walk<'c> {
    pub(super) conquest: &'c Conquest,
    /// Half-edges around each vertex that is no dummy.
    pub(super) around: Vec<Vec<usize>>,
    pub(super) isolated: u64,
    /// Number of decoded vertices.
    pub(super) vertices: usize,
}

/// The mesh of an I-frame's payload, whose elements are in their ranges, or the rule of chapter 5
/// that it breaks. Memory and time are in proportion to what r[intra.counts.density] allows a
/// payload.
pub(crate) fn decode_mesh(payload: &Payload<'_>) -> Result<GridMesh, Rule> {
    let [first, second, third] = payload.sections;
    let (conquest, faces) = connectivity(first, payload)?;
    let around = (0..conquest.vertices.len())
        .map(|v| if conquest.vertices[v].dummy { Vec::new() } else { conquest.around(v) });
    let walk = Walk {
        conquest: &conquest,
        around: around.collect(),
        isolated: payload.isolated,
        vertices: payload.vertices as usize,
    };
    let (coded, positions) = geometry(second, &walk, payload.lattice)?;
    let labels = if payload.has_labels { labels(third, &walk, &coded)? } else { Vec::new() };
    Ok(GridMesh::new(positions, faces).with_labels(labels))
}
