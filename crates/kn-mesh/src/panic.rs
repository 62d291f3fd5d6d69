//! Panics as errors.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Does some work; a panic of it, or of a thread that it waits for, is the error with the panic's
/// message. What the work has changed must not be used after that.
///
/// # Errors
/// The work panicked.
pub fn caught<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| message(&*panic))
}

/// The message of a panic.
fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|&text| text.to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "a panic".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_with_its_message() {
        assert_eq!(caught(|| 7), Ok(7));
        assert_eq!(caught(|| -> u8 { panic!("plain") }), Err("plain".into()));
        let index = 3;
        assert_eq!(caught(|| -> u8 { panic!("index {index}") }), Err("index 3".into()));
        let thread = || std::thread::spawn(|| panic!("below")).join();
        let joined = caught(|| thread().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        assert_eq!(joined, Err("below".into()));
    }
}
