//! Broken streams: an error that names file, frame, bit and rule, exit code 2, nothing left behind.

mod common;

use common::{Scans, fails, kn, names_in, stderr, succeeds};
use std::fs;
use std::path::Path;

/// An encoded sequence and the byte where its second frame begins.
fn encoded() -> (Scans, Vec<u8>) {
    let scans = Scans::new();
    let bytes = fs::read(scans.encoded()).expect("written");
    (scans, bytes)
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

/// Byte offset, name and value of every element.
fn elements(dump: &str) -> Vec<(usize, &str, &str)> {
    let parse = |line: &str| -> Option<(usize, usize)> {
        let bit = line.split_whitespace().next()?.parse::<usize>().ok()?;
        Some((bit / 8, line.len()))
    };
    dump.lines()
        .filter_map(|line| {
            let (byte, _) = parse(line)?;
            let mut words = line.split_whitespace().skip(1);
            Some((byte, words.next()?, words.next()?))
        })
        .collect()
}

#[test]
fn a_truncated_stream_is_refused_or_taken_in_part() {
    let (scans, bytes) = encoded();
    let dump = succeeds(["dump", &scans.text("a.knm")]);
    let elements = elements(&dump);
    let frame_ends = elements
        .windows(2)
        .filter(|pair| {
            pair[0].1 == "unit_crc" && matches!(pair[1], (_, "unit_type", "2" | "4" | "5"))
        })
        .map(|pair| pair[1].0);
    // In front of frame 1, 2, ... and of the index; the header's end comes first.
    for (frames, end) in frame_ends.enumerate().skip(1) {
        for cut in [end, end + 1] {
            fs::write(scans.path("cut.knm"), &bytes[..cut]).expect("written");
            let message = fails(["decode", &scans.text("cut.knm"), "-o", &scans.text("out")]);
            let plural = if frames == 1 { "" } else { "s" };
            let said =
                format!("the stream ends after {cut} bytes and {frames} whole frame{plural},");
            assert!(message.contains("cut.knm: ") && message.contains(&said), "{message}");
            assert!(!scans.path("out").exists());
            let (input, output) = (scans.text("cut.knm"), scans.text("out"));
            succeeds(["decode", &input, "-o", &output, "--partial"]);
            assert_eq!(names_in(&scans.path("out")).len(), frames);
            fs::remove_dir_all(scans.path("out")).expect("removed");
        }
    }
}

#[test]
fn every_command_refuses_a_stream_cut_anywhere() {
    let (scans, bytes) = encoded();
    let path = scans.path("cut.knm");
    let cuts = (0..=64).map(|i| i * (bytes.len() - 1) / 64);
    for (turn, cut) in cuts.enumerate() {
        fs::write(&path, &bytes[..cut]).expect("written");
        let command = ["info", "dump", "verify"][turn % 3];
        let output = kn([command, text(&path)]);
        assert_eq!(output.status.code(), Some(2), "{command} at {cut}");
        assert!(stderr(&output).contains("cut.knm: "), "{command} at {cut}: {}", stderr(&output));
    }
}

#[test]
fn bytes_after_the_end() {
    let (scans, mut bytes) = encoded();
    bytes.push(0);
    fs::write(scans.path("long.knm"), &bytes).expect("written");
    let message = fails(["verify", &scans.text("long.knm")]);
    assert!(message.contains("long.knm: ") && message.contains("(file.order)"), "{message}");
}

#[test]
fn a_flipped_bit_is_a_crc_error_that_names_the_unit() {
    let (scans, bytes) = encoded();
    let dump = succeeds(["dump", &scans.text("a.knm")]);
    let intra = elements(&dump).into_iter().filter(|element| element.1 == "connectivity_section");
    for (byte, ..) in intra {
        let mut bytes = bytes.clone();
        bytes[byte + 40] ^= 0x10;
        fs::write(scans.path("flip.knm"), &bytes).expect("written");
        let message = fails(["decode", &scans.text("flip.knm"), "-o", &scans.text("out")]);
        assert!(message.contains("flip.knm: frame "), "{message}");
        assert!(message.contains("the stream is damaged: unit_crc must be"), "{message}");
        assert!(message.contains("(unit.crc.match)"), "{message}");
    }
    assert!(!scans.path("out").exists());
}

#[test]
fn a_header_that_promises_too_much() {
    let scans = Scans::new();
    let signature = 0x8B4B_4E4D_0D0A_1A0A_u64.to_be_bytes();
    let huge = [&signature[..], &[1, 0xff, 0xff, 0xff, 0xff, 0x0f]].concat();
    fs::write(scans.path("huge.knm"), huge).expect("written");
    let message = fails(["info", &scans.text("huge.knm")]);
    assert!(
        message.contains("huge.knm: bit ") && message.contains("(unit.size.limit)"),
        "{message}"
    );

    fs::write(scans.path("other.knm"), "solid cube").expect("written");
    let (other, out) = (scans.text("other.knm"), scans.text("out"));
    for arguments in [&["info", &other][..], &["verify", &other], &["decode", &other, "-o", &out]] {
        let message = fails(arguments);
        let said = format!(
            "{other}: this is not a .knm stream: a file must begin with the signature of .knm \
             files (file.signature.value)"
        );
        assert_eq!(message, said);
    }
}

#[test]
fn a_stream_without_a_whole_frame_has_nothing_to_take_in_part() {
    let (scans, bytes) = encoded();
    let dump = succeeds(["dump", &scans.text("a.knm")]);
    let elements = elements(&dump);
    let intra =
        elements.iter().find(|element| element.1 == "connectivity_section").expect("a frame").0;
    fs::write(scans.path("cut.knm"), &bytes[..intra + 9]).expect("written");
    let (cut, out) = (scans.text("cut.knm"), scans.text("out"));
    let output = kn(["decode", &cut, "-o", &out, "--partial"]);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(said.contains(&format!("{cut}: there is no whole frame in this file")), "{said}");
    assert!(!scans.path("out").exists());
    // With some frames it says how many.
    fs::write(scans.path("cut.knm"), &bytes[..bytes.len() - 40]).expect("written");
    let output = kn(["decode", &cut, "-o", &out, "--partial", "--frames", "7.."]);
    let said = stderr(&output);
    assert!(said.contains("there is no frame 7: the file holds 4 whole frames"), "{said}");
}

#[test]
fn a_wrong_digest_is_a_difference_and_no_error() {
    let (scans, mut bytes) = encoded();
    let dump = succeeds(["dump", &scans.text("a.knm")]);
    let elements = elements(&dump);
    // The second unit_type 4 begins frame 2; its digest changes and its CRC is mended.
    let is_motion = |element: &&(usize, &str, &str)| element.1 == "unit_type" && element.2 == "4";
    let start = elements.iter().filter(is_motion).nth(1).expect("two P-frames").0;
    let after = |name: &str| {
        let found = elements.iter().find(|element| element.0 > start && element.1 == name);
        found.expect("in every frame").0
    };
    let (digest, crc) = (after("positions_digest"), after("unit_crc"));
    bytes[digest] ^= 1;
    let mended = crc32(&bytes[start..crc]).to_be_bytes();
    bytes[crc..crc + 4].copy_from_slice(&mended);
    fs::write(scans.path("differs.knm"), &bytes).expect("written");

    let output = kn(["verify", &scans.text("differs.knm")]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(said.contains("differs.knm: frame 2, bit "), "{said}");
    assert!(
        said.contains("the decoded frame is not the encoder's: positions_digest must"),
        "{said}"
    );
    assert_eq!(succeeds(["verify", &scans.text("a.knm")]).matches("all digests match").count(), 1);

    // What is decoded or measured is checked too, also frames that are only passed on the way.
    let (differs, out) = (scans.text("differs.knm"), scans.text("out"));
    let scan = scans.text("scan");
    for arguments in [
        &["decode", &differs, "-o", &out][..],
        &["decode", &differs, "-o", &out, "--partial"],
        &["compare", &scan, &differs, "--fast"],
    ] {
        let message = fails(arguments);
        assert!(message.contains("differs.knm: frame 2, bit "), "{message}");
    }
    assert!(!scans.path("out").exists());
}

/// CRC-32 of IEEE 802.3, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}
