//! The first pass over all frames. It checks them, and finds their box and their names.

use crate::arguments::Global;
use crate::progress;
use anyhow::{Result, anyhow, bail};
use kn_bitstream::params::is_frame_name;
use kn_codec::EncodeError;
use kn_io::{InputFrame, Inputs};
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
    /// The longest side of each frame's box; `None` for a frame without faces.
    sides: Vec<Option<f64>>,
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
            survey.include(frame?)?;
            bar.step();
        }
        if survey.bounds.is_none() {
            let file = survey.files.first().map(|file| file.display().to_string());
            let what = match survey.files.len() {
                1 => "frame 0: the mesh has no faces",
                _ => "no frame of the sequence has a face",
            };
            bail!("{}: {what}", file.unwrap_or_default());
        }
        Ok(survey)
    }

    fn include(&mut self, frame: InputFrame) -> Result<()> {
        let own = frame.mesh.surface_box();
        if own.is_none() {
            // Cleaning says what is wrong with faces that have no area.
            clean_scan(&frame)?;
        }
        self.bounds = self.bounds.zip(own).map(|(all, own)| all.union(own)).or(self.bounds).or(own);
        self.sides.push(own.map(|own| own.longest_side()));
        self.exact.include(&frame.mesh.positions);
        self.labelled &= !frame.mesh.labels.is_empty() || frame.mesh.is_empty();
        self.files.push(frame.path);
        self.names.push(frame.name);
        Ok(())
    }

    /// Tells the user of frames without faces, and of names that the stream does not carry.
    pub(crate) fn tell(&self, lossless: bool, global: &Global) {
        let without = || (0..self.sides.len()).filter(|&frame| self.sides[frame].is_none());
        if let Some(first) = without().next() {
            let coded =
                if lossless { "their vertices alone are coded" } else { "coded as empty frames" };
            global.note(format_args!(
                "{} of {} frames have no faces, first {}: frame {first}: {coded}",
                without().count(),
                self.files.len(),
                self.files[first].display(),
            ));
        }
        let mut refused = self.names.iter().filter(|name| !is_frame_name(name));
        if let Some(first) = refused.next() {
            global.note(format_args!(
                "{} names cannot be carried in the stream, first {first:?}: decoded files are named \
                 by their number",
                1 + refused.count()
            ));
        }
    }

    /// Whether every frame is larger than a step of the grid: on a coarser one nothing is left of
    /// it.
    ///
    /// # Errors
    /// A frame is not.
    pub(crate) fn check_step(&self, step: f64) -> Result<()> {
        let named = |frame: usize| format!("{}: frame {frame}", self.files[frame].display());
        let sides = || self.sides.iter().enumerate().filter_map(|(at, side)| Some((at, (*side)?)));
        let Some((small, side)) = sides().find(|(_, side)| *side < step) else { return Ok(()) };
        let longest = self.steps(1.0);
        let largest = sides().max_by(|a, b| a.1.total_cmp(&b.1));
        let because = match largest.filter(|(_, side)| *side >= step) {
            Some((large, side)) => format!(
                "; the box of all frames is {longest:.3e} long, and that of {} {side:.3e}",
                named(large),
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
        let frame = match error.downcast_ref::<EncodeError>() {
            Some(error) => error.frame().and_then(|frame| usize::try_from(frame).ok()),
            None => None,
        };
        match frame.and_then(|frame| self.files.get(frame)) {
            Some(file) => error.context(file.display().to_string()),
            None => error,
        }
    }
}
