//! A stream that arrives in pieces gives the frames and the error of the whole stream.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(init: kn_fuzz::one_thread(), |stream: &[u8]| {
    // The last bytes, of a sound stream its CRC, say how it arrives: any stream is a seed.
    let [.., first, length] = *stream else { return };
    let whole = kn_fuzz::decode(std::iter::once(stream));
    let (head, rest) = stream.split_at(usize::from(first).min(stream.len()));
    let pieces = std::iter::once(head).chain(rest.chunks(1 + usize::from(length)));
    let chunked = kn_fuzz::decode(pieces);
    assert_eq!(whole.frames, chunked.frames);
    assert_eq!(whole.ending, chunked.ending);
});
