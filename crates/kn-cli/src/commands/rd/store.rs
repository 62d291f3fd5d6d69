//! The folder of results: a stream and a JSON file for every cell, named by the cell's key.

use super::results::CellResult;
use crate::output::write_file;
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// The folder that keeps the cells.
pub(super) struct Store {
    cells: PathBuf,
}

impl Store {
    /// Makes the folder where it does not exist.
    ///
    /// # Errors
    /// It cannot be made.
    pub(super) fn open(output: &Path) -> Result<Self> {
        let cells = output.join("cells");
        fs::create_dir_all(&cells).with_context(|| cells.display().to_string())?;
        Ok(Self { cells })
    }

    /// The stream of a cell.
    pub(super) fn stream(&self, key: &str) -> PathBuf {
        self.file(key, "knm")
    }

    fn file(&self, key: &str, extension: &str) -> PathBuf {
        // 64 of 256 bits: enough for names; the whole key is in the file.
        self.cells.join(format!("{}.{extension}", &key[..16]))
    }

    /// The result of a cell that is finished. A file that cannot be read, or is of another cell,
    /// is no result: the cell is run again.
    pub(super) fn load(&self, key: &str) -> Option<CellResult> {
        let text = fs::read(self.file(key, "json")).ok()?;
        let result: CellResult = serde_json::from_slice(&text).ok()?;
        (result.key == key && self.stream(key).is_file()).then_some(result)
    }

    /// Keeps a result; its stream is there already.
    ///
    /// # Errors
    /// The file cannot be written.
    pub(super) fn save(&self, result: &CellResult) -> Result<()> {
        let write = |out: &mut dyn std::io::Write| Ok(serde_json::to_writer_pretty(out, result)?);
        write_file(&self.file(&result.key, "json"), write)
    }
}
