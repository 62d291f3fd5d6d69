//! Frames that the motion does not explain begin a new GoF, and the report says why.

use kn_codec::{Decoder, Encoder, EncoderConfig, FrameKind, FrameReport};
use kn_mesh::Mesh;
use kn_performer::{Action, Performer, PerformerConfig, part};
use std::io::Cursor;

/// The frame from which on something is different.
const CHANGE: usize = 3;
const FRAMES: u32 = 6;

fn performer(ball: bool) -> Vec<Mesh> {
    let config = PerformerConfig {
        vertices: 3_000,
        action: Action::Walk,
        ball,
        ..PerformerConfig::default()
    };
    let performer = Performer::new(config).expect("settings in range");
    (0..FRAMES).map(|index| performer.frame(index)).collect()
}

/// Encodes with all frames in one GoF, if they let it; checks that every frame decodes.
fn encode(frames: &[Mesh]) -> Vec<FrameReport> {
    let config = EncoderConfig::default().with_group_length(16).with_nodes(80);
    let mut encoder = Encoder::new(Vec::new(), config).expect("sound settings");
    frames.iter().for_each(|frame| encoder.push(frame).expect("a sound frame"));
    let finished = encoder.finish().expect("a vector takes everything");
    let mut decoder = Decoder::new(Cursor::new(&finished.writer)).expect("a stream");
    assert_eq!(decoder.frame_count().expect("an index"), frames.len() as u64);
    decoder.check_digests(true);
    let mut mesh = Mesh::default();
    for report in &finished.reports {
        let frame = decoder.next_frame(&mut mesh).expect("sound").expect("a frame");
        assert_eq!((frame.index, frame.kind), (report.frame().index, report.kind()));
    }
    finished.reports
}

/// Asserts that the only I-frames are the first and the changed one, for a reason like `reason`.
#[track_caller]
fn begins_anew_at_the_change(frames: &[Mesh], reason: &[&str]) {
    let reports = encode(frames);
    let intra = |report: &&FrameReport| report.kind() == FrameKind::Intra;
    let reason_of = |report: &FrameReport| report.intra()?.reason.map(|reason| reason.to_string());
    let found: Vec<(u64, Option<String>)> =
        reports.iter().filter(intra).map(|r| (r.frame().index, reason_of(r))).collect();
    assert_eq!(found.len(), 2, "{found:?}");
    assert_eq!((&found[0], found[1].0), (&(0, None), CHANGE as u64));
    let told = found[1].1.as_deref().unwrap_or("no reason");
    assert!(reason.iter().any(|reason| told.contains(reason)), "{told}");
}

/// Moves a part; faces between it and the rest are dropped.
fn move_part(mesh: &mut Mesh, part: &[u8], way: [f64; 3]) {
    let inside = |labels: &[u8], v: u32| part.contains(&labels[v as usize]);
    let labels = &mesh.labels;
    mesh.faces.retain(|face| {
        let corners = face.iter().filter(|&&v| inside(labels, v)).count();
        corners == 0 || corners == 3
    });
    for (position, label) in mesh.positions.iter_mut().zip(labels) {
        if part.contains(label) {
            *position = std::array::from_fn(|axis| position[axis] + way[axis]);
        }
    }
}

#[test]
fn an_ordinary_walk_is_one_group() {
    let reports = encode(&performer(false));
    let anew = |report: &FrameReport| report.intra().is_some_and(|intra| intra.reason.is_some());
    assert!(!reports.iter().any(anew), "{reports:?}");
    assert!(reports[1..].iter().all(|report| report.kind() == FrameKind::Predicted));
}

#[test]
fn a_limb_that_is_gone() {
    let mut frames = performer(false);
    for mesh in &mut frames[CHANGE..] {
        let labels = mesh.labels.clone();
        mesh.faces.retain(|face| {
            face.iter().all(|&v| !part::LEFT_ARM[1..].contains(&labels[v as usize]))
        });
        *mesh = kn_mesh::clean(mesh).expect("sound").mesh;
    }
    // Where the arm hung beside the body, much of it lies near a surface that faces the other way.
    begins_anew_at_the_change(&frames, &["of the reference", "no partner"]);
}

#[test]
fn a_limb_that_is_elsewhere() {
    let mut frames = performer(false);
    let arm = &part::RIGHT_ARM[1..];
    frames[CHANGE..].iter_mut().for_each(|mesh| move_part(mesh, arm, [0.1, 0.6, 0.5]));
    begins_anew_at_the_change(&frames, &["of the reference", "of the frame"]);
}

#[test]
fn a_ball_let_go() {
    let mut frames = performer(true);
    let ball = [part::OTHER];
    for (number, mesh) in frames[CHANGE..].iter_mut().enumerate() {
        move_part(mesh, &ball, [0.0, -0.1 - 0.02 * number as f64, 0.12]);
    }
    begins_anew_at_the_change(&frames, &["comes apart", "of the reference", "of the frame"]);
}

#[test]
fn an_island_that_appears() {
    let mut frames = performer(false);
    for mesh in &mut frames[CHANGE..] {
        // A second head, half a metre beside the first.
        let first = mesh.positions.len() as u32;
        let apart: Vec<[f64; 3]> =
            mesh.positions.iter().map(|p| [p[0] + 0.7, p[1], p[2]]).collect();
        let head = |face: &&[u32; 3]| face.iter().all(|&v| mesh.labels[v as usize] == part::HEAD);
        let faces: Vec<[u32; 3]> =
            mesh.faces.iter().filter(head).map(|f| f.map(|v| v + first)).collect();
        mesh.positions.extend(apart);
        mesh.labels.extend_from_within(..);
        mesh.faces.extend(faces);
    }
    // Of two equal heads the fit may follow either, or be drawn between them.
    begins_anew_at_the_change(&frames, &["of the frame", "of the reference"]);
}
