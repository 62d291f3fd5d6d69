//! Data for tests, benches and tools: [`mutation`] makes odd mesh files, the rest finds measured
//! sequences.
//!
//! # Measured sequences
//!
//! They are the data that tests, benches and tools measure on. It is not part of the project
//! (`docs/data.md`).
//!
//! The environment variable `KN_DATA` names the folder of the sequences, `KN_ORACLE` the folder of
//! the metrics' oracle. A relative path starts at the root of the workspace. Where a variable is
//! unset, `../shared/data` and `../shared/oracle` beside the checkout are taken if they exist.
//!
//! Tests whose data is absent are skipped with one line on standard error each:
//! `skipped: TEST: the sequence dancer is absent: set KN_DATA (docs/data.md)`. The line goes past
//! the test harness's capture, so `.ci/run tests` can count it.

pub mod mutation;

use std::collections::BTreeSet;
use std::io::Write;
use std::panic::Location;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// The checkout's root.
const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// The folder of one sequence, such as `dancer`, or of the registration pairs (`pairs`). `None`,
/// after one line on standard error, if it is absent.
#[track_caller]
pub fn data(sequence: &str) -> Option<PathBuf> {
    find("KN_DATA", "../shared/data", Path::new(sequence), &format!("the sequence {sequence}"))
}

/// The folder of the metrics' oracle: `oracle.csv`, `meshes/`, `stages/`. `None`, after one line
/// on standard error, if it is absent.
#[track_caller]
pub fn oracle() -> Option<PathBuf> {
    find("KN_ORACLE", "../shared/oracle", Path::new(""), "the metrics' oracle")
}

/// A table of other codecs' and programs' figures in `docs/peers`.
pub fn peers(table: &str) -> PathBuf {
    Path::new(ROOT).join("docs/peers").join(table)
}

#[track_caller]
fn find(variable: &str, default: &str, inside: &Path, what: &str) -> Option<PathBuf> {
    let named = std::env::var_os(variable).filter(|value| !value.is_empty());
    let base = named.unwrap_or_else(|| default.into());
    let folder = Path::new(ROOT).join(base).join(inside);
    if folder.is_dir() {
        return Some(folder);
    }
    say_skipped(&format!("{what} is absent: set {variable} (docs/data.md)"));
    None
}

/// Prints one line for each test. Outside a test the place of the call stands for its name.
#[track_caller]
fn say_skipped(reason: &str) {
    static SAID: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    let name = match std::thread::current().name() {
        None | Some("main") => Location::caller().to_string(),
        Some(test) => test.to_owned(),
    };
    let mut said = SAID.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    if said.insert(name.clone()) {
        // `eprintln!` would be captured with the output of a test that passes. A closed standard
        // error is no reason to fail.
        writeln!(std::io::stderr(), "skipped: {name}: {reason}").ok();
    }
}

#[cfg(test)]
mod tests {
    use super::find;
    use std::path::Path;

    #[test]
    fn a_folder_is_found_from_the_root_of_the_workspace() {
        let found = find("KN_TESTDATA_UNSET", "spec", Path::new("conformance"), "the corpus");
        assert!(found.is_some_and(|folder| folder.join("core").is_dir()));
    }

    #[test]
    fn what_is_absent_is_none() {
        assert_eq!(find("KN_TESTDATA_UNSET", "spec", Path::new("absent"), "a test"), None);
    }
}
