//! Streams from files and from standard input.

use crate::output::is_dash;
use anyhow::{Context, Result, ensure};
use kn_bitstream::Trace;
use kn_bitstream::params::UnitOfLength;
use kn_codec::{
    DecodeError, DecodeErrorKind, Decoder, FrameInfo, FrameKind, Limits, Progress, StreamDecoder,
};
use kn_mesh::Mesh;
use kn_sequence::{Sequence, SequenceOptions, StreamReader, StreamSource};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// The longest stream that is taken from standard input.
const MAX_STDIN_BYTES: u64 = 1 << 32;

/// Bytes that are read at a time.
const CHUNK: usize = 1 << 16;

/// Name of a stream in messages.
pub(crate) fn name_of(path: &Path) -> String {
    if is_dash(path) { "standard input".into() } else { path.display().to_string() }
}

/// The stream that a path names; `-` is standard input, which is read whole, so that every command
/// can seek.
pub(crate) fn source(path: &Path) -> Result<StreamSource> {
    if !is_dash(path) {
        return Ok(StreamSource::File(path.to_owned()));
    }
    let mut bytes = Vec::new();
    let mut input = io::stdin().lock().take(MAX_STDIN_BYTES + 1);
    input.read_to_end(&mut bytes).context("standard input")?;
    let fits = bytes.len() as u64 <= MAX_STDIN_BYTES;
    ensure!(fits, "standard input: more than {MAX_STDIN_BYTES} bytes");
    Ok(StreamSource::Memory { name: name_of(path), bytes: bytes.into() })
}

/// Opens the stream that a path names.
pub(crate) fn open(path: &Path) -> Result<StreamReader> {
    Ok(source(path)?.reader()?)
}

/// A decoder over the stream that a path names; it checks digests.
pub(crate) fn decoder(path: &Path) -> Result<Decoder<StreamReader>> {
    Ok(source(path)?.decoder()?)
}

/// A sequence of meshes; `-` is a stream from standard input.
pub(crate) fn sequence(path: &Path, options: &SequenceOptions) -> Result<Sequence> {
    if is_dash(path) {
        return Ok(source(path)?.into());
    }
    Ok(Sequence::open(path, options)?)
}

/// Whether a path means a .knm stream; anything else is a mesh or a pattern of meshes.
pub(crate) fn is_stream(path: &Path) -> bool {
    is_dash(path) || path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("knm"))
}

/// Decodes a whole stream: `trace` sees every syntax element, `seen` every frame.
pub(crate) fn decode_traced(
    source: &mut StreamReader,
    check_digests: bool,
    trace: &mut Trace<'_>,
    mut seen: impl FnMut(FrameInfo),
) -> Result<(), DecodeError> {
    let mut stream = StreamDecoder::new(Limits::default());
    stream.check_digests(check_digests);
    let mut mesh = Mesh::default();
    let mut chunk = vec![0; CHUNK];
    let (mut bytes, mut frames) = (0, 0);
    loop {
        let progress = stream.poll_traced(&mut mesh, Some(&mut *trace))?;
        if let Progress::Frame(info) = progress {
            frames += 1;
            seen(info);
            continue;
        }
        let read = read_some(source, &mut chunk)?;
        bytes += read as u64;
        match (progress, read) {
            (Progress::End, 0) => return Ok(()),
            (_, 0) => return Err(DecodeErrorKind::Truncated { bytes, frames }.into()),
            _ => stream.push(&chunk[..read]),
        }
    }
}

fn read_some(source: &mut StreamReader, chunk: &mut [u8]) -> io::Result<usize> {
    loop {
        match source.read(chunk) {
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            result => return result,
        }
    }
}

/// I or P.
pub(crate) fn kind_letter(kind: FrameKind) -> &'static str {
    match kind {
        FrameKind::Intra => "I",
        FrameKind::Predicted => "P",
    }
}

/// The unit of the coordinates in messages.
pub(crate) fn unit_name(unit: UnitOfLength) -> String {
    match unit {
        UnitOfLength::Unspecified => "units".into(),
        unit => unit.to_string(),
    }
}
