//! Shared by the targets: a decoder inside small limits, and its frames.

use kn_codec::{DecodeError, Decoder, Limits, Progress, StreamDecoder, digest};
use kn_mesh::Mesh;
use std::io::Cursor;

/// Small enough that no input takes seconds.
pub const LIMITS: Limits =
    Limits { max_vertices: 1 << 13, max_faces: 1 << 14, max_nodes: 256, max_unit_bytes: 1 << 16 };

/// All work on this thread: one process is one core, and runs repeat.
pub fn one_thread() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    // Fails where the pool stands already.
    let _ = pool.build_global();
}

/// The frames as lines `index kind #V #F sha256`, and how the stream ended.
pub struct Decoded {
    /// Up to the end or the error.
    pub frames: Vec<String>,
    /// `end`, `needs bytes`, or the error's text.
    pub ending: String,
}

/// Decodes a stream that arrives in these pieces.
pub fn decode<'b>(pieces: impl Iterator<Item = &'b [u8]>) -> Decoded {
    let mut decoder = StreamDecoder::new(LIMITS);
    let mut frames = Vec::new();
    let mut ending = String::from("needs bytes");
    for piece in pieces {
        decoder.push(piece);
        match drain(&mut decoder, &mut frames) {
            Ok(Progress::End) => ending = "end".into(),
            Ok(_) => {}
            Err(error) => {
                ending = error.to_string();
                break;
            }
        }
    }
    Decoded { frames, ending }
}

/// Goes to frames by the index, the last first, and decodes what comes there.
pub fn seek(stream: &[u8]) {
    const FRAMES: u64 = 6;
    let Ok(mut decoder) = Decoder::with_limits(Cursor::new(stream), LIMITS) else { return };
    let Ok(count) = decoder.frame_count() else { return };
    let mut mesh = Mesh::default();
    for frame in (count.saturating_sub(FRAMES)..count).rev() {
        if decoder.seek(frame).is_ok()
            && let Ok(info) = decoder.next_frame(&mut mesh)
        {
            assert_eq!(info.map(|info| info.index), Some(frame));
        }
    }
}

/// All frames that the bytes so far hold.
fn drain(decoder: &mut StreamDecoder, frames: &mut Vec<String>) -> Result<Progress, DecodeError> {
    let mut mesh = Mesh::default();
    loop {
        match decoder.poll(&mut mesh)? {
            Progress::Frame(info) => {
                assert_eq!(mesh.positions.len(), info.vertices as usize);
                assert!(mesh.labels.is_empty() || mesh.labels.len() == mesh.positions.len());
                assert!(mesh.faces.as_flattened().iter().all(|&corner| corner < info.vertices));
                let sha256 = digest::frame_sha256(decoder.grid_positions(), decoder.faces());
                let kind = info.kind;
                frames.push(format!("{} {kind:?} {} {sha256}", info.index, info.vertices));
            }
            progress => return Ok(progress),
        }
    }
}
