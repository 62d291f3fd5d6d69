//! Sequences from files and streams, and their comparison.

mod common;

use common::{FRAMES, Files};
use kn_codec::FrameKind;
use kn_mesh::Mesh;
use kn_sequence::{
    CompareOptions, CompareSequences, Metric, Sequence, SequenceError, SequenceOptions,
    StreamSource, compare_sequences, compare_sequences_with,
};
use std::fs;

fn open(files: &Files, name: &str) -> Sequence {
    Sequence::open(&files.path(name), &SequenceOptions::cleaned()).expect("opened")
}

/// Point-to-surface distances alone, which are fast.
fn distances() -> CompareSequences {
    let mut options = CompareSequences::default();
    options.metrics = CompareOptions::distances();
    options
}

#[test]
fn a_stream_and_its_files_are_the_same_sequence() {
    let files = Files::new();
    let (scans, stream) = (open(&files, "f_*.obj"), open(&files, "a.knm"));
    let bytes = fs::read(files.path("a.knm")).expect("read");
    let memory: Sequence =
        StreamSource::Memory { name: "memory".into(), bytes: bytes.into() }.into();
    assert_eq!((scans.files().count(), stream.files().count()), (FRAMES, 1));
    assert_eq!((memory.name(), memory.files().count()), ("memory", 0));
    // A sequence can be read again.
    for _ in 0..2 {
        let frames: Result<Vec<_>, _> = stream.frames().expect("opened").collect();
        let frames = frames.expect("decoded");
        assert_eq!(frames.len(), FRAMES);
        assert_eq!(frames[0].kind, Some(FrameKind::Intra));
        let mut from_memory = memory.frames().expect("opened");
        for frame in &frames {
            let other = from_memory.next().expect("a frame").expect("decoded");
            assert_eq!((&frame.mesh, frame.bytes), (&other.mesh, other.bytes));
        }
    }
    let found = compare_sequences(&scans, &stream, &distances()).expect("measured");
    assert_eq!(found.frames.len(), FRAMES);
    assert!(found.mean.get(Metric::P2sPsnr).is_some_and(|psnr| psnr > 50.0), "{found:?}");
    assert!(found.mean_predicted.is_some());
    assert!(found.frames[0].bytes.is_some());
}

#[test]
fn only_the_frames_that_were_asked_for_are_measured() {
    let files = Files::new();
    let (scans, stream) = (open(&files, "f_*.obj"), open(&files, "a.knm"));
    let mut options = distances();
    options.frames = 1..=1;
    let mut pairs = Vec::new();
    let found = compare_sequences_with(&scans, &stream, &options, |pair| {
        pairs.push((pair.reference.index, pair.distorted.index));
    });
    let found = found.expect("measured");
    assert_eq!((found.frames.len(), found.frames[0].index), (1, 1));
    assert_eq!(pairs, [(1, 1)]);
    options.frames = 7..=9;
    let error = compare_sequences(&scans, &stream, &options).expect_err("no such frame");
    assert!(error.to_string().starts_with("there is no frame 7 to measure"), "{error}");
}

#[test]
fn a_part_is_measured_where_there_are_labels() {
    let files = Files::new();
    let labelled = SequenceOptions::cleaned().with_labels(Some(files.path("f_*.labels")));
    let scans = Sequence::open(&files.path("f_*.obj"), &labelled).expect("opened");
    let stream = open(&files, "a.knm");
    let mut options = distances();
    options.part = Some(0);
    let head = compare_sequences(&scans, &stream, &options).expect("measured");
    assert!(head.mean.get(Metric::P2sRms).is_some_and(|rms| rms < 0.01), "{head:?}");
    options.part = Some(14);
    let error = compare_sequences(&scans, &stream, &options).expect_err("no such part");
    assert!(matches!(error, SequenceError::NoPart { part: 14, .. }), "{error}");
    let bare = open(&files, "f_*.obj");
    options.part = Some(0);
    let error = compare_sequences(&bare, &stream, &options).expect_err("no labels");
    assert!(matches!(error, SequenceError::NoLabels { frame: 0, .. }), "{error}");
}

#[test]
fn a_sequence_that_ends_early_is_named() {
    let files = Files::new();
    fs::remove_file(files.path("f_2.obj")).expect("removed");
    let (short, long) = (open(&files, "f_*.obj"), open(&files, "a.knm"));
    for (reference, distorted) in [(&short, &long), (&long, &short)] {
        let error = compare_sequences(reference, distorted, &distances()).expect_err("too short");
        let told = error.to_string();
        assert!(told.contains("f_*.obj: frame 2: there is no such frame, but"), "{told}");
    }
}

#[test]
fn broken_input_is_named_with_file_and_frame() {
    let files = Files::new();
    let flat = Mesh::new(vec![[1.0, 2.0, 3.0]; 3], vec![[0, 1, 2]]);
    kn_io::write_mesh(&files.path("f_1.obj"), &flat).expect("written");
    let scans = open(&files, "f_*.obj");
    let error = scans.bounds().expect_err("a degenerate frame").to_string();
    assert!(error.contains("f_1.obj: frame 1: all faces are degenerate"), "{error}");

    let mut bytes = fs::read(files.path("a.knm")).expect("read");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(files.path("a.knm"), bytes).expect("written");
    let frames: Result<Vec<_>, _> = open(&files, "a.knm").frames().expect("opened").collect();
    let error = frames.expect_err("damaged").to_string();
    assert!(error.contains("a.knm: ") && error.contains("the stream is damaged"), "{error}");

    let missing = open(&files, "b.knm").frames().expect_err("missing");
    assert!(matches!(missing, SequenceError::Open { .. }), "{missing}");
}

#[test]
fn a_sequence_needs_an_extent() {
    let files = Files::new();
    let flat = Mesh::new(vec![[1.0, 2.0, 3.0]; 3], vec![[0, 1, 2]]);
    kn_io::write_mesh(&files.path("point.obj"), &flat).expect("written");
    let options = SequenceOptions::default();
    let point = Sequence::open(&files.path("point.obj"), &options).expect("opened");
    assert!(matches!(point.bounds(), Err(SequenceError::NoExtent)));
}
