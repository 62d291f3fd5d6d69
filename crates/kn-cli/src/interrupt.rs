//! Ctrl-C: whatever is not finished is removed before the process ends.

use anyhow::Context;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Temporary files and folders that exist now.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Exit code of a process that was interrupted: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// From now on, Ctrl-C and a request to terminate remove what is unfinished and end the process.
pub(crate) fn install() -> anyhow::Result<()> {
    ctrlc::set_handler(|| {
        // The lock is kept until the end: nothing can be put in place or begun any more.
        let unfinished = lock();
        unfinished.iter().for_each(|path| remove(path));
        std::process::exit(INTERRUPTED);
    })
    .context("cannot watch for interrupts")
}

/// Remembers a temporary file or folder until it is dropped.
pub(crate) struct Unfinished(PathBuf);

impl Unfinished {
    /// Begins with what `create` makes; an interrupt comes either before or after both.
    pub(crate) fn begin<T>(
        create: impl FnOnce() -> std::io::Result<T>,
        path_of: impl FnOnce(&T) -> &Path,
    ) -> std::io::Result<(T, Self)> {
        let mut unfinished = lock();
        let created = create()?;
        let path = path_of(&created).to_owned();
        unfinished.push(path.clone());
        Ok((created, Self(path)))
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
        lock().retain(|path| *path != self.0);
    }
}

fn lock() -> MutexGuard<'static, Vec<PathBuf>> {
    // A list of paths is whole even where a thread panicked while it held the lock.
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
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
