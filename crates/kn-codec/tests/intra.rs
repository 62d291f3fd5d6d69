//! Intra coding end to end: every mesh comes back, and no payload does harm.

mod common;

use common::{announcing, bytes_of, decode_bytes};
use kn_bitstream::rule;
use kn_codec::intra::{IntraEncoding, IntraError, IntraLimits, encode_intra};
use kn_mesh::{Grid, GridMesh};
use kn_performer::{Performer, PerformerConfig};
use proptest::prelude::*;
use std::path::{Path, PathBuf};

const LIMITS: IntraLimits = IntraLimits { max_vertices: 1 << 20, max_faces: 1 << 20 };

fn decode(bytes: &[u8]) -> Result<GridMesh, IntraError> {
    decode_bytes(bytes, &LIMITS)
}

/// Faces begun at their lowest corner, in ascending order.
fn canonical(faces: impl Iterator<Item = [u32; 3]>) -> Vec<[u32; 3]> {
    let turned = |[a, b, c]: [u32; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
    let mut faces: Vec<_> = faces.filter_map(turned).collect();
    faces.sort_unstable();
    faces
}

/// Encodes, decodes and compares; returns the payload and what the encoder says of it.
fn round_trip(mesh: &GridMesh) -> (Vec<u8>, IntraEncoding) {
    let encoding = encode_intra(mesh).expect("encodes");
    let bytes = bytes_of(&encoding);
    let decoded = decode(&bytes).expect("decodes");
    let map = &encoding.vertex_map;
    assert_eq!(decoded.positions.len(), mesh.positions.len());
    assert_eq!(decoded.labels.len(), mesh.labels.len());
    let mut targets = map.clone();
    targets.sort_unstable();
    assert!(targets.into_iter().eq(0..mesh.positions.len() as u32), "the map is a permutation");
    for (vertex, &target) in map.iter().enumerate() {
        assert_eq!(decoded.positions[target as usize], mesh.positions[vertex]);
        if let Some(label) = mesh.labels.get(vertex) {
            assert_eq!(decoded.labels[target as usize], *label);
        }
    }
    let mapped = mesh.faces.iter().map(|face| face.map(|vertex| map[vertex as usize]));
    assert_eq!(canonical(decoded.faces.iter().copied()), canonical(mapped));
    (bytes, encoding)
}

/// A sheet of `n × n` squares, its opposite sides glued where asked: disc, annulus or torus.
fn sheet(n: u32, wrap: [bool; 2]) -> Vec<[u32; 3]> {
    let vertex = |x: u32, y: u32| {
        let [x, y] = [(x, wrap[0]), (y, wrap[1])].map(|(i, wrap)| if wrap { i % n } else { i });
        y * (n + 1) + x
    };
    let squares = (0..n).flat_map(|y| (0..n).map(move |x| (x, y)));
    squares
        .flat_map(|(x, y)| {
            let [a, b] = [vertex(x, y), vertex(x + 1, y)];
            let [c, d] = [vertex(x, y + 1), vertex(x + 1, y + 1)];
            [[a, b, d], [a, d, c]]
        })
        .collect()
}

/// Any triples of a few vertices: every edge and vertex may be as non-manifold as can be.
fn soup() -> impl Strategy<Value = Vec<[u32; 3]>> {
    (1..12u32).prop_flat_map(|n| prop::collection::vec([0..n, 0..n, 0..n], 0..40))
}

/// A piece of a surface that was harmed: faces lost, turned over, doubled, vertices merged.
fn harmed() -> impl Strategy<Value = Vec<[u32; 3]>> {
    let sheet = (3..9u32, any::<[bool; 2]>()).prop_map(|(n, wrap)| sheet(n, wrap));
    let harm = prop::collection::vec((any::<u16>(), any::<u16>(), 0..4u8), 0..12);
    (sheet, harm).prop_map(|(mut faces, harm)| {
        for (at, other, kind) in harm {
            let at = at as usize % faces.len().max(1);
            match kind {
                _ if faces.is_empty() => {}
                0 => drop(faces.remove(at)),
                1 => faces[at].swap(0, 1),
                2 => faces.push(faces[at]),
                _ => {
                    let from = faces[at][0];
                    let to = faces[other as usize % faces.len()][1];
                    let corners = faces.iter_mut().flatten();
                    corners.filter(|vertex| **vertex == from).for_each(|vertex| *vertex = to);
                }
            }
        }
        faces
    })
}

fn any_mesh() -> impl Strategy<Value = GridMesh> {
    let scale = prop_oneof![Just(1i32), Just(30), Just((1 << 20) - 1)];
    (prop_oneof![soup(), harmed()], scale, 0..4usize, 0..4u8, any::<u64>()).prop_map(
        |(faces, scale, isolated, labels, seed)| {
            let used = faces.iter().flatten().max().map_or(0, |&v| v as usize + 1);
            let mut state = seed | 1;
            let mut random = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 33) as i32
            };
            let mut place = || random() % (2 * scale + 1) - scale;
            let positions = (0..used + isolated).map(|_| [place(), place(), place()]).collect();
            let mut mesh = GridMesh::new(positions, faces);
            if labels > 0 {
                let count = mesh.positions.len();
                mesh.labels = (0..count).map(|_| (random() % 256) as u8 % labels).collect();
            }
            mesh
        },
    )
}

