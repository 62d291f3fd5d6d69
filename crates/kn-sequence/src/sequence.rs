//! A sequence of meshes in files or in a stream.

use std::path::{Path, PathBuf};

use kn_codec::{Decoder, FrameKind};
use kn_io::{InputFrame, Inputs, LabelSource, ReadOptions};
use kn_mesh::{BoundingBox, Mesh};

use crate::error::SequenceError;
use crate::scan::clean_surface;
use crate::stream::{StreamReader, StreamSource};

/// Options of how mesh files are read. A stream is decoded as it is, with its own labels.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SequenceOptions {
    /// Whether meshes are cleaned as before encoding: welded, without degenerate and duplicate
    /// faces, and without vertices that no face uses.
    pub clean: bool,
    /// Options of the readers. Labels are not read by default.
    pub read: ReadOptions,
    /// A pattern of label files, one for each mesh.
    pub labels: Option<PathBuf>,
}

impl SequenceOptions {
    /// Options that clean meshes as before encoding.
    pub fn cleaned() -> Self {
        Self { clean: true, ..Self::default() }
    }

    /// Reads labels too: from the files that `pattern` names, or else from the meshes' property.
    pub fn with_labels(mut self, pattern: Option<PathBuf>) -> Self {
        self.read.labels = LabelSource::Property;
        self.labels = pattern;
        self
    }

    /// Samples an animated glTF file at so many frames per second.
    pub fn at_frame_rate(mut self, frames_per_second: f64) -> Self {
        self.read.frame_rate = frames_per_second;
        self
    }
}

impl Default for SequenceOptions {
    /// Options that read meshes as they are in their files, without labels. Frames may be empty.
    fn default() -> Self {
        let read =
            ReadOptions { labels: LabelSource::None, allow_empty: true, ..ReadOptions::default() };
        Self { clean: false, read, labels: None }
    }
}

/// A sequence of meshes. It can be read as often as needed.
#[derive(Debug)]
pub struct Sequence {
    name: String,
    source: Source,
}

#[derive(Debug)]
enum Source {
    Meshes { inputs: Inputs, clean: bool },
    Stream(StreamSource),
}

/// One frame of a sequence.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Frame {
    /// Number of the frame, from 0 on.
    pub index: u64,
    /// The file that it came from.
    pub file: String,
    /// The mesh.
    pub mesh: Mesh,
    /// The kind of the frame, where it came from a stream.
    pub kind: Option<FrameKind>,
    /// Number of bytes of the frame in the stream, where it came from one.
    pub bytes: Option<u64>,
}

impl Frame {
    /// Whether the frame has no vertices: nothing is there at that time.
    pub fn is_empty(&self) -> bool {
        self.mesh.is_empty()
    }
}

impl Sequence {
    /// Opens a `.knm` file, a mesh file, a folder, or a pattern of mesh files.
    ///
    /// # Errors
    /// The file does not exist, or its format is not known. Frames are read later.
    pub fn open(path: &Path, options: &SequenceOptions) -> Result<Self, SequenceError> {
        if is_stream(path) {
            return Ok(StreamSource::File(path.to_owned()).into());
        }
        let inputs = Inputs::find(&[path.to_owned()], options.read.clone())?;
        let inputs = match &options.labels {
            Some(labels) => inputs.with_labels(labels)?,
            None => inputs,
        };
        let (name, clean) = (path.display().to_string(), options.clean);
        Ok(Self { name, source: Source::Meshes { inputs, clean } })
    }

    /// Name of the sequence in messages: the path that it was opened by.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What was made of the names of the files, one sentence each; see [`Inputs::notes`].
    pub fn notes(&self) -> &[String] {
        match &self.source {
            Source::Meshes { inputs, .. } => inputs.notes(),
            Source::Stream(_) => &[],
        }
    }

    /// The files that are read.
    pub fn files(&self) -> Box<dyn Iterator<Item = &Path> + '_> {
        match &self.source {
            Source::Meshes { inputs, .. } => Box::new(inputs.files()),
            Source::Stream(StreamSource::File(path)) => Box::new(std::iter::once(path.as_path())),
            Source::Stream(StreamSource::Memory { .. }) => Box::new(std::iter::empty()),
        }
    }

    /// Frames per second; `None` for mesh files, which do not say.
    ///
    /// # Errors
    /// The stream cannot be opened.
    pub fn frame_rate(&self) -> Result<Option<f64>, SequenceError> {
        let Source::Stream(stream) = &self.source else { return Ok(None) };
        Ok(stream.decoder()?.stream().header().map(|header| header.frame_rate.per_second()))
    }

    /// Reads the frames, from the first one on.
    ///
    /// # Errors
    /// The stream cannot be opened.
    pub fn frames(&self) -> Result<Frames, SequenceError> {
        Ok(Frames(match &self.source {
            Source::Meshes { inputs, clean } => Reader::Meshes(inputs.frames(), *clean),
            Source::Stream(stream) => Reader::Stream(Box::new(stream.decoder()?), stream.name()),
        }))
    }

    /// The box of all frames, which relative distances refer to. Reads every frame once.
    ///
    /// # Errors
    /// A frame cannot be read, there is no frame, or the box has no extent.
    pub fn bounds(&self) -> Result<BoundingBox, SequenceError> {
        let mut bounds: Option<BoundingBox> = None;
        for frame in self.frames()? {
            let one = frame?.mesh.bounding_box();
            bounds = bounds.zip(one).map(|(all, one)| all.union(one)).or(bounds).or(one);
        }
        let bounds = bounds.ok_or(SequenceError::Empty)?;
        if bounds.diagonal() > 0.0 { Ok(bounds) } else { Err(SequenceError::NoExtent) }
    }
}

impl From<StreamSource> for Sequence {
    fn from(stream: StreamSource) -> Self {
        Self { name: stream.name(), source: Source::Stream(stream) }
    }
}

/// Whether a path names a `.knm` stream.
fn is_stream(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("knm"))
}

/// The frames of a sequence, each read when it is asked for.
#[derive(Debug)]
pub struct Frames(Reader);

#[derive(Debug)]
enum Reader {
    Meshes(kn_io::Frames, bool),
    Stream(Box<Decoder<StreamReader>>, String),
}

impl Iterator for Frames {
    type Item = Result<Frame, SequenceError>;

    fn next(&mut self) -> Option<Self::Item> {
        match &mut self.0 {
            Reader::Meshes(frames, clean) => {
                Some(frames.next()?.map_err(SequenceError::from).and_then(|f| scan(f, *clean)))
            }
            Reader::Stream(decoder, name) => {
                let mut mesh = Mesh::default();
                let info = match decoder.next_frame(&mut mesh) {
                    Ok(info) => info?,
                    Err(source) => {
                        return Some(Err(SequenceError::Decode { name: name.clone(), source }));
                    }
                };
                let (kind, bytes) = (Some(info.kind), Some(info.bytes));
                Some(Ok(Frame { index: info.index, file: name.clone(), mesh, kind, bytes }))
            }
        }
    }
}

fn scan(frame: InputFrame, clean: bool) -> Result<Frame, SequenceError> {
    let (index, file) = (frame.index as u64, frame.path.display().to_string());
    let mesh = if clean { clean_surface(&frame)?.mesh } else { frame.mesh };
    Ok(Frame { index, file, mesh, kind: None, bytes: None })
}
