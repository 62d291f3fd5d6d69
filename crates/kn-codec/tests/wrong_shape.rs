//! A decoded frame is never a wrong shape, whatever is in the frames: a P-frame that would be one
//! begins a new GoF. And what a scanner adds to a frame begins none.

// The shapes are this test's own: they need not be the same everywhere.
#![allow(clippy::disallowed_methods)]

use kn_codec::{Decoder, Encoder, EncoderConfig, FrameKind, FrameReport};
use kn_mesh::Mesh;
use kn_metrics::{CompareOptions, MeshRef, Surface, p2s, p2s_of_vertices};
use kn_performer::{Action, Performer, PerformerConfig};
use std::io::Cursor;

/// A closed tube around the y axis that stands at `at`, with a waist so that it is no prism.
fn tube(at: [f64; 3], [height, radius]: [f64; 2], [rings, sides]: [u32; 2]) -> Mesh {
    let mut mesh = Mesh::default();
    for ring in 0..=rings {
        let up = ring as f64 / rings as f64;
        let radius = radius * (1.0 - 0.4 * (std::f64::consts::PI * up).sin());
        for side in 0..sides {
            let angle = std::f64::consts::TAU * side as f64 / sides as f64;
            let place = [radius * angle.cos(), height * up, radius * angle.sin()];
            mesh.positions.push(std::array::from_fn(|axis| at[axis] + place[axis]));
        }
    }
    for ring in 0..rings {
        for side in 0..sides {
            let [a, b] = [side, (side + 1) % sides].map(|side| ring * sides + side);
            mesh.faces.extend([[a, a + sides, b], [b, a + sides, b + sides]]);
        }
    }
    for side in 1..sides - 1 {
        let top = rings * sides;
        mesh.faces.extend([[0, side, side + 1], [top, top + side + 1, top + side]]);
    }
    mesh
}

/// A body that has walked for `step` frames.
fn body(step: usize) -> Mesh {
    tube([0.02 * step as f64, 0.0, 0.01 * step as f64], [1.7, 0.2], [8, 8])
}

fn chair() -> Mesh {
    tube([1.2, 0.0, 0.3], [0.85, 0.1], [4, 6])
}

fn floor(half: f64) -> Mesh {
    let positions = [[-half, -half], [half, -half], [half, half], [-half, half]];
    faces_only(positions.map(|[x, z]| [x, 0.0, z]).to_vec(), vec![[0, 2, 1], [0, 3, 2]])
}

fn triangle(at: [f64; 3], side: f64) -> Mesh {
    let corner = |x: f64, y: f64| [at[0] + side * x, at[1] + side * y, at[2]];
    faces_only(vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)], vec![[0, 1, 2]])
}

fn faces_only(positions: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(positions, faces)
}

fn both(mut one: Mesh, other: &Mesh) -> Mesh {
    let first = one.positions.len() as u32;
    one.positions.extend(&other.positions);
    one.faces.extend(other.faces.iter().map(|face| face.map(|v| v + first)));
    one
}

/// The part of a mesh below a height.
fn below(mut mesh: Mesh, height: f64) -> Mesh {
    let low: Vec<bool> = mesh.positions.iter().map(|position| position[1] < height).collect();
    mesh.retain_faces(|face| face.iter().all(|&v| low[v as usize]));
    kn_mesh::clean(&mesh).expect("sound").drop_isolated().mesh
}

/// Every face with corners of its own, a little apart from its neighbours'.
fn apart(mesh: &Mesh) -> Mesh {
    let mut soup = Mesh::default();
    for (number, face) in mesh.faces.iter().enumerate() {
        let first = soup.positions.len() as u32;
        let shift = 1e-3 * (number % 7) as f64;
        soup.positions.extend(face.map(|v| mesh.positions[v as usize].map(|c| c + shift)));
        soup.faces.push([first, first + 1, first + 2]);
    }
    soup
}

/// Frames in which something comes, goes or is different, by name.
fn sequences() -> Vec<(&'static str, Vec<Mesh>)> {
    let two = |step| both(body(step), &chair());
    let fan = |lift: f64| {
        let positions =
            vec![[0.0, lift, 0.0], [1.0, 0.0, 0.0], [-0.5, 0.0, 0.9], [-0.5, 0.0, -0.9]];
        faces_only(positions, vec![[0, 1, 2], [0, 2, 3], [0, 3, 1]])
    };
    let fine = |height: f64| below(tube([0.0; 3], [1.7, 0.2], [30, 24]), height);
    vec![
        ("floor, then a body", vec![floor(1.0), body(0), body(1), body(2)]),
        ("a wide floor, then a body on it", {
            let on = |step| both(floor(6.0), &body(step));
            vec![floor(6.0), on(0), on(1), on(2)]
        }),
        ("the body leaves", vec![two(0), chair(), chair()]),
        ("the body leaves and returns", vec![two(0), two(1), chair(), two(2), two(3)]),
        ("a chair appears", vec![body(0), two(0), two(1)]),
        ("one of two bodies leaves", {
            let other = |step| tube([1.5, 0.0, 0.01 * step as f64], [1.6, 0.2], [7, 9]);
            vec![both(body(0), &other(0)), both(body(1), &other(1)), other(2), other(3)]
        }),
        ("a triangle between", vec![body(0), body(1), triangle([0.0; 3], 1.0), body(2), body(3)]),
        ("a triangle first", vec![triangle([0.3; 3], 0.5), body(0), body(1)]),
        ("a stray triangle far away", {
            let stray = both(body(1), &triangle([30.0, 0.0, 5.0], 0.3));
            vec![body(0), stray.clone(), stray, body(2), body(3)]
        }),
        ("an upper half returns", vec![body(0), body(1), below(body(2), 0.9), body(3), body(4)]),
        ("an upper half enters", vec![fine(0.7), fine(2.0), fine(2.0)]),
        ("three faces that grow", vec![fan(0.05), fan(0.3), fan(1.5), fan(0.2)]),
        ("triangles without common corners", (0..4).map(|step| apart(&body(step))).collect()),
        ("a soup that becomes a floor", vec![apart(&body(0)), floor(0.5), apart(&body(1))]),
        ("a frame without area", {
            let line =
                faces_only(vec![[0.0; 3], [0.5, 0.5, 0.0], [1.0, 1.0, 0.0]], vec![[0, 1, 2]]);
            vec![body(0), body(1), line.clone(), line, body(2)]
        }),
    ]
}

