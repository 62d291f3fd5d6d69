//! A stream that the decoder takes is read by the interpreter to the same elements, and
//! written back to the same bytes.
#![no_main]

use std::path::Path;
use std::sync::LazyLock;

use kn_bitstream::unit::{Framing, SizeLimits, read_unit};
use kn_conform::{Spec, node_labels, stream_trace};
use libfuzzer_sys::fuzz_target;

static SPEC: LazyLock<Spec> = LazyLock::new(|| {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../spec"));
    Spec::load(folder).unwrap_or_else(|error| panic!("{error}"))
});

fuzz_target!(init: kn_fuzz::one_thread(), |stream: &[u8]| {
    let ending = kn_fuzz::decode(std::iter::once(stream)).ending;
    if ending != "end" {
        return;
    }
    let stream = with_mended_crcs(stream);
    let (by_decoder, result) = stream_trace(&stream);
    result.expect("it was decoded before");
    let by_tables = SPEC.parse(&stream, &node_labels).expect("the decoder takes it");
    assert_eq!(by_decoder, by_tables);
    SPEC.parse_strictly(&stream, &node_labels).1.expect("the decoder takes it");
    let text = SPEC.disassemble(&stream, &node_labels).expect("it was parsed before");
    let again = SPEC.assemble(&text, &node_labels).expect("its own text");
    assert_eq!(again, stream);
});

/// The CRC is not checked while fuzzing, but the assembler writes the right one.
fn with_mended_crcs(stream: &[u8]) -> Vec<u8> {
    let mut mended = stream.to_vec();
    let mut start = 8;
    while let Ok(Framing::Unit(unit)) = read_unit(&stream[start..], SizeLimits::default()) {
        let end = start + unit.total_len;
        let crc = crc32fast::hash(&stream[start..end - 4]);
        mended[end - 4..end].copy_from_slice(&crc.to_be_bytes());
        start = end;
    }
    mended
}
