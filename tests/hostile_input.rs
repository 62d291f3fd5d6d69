//! Streams that lie: every one gives an error or frames inside the limits, never a panic. They are
//! made from the performer's stream and from every stream of `spec/conformance/core`.

mod common;

use common::{encode, performer, small_config};
use kn_bitstream::rule;
use kn_bitstream::unit::{Framing, INDEX, INTRA_FRAME, SizeLimits, read_unit, write_unit};
use kn_bitstream::{BitWriter, Index, IndexGroup};
use kn_codec::{DecodeError, DecodeErrorKind, Decoder, Limits, Progress, StreamDecoder};
use kn_conform::load_corpus;
use kn_mesh::Mesh;
use std::io::Cursor;
use std::ops::Range;
use std::path::Path;

/// A sound stream and what it is called.
struct Sound {
    name: String,
    bytes: Vec<u8>,
}

fn performers() -> Sound {
    let config = small_config().with_group_length(2).with_nodes(12);
    Sound { name: "performer".into(), bytes: encode(&performer(3, 1000), config) }
}

/// The performer's stream and all core streams.
fn sound_streams() -> Vec<Sound> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("spec/conformance");
    let corpus = load_corpus(&folder).expect("the corpus is in the repository");
    let core = corpus.into_iter().filter(|stream| stream.name.starts_with("core/"));
    let mut streams = vec![performers()];
    streams.extend(core.map(|stream| {
        let bytes = std::fs::read(&stream.path).expect("it was found there");
        Sound { name: stream.name, bytes }
    }));
    assert!(streams.len() > 25, "{} streams", streams.len());
    streams
}

/// Number of frames, or the first error; a stream that just stops is an error too.
fn run(bytes: &[u8]) -> Result<u64, DecodeError> {
    let mut decoder = StreamDecoder::new(Limits::default());
    decoder.push(bytes);
    let mut mesh = Mesh::default();
    let mut frames = 0;
    loop {
        match decoder.poll(&mut mesh)? {
            Progress::Frame(info) => {
                assert!(mesh.faces.as_flattened().iter().all(|&v| v < info.vertices));
                frames += 1;
            }
            Progress::End => return Ok(frames),
            Progress::NeedBytes(_) => {
                let bytes = bytes.len() as u64;
                return Err(DecodeErrorKind::Truncated { bytes, frames }.into());
            }
        }
    }
}

/// The units of a sound stream.
fn units(bytes: &[u8]) -> Vec<Range<usize>> {
    let mut units = Vec::new();
    let mut start = 8;
    while start < bytes.len() {
        let Ok(Framing::Unit(unit)) = read_unit(&bytes[start..], SizeLimits::default()) else {
            panic!("a sound stream has whole units");
        };
        units.push(start..start + unit.total_len);
        start += unit.total_len;
    }
    units
}

fn mend_crc(bytes: &mut [u8], unit: &Range<usize>) {
    let crc_start = unit.end - 4;
    let crc = crc32fast::hash(&bytes[unit.start..crc_start]);
    bytes[crc_start..unit.end].copy_from_slice(&crc.to_be_bytes());
}

fn flip(bytes: &mut [u8], bit: usize) {
    bytes[bit / 8] ^= 0x80 >> (bit % 8);
}

#[test]
fn the_streams_themselves_are_sound() {
    for Sound { name, bytes } in sound_streams() {
        assert!(run(&bytes).unwrap_or_else(|error| panic!("{name}: {error}")) > 0, "{name}");
    }
}

