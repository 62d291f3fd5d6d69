//! A sequence of frames in files. It can be read as often as needed.

use super::gltf::Scene;
use super::read::read_file;
use super::sequence::{Kind, find_files, listed_files};
use super::{Fault, LabelSource, MeshError, MeshErrorKind, MeshFormat};
use super::{ReadNotes, ReadOptions, read_mesh};
use kn_mesh::Mesh;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread::JoinHandle;

/// The frames of a sequence in files, and the options of the readers.
#[derive(Clone)]
pub struct Inputs {
    source: Source,
    /// One per frame, or empty.
    labels: Vec<PathBuf>,
    options: ReadOptions,
}

#[derive(Clone)]
enum Source {
    /// One file per frame.
    Files(Arc<Vec<PathBuf>>),
    /// All frames in one glTF file.
    Animation { path: PathBuf, scene: Arc<Scene>, frames: usize },
}

/// One frame of a sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct InputFrame {
    /// Number of the frame in the sequence, from 0.
    pub index: usize,
    /// Name of the file without extension. It has the frame number where one file holds many
    /// frames.
    pub name: String,
    /// The file it was read from.
    pub path: PathBuf,
    /// The mesh as it is in the file, not cleaned.
    pub mesh: Mesh,
    /// Content of the file that is not carried.
    pub notes: ReadNotes,
}

impl Inputs {
    /// Finds the frames that `specs` name. One spec is a file, a folder, a glob or a printf pattern
    /// (`f_%04d.obj`); its files come in natural order, and where their names carry one common
    /// number none may be missing. Several specs are files in the order given; only if this is
    /// the alphabetical order, as from a shell's glob, it becomes the natural one (`f_9`, `f_10`).
    ///
    /// A single GLB or glTF file with an animation is one frame for every step of
    /// [`ReadOptions::frame_rate`] between its first and its last key frame.
    ///
    /// # Errors
    /// No file matches, a numbered frame is missing, formats are mixed, or an animated file cannot
    /// be read.
    pub fn find(specs: &[PathBuf], options: ReadOptions) -> Result<Self, MeshError> {
        let files = match specs {
            [] => return Err(MeshError::new("", MeshErrorKind::NoMatch)),
            [spec] => find_files(spec, Kind::Meshes)?,
            list => listed_files(list)?,
        };
        let source = match &files[..] {
            [path] => animation(path, options.frame_rate)?,
            _ => None,
        };
        let source = source.unwrap_or_else(|| Source::Files(Arc::new(files)));
        Ok(Self { source, labels: Vec::new(), options })
    }

    /// Reads the labels from files beside the meshes: a folder, a glob, a printf pattern or, for
    /// a single frame, one file.
    ///
    /// # Errors
    /// The errors of [`Inputs::find`], or there is not one label file for each frame.
    pub fn with_labels(mut self, spec: &Path) -> Result<Self, MeshError> {
        let labels = find_files(spec, Kind::Labels)?;
        if labels.len() != self.len() {
            let what = format!("{} label files for {} frames", labels.len(), self.len());
            return Err(MeshError::new(spec, MeshErrorKind::Ambiguous(what)));
        }
        self.labels = labels;
        Ok(self)
    }

    /// The number of frames.
    pub fn len(&self) -> usize {
        match &self.source {
            Source::Files(files) => files.len(),
            Source::Animation { frames, .. } => *frames,
        }
    }

    /// The files of all frames, then the files of their labels.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let meshes = match &self.source {
            Source::Files(files) => &files[..],
            Source::Animation { path, .. } => std::slice::from_ref(path),
        };
        meshes.iter().chain(&self.labels).map(PathBuf::as_path)
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
        let inputs = self.clone();
        let reader = std::thread::spawn(move || {
            for index in 0..inputs.len() {
                let frame = inputs.read(index);
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
    /// The errors of [`read_mesh`], with the frame.
    ///
    /// # Panics
    /// If `index` is not below [`Inputs::len`].
    pub fn read(&self, index: usize) -> Result<InputFrame, MeshError> {
        assert!(index < self.len(), "frame {index} of {}", self.len());
        let mut options = self.options.clone();
        if let Some(labels) = self.labels.get(index) {
            options.labels = LabelSource::File(labels.clone());
        }
        let stem =
            |path: &Path| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let (path, name, scan) = match &self.source {
            Source::Files(files) => {
                let path = &files[index];
                (path, stem(path), read_mesh(path, &options))
            }
            Source::Animation { path, scene, .. } => {
                let parsed = scene.at_frame(index, options.frame_rate);
                let name = format!("{}_{index:04}", stem(path));
                (path, name, parsed.finish(path, &options))
            }
        };
        let scan = scan.map_err(|error| error.in_frame(index))?;
        Ok(InputFrame { index, name, path: path.clone(), mesh: scan.mesh, notes: scan.notes })
    }
}

impl fmt::Debug for Inputs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Inputs")
            .field("frames", &self.len())
            .field("options", &self.options)
            .finish_non_exhaustive()
    }
}

/// The frames of a glTF file that has an animation; `None` for any other file.
fn animation(path: &Path, frame_rate: f64) -> Result<Option<Source>, MeshError> {
    if !matches!(MeshFormat::of_path(path)?, MeshFormat::Glb | MeshFormat::Gltf) {
        return Ok(None);
    }
    let at = |fault: Fault| fault.at(path);
    let scene =
        Scene::load(read_file(path)?, path.parent().unwrap_or(Path::new(""))).map_err(at)?;
    let frames = scene.frame_count(frame_rate).map_err(at)?;
    Ok(frames.map(|frames| Source::Animation {
        path: path.to_owned(),
        scene: Arc::new(scene),
        frames,
    }))
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
