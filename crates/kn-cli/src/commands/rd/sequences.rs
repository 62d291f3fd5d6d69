//! The sequences of a configuration: where their frames are, and what is known of them.

use super::config::{CodecLabels, Config, SequenceEntry};
use super::performer;
use super::results::SequenceInfo;
use crate::arguments::{FrameRange, Global};
use crate::frames::FrameFiles;
use crate::progress;
use anyhow::{Context, Result, anyhow, ensure};
use kn_bitstream::params::{FileNames, FrameRate, UpAxis};
use kn_codec::EncodeError;
use kn_io::{Inputs, LabelSource, ReadOptions};
use kn_mesh::{BoundingBox, Mesh};
use kn_sequence::clean_surface;
use sha2::{Digest, Sha256};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A sequence that was read once from end to end.
pub(super) struct Sequence {
    pub(super) info: SequenceInfo,
    /// With labels where there are any.
    inputs: Inputs,
    /// The same without labels.
    bare: Inputs,
    frames: Range<usize>,
    files: Vec<PathBuf>,
    labels: Option<PathBuf>,
    /// The box of the cleaned meshes, which the grid and distances refer to.
    pub(super) bounds: BoundingBox,
    /// The pattern of the names, where they have one.
    pub(super) pattern: Option<FileNames>,
    /// The name of each frame used.
    pub(super) names: Vec<String>,
    choice: FrameFiles,
    pub(super) rate: FrameRate,
    pub(super) up_axis: UpAxis,
}

impl Sequence {
    /// Finds the frames, generates those of a performer, and reads all.
    ///
    /// # Errors
    /// No frames, broken frames: the entry and the file are named.
    pub(super) fn open(
        entry: &SequenceEntry,
        config: &Config,
        output: &Path,
        global: &Global,
    ) -> Result<Self> {
        let named = || format!("sequence '{}'", entry.name);
        let source = match (&entry.performer, &entry.input) {
            (Some(recipe), _) => {
                performer::generate(recipe, entry.frame_rate()?.per_second(), output, global)
                    .with_context(named)?
            }
            (None, Some(input)) => config.path(input).with_context(named)?,
            (None, None) => return Err(anyhow!("no input")).with_context(named),
        };
        let labels = entry.label_files().map(|labels| config.path(labels));
        let labels = labels.transpose().with_context(named)?;
        Self::survey(entry, &source, labels, global).with_context(named)
    }

    fn survey(
        entry: &SequenceEntry,
        source: &Path,
        labels: Option<PathBuf>,
        global: &Global,
    ) -> Result<Self> {
        let rate = entry.frame_rate()?;
        let find = |labels| {
            let frame_rate = rate.per_second();
            let options = ReadOptions { labels, frame_rate, ..ReadOptions::default() };
            let options = entry.files().options(options);
            Inputs::find(&[source.to_owned()], options)
        };
        let (inputs, bare) = (find(LabelSource::Property)?, find(LabelSource::None)?);
        let inputs = match &labels {
            Some(labels) => inputs.with_labels(labels)?,
            None => inputs,
        };
        inputs.notes().iter().for_each(|note| global.note(note));
        let frames = frames_in(&entry.frame_range()?, inputs.len())?;
        let look = Look::at(&inputs, frames.clone(), global)?;
        let bounds = look.bounds.context("no frame has a vertex")?;
        ensure!(bounds.diagonal() > 0.0, "all vertices are at one point");
        let info = SequenceInfo {
            name: entry.name.clone(),
            input: source.display().to_string(),
            first: frames.start as u64,
            fps: rate.per_second(),
            side: bounds.longest_side(),
            diagonal: bounds.diagonal(),
            ..look.info()
        };
        Ok(Self {
            info,
            inputs,
            bare,
            frames,
            pattern: FileNames::of_all(&look.names),
            names: look.names,
            files: look.files,
            choice: entry.files(),
            labels,
            bounds,
            rate,
            up_axis: entry.up_axis()?,
        })
    }

    /// The box that every frame fits.
    pub(super) fn box_of_all(&self) -> &BoundingBox {
        &self.bounds
    }

    /// Number of frames used.
    pub(super) fn len(&self) -> usize {
        self.frames.len()
    }

    /// Frame `index` of those used, cleaned.
    ///
    /// # Errors
    /// The file cannot be read.
    pub(super) fn frame(&self, index: usize, labels: CodecLabels) -> Result<Mesh> {
        let inputs = match labels {
            CodecLabels::Sequence => &self.inputs,
            CodecLabels::Auto | CodecLabels::None => &self.bare,
        };
        let frame = inputs.read(self.frames.start + index)?;
        Ok(clean_surface(&frame)?.mesh)
    }

