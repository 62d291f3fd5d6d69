//! Small sequences of the performer and their streams.

// Each test binary uses its own part of this module.
#![allow(dead_code)]

use kn_codec::{Decoder, Encoder, EncoderConfig};
use kn_mesh::Mesh;
use kn_performer::{Performer, PerformerConfig};
use std::io::Cursor;

/// `count` frames of about `vertices` vertices, with noise, holes and labels.
pub(crate) fn performer(count: u32, vertices: usize) -> Vec<Mesh> {
    let config = PerformerConfig { vertices, holes: 2, ..PerformerConfig::default() };
    let performer = Performer::new(config).expect("the settings are in range");
    (0..count).map(|index| performer.frame(index)).collect()
}

/// Settings for small sequences: GoFs of three frames, thirty nodes.
pub(crate) fn small_config() -> EncoderConfig {
    EncoderConfig::default().with_group_length(3).with_nodes(30)
}

/// The stream of a sequence.
pub(crate) fn encode(frames: &[Mesh], config: EncoderConfig) -> Vec<u8> {
    let mut encoder = Encoder::new(Vec::new(), config).expect("sound settings");
    for frame in frames {
        encoder.push(frame).expect("a sound frame");
    }
    encoder.finish().expect("a vector takes everything").writer
}

/// One decoded frame as integers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Decoded {
    pub(crate) positions: Vec<[i32; 3]>,
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) mesh: Mesh,
}

/// All frames of a stream, digests checked.
pub(crate) fn decode(stream: &[u8]) -> Vec<Decoded> {
    let mut decoder = Decoder::new(Cursor::new(stream)).expect("a stream");
    decoder.check_digests(true);
    let mut frames = Vec::new();
    let mut mesh = Mesh::default();
    while decoder.next_frame(&mut mesh).expect("a sound stream").is_some() {
        frames.push(Decoded {
            positions: decoder.stream().grid_positions().to_vec(),
            faces: decoder.stream().faces().to_vec(),
            mesh: mesh.clone(),
        });
    }
    frames
}

/// Runs `work` in a pool of so many threads.
pub(crate) fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(work)
}
