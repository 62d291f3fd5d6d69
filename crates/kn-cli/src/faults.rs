//! Panics: faults of the program. They end a command like any error, and say where they are.

use anyhow::{Result, anyhow};
use std::panic;
use std::sync::{Mutex, PoisonError};

/// The place of the first panic.
static PLACE: Mutex<Option<String>> = Mutex::new(None);

/// From now on a panic prints nothing by itself: it becomes the error of what was being done, and
/// [`tell`] says where it was.
pub(crate) fn keep_silent() {
    panic::set_hook(Box::new(|info| {
        let mut place = PLACE.lock().unwrap_or_else(PoisonError::into_inner);
        if let (None, Some(location)) = (&*place, info.location()) {
            *place = Some(location.to_string());
        }
    }));
}

/// Does some work; a panic that nothing nearer has caught is an error.
pub(crate) fn caught<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    kn_mesh::caught(work).unwrap_or_else(|panic| Err(anyhow!("internal error: {panic}")))
}

/// Prints where the first panic was, if there was one.
pub(crate) fn tell() {
    if let Some(place) = &*PLACE.lock().unwrap_or_else(PoisonError::into_inner) {
        let version = env!("CARGO_PKG_VERSION");
        eprintln!("kn: this is a fault of kn {version}, at {place}: please report it");
    }
}
