//! A sequence of frames in files. It can be read as often as needed.

use super::gltf::Scene;
use super::read::read_file;
use super::sequence::{find_frames, find_labels};
use super::{Fault, LabelSource, MeshError, MeshErrorKind, MeshFormat};
use super::{ReadNotes, ReadOptions, read_mesh};
use kn_mesh::{Mesh, caught};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};

/// The frames of a sequence in files, and the options of the readers.
#[derive(Clone)]
pub struct Inputs {
    source: Source,
    /// One per frame, or empty.
    labels: Vec<PathBuf>,
    options: ReadOptions,
    notes: Vec<String>,
}

#[derive(Clone)]
enum Source {
    /// One file per frame, with the names of the frames.
    Files(Arc<Vec<PathBuf>>, Arc<Vec<String>>),
    /// All frames in one glTF file.
    Animation { path: PathBuf, scene: Arc<Scene>, frames: usize },
}

/// One frame of a sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct InputFrame {
    /// Number of the frame in the sequence, from 0.
    pub index: usize,
    /// Name of the file without extension. It has the frame number where one file holds many
    /// frames. It is the folder's name where all files have one name, and the missing file's where
    /// the frame before is held.
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
    /// (`f_%04d.obj`). Its files come in the order of the numbers in their names, which may be
    /// negative, rise by more than one, or be times; where one is missing,
    /// [`ReadOptions::missing`] says what is done. Files without numbers come in the order of their
    /// names. In a folder without meshes, each folder that has a mesh is a frame. A file or folder
    /// that exists is meant as it is written, even where its name looks like a pattern.
    ///
    /// Several specs are files in the order given; only if this is the alphabetical order, as from
    /// a shell's glob, it becomes the natural one (`f_9`, `f_10`).
    ///
    /// A single GLB or glTF file with an animation is one frame for every step of
    /// [`ReadOptions::frame_rate`] between its first and its last key frame.
    ///
    /// # Errors
    /// No file matches, a numbered frame is missing, the files are of several formats or of several
    /// series, or an animated file cannot be read.
    pub fn find(specs: &[PathBuf], options: ReadOptions) -> Result<Self, MeshError> {
        let found = find_frames(specs, &options)?;
        let source = match &found.frames[..] {
            [frame] => animation(&frame.path, options.frame_rate)?,
            _ => None,
        };
        let names = found.names();
        let source = source.unwrap_or_else(|| {
            let files = found.frames.into_iter().map(|frame| frame.path).collect();
            Source::Files(Arc::new(files), Arc::new(names))
        });
        Ok(Self { source, labels: Vec::new(), options, notes: found.notes })
    }

    /// Reads the labels from files beside the meshes: a folder, a glob, a printf pattern or, for
    /// a single frame, one file.
    ///
    /// # Errors
    /// The errors of [`Inputs::find`], or there is not one label file for each frame.
    pub fn with_labels(mut self, spec: &Path) -> Result<Self, MeshError> {
        let labels = find_labels(spec, &self.options)?.frames;
        if labels.len() != self.len() {
            let what = format!("{} label files for {} frames", labels.len(), self.len());
            return Err(MeshError::new(spec, MeshErrorKind::Ambiguous(what)));
        }
        self.labels = labels.into_iter().map(|frame| frame.path).collect();
        Ok(self)
    }

    /// What was made of the names of the files, one sentence each: frames that are left out or
    /// held, numbers that rise by more than one.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The number of frames.
    pub fn len(&self) -> usize {
        match &self.source {
            Source::Files(files, _) => files.len(),
            Source::Animation { frames, .. } => *frames,
        }
    }

    /// The files of all frames, then the files of their labels.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let meshes = match &self.source {
            Source::Files(files, _) => &files[..],
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
    /// nothing more comes. A panic of a reader is the error [`MeshErrorKind::Internal`] of its
    /// frame.
    pub fn frames(&self) -> Frames {
        let (len, inputs) = (self.len(), self.clone());
        Frames::new(len, move |index| inputs.read(index), {
            let inputs = self.clone();
            move |index| inputs.path(index).to_owned()
        })
    }

    /// The file of a frame.
    fn path(&self, index: usize) -> &Path {
        match &self.source {
            Source::Files(files, _) => &files[index],
            Source::Animation { path, .. } => path,
        }
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
            Source::Files(files, names) => {
                let path = &files[index];
                (path, names[index].clone(), read_mesh(path, &options))
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
}

impl Frames {
    /// Starts a thread that reads `len` frames; `path` names the file of one.
    fn new(
        len: usize,
        mut read: impl FnMut(usize) -> Result<InputFrame, MeshError> + Send + 'static,
        path: impl Fn(usize) -> PathBuf + Send + 'static,
    ) -> Self {
        let (sender, receiver) = sync_channel(1);
        std::thread::spawn(move || {
            for index in 0..len {
                let frame = caught(|| read(index)).unwrap_or_else(|panic| {
                    let kind = MeshErrorKind::Internal(panic);
                    Err(MeshError::new(path(index), kind).in_frame(index))
                });
                let last = frame.is_err();
                // The receiver is gone when the caller has dropped the iterator.
                if sender.send(frame).is_err() || last {
                    break;
                }
            }
        });
        Self { receiver }
    }
}

impl Iterator for Frames {
    type Item = Result<InputFrame, MeshError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.receiver.recv().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_of_a_reader_is_the_error_of_its_frame() {
        let frame = |index: usize| InputFrame {
            index,
            name: format!("f_{index}"),
            path: PathBuf::new(),
            mesh: Mesh::default(),
            notes: ReadNotes::default(),
        };
        let read = move |index| match index {
            2 => panic!("index out of bounds"),
            _ => Ok(frame(index)),
        };
        let mut frames = Frames::new(5, read, |index| format!("scan/f_{index}.obj").into());
        assert!(frames.by_ref().take(2).all(|frame| frame.is_ok()));
        let error = frames.next().expect("an error").expect_err("a panic").to_string();
        let message = "scan/f_2.obj (frame 2): internal error: index out of bounds; \
                       please report it with this file";
        assert_eq!(error, message);
        assert!(frames.next().is_none());
    }
}
