//! The specification's text, which some commands interpret.

use anyhow::{Result, ensure};
use kn_conform::Spec;
use std::path::Path;

/// Reads the folder that `--spec` names. It is no part of the program: what is checked against the
/// specification shall be checked against its text.
///
/// # Errors
/// The folder is another one, or its text is broken.
pub(crate) fn load(folder: &Path) -> Result<Spec> {
    ensure!(
        folder.join("tables").is_dir(),
        "{}: not the folder of the specification: name it with --spec FOLDER (spec/ in kn's sources)",
        folder.display()
    );
    Ok(Spec::load(folder)?)
}
