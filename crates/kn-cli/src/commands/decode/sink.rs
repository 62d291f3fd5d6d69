//! The outputs of `kn decode`: a file for each frame in one folder, or one animated GLB file.

use crate::output::{OutputFolder, folder_of};
use crate::outputs::Outputs;
use anyhow::{Context, Result, ensure};
use kn_io::{GlbWriter, MeshError, write_mesh_in};
use kn_mesh::{Mesh, Precision};
use std::collections::HashSet;
use std::path::Path;

/// Takes decoded frames; nothing is in its place before [`Sink::finish`].
pub(super) enum Sink {
    /// One file a frame.
    Files(Box<Files>),
    /// All frames in one file.
    Animation { folder: OutputFolder, name: String, writer: Box<GlbWriter> },
}

/// One file for each frame.
pub(super) struct Files {
    folder: OutputFolder,
    names: FileNames,
    /// Knows the inputs, which are never replaced.
    outputs: Outputs,
    precision: Precision,
    overwrite: bool,
}

impl Files {
    /// Files of this extension and precision in `folder`.
    pub(super) fn create(
        folder: &Path,
        extension: &'static str,
        precision: Precision,
        outputs: Outputs,
        overwrite: bool,
    ) -> Result<Self> {
        let names = FileNames { extension, taken: HashSet::new() };
        let folder = OutputFolder::create(folder)?;
        Ok(Self { folder, names, outputs, precision, overwrite })
    }

    fn push(&mut self, index: u64, name: Option<String>, mesh: &Mesh) -> Result<()> {
        let name = self.names.choose(name, index);
        let target = self.folder.target(&name);
        self.outputs.inside("--output", &target)?;
        // Decoded frames have the names of the scans, which may be all that there is.
        let is_free = self.overwrite || target.symlink_metadata().is_err();
        ensure!(
            is_free,
            "{}: this file is there already; --overwrite replaces it",
            target.display()
        );
        let written = write_mesh_in(&self.folder.place(&name), mesh, self.precision);
        Ok(written.map_err(|error| at(error, &target).in_frame(index as usize))?)
    }
}

impl Sink {
    /// One GLB file that plays at this rate.
    pub(super) fn animation(file: &Path, frame_rate: f64) -> Result<Self> {
        let name = file.file_name().context("the output has no file name")?;
        let name = name.to_string_lossy().into_owned();
        let mut folder = OutputFolder::create(folder_of(file))?;
        let created = GlbWriter::create(&folder.place(&name), frame_rate);
        let writer = created.map_err(|error| at(error, file))?;
        Ok(Self::Animation { folder, name, writer: Box::new(writer) })
    }

    /// Adds a frame; `name` is what the stream calls it.
    pub(super) fn push(&mut self, index: u64, name: Option<String>, mesh: &Mesh) -> Result<()> {
        match self {
            Self::Files(files) => files.push(index, name, mesh)?,
            Self::Animation { folder, name, writer } => {
                writer.push(mesh).map_err(|error| at(error, &folder.target(name)))?;
            }
        }
        Ok(())
    }

    /// Puts the files in place and returns their number.
    pub(super) fn finish(self) -> Result<usize> {
        match self {
            Self::Files(files) => files.folder.publish(),
            Self::Animation { folder, name, writer } => {
                writer.finish().map_err(|error| at(error, &folder.target(&name)))?;
                folder.publish()
            }
        }
    }
}

/// The error, about the file that the user knows of and not about its temporary place.
fn at(mut error: MeshError, target: &Path) -> MeshError {
    error.path = target.to_owned();
    error
}

/// Gives every frame a file name of its own.
pub(super) struct FileNames {
    extension: &'static str,
    taken: HashSet<String>,
}

impl FileNames {
    /// The name in the stream, where it has one that no other frame has; else by the index.
    fn choose(&mut self, in_stream: Option<String>, index: u64) -> String {
        let usable = in_stream.filter(|name| !name.is_empty() && !self.taken.contains(name));
        let name = usable.unwrap_or_else(|| format!("frame_{index:04}"));
        let file = format!("{name}.{}", self.extension);
        self.taken.insert(name);
        file
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_of_one_name_do_not_overwrite_each_other() {
        let mut names = FileNames { extension: "ply", taken: HashSet::new() };
        assert_eq!(names.choose(Some("walk_7".into()), 0), "walk_7.ply");
        assert_eq!(names.choose(Some("walk_7".into()), 1), "frame_0001.ply");
        assert_eq!(names.choose(Some(String::new()), 2), "frame_0002.ply");
        assert_eq!(names.choose(None, 3), "frame_0003.ply");
    }
}
