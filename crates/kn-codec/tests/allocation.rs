//! The memory that a payload can make the decoder of I-frames allocate. Alone in its process: it
//! counts every byte of it.

mod common;

use common::{announcing, bytes_of, decode_bytes};
use kn_codec::intra::{IntraLimits, encode_intra};
use kn_mesh::{Grid, GridMesh};
use kn_performer::{Performer, PerformerConfig};
use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// Bytes for each face, and for each vertex, of any payload, as [`decode_intra`] states.
const PER_FACE: usize = 1500;
const PER_VERTEX: usize = 60;
/// Bytes for each face or vertex of a scan, about a hundred by `docs/notes/intra.md`.
const PER_ELEMENT: usize = 128;
/// Bytes for each byte of a payload that announces more than it has.
const FACTOR: usize = 1024;
/// Tables and models, whatever the payload.
const FIXED: usize = 1 << 20;

const LIMITS: IntraLimits = IntraLimits { max_vertices: 1 << 21, max_faces: 1 << 22 };

/// Greatest number of bytes held at once while a new decoder takes the payload.
fn peak(payload: &[u8]) -> usize {
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    // Refused or not: only memory counts here.
    let decoded = decode_bytes(payload, &LIMITS);
    drop(decoded);
    ALLOCATOR.peak_usage().saturating_sub(before)
}

fn performer() -> (GridMesh, Vec<u8>) {
    let config = PerformerConfig { vertices: 20_000, ..PerformerConfig::default() };
    let mesh = Performer::new(config).expect("sound settings").frame(0);
    let bounds = mesh.bounding_box().expect("vertices");
    let grid = Grid { origin: bounds.min, step: bounds.longest_side() / 2047.0 };
    let positions = grid.quantise(&mesh.positions).expect("inside");
    let mesh = mesh.with_positions(positions);
    let payload = bytes_of(&encode_intra(&mesh).expect("a sound mesh"));
    (mesh, payload)
}

fn triangles_apart(count: usize) -> GridMesh {
    let corners = 0..3 * count as u32;
    let position =
        |v: u32| [(v / 3 % 200) as i32 * 9 + (v % 3) as i32, v as i32 / 600, v as i32 % 2];
    let faces = corners.clone().step_by(3).map(|v| [v, v + 1, v + 2]).collect();
    GridMesh::new(corners.map(position).collect(), faces)
}

#[test]
fn memory_is_bounded_by_the_payload() {
    let (mesh, payload) = performer();
    let elements = mesh.positions.len() + mesh.faces.len();
    let sound = peak(&payload);
    eprintln!("a sound mesh: {sound} bytes, {} an element", sound / elements);
    assert!(sound <= PER_ELEMENT * elements + FIXED);

    let mut worst = 0;
    for len in [64, 256, 1024] {
        let most = 2048 * len as u32;
        for (vertices, faces) in [(most, 0), (0, most), (most / 3, 2 * (most / 3))] {
            let peak = peak(&announcing(vertices, faces, len));
            worst = worst.max(peak.saturating_sub(FIXED) / len);
            assert!(peak <= FACTOR * len + FIXED, "{vertices}, {faces}: {peak}");
        }
    }
    // Every byte of the beginning, where the counts are, and some of the rest.
    for at in (0..40).chain((40..payload.len()).step_by(997)) {
        for value in [0x00, 0x7f, 0x80, 0xff] {
            let mut harmed = payload.clone();
            harmed[at] = value;
            let peak = peak(&harmed);
            worst = worst.max(peak.saturating_sub(FIXED) / harmed.len());
            assert!(peak <= FACTOR * harmed.len() + FIXED, "byte {at} = {value}: {peak}");
        }
    }
    eprintln!("at worst {worst} bytes for a byte of payload");

    // Triangles that touch nothing: three more of a dummy close each, as many as there may be.
    let count = 20_000;
    let apart: GridMesh = triangles_apart(count);
    let payload = bytes_of(&encode_intra(&apart).expect("a sound mesh"));
    let peak = peak(&payload);
    eprintln!("triangles apart: {peak} bytes, {} a face", peak / count);
    assert!(peak <= PER_FACE * count + PER_VERTEX * 3 * count + FIXED);
}
