//! `--vertex-maps`: where the vertices of an I-frame's file are in the decoded mesh.

use crate::output::write_file;
use anyhow::{Context, Result};
use kn_codec::GONE;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};

/// Files of one line a vertex: the index of the decoded vertex, or `-` where decimation took it.
pub(super) struct VertexMaps {
    folder: PathBuf,
    /// Of frames that are read and not yet coded: the name, and `#V` cleaned vertex of each one in
    /// the file.
    waiting: VecDeque<(String, Vec<u32>)>,
}

impl VertexMaps {
    /// Makes the folder.
    pub(super) fn new(folder: &Path) -> Result<Self> {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
        Ok(Self { folder: folder.to_owned(), waiting: VecDeque::new() })
    }

    /// A frame has been read and cleaned.
    pub(super) fn read(&mut self, name: String, cleaned: Vec<u32>) {
        self.waiting.push_back((name, cleaned));
    }

    /// The frame that has waited longest has been coded; `decoded` is its map, from cleaned to
    /// decoded vertices, if it is an I-frame.
    pub(super) fn coded(&mut self, decoded: Option<&[u32]>) -> Result<()> {
        let (Some((name, cleaned)), Some(decoded)) = (self.waiting.pop_front(), decoded) else {
            return Ok(());
        };
        write_file(&self.folder.join(format!("{name}.map")), |writer| {
            for vertex in cleaned {
                match decoded.get(vertex as usize) {
                    Some(&target) if target != GONE => writeln!(writer, "{target}")?,
                    _ => writeln!(writer, "-")?,
                }
            }
            Ok(())
        })
    }
}
