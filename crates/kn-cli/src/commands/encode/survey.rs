//! The first pass over all frames. It checks them, and finds their box and their names.

use crate::arguments::Global;
use crate::progress;
use anyhow::{Result, anyhow, bail};
use kn_codec::EncodeError;
use kn_io::Inputs;
use kn_mesh::{BoundingBox, ExactGrid, Grid};
use kn_sequence::clean_scan;
use std::path::PathBuf;

/// Facts about a sequence, known before it is encoded.
pub(crate) struct Survey {
    /// The file of each frame.
    pub(crate) files: Vec<PathBuf>,
    /// The name of each frame, without extension.
    pub(crate) names: Vec<String>,
    /// The box of all surfaces: vertices that no face uses do not count.
    pub(crate) bounds: Option<BoundingBox>,
    /// The longest side of each frame's box.
    sides: Vec<f64>,
    /// Whether every frame has labels.
    pub(crate) labelled: bool,
    /// The grid that all coordinates lie on already, if there is one.
    exact: ExactGrid,
}

impl Survey {
    /// Reads every frame once.
    pub(crate) fn new(inputs: &Inputs, global: &Global) -> Result<Self> {
        let bar = progress::bar(global, "reading", Some(inputs.len() as u64));
        let mut survey = Self {
            files: Vec::new(),
            names: Vec::new(),
            bounds: None,
            sides: Vec::new(),
            labelled: true,
            exact: ExactGrid::default(),
        };
        for frame in inputs.frames() {
            let frame = frame?;
            let Some(own) = frame.mesh.surface_box() else {
                // Cleaning says what is wrong.
                clean_scan(&frame)?;
                bail!("{}: frame {}: the mesh has no faces", frame.path.display(), frame.index);
            };
            survey.bounds = Some(survey.bounds.map_or(own, |all| all.union(own)));
            survey.sides.push(own.longest_side());
            survey.exact.include(&frame.mesh.positions);
            survey.labelled &= !frame.mesh.labels.is_empty();
            survey.files.push(frame.path);
            survey.names.push(frame.name);
            bar.step();
        }
        Ok(survey)
    }

    /// Whether every frame is larger than a step of the grid: on a coarser one nothing is left of
    /// it.
    ///
    /// # Errors
    /// A frame is not.
    pub(crate) fn check_step(&self, step: f64) -> Result<()> {
        let named = |frame: usize| format!("{}: frame {frame}", self.files[frame].display());
        let Some(small) = self.sides.iter().position(|&side| side < step) else { return Ok(()) };
        let (side, longest) = (self.sides[small], self.steps(1.0));
        let largest =
            (0..self.sides.len()).max_by(|&a, &b| self.sides[a].total_cmp(&self.sides[b]));
        let because = match largest.filter(|&frame| self.sides[frame] >= step) {
            Some(large) => format!(
                "; the box of all frames is {longest:.3e} long, and that of {} {:.3e}",
                named(large),
                self.sides[large]
            ),
            None => String::new(),
        };
        bail!(
            "{}: the mesh is {side:.3e} long, which is less than a step of the grid, {step:.3e}{because}",
            named(small)
        );
    }

    /// Number of steps along the longest side of the box of all frames.
    pub(crate) fn steps(&self, step: f64) -> f64 {
        self.bounds.map_or(0.0, |bounds| bounds.longest_side() / step)
    }

    /// The grid that gives all coordinates back.
    ///
    /// # Errors
    /// There is none; the error names the file and frame where that shows.
    pub(crate) fn lossless_grid(&self) -> Result<Grid> {
        self.exact.grid().map_err(|error| {
            let file = error.frame().and_then(|frame| Some((frame, self.files.get(frame)?)));
            let place = file.map(|(frame, file)| format!("{}: frame {frame}: ", file.display()));
            anyhow!("{}--lossless: {error}", place.unwrap_or_default())
        })
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
