//! Which files a folder, a glob or a printf pattern means, and in which order.

mod names;
mod numbering;
mod patterns;

pub use numbering::Missing;

use super::{MeshError, MeshErrorKind, MeshFormat, ReadOptions};
use names::{file_name, frame_names, names_of, natural_order};
use numbering::in_order;
use patterns::matching_files;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

/// The kind of files that are searched.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// Files with the extension of a mesh format, all of one format.
    Meshes,
    /// Label files: in a folder those named `*.labels`, by a pattern whatever it matches.
    Labels,
}

/// The files of a sequence in their order.
#[derive(Debug, Default)]
pub(super) struct Found {
    pub(super) frames: Vec<FrameFile>,
    /// What was made of the names, one sentence each.
    pub(super) notes: Vec<String>,
}

/// The file of a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct FrameFile {
    pub(super) path: PathBuf,
    /// The path that the frame is named by. It differs from `path` where a missing frame is held.
    pub(super) named: PathBuf,
}

impl Found {
    /// Files that are frames as they are.
    fn plain(files: impl IntoIterator<Item = PathBuf>) -> Self {
        let frame = |path: PathBuf| FrameFile { named: path.clone(), path };
        Self { frames: files.into_iter().map(frame).collect(), notes: Vec::new() }
    }

    /// The name of each frame, without extension.
    pub(super) fn names(&self) -> Vec<String> {
        frame_names(&self.frames.iter().map(|frame| frame.named.clone()).collect::<Vec<_>>())
    }

    /// Every n-th frame, from the first on.
    fn every(mut self, options: &ReadOptions) -> Self {
        self.frames = self.frames.into_iter().step_by(options.every.get()).collect();
        self
    }
}

/// The files that `specs` mean; see [`Inputs::find`](super::Inputs::find).
///
/// # Errors
/// The errors of [`find_files`] and [`listed_files`].
pub(super) fn find_frames(specs: &[PathBuf], options: &ReadOptions) -> Result<Found, MeshError> {
    let found = match specs {
        [] => return Err(MeshError::new("", MeshErrorKind::NoMatch)),
        [spec] => find_files(spec, Kind::Meshes, options.missing)?,
        list => Found::plain(listed_files(list)?),
    };
    Ok(found.every(options))
}

/// The label files that `spec` means.
///
/// # Errors
/// The errors of [`find_files`].
pub(super) fn find_labels(spec: &Path, options: &ReadOptions) -> Result<Found, MeshError> {
    Ok(find_files(spec, Kind::Labels, options.missing)?.every(options))
}

/// The files that `spec` means: a file, a folder, a printf pattern (`f_%04d.obj`) or a glob, in
/// the order of their numbers. A name that exists is never taken for a pattern. In a folder
/// without meshes each folder with one mesh is a frame.
///
/// # Errors
/// Nothing matches, the matches are of several formats or of several series, or a number between
/// two others is missing.
fn find_files(spec: &Path, kind: Kind, missing: Missing) -> Result<Found, MeshError> {
    if spec.is_file() {
        return Ok(Found::plain([spec.to_owned()]));
    }
    let files = if spec.is_dir() {
        match list_folder(spec, kind)? {
            (files, folders) if files.is_empty() => one_of_each(spec, &folders, kind)?,
            (files, _) => files,
        }
    } else {
        let mut matches = matching_files(spec)?;
        matches.retain(|path| kind == Kind::Labels || in_folder(path, kind));
        matches
    };
    if files.is_empty() {
        let kind = match kind {
            Kind::Meshes => MeshErrorKind::NoMatch,
            Kind::Labels => MeshErrorKind::NoLabelFile,
        };
        return Err(MeshError::new(spec, kind));
    }
    if kind == Kind::Meshes {
        check_one_format(spec, &files)?;
    }
    in_order(spec, files, missing)
}

/// Files listed one by one: in the order given, unless this is the alphabetical order that a
/// shell's glob comes in, which puts `f_10` before `f_9`; then in natural order.
///
/// # Errors
/// A file does not exist, or is a folder.
fn listed_files(files: &[PathBuf]) -> Result<Vec<PathBuf>, MeshError> {
    for file in files {
        if fs::metadata(file).map_err(|error| MeshError::new(file, error))?.is_dir() {
            let what = "a folder cannot be listed beside files: give it alone, or its files";
            return Err(MeshError::new(file, MeshErrorKind::Ambiguous(what.into())));
        }
    }
    if !files.is_sorted() {
        return Ok(files.to_vec());
    }
    let mut names = names_of(files.to_vec());
    names.sort_by(natural_order);
    Ok(names.into_iter().map(|name| name.path).collect())
}

fn in_folder(path: &Path, kind: Kind) -> bool {
    match kind {
        Kind::Meshes => MeshFormat::of_path(path).is_ok(),
        Kind::Labels => path.extension() == Some(OsStr::new("labels")),
    }
}

/// The files of a kind and the folders that are in a folder, sorted.
fn list_folder(folder: &Path, kind: Kind) -> Result<(Vec<PathBuf>, Vec<PathBuf>), MeshError> {
    let list = || {
        let (mut files, mut folders) = (Vec::new(), Vec::new());
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            // Hidden files are not meant, neither here nor by a glob: `._f.obj` is no scan.
            let hidden = entry.file_name().as_encoded_bytes().starts_with(b".");
            let path = entry.path();
            if !hidden && path.is_file() && in_folder(&path, kind) {
                files.push(path);
            } else if !hidden && path.is_dir() {
                folders.push(path);
            }
        }
        files.sort();
        folders.sort();
        Ok((files, folders))
    };
    list().map_err(|error: std::io::Error| MeshError::new(folder, error))
}

/// The file of each folder of a sequence that has a folder for each frame.
///
/// # Errors
/// A folder has several files of the kind.
fn one_of_each(spec: &Path, folders: &[PathBuf], kind: Kind) -> Result<Vec<PathBuf>, MeshError> {
    let mut found = Vec::new();
    for folder in folders {
        let (files, _) = list_folder(folder, kind)?;
        if let [first, _, ..] = &files[..] {
            let (first, folder) = (file_name(first), folder.display());
            let what = format!(
                "no mesh file matches here, and the folder {folder} has {}: name that folder, or \
                 one file of each folder, as in '{}/*/{first}'",
                files.len(),
                spec.display()
            );
            return Err(MeshError::new(spec, MeshErrorKind::Ambiguous(what)));
        }
        found.extend(files);
    }
    Ok(found)
}

fn check_one_format(spec: &Path, files: &[PathBuf]) -> Result<(), MeshError> {
    let first = MeshFormat::of_path(&files[0])?;
    for file in files {
        if MeshFormat::of_path(file)? != first {
            let what = format!(
                "several formats match, for instance {} and {}; choose one by a pattern",
                files[0].display(),
                file.display()
            );
            return Err(MeshError::new(spec, MeshErrorKind::Ambiguous(what)));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
