//! Outputs of a command, checked before any work: no output replaces an input or
//! another output, and each can be written where it shall be.

use crate::output::{folder_of, is_dash};
use anyhow::{Context, Result, anyhow, bail, ensure};
use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The inputs of a command and the outputs that were checked so far.
#[derive(Debug, Default)]
pub(crate) struct Outputs {
    inputs: HashSet<Identity>,
    /// Each with the flag that names it.
    outputs: HashMap<Identity, String>,
}

/// The identity of a file: equal for two paths to the same file, whatever links they go through.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Identity {
    StandardOutput,
    /// Device and inode.
    #[cfg(unix)]
    Inode(u64, u64),
    Path(PathBuf),
}

impl Outputs {
    /// Of a command that reads these files.
    pub(crate) fn beside<'p>(inputs: impl IntoIterator<Item = &'p Path>) -> Self {
        let inputs = inputs.into_iter().filter(|path| !is_dash(path)).filter_map(identity);
        Self { inputs: inputs.collect(), outputs: HashMap::new() }
    }

    /// The command prints its result: nothing else can go to standard output.
    ///
    /// # Errors
    /// Another output goes there.
    pub(crate) fn prints(&mut self) -> Result<()> {
        self.claim("the result", Path::new("-"))
    }

    /// A file that `flag` names; `-` is standard output.
    ///
    /// # Errors
    /// It is an input or another output, a folder, or cannot be made there.
    pub(crate) fn file(&mut self, flag: &str, path: &Path) -> Result<()> {
        if !is_dash(path) {
            let names_folder = ends_with_separator(path) || path.is_dir();
            ensure!(!names_folder, "{}: a folder, but {flag} is a file", path.display());
            if !is_special(path) {
                check_folder(folder_of(path)).with_context(|| path.display().to_string())?;
            }
        }
        self.claim(flag, path)
    }

    /// Checks the path of a PNG file.
    ///
    /// # Errors
    /// As for [`Self::file`], or its name ends otherwise.
    pub(crate) fn picture(&mut self, flag: &str, path: &Path) -> Result<()> {
        let is_png = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("png"));
        if !(is_png || is_dash(path) || is_special(path)) {
            bail!("{}: {flag} writes PNG: call the file .png", path.display());
        }
        self.file(flag, path)
    }

    /// A file in a folder that is known to be writable.
    ///
    /// # Errors
    /// It is an input or another output, or a folder.
    pub(crate) fn inside(&mut self, flag: &str, path: &Path) -> Result<()> {
        check_no_folder(path)?;
        self.claim(flag, path)
    }

    fn claim(&mut self, flag: &str, path: &Path) -> Result<()> {
        let identity = if is_dash(path) { Some(Identity::StandardOutput) } else { identity(path) };
        let Some(identity) = identity else { return Ok(()) };
        let name = crate::output::name_of(path);
        ensure!(
            !self.inputs.contains(&identity),
            "{name}: {flag} would replace an input of this command"
        );
        match self.outputs.insert(identity, flag.to_owned()) {
            Some(other) => Err(anyhow!("{name}: {other} and {flag} name the same file")),
            None => Ok(()),
        }
    }
}

/// A folder in the place of a file to be written is an error.
///
/// # Errors
/// There is one.
pub(crate) fn check_no_folder(path: &Path) -> Result<()> {
    ensure!(!path.is_dir(), "{}: this is a folder; give the path of a file", path.display());
    Ok(())
}

/// Whether a path is written so that it can only mean a folder.
pub(crate) fn ends_with_separator(path: &Path) -> bool {
    path.to_string_lossy().ends_with(std::path::is_separator)
}

/// A pipe or a device: nothing that is there can be lost, and several outputs may go to it.
fn is_special(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

/// Whether files can be made in a folder, tried with one that has no name.
fn check_folder(folder: &Path) -> std::io::Result<()> {
    // Asked first for its message: the one of `tempfile_in` may name a random path.
    fs::metadata(folder)?;
    tempfile::tempfile_in(folder).map(drop)
}

/// `None` where files cannot be told apart, since there is no file or it is special.
fn identity(path: &Path) -> Option<Identity> {
    match fs::metadata(path) {
        Ok(found) if !found.is_file() => None,
        Ok(found) => of_file(path, &found),
        Err(_) => {
            let folder = fs::canonicalize(folder_of(path)).ok()?;
            Some(Identity::Path(folder.join(path.file_name()?)))
        }
    }
}

#[cfg(unix)]
fn of_file(_: &Path, found: &fs::Metadata) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt;
    Some(Identity::Inode(found.dev(), found.ino()))
}

#[cfg(not(unix))]
fn of_file(path: &Path, _: &fs::Metadata) -> Option<Identity> {
    fs::canonicalize(path).ok().map(Identity::Path)
}