fn encode(frames: &[Mesh], config: EncoderConfig) -> (Vec<Mesh>, Vec<FrameReport>) {
    let mut encoder = Encoder::new(Vec::new(), config).expect("sound settings");
    frames.iter().for_each(|frame| encoder.push(frame).expect("a frame"));
    let finished = encoder.finish().expect("a vector takes everything");
    let mut decoder = Decoder::new(Cursor::new(&finished.writer)).expect("a stream");
    decoder.check_digests(true);
    let (mut decoded, mut mesh) = (Vec::new(), Mesh::default());
    while decoder.next_frame(&mut mesh).expect("sound").is_some() {
        decoded.push(mesh.clone());
    }
    (decoded, finished.reports)
}

/// The larger RMS distance of area samples and of vertices, both ways; `None` without an area.
fn distance(one: &Mesh, other: &Mesh) -> Option<f64> {
    let options = CompareOptions::distances();
    let surface = |mesh: &Mesh| Surface::new(mesh.into(), &options).ok();
    let (one, other) = (surface(one)?, surface(other)?);
    let even = p2s(one.indexed(), other.indexed(), 5000).ok()?;
    let corners = p2s_of_vertices(one.indexed(), other.indexed()).ok()?;
    Some(even.rms().max(corners.rms()))
}

fn diagonal(frames: &[Mesh]) -> f64 {
    let positions: Vec<[f64; 3]> =
        frames.iter().flat_map(|frame| frame.positions.iter().copied()).collect();
    let bounds = MeshRef::new(&positions, &[]).bounding_box().expect("vertices");
    (0..3).map(|k| (bounds.max[k] - bounds.min[k]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn no_decoded_frame_is_a_wrong_shape() {
    for (name, frames) in sequences() {
        for scale in [1e-3, 1.0, 700.0] {
            let mut frames = frames.clone();
            frames
                .iter_mut()
                .flat_map(|f| &mut f.positions)
                .for_each(|p| *p = p.map(|c| c * scale));
            for group_length in [2, 8] {
                let config = EncoderConfig::default().with_group_length(group_length);
                let (decoded, reports) = encode(&frames, config);
                assert_eq!((decoded.len(), reports.len()), (frames.len(), frames.len()), "{name}");
                let whole = diagonal(&frames);
                for (index, (frame, scan)) in decoded.iter().zip(&frames).enumerate() {
                    let Some(distance) = distance(frame, scan) else { continue };
                    let share = distance / whole;
                    assert!(
                        share < 0.015,
                        "{name} × {scale}, GoFs of {group_length}, frame {index}: {share:.4}, {:?}",
                        reports[index]
                    );
                }
            }
        }
    }
}

#[test]
fn the_bound_is_a_setting_and_in_the_report() {
    let frames: Vec<Mesh> = (0..4).map(body).collect();
    let (_, reports) = encode(&frames, EncoderConfig::default());
    for report in reports[1..].iter().map(|report| report.predicted().expect("a P-frame")) {
        let (error, bound) = (report.error, report.error_bound);
        assert!(error.rms <= bound.rms && error.region <= bound.region, "{error:?} {bound:?}");
        assert!(bound.rms > 0.01 && bound.rms < 0.012, "{bound:?}");
    }
    let strict = EncoderConfig::default().with_max_error(1e-9).with_nodes(1);
    let growing: Vec<Mesh> =
        (0..3).map(|step| tube([0.0; 3], [1.7, 0.2 + 0.02 * step as f64], [8, 8])).collect();
    let (_, reports) = encode(&growing, strict);
    let reason = reports[1].intra().and_then(|intra| intra.reason).expect("an I-frame");
    assert!(reason.to_string().contains("of the scan's size away"), "{reason}");
}

/// Specks of a scanner, different in every frame, around a body.
fn with_specks(mut mesh: Mesh, seed: u64) -> Mesh {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 40) as f64 / (1 << 24) as f64
    };
    mesh.labels.clear();
    for _ in 0..80 {
        let at = [0.8 * random() - 0.4, 1.8 * random(), 0.8 * random() - 0.4];
        mesh = both(mesh, &tube(at, [0.008, 0.004], [1, 4]));
    }
    mesh
}

#[test]
fn specks_that_come_and_go_begin_no_new_group() {
    let config =
        PerformerConfig { vertices: 4_000, action: Action::Walk, ..PerformerConfig::default() };
    let performer = Performer::new(config).expect("settings in range");
    let frames: Vec<Mesh> =
        (0..6).map(|index| with_specks(performer.frame(index), index.into())).collect();
    let (_, reports) = encode(&frames, EncoderConfig::default().with_group_length(16));
    let kinds: Vec<FrameKind> = reports.iter().map(FrameReport::kind).collect();
    assert!(kinds[1..].iter().all(|&kind| kind == FrameKind::Predicted), "{reports:?}");
}
