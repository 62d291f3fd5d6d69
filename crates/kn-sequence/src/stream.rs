//! The bytes of a stream, in a file or in memory.

use std::fs::File;
use std::io::{self, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::PathBuf;
use std::sync::Arc;

use kn_codec::Decoder;

use crate::error::SequenceError;

/// The source of a stream: a file or memory. It can be read as often as needed.
#[derive(Clone, Debug)]
pub enum StreamSource {
    /// A file.
    File(PathBuf),
    /// Bytes in memory.
    Memory {
        /// Name of the stream in messages.
        name: String,
        /// The whole stream.
        bytes: Arc<[u8]>,
    },
}

impl StreamSource {
    /// Name of the stream in messages.
    pub fn name(&self) -> String {
        match self {
            Self::File(path) => path.display().to_string(),
            Self::Memory { name, .. } => name.clone(),
        }
    }

    /// Opens the stream at its first byte.
    ///
    /// # Errors
    /// The file cannot be opened.
    pub fn reader(&self) -> Result<StreamReader, SequenceError> {
        Ok(match self {
            Self::File(path) => {
                let open = |source| SequenceError::Open { name: self.name(), source };
                StreamReader::File(BufReader::new(File::open(path).map_err(open)?))
            }
            Self::Memory { bytes, .. } => StreamReader::Memory(Cursor::new(bytes.clone())),
        })
    }

    /// Makes a decoder that compares every frame with the digest that it carries, so that damaged
    /// frames are not measured as if they were the encoder's.
    ///
    /// # Errors
    /// The file cannot be opened, or its first bytes are not those of a stream.
    pub fn decoder(&self) -> Result<Decoder<StreamReader>, SequenceError> {
        let decode = |source| SequenceError::Decode { name: self.name(), source };
        let mut decoder = Decoder::new(self.reader()?).map_err(decode)?;
        decoder.check_digests(true);
        Ok(decoder)
    }
}

/// A reader of a stream.
#[derive(Debug)]
pub enum StreamReader {
    /// Reads a file.
    File(BufReader<File>),
    /// Reads memory.
    Memory(Cursor<Arc<[u8]>>),
}

impl StreamReader {
    /// Number of bytes of the whole stream.
    ///
    /// # Errors
    /// The size of the file cannot be found.
    pub fn size(&self) -> io::Result<u64> {
        match self {
            Self::File(file) => Ok(file.get_ref().metadata()?.len()),
            Self::Memory(bytes) => Ok(bytes.get_ref().len() as u64),
        }
    }
}

impl Read for StreamReader {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.read(buffer),
            Self::Memory(bytes) => bytes.read(buffer),
        }
    }
}

impl Seek for StreamReader {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match self {
            Self::File(file) => file.seek(to),
            Self::Memory(bytes) => bytes.seek(to),
        }
    }
}
