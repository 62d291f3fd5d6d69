//! Labels of scans: their origin, the segmentation of a sequence, and checks of given labels.

use std::convert::Infallible;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use kn_bitstream::params::UpAxis;
use kn_io::{InputFrame, Inputs, LabelSource, MeshError, ReadOptions};
use kn_mesh::{Mesh, caught};
use kn_segment::{LabelWarning, OTHER, SegmentOptions, Segmentation, Segmenter, check_labels};

use crate::error::SequenceError;
use crate::scan::clean_scan;

/// The origin of the labels of a sequence.
///
/// Text forms are `property`, `auto`, `colours` (or `colors`), `none`, and for anything else a
/// pattern of label files.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum LabelOrigin {
    /// The vertex property `label` of PLY files, where they have it.
    #[default]
    Property,
    /// The segmentation. Labels in the files are not read.
    Auto,
    /// The colours of the vertices, which must be those of [`kn_bitstream::params::BodyPart`].
    Colours,
    /// Files of labels, one for each mesh: a folder, a glob or a printf pattern.
    Files(PathBuf),
    /// No labels, whatever the files hold.
    None,
}

impl LabelOrigin {
    /// Finds the frames that `specs` name like [`Inputs::find`], with labels of this origin.
    ///
    /// # Errors
    /// The errors of [`Inputs::find`] and of [`Inputs::with_labels`].
    pub fn find_inputs(
        &self,
        specs: &[PathBuf],
        options: ReadOptions,
    ) -> Result<Inputs, MeshError> {
        let labels = match self {
            Self::Property => LabelSource::Property,
            Self::Colours => LabelSource::Colours,
            Self::Auto | Self::Files(_) | Self::None => LabelSource::None,
        };
        let inputs = Inputs::find(specs, ReadOptions { labels, ..options })?;
        match self {
            Self::Files(pattern) => inputs.with_labels(pattern),
            _ => Ok(inputs),
        }
    }
}

impl FromStr for LabelOrigin {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text {
            "property" => Self::Property,
            "auto" => Self::Auto,
            "colours" | "colors" => Self::Colours,
            "none" => Self::None,
            pattern => Self::Files(pattern.into()),
        })
    }
}

impl fmt::Display for LabelOrigin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Property => f.write_str("property"),
            Self::Auto => f.write_str("auto"),
            Self::Colours => f.write_str("colours"),
            Self::Files(pattern) => write!(f, "{}", pattern.display()),
            Self::None => f.write_str("none"),
        }
    }
}

/// A scan with its labels.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LabelledScan {
    /// Number of the frame.
    pub index: usize,
    /// Name of the frame, without extension.
    pub name: String,
    /// The file that the frame was read from.
    pub path: PathBuf,
    /// The mesh after [`clean_scan`], with its labels.
    pub mesh: Mesh,
    /// One label for each vertex of the file, in the order of the file.
    pub file_labels: Vec<u8>,
    /// The result of the segmentation, or of the check.
    pub findings: LabelFindings,
}

/// The findings about the labels of a scan.
#[derive(Clone, Debug, PartialEq)]
pub enum LabelFindings {
    /// The labels are those of the segmentation.
    Found(Segmentation),
    /// The labels came with the scan. The check has these warnings.
    Checked(Vec<LabelWarning>),
    /// The scan has no faces, an empty frame for instance: there is nothing to find. Its vertices,
    /// if it has any, are `Other`.
    NoFaces,
}

impl LabelFindings {
    /// All warnings, as sentences without full stop.
    pub fn warnings(&self) -> Vec<String> {
        match self {
            Self::Found(found) => found.warnings.iter().map(ToString::to_string).collect(),
            Self::Checked(warnings) => warnings.iter().map(ToString::to_string).collect(),
            Self::NoFaces => vec!["no faces".into()],
        }
    }

    /// Whether a person was found, the check has no warning, or there was nothing to look at.
    pub fn is_good(&self) -> bool {
        match self {
            Self::Found(found) => found.found_a_person(),
            Self::Checked(warnings) => warnings.is_empty(),
            Self::NoFaces => true,
        }
    }
}

/// The labelled scans of a sequence, each read when it is asked for. Nothing comes after an error.
#[derive(Debug)]
pub struct LabelledScans {
    frames: kn_io::Frames,
    up_axis: UpAxis,
    /// `None` checks the labels that the scans have.
    segmenter: Option<Segmenter>,
}

