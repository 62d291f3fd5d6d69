//! Files that are written whole or not at all.

use super::{MeshError, MeshErrorKind};
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use tempfile::NamedTempFile;

/// Writes a file through `fill` into a temporary file in the same folder, then renames it.
///
/// On any error the temporary file is removed and a file that was at `path` before stays as it
/// was. What exists and is no regular file (a pipe, a device) is written to directly.
///
/// # Errors
/// The folder is missing or not writable, the disk is full, or what `fill` returned.
pub fn write_atomically<T>(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<T>,
) -> Result<T, MeshError> {
    let special = fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir());
    let written = if special { write_directly(path, fill) } else { write_beside(path, fill) };
    written.map_err(|error| MeshError::new(path, MeshErrorKind::Io(error)))
}

fn write_directly<T>(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<T>,
) -> io::Result<T> {
    let mut writer = BufWriter::new(fs::OpenOptions::new().write(true).open(path)?);
    let value = fill(&mut writer)?;
    writer.flush()?;
    Ok(value)
}

fn write_beside<T>(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<T>,
) -> io::Result<T> {
    let mut temporary = temporary_beside(path)?;
    let mut writer = BufWriter::with_capacity(1 << 16, temporary.as_file_mut());
    let value = fill(&mut writer)?;
    writer.flush()?;
    drop(writer);
    temporary.persist(path).map_err(|failed| failed.error)?;
    Ok(value)
}

/// A temporary file in the folder of `path`, removed when dropped.
pub(super) fn temporary_beside(path: &Path) -> io::Result<NamedTempFile> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    // Opened by us, not by tempfile: with the permissions of any new file instead of private ones,
    // and with errors that do not name the random path.
    tempfile::Builder::new().prefix(".kn-").suffix(".part").make_in(folder, |path| {
        fs::OpenOptions::new().read(true).write(true).create_new(true).open(path)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("mesh.obj");
        write_atomically(&path, |w| w.write_all(b"old")).expect("written");
        let error = write_atomically(&path, |w| {
            w.write_all(b"half")?;
            Err::<(), _>(io::Error::other("disk full"))
        });
        let message = error.expect_err("must fail").to_string();
        assert!(message.contains("mesh.obj") && message.ends_with("disk full"), "{message}");
        assert_eq!(fs::read(&path).expect("still there"), b"old");
        assert_eq!(fs::read_dir(folder.path()).expect("folder").count(), 1);
    }

    #[test]
    fn a_missing_folder_is_named() {
        let error = write_atomically(Path::new("/nowhere/at/all/m.ply"), |_| Ok(()));
        let message = error.expect_err("no such folder").to_string();
        assert!(message.starts_with("/nowhere/at/all/m.ply: No such file"), "{message}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_folder_that_takes_no_files_is_an_error() {
        let error = write_atomically(Path::new("/proc/m.obj"), |_| Ok(()));
        let message = error.expect_err("not writable, even for root").to_string();
        assert!(message.starts_with("/proc/m.obj: ") && message.contains("os error"), "{message}");
    }

    #[cfg(unix)]
    #[test]
    fn new_files_have_ordinary_permissions() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
        write_atomically(&ours, |w| w.write_all(b"x")).expect("written");
        fs::write(&plain, b"x").expect("written");
        let mode = |path| fs::metadata(path).map(|found| found.permissions().mode());
        assert_eq!(mode(&ours).expect("there"), mode(&plain).expect("there"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_an_error_that_names_the_file() {
        let error = write_atomically(Path::new("/dev/full"), |w| w.write_all(&[0; 100]));
        let message = error.expect_err("full").to_string();
        assert!(message.starts_with("/dev/full: No space left"), "{message}");
    }
}
