//! Chapter 5, read literally: the mesh of an I-frame from its payload.
//!
//! Written from the text of the specification, with no eye on speed; shares no code with kn-codec.

use kn_bitstream::rule::{self, Rule};
use kn_mesh::GridMesh;

use super::conquest::{Conquest, connectivity};
use super::geometry::geometry;
use super::labels::labels;

/// r[intra.header]
pub(super) struct Counts {
    has_labels: bool,
    pub(super) lattice: bool,
    pub(super) vertices: u64,
    pub(super) isolated: u64,
    pub(super) faces: u64,
    pub(super) raw_faces: u64,
    pub(super) components: u64,
    pub(super) joins: u64,
    sizes: [u64; 3],
}

/// What geometry and labels walk over.
pub(super) struct Walk<'c> {
    pub(super) conquest: &'c Conquest,
    /// Half-edges around each vertex that is no dummy.
    pub(super) around: Vec<Vec<usize>>,
    pub(super) isolated: u64,
    /// Number of decoded vertices.
    pub(super) vertices: usize,
}

/// The mesh of an I-frame's payload, or the rule of chapter 5 that it breaks. Memory and time are in
/// proportion to what r[intra.counts.density] allows a payload.
pub fn decode_mesh(payload: &[u8]) -> Result<GridMesh, Rule> {
    let (counts, sections) = read_header(payload)?;
    check(&counts, payload.len() as u64)?;
    let [first, second, third] = split(sections, counts.sizes)?;
    if !counts.has_labels && !third.is_empty() {
        return Err(rule::INTRA_SECTIONS_SIZE);
    }
    let (conquest, faces) = connectivity(first, &counts)?;
    let around = (0..conquest.vertices.len())
        .map(|v| if conquest.vertices[v].dummy { Vec::new() } else { conquest.around(v) });
    let walk = Walk {
        conquest: &conquest,
        around: around.collect(),
        isolated: counts.isolated,
        vertices: counts.vertices as usize,
    };
    let (coded, positions) = geometry(second, &walk, counts.lattice)?;
    let labels = if counts.has_labels { labels(third, &walk, &coded)? } else { Vec::new() };
    Ok(GridMesh::new(positions, faces).with_labels(labels))
}

/// Vertices and faces that a payload announces.
pub(super) fn announced(payload: &[u8]) -> Result<[u64; 2], Rule> {
    let (counts, _) = read_header(payload)?;
    check(&counts, payload.len() as u64)?;
    Ok([counts.vertices, counts.faces])
}

/// The header, and the bytes behind it.
fn read_header(payload: &[u8]) -> Result<(Counts, &[u8]), Rule> {
    const HEADER: Rule = rule::INTRA_HEADER;
    let [flags, attributes, rest @ ..] = payload else { return Err(HEADER) };
    if *flags > 3 {
        return Err(HEADER);
    }
    if *attributes != 0 {
        return Err(rule::INTRA_HEADER_ATTRIBUTES);
    }
    let mut bytes = rest;
    let mut numbers = [0; 9];
    for number in &mut numbers {
        let mut shift = 0;
        loop {
            let (&byte, behind) = bytes.split_first().ok_or(HEADER)?;
            bytes = behind;
            *number |= u64::from(byte & 127) << shift;
            if byte < 128 {
                if (byte == 0 && shift > 0) || *number >= 1 << 32 {
                    return Err(HEADER);
                }
                break;
            }
            shift += 7;
            if shift > 28 {
                return Err(HEADER);
            }
        }
    }
    let [vertices, isolated, faces, raw_faces, components, joins, sizes @ ..] = numbers;
    let (has_labels, lattice) = (flags & 1 == 1, flags & 2 == 2);
    let counts = Counts {
        has_labels,
        lattice,
        vertices,
        isolated,
        faces,
        raw_faces,
        components,
        joins,
        sizes,
    };
    Ok((counts, bytes))
}

fn check(counts: &Counts, payload_bytes: u64) -> Result<(), Rule> {
    if counts.vertices + counts.faces > 2048 * payload_bytes {
        return Err(rule::INTRA_COUNTS_DENSITY);
    }
    if counts.isolated > counts.vertices {
        return Err(rule::INTRA_VERTICES_COUNT);
    }
    let simple = counts.faces.checked_sub(counts.raw_faces).ok_or(rule::INTRA_FACES_COUNT)?;
    if counts.components > simple {
        return Err(rule::INTRA_FACES_COUNT);
    }
    if counts.joins > 3 * simple { Err(rule::INTRA_JOIN_ORDER) } else { Ok(()) }
}

/// r[intra.sections.size]
fn split(bytes: &[u8], sizes: [u64; 3]) -> Result<[&[u8]; 3], Rule> {
    if sizes.iter().sum::<u64>() != bytes.len() as u64 {
        return Err(rule::INTRA_SECTIONS_SIZE);
    }
    let (first, rest) = bytes.split_at(sizes[0] as usize);
    let (second, third) = rest.split_at(sizes[1] as usize);
    Ok([first, second, third])
}