/// Given byte by byte, a decoder has seen every truncation: it wants more until the last byte.
#[test]
fn every_truncation_is_an_error() {
    for Sound { name, bytes } in sound_streams() {
        let mut decoder = StreamDecoder::new(Limits::default());
        let mut mesh = Mesh::default();
        for (length, byte) in bytes.iter().enumerate() {
            let at = format!("{name}, cut after {length} bytes");
            let progress = loop {
                match decoder.poll(&mut mesh).unwrap_or_else(|error| panic!("{at}: {error}")) {
                    Progress::Frame(_) => {}
                    progress => break progress,
                }
            };
            assert!(matches!(progress, Progress::NeedBytes(1..)), "{at}: {progress:?}");
            decoder.push(std::slice::from_ref(byte));
        }
    }
}

/// The same with a decoder for each truncation, near the units' ends and at some other places.
#[test]
fn a_stream_cut_short_is_an_error_at_once() {
    for Sound { name, bytes } in sound_streams() {
        let units = units(&bytes);
        let near = |length: usize| units.iter().any(|unit| length.abs_diff(unit.end) < 40);
        for length in (0..bytes.len()).filter(|&length| near(length) || length % 61 == 0) {
            let error = run(&bytes[..length]).expect_err("it is cut short");
            let truncated = matches!(error.kind(), DecodeErrorKind::Truncated { .. });
            assert!(truncated, "{name}, cut after {length} bytes: {error}");
        }
    }
}

#[test]
fn a_spare_byte_is_an_error() {
    for Sound { name, mut bytes } in sound_streams() {
        bytes.push(0);
        let error = run(&bytes).expect_err("one byte too many");
        assert_eq!(error.rule(), Some(rule::FILE_ORDER), "{name}");
    }
}

#[test]
fn every_flipped_bit_of_every_header_is_found() {
    for Sound { name, bytes: sound } in sound_streams() {
        for unit in std::iter::once(0..8).chain(units(&sound)) {
            for bit in 8 * unit.start..8 * unit.end.min(unit.start + 64) {
                let mut broken = sound.clone();
                flip(&mut broken, bit);
                let Err(error) = run(&broken) else { panic!("{name}: bit {bit} is not missed") };
                assert!(!error.to_string().is_empty(), "{name}, bit {bit}");
            }
        }
    }
}

#[test]
fn with_the_crc_mended_a_flipped_bit_errs_or_decodes() {
    for Sound { bytes: sound, .. } in sound_streams() {
        for unit in units(&sound) {
            let bits = 8 * (unit.end - 4 - unit.start);
            let step = (bits / 400).max(1);
            for bit in (0..bits.min(512)).chain((512..bits).step_by(step)) {
                let mut broken = sound.clone();
                flip(&mut broken, 8 * unit.start + bit);
                mend_crc(&mut broken, &unit);
                // Either is allowed; that it comes back at all, inside the limits, is the test.
                let _ = run(&broken);
            }
        }
    }
}

#[test]
fn limits_are_checked_before_anything_is_built() {
    let stream = performers().bytes;
    let asks = |limits: Limits| {
        let mut decoder = StreamDecoder::new(limits);
        decoder.push(&stream);
        let mut mesh = Mesh::default();
        loop {
            match decoder.poll(&mut mesh) {
                Ok(Progress::Frame(_)) => {}
                Ok(other) => panic!("{other:?} in spite of the limits"),
                Err(error) => return error.to_string(),
            }
        }
    };
    let default = Limits::default();
    assert!(asks(Limits { max_vertices: 100, ..default }).contains("vertices"));
    assert!(asks(Limits { max_faces: 100, ..default }).contains("faces"));
    assert!(asks(Limits { max_nodes: 11, ..default }).contains("12 key nodes"));
    assert!(asks(Limits { max_unit_bytes: 100, ..default }).contains("bytes in a unit"));
}

/// The stream with an index that has the GoFs begin at these bytes.
fn with_groups(bytes: &[u8], starts: &[usize], frames: u8) -> Vec<u8> {
    let units = units(bytes);
    let index = units.last().expect("a sound stream has an index");
    let ends = starts.iter().skip(1).chain([&index.start]);
    let groups = starts.iter().zip(ends);
    let group = |(start, end): (&usize, &usize)| IndexGroup { bytes: (end - start) as u32, frames };
    let mut bits = BitWriter::new();
    Index { groups: groups.map(group).collect() }.write(&mut bits);
    let mut lying = bytes[..index.start].to_vec();
    write_unit(&mut lying, INDEX, &bits.into_bytes());
    lying
}