proptest! {
    #[test]
    fn every_mesh_comes_back(mesh in any_mesh()) {
        round_trip(&mesh);
    }

    #[test]
    fn harmed_payloads_are_refused_or_decoded(
        mesh in any_mesh(),
        flips in prop::collection::vec((any::<u16>(), 0..8u8), 1..4),
        cut in any::<u16>(),
    ) {
        let (mut bytes, _) = round_trip(&mesh);
        assert!(decode(&bytes[..cut as usize % bytes.len()]).is_err(), "truncated");
        for (at, bit) in flips {
            let at = at as usize % bytes.len();
            bytes[at] ^= 1 << bit;
        }
        if let Ok(mesh) = decode(&bytes) {
            let count = mesh.positions.len() as u32;
            assert!(count <= LIMITS.max_vertices && mesh.faces.len() <= 1 << 20);
            assert!(mesh.faces.iter().flatten().all(|&vertex| vertex < count));
            assert!(mesh.labels.is_empty() || mesh.labels.len() as u32 == count);
        }
    }

    #[test]
    fn any_bytes_are_refused_or_decoded(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = decode(&bytes);
        // With a header that holds, so that the sections are reached.
        let mut with_header = vec![1, 0, 20, 0, 30, 0, 1, 0, (bytes.len() / 2) as u8, 0, 0];
        with_header[9] = (bytes.len() - bytes.len() / 2) as u8;
        with_header.extend(bytes);
        let _ = decode(&with_header);
    }
}

#[test]
fn every_truncation_and_a_spare_byte_are_refused() {
    let faces = sheet(4, [true, false]);
    let mut mesh =
        GridMesh::new((0..25).map(|i| [i % 5 * 10, i / 5 * 10, i * i % 7]).collect(), faces);
    mesh.labels = (0..25).map(|i| i as u8 / 12).collect();
    let (mut bytes, _) = round_trip(&mesh);
    for length in 0..bytes.len() {
        assert!(decode(&bytes[..length]).is_err(), "{length} of {} bytes", bytes.len());
    }
    bytes.push(0);
    assert!(decode(&bytes).is_err(), "a spare byte");
}

#[test]
fn the_report_names_what_was_cut() {
    // Three faces on one edge, a face that repeats a vertex, a vertex without a face.
    let faces = vec![[0, 1, 2], [1, 0, 3], [0, 1, 4], [5, 5, 6]];
    let mesh = GridMesh::new((0..8).map(|i| [i, i * i, 3 * i]).collect(), faces);
    let (_, encoding) = round_trip(&mesh);
    assert_eq!(encoding.cut_edges, 1);
    assert_eq!(encoding.header.raw_face_count, 1);
    assert_eq!(encoding.header.isolated_count, 3);
    assert_eq!(encoding.header.join_count, 4);
    assert_eq!(encoding.header.component_count, 3);
}

#[test]
fn empty_meshes_and_bad_input() {
    round_trip(&GridMesh::default());
    round_trip(&GridMesh::new(vec![[-1_048_575, 0, 1_048_575]], vec![]));
    let refused = |mesh: &GridMesh| encode_intra(mesh).expect_err("refused");
    let mut mesh = GridMesh::new(vec![[0, 0, 0], [0, 1 << 20, 0]], vec![]);
    assert_eq!(refused(&mesh), IntraError::Outside { vertex: 1 });
    mesh.positions[1] = [1; 3];
    mesh.faces = vec![[0, 1, 0], [0, 1, 2]];
    assert_eq!(refused(&mesh), IntraError::FaceIndex { face: 1 });
    mesh.faces.pop();
    mesh.labels = vec![7];
    assert_eq!(refused(&mesh), IntraError::LabelCount { labels: 1, vertices: 2 });
}

#[test]
fn limits_hold_before_anything_is_allocated() {
    let mesh = GridMesh::new(vec![[0; 3]; 100], sheet(8, [false, false]));
    let bytes = bytes_of(&encode_intra(&mesh).expect("encodes"));
    let limits = IntraLimits { max_vertices: 99, max_faces: 1000 };
    let refused = decode_bytes(&bytes, &limits);
    let expected = IntraError::Limit { what: "vertices", asked: 100, allowed: 99 };
    assert_eq!(refused.map(drop), Err(expected));
}

#[test]
fn a_regular_mesh_stays_within_the_density_that_decoders_accept() {
    let n = 300;
    let positions = (0..=n).flat_map(|y| (0..=n).map(move |x| [x as i32, y as i32, 0]));
    round_trip(&GridMesh::new(positions.collect(), sheet(n, [false, false])));
}

