//! A sequence of frames to read, one after the other, as often as needed.

use super::sequence::{Kind, find_files, listed_files};
use super::{LabelSource, MeshError, MeshErrorKind, ReadNotes, ReadOptions, read_mesh};
use crate::Mesh;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread::JoinHandle;

/// The frames of a sequence: where they are and how to read them.
#[derive(Clone, Debug)]
pub struct Inputs {
    shared: Arc<Shared>,
}

#[derive(Clone, Debug)]
struct Shared {
    files: Vec<PathBuf>,
    /// One per frame, or empty.
    labels: Vec<PathBuf>,
    options: ReadOptions,
}

/// One frame of a sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct InputFrame {
    /// Number of the frame in the sequence, from 0.
    pub index: usize,
    /// File name without extension.
    pub name: String,
    /// The file it was read from.
    pub path: PathBuf,
    /// The mesh as it is in the file.
    pub mesh: Mesh,
    /// What the file held beside the mesh.
    pub notes: ReadNotes,
}

impl Inputs {
    /// The frames that `specs` mean. One spec is a file, a folder, a glob or a printf pattern
    /// (`f_%04d.obj`); its files come in natural order, and where their names carry one common
    /// number none may be missing. Several specs are files in the order given; only if this is
    /// the alphabetical order, as from a shell's glob, it becomes the natural one (`f_9`, `f_10`).
    ///
    /// # Errors
    /// Nothing matches, a numbered frame is missing, or formats are mixed.
    pub fn find(specs: &[PathBuf], options: ReadOptions) -> Result<Self, MeshError> {
        let files = match specs {
            [] => return Err(MeshError::new("", MeshErrorKind::NoMatch)),
            [spec] => find_files(spec, Kind::Meshes)?,
            list => listed_files(list)?,
        };
        Ok(Self { shared: Arc::new(Shared { files, labels: Vec::new(), options }) })
    }

    /// Takes the labels from files beside the meshes: a folder, a glob, a printf pattern or, for
    /// a single frame, one file.
    ///
    /// # Errors
    /// As for [`Inputs::find`], or there is not one label file per frame.
    pub fn with_labels(self, spec: &Path) -> Result<Self, MeshError> {
        let labels = find_files(spec, Kind::Labels)?;
        if labels.len() != self.len() {
            let what = format!("{} label files for {} frames", labels.len(), self.len());
            return Err(MeshError::new(spec, MeshErrorKind::Ambiguous(what)));
        }
        let mut shared = Arc::unwrap_or_clone(self.shared);
        shared.labels = labels;
        Ok(Self { shared: Arc::new(shared) })
    }

    /// The number of frames.
    pub fn len(&self) -> usize {
        self.shared.files.len()
    }

    /// Whether there are no frames; never true for what [`Inputs::find`] returns.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Reads all frames in order. The next frame is read on another thread while the caller works
    /// on this one; at most three are in memory, however long the sequence is. After an error
    /// nothing more comes.
    pub fn frames(&self) -> Frames {
        let (sender, receiver) = sync_channel(1);
        let shared = Arc::clone(&self.shared);
        let reader = std::thread::spawn(move || {
            for index in 0..shared.files.len() {
                let frame = shared.read(index);
                let last = frame.is_err();
                // The receiver is gone when the caller has dropped the iterator.
                if sender.send(frame).is_err() || last {
                    break;
                }
            }
        });
        Frames { receiver, reader: Some(reader) }
    }

    /// Reads one frame.
    ///
    /// # Errors
    /// As for [`read_mesh`]; the error names the frame.
    ///
    /// # Panics
    /// If `index` is not below [`Inputs::len`].
    pub fn read(&self, index: usize) -> Result<InputFrame, MeshError> {
        self.shared.read(index)
    }
}

impl Shared {
    fn read(&self, index: usize) -> Result<InputFrame, MeshError> {
        let path = &self.files[index];
        let mut options = self.options.clone();
        if let Some(labels) = self.labels.get(index) {
            options.labels = LabelSource::File(labels.clone());
        }
        let scan = read_mesh(path, &options).map_err(|error| error.in_frame(index))?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(InputFrame { index, name, path: path.clone(), mesh: scan.mesh, notes: scan.notes })
    }
}

/// The frames of [`Inputs::frames`].
#[derive(Debug)]
pub struct Frames {
    receiver: Receiver<Result<InputFrame, MeshError>>,
    reader: Option<JoinHandle<()>>,
}

impl Iterator for Frames {
    type Item = Result<InputFrame, MeshError>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Ok(frame) = self.receiver.recv() {
            return Some(frame);
        }
        // The sequence is over, unless the reader panicked: that must not look like its end.
        if let Some(Err(panic)) = self.reader.take().map(JoinHandle::join) {
            std::panic::resume_unwind(panic);
        }
        None
    }
}
