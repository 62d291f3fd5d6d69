//! Output that appears whole or not at all, whether the disk is full, the input is broken or the
//! user presses Ctrl-C.

use crate::interrupt::{MadeFolders, Unfinished};
use crate::outputs::check_no_folder;
use anyhow::{Context, Result};
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// The path that means standard input or output.
pub(crate) fn is_dash(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Name of an output in messages.
pub(crate) fn name_of(path: &Path) -> String {
    if is_dash(path) { "standard output".into() } else { path.display().to_string() }
}

/// Prints a result: errors name standard output.
pub(crate) fn print<T>(fill: impl FnOnce(&mut dyn Write) -> Result<T>) -> Result<T> {
    write_file(Path::new("-"), fill)
}

/// Prints a value as JSON.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<()> {
    print(|out| {
        serde_json::to_writer_pretty(&mut *out, value)?;
        Ok(writeln!(out)?)
    })
}

/// Writes a file through `fill`: into a temporary file in the same folder that is renamed at the
/// end. `-` and what is no regular file (a pipe, a device) are written to directly.
///
/// Errors of the output name it; errors that `fill` has of its own are left as they are.
pub(crate) fn write_file<T>(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> Result<T>,
) -> Result<T> {
    if is_dash(path) {
        return fill_and_flush(io::stdout().lock(), path, fill);
    }
    let special = fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir());
    if special {
        let file = fs::OpenOptions::new().write(true).open(path).with_context(|| name_of(path))?;
        return fill_and_flush(file, path, fill);
    }
    let (unfinished, temporary) = Unfinished::begin(|| temporary_beside(path), |file| file.path())
        .with_context(|| name_of(path))?;
    let value = fill_and_flush(temporary.as_file(), path, fill)?;
    let persist = || temporary.persist(path).map_err(|failed| failed.error);
    unfinished.finish(persist).with_context(|| name_of(path))?;
    Ok(value)
}

fn fill_and_flush<T>(
    file: impl Write,
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> Result<T>,
) -> Result<T> {
    let mut writer = BufWriter::with_capacity(1 << 16, Watched { file, failed: false });
    let filled = fill(&mut writer).and_then(|value| {
        writer.flush()?;
        Ok(value)
    });
    let failed = writer.get_ref().failed;
    // After a failure the buffer is not written again when it is dropped.
    let _ = writer.into_parts();
    filled.map_err(|error| if failed { error.context(name_of(path)) } else { error })
}

/// Remembers whether writing has failed: only then an error is about the output.
struct Watched<W> {
    file: W,
    failed: bool,
}

impl<W: Write> Write for Watched<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes);
        self.failed |= written.is_err();
        written
    }

    fn flush(&mut self) -> io::Result<()> {
        let flushed = self.file.flush();
        self.failed |= flushed.is_err();
        flushed
    }
}

/// The folder that holds `path`.
pub(crate) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn temporary_beside(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let folder = folder_of(path);
    // Opened by us, not by tempfile: the process's umask shall decide about permissions, as for any
    // output, and errors shall not name the random path.
    temporary_name().make_in(folder, |path| {
        fs::OpenOptions::new().read(true).write(true).create_new(true).open(path)
    })
}

fn temporary_name() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".kn-").suffix(".part");
    builder
}

/// Many files for one folder, which appear there together at the end.
///
/// The fields are dropped in this order: the temporary folder, its note, then folders made in vain.
pub(crate) struct OutputFolder {
    staging: tempfile::TempDir,
    unfinished: Unfinished,
    names: Vec<String>,
    made: MadeFolders,
}

impl OutputFolder {
    /// Makes the folder where it does not exist, and a temporary one inside it.
    pub(crate) fn create(folder: &Path) -> Result<Self> {
        let name = || folder.display().to_string();
        let made = MadeFolders::create(folder).with_context(name)?;
        let create = || temporary_name().tempdir_in(folder);
        let begun = Unfinished::begin(create, |staging| staging.path());
        let (unfinished, staging) =
            begun.map_err(|error| io::Error::from(error.kind())).with_context(name)?;
        Ok(Self { staging, unfinished, names: Vec::new(), made })
    }

    /// The temporary place of a file; `name` is a plain file name.
    pub(crate) fn place(&mut self, name: &str) -> PathBuf {
        self.names.push(name.to_owned());
        self.staging.path().join(name)
    }

    /// Path that the file of this name will have at the end.
    pub(crate) fn target(&self, name: &str) -> PathBuf {
        self.made.folder().join(name)
    }

    /// Puts all files in place, over files of the same names, and returns their number. What would
    /// keep one of them out is found before the first is moved.
    pub(crate) fn publish(self) -> Result<usize> {
        // The folders are dropped last, when the temporary one is no longer in them.
        let Self { made, staging, unfinished, names } = self;
        unfinished.finish(|| {
            let staging = staging;
            let targets = || names.iter().map(|name| (name, made.folder().join(name)));
            targets().try_for_each(|(_, target)| check_no_folder(&target))?;
            for (name, target) in targets() {
                fs::rename(staging.path().join(name), &target)
                    .with_context(|| target.display().to_string())?;
            }
            Ok(names.len())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("a folder");
        let mut names: Vec<String> = entries
            .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_failed_file_leaves_the_old_one_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.knm");
        write_file(&path, |w| Ok(w.write_all(b"old")?)).expect("written");
        let failed = write_file(&path, |w| {
            w.write_all(b"half")?;
            anyhow::bail!("the scan is bad") as Result<()>
        });
        assert!(failed.is_err());
        assert_eq!(fs::read(&path).expect("still there"), b"old");
        assert_eq!(names_in(folder.path()), ["a.knm"]);
    }

    #[test]
    fn a_missing_folder_and_a_full_disk_are_named() {
        let error = write_file(Path::new("/nowhere/a.knm"), |_| Ok(())).expect_err("no folder");
        assert_eq!(format!("{error:#}"), "/nowhere/a.knm: No such file or directory (os error 2)");
        if cfg!(target_os = "linux") {
            let full = Path::new("/dev/full");
            let error = write_file(full, |w| Ok(w.write_all(&[0; 9])?)).expect_err("full");
            assert!(format!("{error:#}").starts_with("/dev/full: No space left"), "{error:#}");
        }
    }

    #[test]
    fn a_folder_is_filled_at_the_end_or_not_at_all() {
        let base = tempfile::tempdir().expect("a temporary folder");
        let out = base.path().join("deep/out");
        let mut folder = OutputFolder::create(&out).expect("made");
        fs::write(folder.place("a.obj"), b"a").expect("written");
        drop(folder);
        assert_eq!(names_in(base.path()), [] as [&str; 0]);

        let mut folder = OutputFolder::create(&out).expect("made");
        fs::write(folder.place("a.obj"), b"a").expect("written");
        fs::write(folder.place("b.obj"), b"b").expect("written");
        assert!(!out.join("a.obj").exists());
        assert_eq!(folder.publish().expect("published"), 2);
        assert_eq!(names_in(&out), ["a.obj", "b.obj"]);
    }
}