/// An index may send a decoder anywhere; only an I-frame begins a GoF, whatever came before.
#[test]
fn seeking_by_an_index_that_lies_is_an_error() {
    for Sound { name, bytes } in sound_streams() {
        let units = units(&bytes);
        let first = units[1].start;
        for unit in &units[2..units.len() - 1] {
            let lying = with_groups(&bytes, &[first, unit.start], 1);
            for used in [false, true] {
                let at = format!("{name}, byte {}, used {used}", unit.start);
                let mut decoder = Decoder::new(Cursor::new(&lying)).expect("the header is sound");
                let mut mesh = Mesh::default();
                if used {
                    while decoder.next_frame(&mut mesh).is_ok_and(|frame| frame.is_some()) {}
                }
                decoder.seek(1).unwrap_or_else(|error| panic!("{at}: {error}"));
                let shown = decoder.next_frame(&mut mesh);
                if bytes[unit.start] == INTRA_FRAME {
                    assert!(shown.is_ok(), "{at}");
                } else {
                    let error = shown.expect_err("no I-frame is there");
                    assert_eq!(error.rule(), Some(rule::FILE_ORDER), "{at}");
                }
            }
        }
    }
}

/// A reader that cannot seek can still be read from where it stands.
#[test]
fn a_failed_search_for_the_index_leaves_the_reader_where_it_was() {
    let stream = performers().bytes;
    let cut = &stream[..stream.len() - 1];
    let mut decoder = Decoder::new(Cursor::new(cut)).expect("the header is sound");
    let mut mesh = Mesh::default();
    for frame in 0..3 {
        let error = decoder.frame_count().expect_err("the last byte is missing");
        assert_eq!(error.rule(), Some(rule::INDEX_SIZE_VALUE));
        let info = decoder.next_frame(&mut mesh).expect("sound so far").expect("a frame");
        assert_eq!(info.index, frame);
    }
}

#[test]
fn an_index_is_checked_like_any_other_unit() {
    let stream = performers().bytes;
    let rule = |stream: &[u8], limits: Limits| {
        let mut decoder = Decoder::with_limits(Cursor::new(stream), limits).expect("a header");
        decoder.frame_count().expect_err("it is broken")
    };
    let mut flipped = stream.clone();
    let last = 8 * stream.len() - 1;
    flip(&mut flipped, last);
    assert_eq!(rule(&flipped, Limits::default()).rule(), Some(rule::UNIT_CRC_MATCH));
    let start = units(&stream).last().expect("an index").start;
    let mut bits = BitWriter::new();
    Index { groups: vec![IndexGroup { bytes: 1, frames: 1 }] }.write(&mut bits);
    let mut payload = bits.into_bytes();
    // A spare byte before `index_size`, which counts it.
    let size = payload.len() - 4;
    payload.insert(size, 0);
    payload[size + 4] += 1;
    let mut spare = stream[..start].to_vec();
    write_unit(&mut spare, INDEX, &payload);
    assert!(rule(&spare, Limits::default()).rule().is_some());
    // The header of this stream has more bytes than its index.
    let many = (0..4000).map(|_| IndexGroup { bytes: 1, frames: 1 });
    let mut bits = BitWriter::new();
    Index { groups: many.collect() }.write(&mut bits);
    let mut large = stream[..start].to_vec();
    write_unit(&mut large, INDEX, &bits.into_bytes());
    let small = Limits { max_unit_bytes: 4000, ..Limits::default() };
    assert!(matches!(rule(&large, small).kind(), DecodeErrorKind::Limit { .. }));
}