    /// Adds the file's name to an encoder's error about a frame.
    pub(super) fn name_file(&self, error: EncodeError) -> anyhow::Error {
        let frame = error.frame().and_then(|frame| usize::try_from(frame).ok());
        let file = frame.and_then(|frame| self.files.get(frame));
        let error = anyhow::Error::from(error);
        match file {
            Some(file) => error.context(file.display().to_string()),
            None => error,
        }
    }

    /// The arguments of `kn encode` that name these frames.
    pub(super) fn arguments(&self, labels: CodecLabels) -> Vec<String> {
        let whole = self.frames == (0..self.inputs.len());
        let mut arguments = if whole {
            vec![self.info.input.clone()]
        } else {
            self.files.iter().map(|file| file.display().to_string()).collect()
        };
        if whole {
            arguments.extend(self.choice.flags());
        }
        let mut flag = |name: &str, value: String| arguments.extend([name.into(), value]);
        match (&self.labels, labels) {
            (_, CodecLabels::None) => flag("--labels", "none".into()),
            (_, CodecLabels::Auto) => flag("--labels", "auto".into()),
            (Some(labels), _) => flag("--labels", labels.display().to_string()),
            (None, _) => {}
        }
        if self.rate != FrameRate::default() {
            flag("--fps", self.rate.to_string());
        }
        if self.up_axis != UpAxis::default() {
            flag("--up", self.up_axis.to_string());
        }
        arguments
    }
}

/// The frames of `0..count` that a range names.
fn frames_in(range: &FrameRange, count: usize) -> Result<Range<usize>> {
    let last = count as u64 - 1;
    ensure!(range.first() <= last, "there is no frame {}: the last is {last}", range.first());
    let open = range.last() == u64::MAX;
    ensure!(open || range.last() <= last, "there is no frame {}: the last is {last}", range.last());
    Ok(range.first() as usize..range.last().min(last) as usize + 1)
}

/// Facts from one pass over all frames.
struct Look {
    bounds: Option<BoundingBox>,
    labelled: bool,
    vertices: usize,
    faces: usize,
    names: Vec<String>,
    files: Vec<PathBuf>,
    digest: Sha256,
}

impl Look {
    fn at(inputs: &Inputs, frames: Range<usize>, global: &Global) -> Result<Self> {
        let bar = progress::bar(global, "reading", Some(frames.len() as u64));
        let mut look = Self {
            bounds: None,
            labelled: true,
            vertices: 0,
            faces: 0,
            names: Vec::new(),
            files: Vec::new(),
            digest: Sha256::new(),
        };
        for index in frames {
            let frame = inputs.read(index)?;
            look.take(&clean_surface(&frame)?.mesh);
            look.names.push(frame.name);
            look.files.push(frame.path);
            bar.step();
        }
        Ok(look)
    }

    /// Facts about the frames alone.
    fn info(&self) -> SequenceInfo {
        let count = self.files.len();
        SequenceInfo {
            frames: count as u64,
            vertices: self.vertices as f64 / count as f64,
            faces: self.faces as f64 / count as f64,
            labelled: self.labelled,
            digest: hex(self.digest.clone()),
            ..SequenceInfo::default()
        }
    }

    fn take(&mut self, mesh: &Mesh) {
        let own = mesh.bounding_box();
        self.bounds = self.bounds.zip(own).map(|(all, own)| all.union(own)).or(self.bounds).or(own);
        self.labelled &= !mesh.labels.is_empty() || mesh.is_empty();
        self.vertices += mesh.positions.len();
        self.faces += mesh.faces.len();
        // Counts come first, so that no two sequences hash the same bytes.
        for count in [mesh.positions.len(), mesh.faces.len(), mesh.labels.len()] {
            self.digest.update((count as u64).to_le_bytes());
        }
        let positions = mesh.positions.as_flattened().iter().flat_map(|c| c.to_le_bytes());
        self.digest.update(positions.collect::<Vec<u8>>());
        let faces = mesh.faces.as_flattened().iter().flat_map(|v| v.to_le_bytes());
        self.digest.update(faces.collect::<Vec<u8>>());
        self.digest.update(&mesh.labels);
    }
}

/// A digest as text.
pub(super) fn hex(digest: Sha256) -> String {
    digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_must_exist() {
        let frames = |text: &str, count| frames_in(&text.parse().expect("a range"), count);
        assert_eq!(frames("..", 5).expect("all"), 0..5);
        assert_eq!(frames("2..", 5).expect("some"), 2..5);
        assert_eq!(frames("1..3", 5).expect("some"), 1..4);
        let error = frames("1..5", 5).expect_err("too many");
        assert_eq!(error.to_string(), "there is no frame 5: the last is 4");
        assert!(frames("7..", 5).is_err());
    }
}
