//! Any bytes decode or err, inside the limits, from the start and from wherever the index sends a
//! reader; the faces of what they decode to are in range.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(init: kn_fuzz::one_thread(), |stream: &[u8]| {
    kn_fuzz::decode(std::iter::once(stream));
    kn_fuzz::seek(stream);
});
