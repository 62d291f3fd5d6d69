//! Empty frames: meshes without vertices between others. Each is a GoF of its own.

use kn_codec::digest::frame_sha256;
use kn_codec::params::FileNames;
use kn_codec::{
    Decoder, EncodeError, Encoder, EncoderConfig, FrameInfo, FrameKind, FrameReport, GridChoice,
    LabelChoice,
};
use kn_mesh::{BoundingBox, Mesh};
use std::io::Cursor;

/// A tetrahedron that stands at `x`, labelled or not.
fn solid(x: f64, labelled: bool) -> Mesh {
    let positions = vec![[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0], [x, 0.0, 1.0]];
    let mesh = Mesh::new(positions, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
    if labelled { mesh.with_labels(vec![7; 4]) } else { mesh }
}

fn config() -> EncoderConfig {
    EncoderConfig::default().with_labels(LabelChoice::Given).with_group_length(4).with_bits(9)
}

/// The frames that `pattern` shows: `x` for a mesh, `-` for an empty frame.
fn frames(pattern: &str, labelled: bool) -> Vec<Mesh> {
    let frame = |(at, shown)| match shown {
        'x' => solid(at as f64 * 0.01, labelled),
        _ => Mesh::default(),
    };
    pattern.chars().enumerate().map(frame).collect()
}

fn encode(
    meshes: &[Mesh],
    config: EncoderConfig,
) -> Result<(Vec<u8>, Vec<FrameReport>), EncodeError> {
    let mut encoder = Encoder::new(Vec::new(), config)?;
    let mut reports = Vec::new();
    for mesh in meshes {
        encoder.push(mesh)?;
        reports.extend(encoder.drain_reports());
    }
    let finished = encoder.finish()?;
    reports.extend(finished.reports);
    assert_eq!(finished.summary.frames, meshes.len() as u64);
    Ok((finished.writer, reports))
}

fn decode(stream: &[u8]) -> Vec<(FrameInfo, Mesh, Option<String>)> {
    let mut decoder = Decoder::new(Cursor::new(stream)).expect("a stream");
    decoder.check_digests(true);
    let mut frames = Vec::new();
    let mut mesh = Mesh::default();
    while let Some(info) = decoder.next_frame(&mut mesh).expect("sound") {
        frames.push((info, mesh.clone(), decoder.stream().frame_name()));
    }
    frames
}

#[test]
fn empty_frames_come_back_wherever_they_are() {
    for pattern in ["xx-xx", "-xxx", "xxx-", "--x--", "x-x-x", "xxxxxx--xxxxx-", "x"] {
        for labelled in [false, true] {
            let (stream, reports) = encode(&frames(pattern, labelled), config()).expect(pattern);
            let decoded = decode(&stream);
            let found: Vec<FrameKind> = decoded.iter().map(|(info, ..)| info.kind).collect();
            let mut before = '-';
            for (shown, kind) in pattern.chars().zip(&found) {
                // An empty frame is a GoF, and so a GoF begins behind it.
                let begins = shown == '-' || before == '-';
                assert!(!begins || *kind == FrameKind::Intra, "{pattern}");
                before = shown;
            }
            let reported: Vec<FrameKind> = reports.iter().map(FrameReport::kind).collect();
            assert_eq!(reported, found);
            for ((info, mesh, _), shown) in decoded.iter().zip(pattern.chars()) {
                assert_eq!(info.is_empty(), shown == '-', "{pattern}");
                assert_eq!((mesh.is_empty(), mesh.faces.is_empty()), (shown == '-', shown == '-'));
                assert_eq!(mesh.labels.len(), if labelled { mesh.positions.len() } else { 0 });
            }
        }
    }
}

#[test]
fn the_digest_of_an_empty_frame_is_that_of_no_numbers() {
    let (stream, _) = encode(&frames("x-", false), config()).expect("sound");
    let mut decoder = Decoder::new(Cursor::new(&stream[..])).expect("a stream");
    let mut mesh = Mesh::default();
    decoder.seek(1).expect("there is a frame 1");
    let info = decoder.next_frame(&mut mesh).expect("sound").expect("a frame");
    assert!(info.is_empty() && info.index == 1);
    let stream = decoder.stream();
    let sha = frame_sha256(stream.grid_positions(), stream.faces());
    assert_eq!(sha, "af5570f5a1810b7af78caf4bc70a660f0df51e42baf91d4de5b2328de0e83dfc");
}

#[test]
fn found_labels_ignore_empty_frames() {
    let config = config().with_labels(LabelChoice::Auto);
    let (stream, reports) = encode(&frames("-xx-x", false), config).expect("sound");
    assert_eq!(decode(&stream).len(), 5);
    let looked_at: Vec<bool> =
        reports.iter().map(|report| report.frame().parts.is_some()).collect();
    assert_eq!(looked_at, [false, true, true, false, true]);
}

#[test]
fn a_sequence_may_be_empty_where_the_settings_have_a_grid() {
    let error = encode(&frames("--", false), config()).expect_err("no grid").to_string();
    assert!(error.contains("no frame has a vertex"), "{error}");
    let bounds = Some(BoundingBox { min: [0.0; 3], max: [1.0; 3] });
    let config = config().with_grid(GridChoice::Bits { bits: 9, bounds });
    let (stream, _) = encode(&frames("--", false), config).expect("sound");
    assert!(decode(&stream).iter().all(|(info, ..)| info.is_empty()));
}

/// Points without faces are no surface that a motion could reach.
#[test]
fn points_are_a_gof_of_their_own() {
    let points = Mesh::new(vec![[0.5; 3], [0.25; 3]], Vec::new());
    let meshes = [solid(0.0, false), solid(0.1, false), points, solid(0.2, false)];
    let (stream, _) = encode(&meshes, config()).expect("sound");
    let decoded = decode(&stream);
    let counts: Vec<(u32, u32)> =
        decoded.iter().map(|(info, ..)| (info.vertices, info.faces)).collect();
    assert_eq!(counts, [(4, 4), (4, 4), (2, 0), (4, 4)]);
    assert_eq!(decoded[2].0.kind, FrameKind::Intra);
}

#[test]
fn frames_carry_the_names_that_the_pattern_does_not_give() {
    let names = ["tänzer 1 é", "f_001", "tänzer 3 é", "", "動 5"];
    let meshes = frames("xx-xx", false);
    let pattern = FileNames { prefix: "f_".into(), digits: 3, first: 0 };
    let mut encoder = Encoder::new(Vec::new(), config().with_names(pattern)).expect("sound");
    for (mesh, name) in meshes.iter().zip(names) {
        encoder.push_named(mesh, name).expect("sound");
    }
    let stream = encoder.finish().expect("sound").writer;
    let found: Vec<String> = decode(&stream).into_iter().filter_map(|(.., name)| name).collect();
    assert_eq!(found, ["tänzer 1 é", "f_001", "tänzer 3 é", "f_003", "動 5"]);
    let mut encoder = Encoder::new(Vec::new(), config()).expect("sound");
    let error = encoder.push_named(&meshes[0], "a/b").expect_err("no name").to_string();
    assert!(error.contains("cannot carry the name \"a/b\""), "{error}");
}
