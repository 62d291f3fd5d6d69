//! `--vertex-maps`: the decoded vertex of every vertex of an I-frame's file.

use crate::output::{OutputFolder, write_file};
use crate::outputs::Outputs;
use anyhow::Result;
use kn_codec::DROPPED;
use std::collections::VecDeque;
use std::path::Path;

/// Files of one line a vertex: the index of the decoded vertex, or `-` where decimation took it or
/// no face used it.
pub(super) struct VertexMaps {
    folder: OutputFolder,
    outputs: Outputs,
    /// Of frames that are read and not yet coded: the name, and `#V` cleaned vertex of each one in
    /// the file.
    waiting: VecDeque<(String, Vec<u32>)>,
}

impl VertexMaps {
    /// Makes the folder; `outputs` are those of the command.
    pub(super) fn new(folder: &Path, outputs: Outputs) -> Result<Self> {
        Ok(Self { folder: OutputFolder::create(folder)?, outputs, waiting: VecDeque::new() })
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
        let name = format!("{name}.map");
        self.outputs.inside("--vertex-maps", &self.folder.target(&name))?;
        write_file(&self.folder.place(&name), |writer| {
            for vertex in cleaned {
                match decoded.get(vertex as usize) {
                    Some(&target) if target != DROPPED => writeln!(writer, "{target}")?,
                    _ => writeln!(writer, "-")?,
                }
            }
            Ok(())
        })
    }

    /// Puts all files in place.
    pub(super) fn publish(self) -> Result<usize> {
        self.folder.publish()
    }
}
