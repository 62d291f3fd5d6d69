//! Streams that lie: every one gives an error or frames inside the limits, never a panic.

mod common;

use common::{encode, performer, small_config};
use kn_codec::{DecodeError, DecodeErrorKind, EncoderConfig, Limits, Progress, StreamDecoder};
use kn_mesh::Mesh;

fn stream() -> Vec<u8> {
    let config = EncoderConfig { group_length: 2, nodes: 12, ..small_config() };
    encode(&performer(3, 1000), config)
}

/// All frames, or the first error; a stream that just stops is an error too.
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

/// Ends of the units of a sound stream, with the offset of each payload.
fn units(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    use kn_bitstream::unit::{Framing, SizeLimits, read_unit};
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

fn mend_crc(bytes: &mut [u8], unit: &std::ops::Range<usize>) {
    let crc_start = unit.end - 4;
    let crc = crc32fast::hash(&bytes[unit.start..crc_start]);
    bytes[crc_start..unit.end].copy_from_slice(&crc.to_be_bytes());
}

#[test]
fn the_stream_itself_is_sound() {
    assert_eq!(run(&stream()).expect("sound"), 3);
}

#[test]
fn every_truncation_is_an_error() {
    let stream = stream();
    let units = units(&stream);
    // Every length around the units' ends, and a spread of the others.
    let near = |length: usize| units.iter().any(|unit| length.abs_diff(unit.end) < 40);
    for length in (0..stream.len()).filter(|&length| near(length) || length % 61 == 0) {
        let error = run(&stream[..length]).expect_err("it is cut short");
        assert!(matches!(error.kind(), DecodeErrorKind::Truncated { .. }), "{length}: {error}");
    }
}

#[test]
fn a_spare_byte_is_an_error() {
    let mut stream = stream();
    stream.push(0);
    let error = run(&stream).expect_err("one byte too many");
    assert_eq!(error.rule(), Some("file.order"));
}

#[test]
fn every_flipped_bit_of_every_header_is_found() {
    let sound = stream();
    for (number, unit) in units(&sound).iter().enumerate() {
        for bit in 8 * unit.start..8 * unit.end.min(unit.start + 64) {
            let mut broken = sound.clone();
            broken[bit / 8] ^= 0x80 >> (bit % 8);
            let error = run(&broken).expect_err("a CRC finds one flipped bit");
            let text = error.to_string();
            assert!(!text.is_empty(), "unit {number}, bit {bit}");
        }
    }
}

#[test]
fn with_the_crc_mended_a_flipped_bit_errs_or_decodes() {
    let sound = stream();
    for unit in units(&sound) {
        let bits = 8 * (unit.end - 4 - unit.start);
        let step = (bits / 400).max(1);
        for bit in (0..bits.min(512)).chain((512..bits).step_by(step)) {
            let mut broken = sound.clone();
            broken[unit.start + bit / 8] ^= 0x80 >> (bit % 8);
            mend_crc(&mut broken, &unit);
            // Either is allowed; that it comes back at all, inside the limits, is the test.
            let _ = run(&broken);
        }
    }
}

#[test]
fn limits_are_checked_before_anything_is_built() {
    let stream = stream();
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