/// The OBJ files of a measured sequence.
fn scans(folder: &str) -> Option<Vec<PathBuf>> {
    let entries = std::fs::read_dir(kn_testdata::data(folder)?).expect("a folder");
    let mut files: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "obj"));
    files.sort();
    Some(files)
}

/// An OBJ file's vertices on a grid of 11 bits, and its faces, as they stand in the file.
fn read_grid_mesh(path: &Path) -> GridMesh {
    let text = std::fs::read_to_string(path).expect("readable");
    let numbers = |line: &str| -> Vec<f64> {
        let words = line.split_whitespace().skip(1);
        words.filter_map(|word| word.split('/').next()?.parse().ok()).collect()
    };
    let vertices: Vec<_> = text.lines().filter(|l| l.starts_with("v ")).map(numbers).collect();
    let faces = text.lines().filter(|l| l.starts_with("f ")).map(numbers);
    let largest = vertices.iter().flatten().fold(0.0f64, |max, x| max.max(x.abs()));
    let grid = |v: &Vec<f64>| [v[0], v[1], v[2]].map(|x| (x / largest * 1023.0).round() as i32);
    let mut mesh = GridMesh::new(
        vertices.iter().map(grid).collect(),
        faces.map(|f| [f[0], f[1], f[2]].map(|i| i as u32 - 1)).collect(),
    );
    if let Ok(labels) = std::fs::read_to_string(path.with_extension("labels")) {
        mesh.labels = labels.lines().map(|l| l.trim().parse().expect("a label")).collect();
    }
    mesh
}

#[test]
fn all_raw_captures_come_back() {
    for file in scans("punch_dirty").unwrap_or_default() {
        round_trip(&read_grid_mesh(&file));
    }
}

/// Every vertex takes the commonest label around it, its own where that is among them.
fn smooth_labels(mesh: &mut GridMesh) {
    let mut votes = vec![[0u32; 16]; mesh.positions.len()];
    for face in &mesh.faces {
        for (corner, other) in [(0, 1), (1, 2), (2, 0), (1, 0), (2, 1), (0, 2)] {
            let label = mesh.labels[face[other] as usize];
            votes[face[corner] as usize][usize::from(label)] += 1;
        }
    }
    for (label, votes) in mesh.labels.iter_mut().zip(&votes) {
        let most = (0..16).max_by_key(|&l| (votes[l], l == usize::from(*label))).unwrap_or(0);
        *label = most as u8;
    }
}

#[test]
fn scans_come_back() {
    for folder in ["dancer", "mitch", "liam", "tshirt_turn"] {
        for file in scans(folder).unwrap_or_default().iter().step_by(5) {
            round_trip(&read_grid_mesh(file));
        }
    }
}

fn label_bits(mesh: &GridMesh) -> f64 {
    8.0 * round_trip(mesh).1.labels.len() as f64 / mesh.positions.len() as f64
}

#[test]
fn clean_labels_cost_next_to_nothing() {
    let config = PerformerConfig { vertices: 20_000, ..PerformerConfig::default() };
    let performer = Performer::new(config).expect("sound settings");
    let frames = (0..24).step_by(3);
    let mut sum = 0.0;
    for frame in frames.clone() {
        let mesh = performer.frame(frame);
        let bounds = mesh.bounding_box().expect("a box");
        let grid = Grid { origin: bounds.min, step: bounds.longest_side() / 2047.0 };
        let positions = grid.quantise(&mesh.positions).expect("inside");
        sum += label_bits(&mesh.with_positions(positions));
    }
    let mean = sum / frames.len() as f64;
    eprintln!("labels: {mean:.4} bit a vertex");
    assert!(mean < 0.05, "{mean}");
}

#[test]
fn ragged_labels_cost_little() {
    for file in scans("tshirt_turn").unwrap_or_default().iter().step_by(8) {
        let mut mesh = read_grid_mesh(file);
        // The true labels' borders are ragged: one vertex in eight along them disagrees with most
        // of its neighbours.
        let bits = label_bits(&mesh);
        assert!(bits < 0.10, "{}: {bits}", file.display());
        (0..4).for_each(|_| smooth_labels(&mut mesh));
        let bits = label_bits(&mesh);
        assert!(bits < 0.08, "{}: {bits}", file.display());
    }
}

/// The numbers of the header are checked before anything is allocated for them; the rest grows with
/// decisions that were read.
#[test]
fn announced_counts_are_bounded_by_the_bytes_that_are_there() {
    let refusal = |vertices, faces, payload| {
        decode(&announcing(vertices, faces, payload)).expect_err("zeros are no mesh")
    };
    let density =
        |error| matches!(error, IntraError::Malformed { rule: rule::INTRA_COUNTS_DENSITY, .. });
    for payload in [40, 100, 400] {
        let most = 2048 * payload as u32;
        assert!(density(refusal(most + 1, 0, payload)));
        assert!(density(refusal(0, most + 1, payload)));
        assert!(density(refusal(most / 2, most / 2 + 1, payload)));
        assert!(!density(refusal(most / 2, most / 2, payload)));
    }
}
