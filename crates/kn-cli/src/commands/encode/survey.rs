//! The first look at all frames: are they sound, how large is their box, what are their names.

use crate::arguments::Global;
use crate::progress;
use anyhow::Result;
use kn_codec::EncodeError;
use kn_mesh::io::Inputs;
use kn_mesh::{BoundingBox, ExactGrid};
use std::path::PathBuf;

/// What is known about a sequence before it is encoded.
pub(crate) struct Survey {
    /// The file of each frame.
    pub(crate) files: Vec<PathBuf>,
    /// The name of each frame, without extension.
    pub(crate) names: Vec<String>,
    /// The box of all frames.
    pub(crate) bounds: Option<BoundingBox>,
    /// Whether every frame has labels.
    pub(crate) labelled: bool,
    /// The grid that all coordinates lie on already, if there is one.
    pub(crate) exact: ExactGrid,
}

impl Survey {
    /// Reads every frame once.
    pub(crate) fn new(inputs: &Inputs, global: &Global) -> Result<Self> {
        let bar = progress::bar(global, "reading", Some(inputs.len() as u64));
        let mut survey = Self {
            files: Vec::new(),
            names: Vec::new(),
            bounds: None,
            labelled: true,
            exact: ExactGrid::default(),
        };
        for frame in inputs.frames() {
            let frame = frame?;
            let bounds = frame.mesh.bounding_box();
            survey.bounds = match (survey.bounds, bounds) {
                (Some(all), Some(one)) => Some(all.union(one)),
                (all, one) => all.or(one),
            };
            survey.exact.include(&frame.mesh.positions);
            survey.labelled &= !frame.mesh.labels.is_empty();
            survey.files.push(frame.path);
            survey.names.push(frame.name);
            bar.step();
        }
        Ok(survey)
    }

    /// Adds the file's name to an encoder's error about a frame.
    pub(crate) fn name_file(&self, error: anyhow::Error) -> anyhow::Error {
        let frame = match error.downcast_ref() {
            Some(EncodeError::Input { frame, .. }) => usize::try_from(*frame).ok(),
            _ => None,
        };
        match frame.and_then(|frame| self.files.get(frame)) {
            Some(file) => error.context(file.display().to_string()),
            None => error,
        }
    }
}
