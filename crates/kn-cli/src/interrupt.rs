//! Ctrl-C: whatever is not finished is removed before the process ends.

use anyhow::Context;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Outputs that are not finished.
static UNFINISHED: Mutex<Pending> = Mutex::new(Pending { temporary: Vec::new(), made: Vec::new() });

/// Files and folders that an interrupt removes.
struct Pending {
    /// Files and folders under temporary names.
    temporary: Vec<PathBuf>,
    /// Folders that were made for output, the innermost first, which go if they are empty.
    made: Vec<PathBuf>,
}

/// Exit code of a process that was interrupted: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// From now on, Ctrl-C and a request to terminate remove what is unfinished and end the process.
pub(crate) fn install() -> anyhow::Result<()> {
    ctrlc::set_handler(|| {
        // The lock is kept until the end: nothing can be put in place or begun any more.
        let unfinished = lock();
        unfinished.temporary.iter().for_each(|path| remove(path));
        remove_empty(&unfinished.made);
        std::process::exit(INTERRUPTED);
    })
    .context("cannot watch for interrupts")
}

/// Remembers a temporary file or folder until it is dropped.
pub(crate) struct Unfinished(PathBuf);

impl Unfinished {
    /// Begins with what `create` makes; an interrupt comes either before or after both. What was
    /// made must be dropped before this is.
    pub(crate) fn begin<T>(
        create: impl FnOnce() -> std::io::Result<T>,
        path_of: impl FnOnce(&T) -> &Path,
    ) -> std::io::Result<(Self, T)> {
        let mut unfinished = lock();
        let created = create()?;
        let path = path_of(&created).to_owned();
        unfinished.temporary.push(path.clone());
        Ok((Self(path), created))
    }

    /// Puts what was made in place; an interrupt comes either before or after.
    pub(crate) fn finish<T>(self, put_in_place: impl FnOnce() -> T) -> T {
        let unfinished = lock();
        let result = put_in_place();
        drop(unfinished);
        result
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        lock().temporary.retain(|path| *path != self.0);
    }
}

/// A folder for output; those of its ancestors that had to be made go again if they stay empty.
pub(crate) struct MadeFolders {
    folder: PathBuf,
    /// The folder and its ancestors, as far as they did not exist; the innermost first.
    made: Vec<PathBuf>,
}

impl MadeFolders {
    pub(crate) fn create(folder: &Path) -> std::io::Result<Self> {
        let mut unfinished = lock();
        let exists = |path: &&Path| !path.as_os_str().is_empty() && !path.exists();
        let made: Vec<PathBuf> =
            folder.ancestors().take_while(exists).map(Path::to_owned).collect();
        unfinished.made.splice(0..0, made.iter().cloned());
        let folders = Self { folder: folder.to_owned(), made };
        let created = fs::create_dir_all(folder);
        // What failed is undone under the lock's next holder.
        drop(unfinished);
        created.map(|()| folders)
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }
}

impl Drop for MadeFolders {
    fn drop(&mut self) {
        let mut unfinished = lock();
        remove_empty(&self.made);
        unfinished.made.retain(|folder| !self.made.contains(folder));
    }
}

fn lock() -> MutexGuard<'static, Pending> {
    // Lists of paths are whole even where a thread panicked while it held the lock.
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes folders, the innermost first. One that is not empty, or was never made, cannot be.
fn remove_empty(folders: &[PathBuf]) {
    folders.iter().for_each(|folder| drop(fs::remove_dir(folder)));
}

/// Removes a file or a folder. The main thread may still be putting files into the folder, so that
/// it is tried a few times; what fails then cannot be helped at this point.
fn remove(path: &Path) {
    if path.is_dir() {
        let _ = (0..10).any(|_| fs::remove_dir_all(path).is_ok());
    } else {
        let _ = fs::remove_file(path);
    }
}
