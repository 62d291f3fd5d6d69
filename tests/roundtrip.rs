//! The encoder's reports agree with the decoder's frames.

mod common;

use common::{decode, encode, performer, small_config};
use kn_bitstream::params::{Combination, FileNames, InfluenceMode, Weights};
use kn_codec::{AffineChoice, Decoder, EncoderConfig, FrameKind, GridChoice, SmoothingChoice};
use kn_mesh::Mesh;
use std::io::Cursor;

/// The digests in the stream are the encoder's own reconstruction; decoding checks every one.
fn digests_hold(frames: &[Mesh], config: EncoderConfig) {
    let stream = encode(frames, config);
    assert_eq!(decode(&stream).len(), frames.len());
}

#[test]
fn every_combination_and_affine_choice_decodes_to_the_encoders_frames() {
    let frames = performer(3, 2000);
    for combination in Combination::ALL {
        for affine in [AffineChoice::torso(), AffineChoice::All] {
            digests_hold(&frames, small_config().with_combination(combination).with_affine(affine));
        }
    }
    digests_hold(&frames, small_config().with_affine(AffineChoice::None));
}

#[test]
fn every_weight_scheme_mode_and_precision_decodes_to_the_encoders_frames() {
    let frames = performer(3, 2000);
    let gaussian = Weights::gaussian(60);
    for weights in [Weights::INVERSE_SQUARE, Weights::SUMNER, gaussian] {
        digests_hold(&frames, small_config().with_weights(weights));
    }
    for nodes_per_vertex in [1, 2, 8] {
        digests_hold(&frames, small_config().with_nodes_per_vertex(nodes_per_vertex));
    }
    for fraction_bits in [0, 3] {
        digests_hold(&frames, small_config().with_fraction_bits(fraction_bits));
    }
    digests_hold(&frames, small_config().with_influence(InfluenceMode::Strict));
}

#[test]
fn scans_without_labels_are_coded() {
    let mut frames = performer(4, 2000);
    frames.iter_mut().for_each(|frame| frame.labels.clear());
    for affine in [AffineChoice::torso(), AffineChoice::All] {
        digests_hold(&frames, small_config().with_affine(affine));
    }
}

#[test]
fn groups_of_every_length_hold_all_frames() {
    let frames = performer(5, 1200);
    for group_length in [1, 2, 5, 255] {
        let stream = encode(&frames, small_config().with_group_length(group_length));
        let mut decoder = Decoder::new(Cursor::new(&stream)).expect("a stream");
        assert_eq!(decoder.frame_count().expect("an index"), 5);
        let mut mesh = Mesh::default();
        let mut bytes = 0;
        while let Some(info) = decoder.next_frame(&mut mesh).expect("sound") {
            let intra = info.index % u64::from(group_length) == 0;
            assert_eq!(info.kind == FrameKind::Intra, intra);
            bytes += info.bytes;
        }
        assert!(bytes < stream.len() as u64);
    }
}

#[test]
fn seeking_shows_the_frame_that_decoding_in_order_shows() {
    let frames = performer(8, 1200);
    let stream = encode(&frames, small_config());
    let in_order = decode(&stream);
    let mut decoder = Decoder::new(Cursor::new(&stream)).expect("a stream");
    let mut mesh = Mesh::default();
    for frame in [7, 0, 4, 3, 2, 6] {
        decoder.seek(frame).expect("the frame exists");
        let info = decoder.next_frame(&mut mesh).expect("sound").expect("a frame");
        assert_eq!(info.index, frame);
        assert_eq!(mesh, in_order[frame as usize].mesh);
    }
    // From the last seek on to the end, through the index.
    assert!(decoder.next_frame(&mut mesh).expect("sound").is_some());
    assert!(decoder.next_frame(&mut mesh).expect("the index matches").is_none());
    let error = decoder.seek(8).expect_err("there are 8 frames");
    assert_eq!(error.to_string(), "there is no frame 8; the stream has 8");
}

/// Without smoothing an I-frame gives every vertex back on its grid point, and every face.
#[test]
fn an_intra_frame_is_the_scan_on_the_grid() {
    let frames = performer(1, 3000);
    let step = 0.004;
    let grid = GridChoice::Step { step, bounds: None };
    let smoothing = SmoothingChoice::Strength(0);
    let decoded =
        decode(&encode(&frames, small_config().with_grid(grid).with_smoothing(smoothing)));
    let (scan, shown) = (&frames[0], &decoded[0].mesh);
    assert_eq!(scan.positions.len(), shown.positions.len());
    assert_eq!(scan.faces.len(), shown.faces.len());
    let mut scan_corners: Vec<_> = scan.positions.iter().map(|p| on_grid(*p, scan, step)).collect();
    let origin = scan.bounding_box().expect("vertices").min;
    let unit = f64::from(1 << small_config().sequence.fraction_bits);
    let mut shown_corners: Vec<_> = decoded[0]
        .positions
        .iter()
        .map(|p| p.map(|c| c >> small_config().sequence.fraction_bits))
        .collect();
    scan_corners.sort_unstable();
    shown_corners.sort_unstable();
    assert_eq!(scan_corners, shown_corners);
    for (integer, world) in decoded[0].positions.iter().zip(&shown.positions) {
        for axis in 0..3 {
            assert_eq!(f64::from(integer[axis]) % unit, 0.0);
            let expected = origin[axis] + step * f64::from(integer[axis]) / unit;
            assert_eq!(world[axis], expected);
        }
    }
}

/// Smoothing moves no coordinate by more than half a grid step, and brings the surface closer.
#[test]
fn smoothing_stays_inside_the_grid_s_uncertainty() {
    let frames = performer(1, 3000);
    let decoded = |smoothing| {
        let grid = GridChoice::Bits { bits: 8, bounds: None };
        decode(&encode(&frames, small_config().with_grid(grid).with_smoothing(smoothing)))
    };
    let plain = &decoded(SmoothingChoice::Strength(0))[0].positions;
    let half_step = (1 << small_config().sequence.fraction_bits) / 2;
    let mut last = plain.clone();
    for strength in 1..=5 {
        let smooth = decoded(SmoothingChoice::Strength(strength)).remove(0).positions;
        let moves = smooth.iter().flatten().zip(plain.iter().flatten()).map(|(a, b)| (a - b).abs());
        assert!(moves.max() <= Some(half_step));
        assert_ne!(smooth, last, "strength {strength}");
        last = smooth;
    }
    assert_ne!(decoded(SmoothingChoice::Auto)[0].positions, *plain, "8 bits are coarse");
}

fn on_grid(position: [f64; 3], scan: &Mesh, step: f64) -> [i32; 3] {
    let origin = scan.bounding_box().expect("vertices").min;
    std::array::from_fn(|axis| ((position[axis] - origin[axis]) / step).round() as i32)
}

#[test]
fn frames_are_named_by_the_pattern() {
    let names = Some(FileNames { prefix: "dance_".into(), digits: 4, first: 17 });
    let stream = encode(&performer(2, 1200), small_config().with_names(names));
    let mut decoder = Decoder::new(Cursor::new(&stream)).expect("a stream");
    let mut mesh = Mesh::default();
    let mut seen = Vec::new();
    while decoder.next_frame(&mut mesh).expect("sound").is_some() {
        seen.push(decoder.stream().frame_name().expect("named"));
    }
    assert_eq!(seen, ["dance_0017", "dance_0018"]);
}
