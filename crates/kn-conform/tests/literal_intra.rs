//! kn-codec and the literal reading of chapters 4 and 5 agree on every payload: meshes of all kinds
//! of pathology, and payloads that were tampered with.

use kn_bitstream::rule::{self, Rule};
use kn_bitstream::{BitReader, BitWriter, IntraPayload, Level};
use kn_codec::intra::{IntraDecoder, IntraError, IntraLimits, decode_intra, encode_intra};
use kn_conform::Spec;
use kn_mesh::GridMesh;
use proptest::prelude::*;
use std::path::Path;

/// Corners among few vertices: edges of many faces, faces that repeat a vertex or each other,
/// vertices of several fans, vertices without faces.
fn soup() -> impl Strategy<Value = GridMesh> {
    let vertex = (prop::array::uniform3(-40..40_i32), 0..4_u8);
    let vertices = prop::collection::vec(vertex, 1..40);
    (vertices, any::<bool>(), 1..5_i32).prop_flat_map(|(vertices, labelled, scale)| {
        let count = vertices.len() as u32;
        let faces = prop::collection::vec(prop::array::uniform3(0..count), 0..60);
        faces.prop_map(move |faces| {
            let position = |(p, _): &([i32; 3], u8)| p.map(|c| c * 7_i32.pow(scale as u32));
            let labels = vertices.iter().filter(|_| labelled).map(|&(_, label)| label).collect();
            GridMesh::new(vertices.iter().map(position).collect(), faces).with_labels(labels)
        })
    })
}

/// A bumpy sheet that may be closed along either side, with holes and flipped faces.
fn sheet() -> impl Strategy<Value = GridMesh> {
    let size = (3..12_usize, 3..12_usize);
    (size, any::<[bool; 3]>(), 1..400_i32).prop_flat_map(|((columns, rows), closed, step)| {
        let count = columns * rows;
        let bumps = prop::collection::vec((-9..9_i32, 0..15_u8), count);
        let fates = prop::collection::vec(0..20_u8, count);
        (bumps, fates).prop_map(move |(bumps, fates)| {
            let at = |column, row| ((row % rows) * columns + column % columns) as u32;
            let mut mesh = GridMesh::default();
            for (index, (bump, label)) in bumps.into_iter().enumerate() {
                let (column, row) = ((index % columns) as i32, (index / columns) as i32);
                mesh.positions.push([step * column, step * row, bump * step / 8]);
                mesh.labels.extend(closed[2].then_some(label / 5));
            }
            let spans = [columns - usize::from(!closed[0]), rows - usize::from(!closed[1])];
            for row in 0..spans[1] {
                for column in 0..spans[0] {
                    let [a, b] = [at(column, row), at(column + 1, row)];
                    let [c, d] = [at(column, row + 1), at(column + 1, row + 1)];
                    match fates[(row * columns + column) % fates.len()] {
                        0 => {}
                        1 => mesh.faces.extend([[a, c, b], [b, c, d]]),
                        _ => mesh.faces.extend([[a, b, c], [b, d, c]]),
                    }
                }
            }
            mesh
        })
    })
}

fn payload(mesh: &GridMesh) -> Vec<u8> {
    let mut bits = BitWriter::new();
    encode_intra(mesh).expect("a mesh").payload().write(&mut bits);
    bits.into_bytes()
}

fn highest_level() -> Level {
    Level::all().last().expect("there are levels").1
}

/// The mesh as the specification's tables and a literal reading have it, or the rule that is
/// broken.
fn by_text(payload: &[u8]) -> Result<GridMesh, Rule> {
    static SPEC: std::sync::OnceLock<Spec> = std::sync::OnceLock::new();
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../spec"));
    let spec = SPEC.get_or_init(|| Spec::load(folder).unwrap_or_else(|error| panic!("{error}")));
    let mesh = spec.decode_mesh(payload);
    mesh.map_err(|failure| failure.rule.unwrap_or_else(|| panic!("{failure}")))
}

/// The mesh, or the rule that is broken.
fn by_codec(payload: &[u8]) -> Result<GridMesh, Rule> {
    let mut bits = BitReader::new(payload);
    let read = IntraPayload::read(&mut bits, payload.len() as u32, &highest_level());
    let read = read.and_then(|read| bits.finish().map(|()| read));
    let payload = read.map_err(|error| error.rule().expect("no limits"))?;
    let limits = IntraLimits { max_vertices: u32::MAX, max_faces: u32::MAX };
    let mut mesh = GridMesh::default();
    match decode_intra(&payload, &limits, &mut IntraDecoder::default(), &mut mesh) {
        Ok(()) => Ok(mesh),
        Err(IntraError::Malformed { rule, .. }) => Err(rule),
        Err(error) => panic!("{error}"),
    }
}

/// The place of `label_size`, the last number of the header.
fn place_of_label_size(payload: &[u8]) -> usize {
    let mut at = 2;
    for _ in 0..8 {
        while payload[at] & 0x80 != 0 {
            at += 1;
        }
        at += 1;
    }
    at
}

proptest! {
    /// A section that is longer than its decisions, or has none at all.
    #[test]
    fn spare_bytes_of_labels_are_judged_alike(mesh in soup(), spare in 1..20_usize, value: u8) {
        let mut payload = payload(&mesh);
        let place = place_of_label_size(&payload);
        prop_assume!(payload[place] < 0x80 - 20);
        payload[place] += spare as u8;
        payload.extend(std::iter::repeat_n(value, spare));
        let [ours, literal] = [by_codec(&payload), by_text(&payload)];
        if mesh.labels.is_empty() {
            prop_assert_eq!(&ours, &Err(rule::INTRA_SECTIONS_SIZE));
        }
        prop_assert_eq!(literal, ours);
    }

    #[test]
    fn soups_decode_alike(mesh in soup()) {
        let payload = payload(&mesh);
        prop_assert_eq!(by_text(&payload), by_codec(&payload));
    }

    #[test]
    fn sheets_decode_alike(mesh in sheet()) {
        let payload = payload(&mesh);
        prop_assert_eq!(by_text(&payload), by_codec(&payload));
    }

    #[test]
    fn tampered_payloads_are_judged_alike(
        mesh in prop_oneof![soup(), sheet()],
        place in any::<prop::sample::Index>(),
        bit in 0..8_u8,
    ) {
        let mut payload = payload(&mesh);
        let place = place.index(payload.len());
        payload[place] ^= 1 << bit;
        // One bit may break several rules at once: which is named first is open.
        prop_assert_eq!(by_text(&payload).ok(), by_codec(&payload).ok());
    }
}
