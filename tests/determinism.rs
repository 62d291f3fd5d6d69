//! Same input, same stream; same stream, same frames: for any number of threads, any chunking.

mod common;

use common::{decode, encode, performer, small_config, with_threads};
use kn_codec::{Limits, Progress, StreamDecoder};
use kn_mesh::Mesh;

#[test]
fn the_stream_does_not_depend_on_threads() {
    let frames = performer(4, 2500);
    let streams =
        [1, 2, 8].map(|threads| with_threads(threads, || encode(&frames, small_config())));
    assert!(streams[0] == streams[1], "2 threads");
    assert!(streams[0] == streams[2], "8 threads");
}

#[test]
fn decoded_frames_do_not_depend_on_threads() {
    let stream = encode(&performer(4, 9000), small_config());
    let frames = [1, 2, 8].map(|threads| with_threads(threads, || decode(&stream)));
    assert!(frames[0] == frames[1], "2 threads");
    assert!(frames[0] == frames[2], "8 threads");
}

#[test]
fn decoded_frames_do_not_depend_on_how_bytes_arrive() {
    let stream = encode(&performer(4, 1200), small_config());
    let whole = decode(&stream);
    for chunk in [1, 7, 1000] {
        let mut decoder = StreamDecoder::new(Limits::default());
        let mut mesh = Mesh::default();
        let mut seen = 0;
        let mut chunks = stream.chunks(chunk);
        loop {
            match decoder.poll(&mut mesh).expect("a sound stream") {
                Progress::NeedBytes(n) => {
                    assert!(n > 0);
                    decoder.push(chunks.next().expect("not yet complete"));
                }
                Progress::Frame(info) => {
                    assert_eq!(info.index, seen as u64);
                    assert!(mesh == whole[seen].mesh, "frame {seen} in chunks of {chunk}");
                    seen += 1;
                }
                Progress::End => break,
            }
        }
        assert_eq!(seen, whole.len());
    }
}
