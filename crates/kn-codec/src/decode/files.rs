//! A decoder that reads a file, and seeks in it.

use crate::decode::frame_info::FrameInfo;
use crate::decode::stream::{ParsedIndex, Progress, StreamDecoder};
use crate::error::{DecodeError, DecodeErrorKind};
use crate::limits::Limits;
use kn_bitstream::{Index, TAIL_BYTES, index_size, rule};
use kn_mesh::Mesh;
use std::io::{ErrorKind, Read, Seek, SeekFrom};

/// Number of bytes that one read asks for.
const CHUNK: usize = 1 << 16;

/// Decodes a stream from a reader, frame by frame, into a mesh whose buffers are reused.
///
/// Safe on untrusted input, see [`StreamDecoder`].
#[derive(Debug)]
pub struct Decoder<R> {
    reader: R,
    stream: StreamDecoder,
    chunk: Vec<u8>,
    index: Option<Index>,
    /// Offset of the first GoF in the file; set when the index is read.
    groups_start: u64,
}

impl<R: Read> Decoder<R> {
    /// Makes a decoder with the default [`Limits`], and reads the sequence header.
    ///
    /// # Errors
    /// See [`DecodeErrorKind`].
    pub fn new(reader: R) -> Result<Self, DecodeError> {
        Self::with_limits(reader, Limits::default())
    }

    /// Makes a decoder with the caller's limits, and reads the sequence header.
    ///
    /// # Errors
    /// See [`DecodeErrorKind`].
    pub fn with_limits(mut reader: R, limits: Limits) -> Result<Self, DecodeError> {
        let mut stream = StreamDecoder::new(limits);
        let mut chunk = vec![0; CHUNK];
        while stream.poll_header()?.is_some() {
            feed(&mut reader, &mut chunk, &mut stream)?;
        }
        Ok(Self { reader, stream, chunk, index: None, groups_start: 0 })
    }

    /// Decodes the next frame into `mesh`. Returns `None` after the last frame.
    ///
    /// # Errors
    /// See [`DecodeErrorKind`]. After an error the decoder goes on only after [`Self::seek`].
    pub fn next_frame(&mut self, mesh: &mut Mesh) -> Result<Option<FrameInfo>, DecodeError> {
        loop {
            match self.stream.poll(mesh)? {
                Progress::Frame(info) => return Ok(Some(info)),
                Progress::NeedBytes(_) => {
                    feed(&mut self.reader, &mut self.chunk, &mut self.stream)?;
                }
                Progress::End => {
                    // Nothing may follow the index.
                    if read_some(&mut self.reader, &mut self.chunk)? == 0 {
                        return Ok(None);
                    }
                    self.stream.push(&self.chunk[..1]);
                }
            }
        }
    }

    /// Sets whether every frame is compared with the digest that it carries. The default is no.
    pub fn check_digests(&mut self, check: bool) {
        self.stream.check_digests(check);
    }

    /// The decoder without I/O. It has the header, the grid, and the positions, faces and name of
    /// the last frame.
    pub fn stream(&self) -> &StreamDecoder {
        &self.stream
    }
}

impl<R: Read + Seek> Decoder<R> {
    /// The index at the end of the file: the GoFs in order.
    ///
    /// # Errors
    /// The file has no sound index, or the reader fails.
    pub fn index(&mut self) -> Result<&Index, DecodeError> {
        if self.index.is_none() {
            let position = self.reader.stream_position()?;
            let found = read_index(&mut self.reader, &self.stream);
            // Also where there is no sound index: frames may still be read from here on.
            self.reader.seek(SeekFrom::Start(position))?;
            let (index, groups_start) = found?;
            self.index = Some(index);
            self.groups_start = groups_start;
        }
        self.index.as_ref().ok_or_else(|| DecodeErrorKind::Failed.into())
    }

    /// Number of frames in the file, by its index.
    ///
    /// # Errors
    /// The errors of [`Self::index`].
    pub fn frame_count(&mut self) -> Result<u64, DecodeError> {
        Ok(self.index()?.groups.iter().map(|group| u64::from(group.frames)).sum())
    }

    /// Makes `frame` (from 0) the next frame. Decodes the frames of its GoF before it.
    ///
    /// # Errors
    /// The frame does not exist, the file has no sound index, or a frame before it cannot be
    /// decoded.
    pub fn seek(&mut self, frame: u64) -> Result<(), DecodeError> {
        let frames = self.frame_count()?;
        if frame >= frames {
            return Err(DecodeErrorKind::NoSuchFrame { frame, frames }.into());
        }
        let groups = &self.index()?.groups;
        let (mut group, mut first, mut bytes) = (0, 0, 0);
        while first + u64::from(groups[group].frames) <= frame {
            first += u64::from(groups[group].frames);
            bytes += u64::from(groups[group].bytes);
            group += 1;
        }
        let before = groups[..group].to_vec();
        let offset = self.groups_start + bytes;
        self.reader.seek(SeekFrom::Start(offset))?;
        self.stream.restart(offset, &before);
        let mut skipped = Mesh::default();
        for _ in first..frame {
            self.next_frame(&mut skipped)?;
        }
        Ok(())
    }
}

/// Reads the index unit and returns it with the offset of the first GoF. Its size is checked before
/// memory is allocated for it.
fn read_index<R: Read + Seek>(
    reader: &mut R,
    stream: &StreamDecoder,
) -> Result<(Index, u64), DecodeError> {
    let length = reader.seek(SeekFrom::End(0))?;
    let misplaced = |byte: u64| {
        let (rule, at) = (rule::INDEX_SIZE_VALUE, 8 * byte);
        DecodeError::from(DecodeErrorKind::Malformed { rule, at, frame: None })
    };
    let mut tail = [0; TAIL_BYTES];
    let tail_start = length.checked_sub(TAIL_BYTES as u64).ok_or_else(|| misplaced(0))?;
    reader.seek(SeekFrom::Start(tail_start))?;
    reader.read_exact(&mut tail)?;
    let size = index_size(tail) as usize;
    let start = length.checked_sub(size as u64).ok_or_else(|| misplaced(tail_start))?;
    reader.seek(SeekFrom::Start(start))?;
    let mut bytes = Vec::new();
    let index = loop {
        match stream.parse_index(&bytes, 8 * start)? {
            ParsedIndex::Index(index) => break index,
            ParsedIndex::NeedBytes(n) if bytes.len() + n <= size => {
                let had = bytes.len();
                bytes.resize(had + n, 0);
                reader.read_exact(&mut bytes[had..])?;
            }
            ParsedIndex::NeedBytes(_) => return Err(misplaced(start)),
        }
    };
    if bytes.len() != size {
        return Err(misplaced(start));
    }
    let groups_bytes: u64 = index.groups.iter().map(|group| u64::from(group.bytes)).sum();
    let first = start.checked_sub(groups_bytes).ok_or_else(|| misplaced(start))?;
    Ok((index, first))
}

/// Reads one chunk into the stream; the end of the file is an error.
fn feed<R: Read>(
    reader: &mut R,
    chunk: &mut [u8],
    stream: &mut StreamDecoder,
) -> Result<(), DecodeError> {
    let read = read_some(reader, chunk)?;
    if read == 0 {
        let (bytes, frames) = (stream.received(), stream.decoded());
        return Err(DecodeErrorKind::Truncated { bytes, frames }.into());
    }
    stream.push(&chunk[..read]);
    Ok(())
}

fn read_some<R: Read>(reader: &mut R, chunk: &mut [u8]) -> Result<usize, DecodeError> {
    loop {
        match reader.read(chunk) {
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            result => return Ok(result?),
        }
    }
}