/// Finds the body parts of the scans of a sequence, in their order.
///
/// The scans are cleaned first. Every vertex of the file has the label of the vertex that it was
/// welded to. A frame in which no person is found is `Other` everywhere.
pub fn segment_scans(inputs: &Inputs, options: SegmentOptions) -> LabelledScans {
    let segmenter = Some(Segmenter::new(options));
    LabelledScans { frames: inputs.frames(), up_axis: options.up_axis, segmenter }
}

/// Checks the labels that the scans of a sequence came with.
pub fn check_scans(inputs: &Inputs, options: SegmentOptions) -> LabelledScans {
    LabelledScans { frames: inputs.frames(), up_axis: options.up_axis, segmenter: None }
}

impl LabelledScans {
    fn label(&mut self, frame: InputFrame) -> Result<LabelledScan, SequenceError> {
        let cleaned = clean_scan(&frame)?;
        let mut mesh = cleaned.mesh;
        let findings = caught(|| match &mut self.segmenter {
            _ if mesh.faces.is_empty() => Ok(LabelFindings::NoFaces),
            Some(segmenter) => {
                segmenter.segment(&mesh.positions, &mesh.faces).map(LabelFindings::Found)
            }
            None => check_labels(&mesh.positions, &mesh.faces, &mesh.labels, self.up_axis)
                .map(LabelFindings::Checked),
        });
        let findings = findings.map_err(|message| SequenceError::Internal {
            file: frame.path.display().to_string(),
            frame: frame.index as u64,
            message,
        })?;
        let findings = findings.map_err(|source| SequenceError::Segment {
            file: frame.path.clone(),
            frame: frame.index,
            source,
        })?;
        match &findings {
            LabelFindings::Found(found) => mesh.labels.clone_from(&found.labels),
            LabelFindings::NoFaces => mesh.labels = vec![OTHER; mesh.positions.len()],
            LabelFindings::Checked(_) => {}
        }
        let of_file = cleaned.vertex_map.iter().map(|&vertex| mesh.labels[vertex as usize]);
        let file_labels = of_file.collect();
        let InputFrame { index, name, path, .. } = frame;
        Ok(LabelledScan { index, name, path, mesh, file_labels, findings })
    }
}

impl Iterator for LabelledScans {
    type Item = Result<LabelledScan, SequenceError>;

    fn next(&mut self) -> Option<Self::Item> {
        let frame = self.frames.next()?.map_err(SequenceError::from);
        Some(frame.and_then(|frame| self.label(frame)))
    }
}

/// Warnings about the labels that a sequence came with. A warning that repeats is kept once, with
/// its first frame.
#[derive(Clone, Debug, Default)]
pub struct LabelWarnings(Vec<RepeatedWarning>);

/// A warning, its first frame, and the number of later frames that have it too.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RepeatedWarning {
    /// The warning of the first frame.
    pub warning: LabelWarning,
    /// The file of the first frame.
    pub file: PathBuf,
    /// Number of the first frame.
    pub frame: usize,
    /// Number of later frames with the same kind of warning about the same part.
    pub more: usize,
}

impl LabelWarnings {
    /// Checks the labels of a cleaned frame. A frame without labels, and one that cannot be
    /// checked since it has no area, adds nothing.
    pub fn check(&mut self, file: &Path, frame: usize, mesh: &Mesh, up_axis: UpAxis) {
        let Mesh { positions, faces, labels, .. } = mesh;
        if labels.is_empty() {
            return;
        }
        for warning in check_labels(positions, faces, labels, up_axis).unwrap_or_default() {
            match self.0.iter_mut().find(|known| known.warning.is_like(&warning)) {
                Some(known) => known.more += 1,
                None => {
                    let file = file.to_owned();
                    self.0.push(RepeatedWarning { warning, file, frame, more: 0 });
                }
            }
        }
    }

    /// The warnings, in the order of their first frames.
    pub fn iter(&self) -> impl Iterator<Item = &RepeatedWarning> {
        self.0.iter()
    }
}

impl fmt::Display for RepeatedWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { warning, file, frame, more } = self;
        write!(f, "{}: frame {frame}: labels: {warning}", file.display())?;
        match more {
            0 => Ok(()),
            1 => f.write_str(" (and in 1 more frame)"),
            more => write!(f, " (and in {more} more frames)"),
        }
    }
}
