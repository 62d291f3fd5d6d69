//! Frames to measure: meshes in files, or a stream.

use crate::scans;
use crate::stream::{self, Source};
use anyhow::{Context, Result, ensure};
use kn_codec::{Decoder, FrameKind};
use kn_io::{Frames, InputFrame, Inputs, LabelSource, ReadOptions};
use kn_mesh::{BoundingBox, Mesh};
use std::path::{Path, PathBuf};

/// A sequence that can be read as often as needed.
pub(crate) enum Sequence {
    Scans { inputs: Inputs, clean: bool },
    Stream(PathBuf),
}

/// One frame of a sequence.
#[derive(Debug, Default)]
pub(crate) struct Frame {
    pub(crate) index: u64,
    /// The file it came from.
    pub(crate) file: String,
    pub(crate) mesh: Mesh,
    /// I or P in a stream.
    pub(crate) kind: Option<FrameKind>,
    /// Its bytes in a stream.
    pub(crate) bytes: Option<u64>,
}

impl Sequence {
    /// What a path means: a .knm file, a mesh, a folder or a pattern of meshes. With `clean`,
    /// meshes are welded and freed of degenerate and duplicate faces and of vertices in no face, as
    /// `kn encode` does.
    /// Labels are read where asked for: from files beside the meshes or a PLY property; a stream
    /// has its own.
    pub(crate) fn open(
        path: &Path,
        clean: bool,
        labelled: bool,
        labels: Option<&Path>,
    ) -> Result<Self> {
        if stream::is_stream(path) {
            return Ok(Self::Stream(path.to_owned()));
        }
        let source = if labelled { LabelSource::Property } else { LabelSource::None };
        let options = ReadOptions { labels: source, ..ReadOptions::default() };
        let inputs = Inputs::find(&[path.to_owned()], options)?;
        let inputs = match labels {
            Some(labels) => inputs.with_labels(labels)?,
            None => inputs,
        };
        Ok(Self::Scans { inputs, clean })
    }

    /// The files that are read.
    pub(crate) fn files(&self) -> Box<dyn Iterator<Item = &Path> + '_> {
        match self {
            Self::Scans { inputs, .. } => Box::new(inputs.files()),
            Self::Stream(path) => Box::new(std::iter::once(path.as_path())),
        }
    }

    /// Begins with the first frame.
    pub(crate) fn reader(&self) -> Result<Reader> {
        Ok(match self {
            Self::Scans { inputs, clean } => Reader::Scans(inputs.frames(), *clean),
            Self::Stream(path) => Reader::Stream(Box::new(stream::open(path)?), path.clone()),
        })
    }

    /// The box of all frames, which is the scale of relative distances.
    pub(crate) fn bounds(&self) -> Result<BoundingBox> {
        let mut bounds: Option<BoundingBox> = None;
        let mut reader = self.reader()?;
        while let Some(frame) = reader.next_frame()? {
            let one = frame.mesh.bounding_box();
            bounds = bounds.zip(one).map(|(all, one)| all.union(one)).or(bounds).or(one);
        }
        let bounds = bounds.context("no frame to measure")?;
        ensure!(bounds.diagonal() > 0.0, "all vertices of the reference are at one point");
        Ok(bounds)
    }
}

/// Reads a sequence frame by frame.
pub(crate) enum Reader {
    Scans(Frames, bool),
    Stream(Box<Decoder<Source>>, PathBuf),
}

impl Reader {
    /// The next frame; `None` after the last.
    pub(crate) fn next_frame(&mut self) -> Result<Option<Frame>> {
        match self {
            Self::Scans(frames, clean) => {
                frames.next().map(|frame| scan(frame?, *clean)).transpose()
            }
            Self::Stream(decoder, path) => {
                let mut mesh = Mesh::default();
                let decoded =
                    decoder.next_frame(&mut mesh).with_context(|| stream::name_of(path))?;
                Ok(decoded.map(|info| Frame {
                    index: info.index,
                    file: stream::name_of(path),
                    mesh,
                    kind: Some(info.kind),
                    bytes: Some(info.bytes),
                }))
            }
        }
    }
}

fn scan(frame: InputFrame, clean: bool) -> Result<Frame> {
    let (index, file) = (frame.index as u64, frame.path.display().to_string());
    let mesh = if clean { scans::surface(&frame)?.mesh } else { frame.mesh };
    Ok(Frame { index, file, mesh, ..Frame::default() })
}
