//! Comparison of two sequences, frame by frame.

use std::ops::RangeInclusive;

use kn_codec::FrameKind;
use kn_mesh::{BoundingBox, Mesh, caught};
use kn_metrics::{
    CompareError, CompareOptions, Comparison, EmptySide, FaceMarks, Surface, compare_empty,
    compare_faces, compare_surfaces,
};

use crate::error::SequenceError;
use crate::sequence::{Frame, Sequence};

/// Options of a comparison of sequences: the metrics and the frames.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CompareSequences {
    /// The metrics. Without `bounds` they refer to the box of the whole reference, which is read
    /// once more for it.
    pub metrics: CompareOptions,
    /// Numbers of the frames, both ends included.
    pub frames: RangeInclusive<u64>,
    /// Label of one body part. The points of its faces are measured against the whole other frame,
    /// by point-to-surface distances alone. `None` measures whole frames.
    pub part: Option<u8>,
}

impl Default for CompareSequences {
    /// All metrics of all frames.
    fn default() -> Self {
        Self { metrics: CompareOptions::default(), frames: 0..=u64::MAX, part: None }
    }
}

/// The result of one frame.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct FrameComparison {
    /// Number of the frame.
    pub index: u64,
    /// Kind of the frame of the distorted sequence, where that is a stream.
    pub kind: Option<FrameKind>,
    /// Bytes of that frame, where it came from a stream.
    pub bytes: Option<u64>,
    /// The metrics.
    pub comparison: Comparison,
}

/// The result of a comparison of two sequences.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SequenceComparison {
    /// The box that relative distances and decibels refer to.
    pub bounds: BoundingBox,
    /// The frames that were measured, at least one.
    pub frames: Vec<FrameComparison>,
    /// Means over all measured frames, without those that are empty in both sequences.
    pub mean: Comparison,
    /// Means over the P-frames, where the distorted sequence is a stream that has some.
    pub mean_predicted: Option<Comparison>,
}

/// Two frames, prepared and measured.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct MeasuredPair<'p> {
    /// The frame of the reference.
    pub reference: &'p Frame,
    /// The frame of the distorted sequence.
    pub distorted: &'p Frame,
    /// The reference as it was prepared for the metrics.
    pub reference_surface: &'p Surface,
    /// The distorted frame as it was prepared for the metrics.
    pub distorted_surface: &'p Surface,
    /// The metrics.
    pub comparison: &'p Comparison,
}

/// Measures `distorted` against `reference`. One pair of frames is held at a time. Empty frames have
/// the values of [`compare_empty`].
///
/// # Errors
/// A frame cannot be read or measured, the sequences differ in length (as far as `options` ask for
/// their frames), or none of the frames that were asked for exists.
pub fn compare_sequences(
    reference: &Sequence,
    distorted: &Sequence,
    options: &CompareSequences,
) -> Result<SequenceComparison, SequenceError> {
    compare_sequences_with(reference, distorted, options, |_| ())
}

/// Measures like [`compare_sequences`], and calls `observe` with every measured pair, for instance
/// for pictures. A pair with an empty frame has no surfaces to show, and is left out.
///
/// # Errors
/// The errors of [`compare_sequences`].
pub fn compare_sequences_with(
    reference: &Sequence,
    distorted: &Sequence,
    options: &CompareSequences,
    mut observe: impl FnMut(MeasuredPair<'_>),
) -> Result<SequenceComparison, SequenceError> {
    let bounds = options.metrics.bounds.map_or_else(|| reference.bounds(), Ok)?;
    let metrics = options.metrics.clone().with_bounds(bounds);
    let (mut left, mut right) = (reference.frames()?, distorted.frames()?);
    let names = [reference, distorted].map(|sequence| sequence.name().to_owned());
    let (mut frames, mut count) = (Vec::new(), 0);
    loop {
        let (a, b) = match (left.next().transpose()?, right.next().transpose()?) {
            (Some(a), Some(b)) => (a, b),
            (None, None) => break,
            (Some(a), None) => return Err(length(&names[1], &names[0], a.index)),
            (None, Some(b)) => return Err(length(&names[0], &names[1], b.index)),
        };
        count = a.index + 1;
        if options.frames.contains(&a.index) {
            let measured = caught(|| measure(&a, &b, &metrics, options.part, &mut observe));
            frames.push(measured.map_err(|message| internal(&a, message))??);
        }
        if a.index >= *options.frames.end() {
            break;
        }
    }
    let [reference, distorted] = names;
    let first = *options.frames.start();
    let mean = Comparison::mean(frames.iter().map(|frame| &frame.comparison))
        .ok_or(SequenceError::NoFrame { first, reference, distorted, frames: count })?;
    let predicted = frames.iter().filter(|frame| frame.kind == Some(FrameKind::Predicted));
    let mean_predicted = Comparison::mean(predicted.map(|frame| &frame.comparison));
    Ok(SequenceComparison { bounds, frames, mean, mean_predicted })
}

fn internal(frame: &Frame, message: String) -> SequenceError {
    SequenceError::Internal { file: frame.file.clone(), frame: frame.index, message }
}

fn length(short: &str, long: &str, frame: u64) -> SequenceError {
    SequenceError::Length { short: short.into(), long: long.into(), frame }
}

fn measure(
    a: &Frame,
    b: &Frame,
    metrics: &CompareOptions,
    part: Option<u8>,
    observe: &mut impl FnMut(MeasuredPair<'_>),
) -> Result<FrameComparison, SequenceError> {
    let at = |frame: &Frame| {
        let (file, frame) = (frame.file.clone(), frame.index);
        move |source: CompareError| SequenceError::Compare { file, frame, source }
    };
    let comparison_of =
        |comparison| FrameComparison { index: b.index, kind: b.kind, bytes: b.bytes, comparison };
    if let Some(empty) = empty_side(&a.mesh, &b.mesh) {
        return compare_empty(empty, metrics).map(comparison_of).map_err(at(b));
    }
    let prepare = |frame: &Frame| Surface::new((&frame.mesh).into(), metrics).map_err(at(frame));
    let (reference, distorted) = (prepare(a)?, prepare(b)?);
    let comparison = match part {
        None => compare_surfaces(&reference, &distorted, metrics),
        Some(part) => {
            let (marks_a, marks_b) = (faces_of(a, part)?, faces_of(b, part)?);
            let marks = FaceMarks { reference: &marks_a, distorted: &marks_b };
            compare_faces(&reference, &distorted, marks, metrics)
        }
    };
    let comparison = comparison.map_err(at(b))?;
    observe(MeasuredPair {
        reference: a,
        distorted: b,
        reference_surface: &reference,
        distorted_surface: &distorted,
        comparison: &comparison,
    });
    Ok(comparison_of(comparison))
}

/// Measures one frame; empty frames have the values of [`compare_empty`]. The options name the box.
///
/// # Errors
/// A frame cannot be measured.
pub fn compare_frames(
    reference: &Mesh,
    distorted: &Mesh,
    metrics: &CompareOptions,
) -> Result<Comparison, CompareError> {
    if let Some(empty) = empty_side(reference, distorted) {
        return compare_empty(empty, metrics);
    }
    let (a, b) =
        (Surface::new(reference.into(), metrics)?, Surface::new(distorted.into(), metrics)?);
    compare_surfaces(&a, &b, metrics)
}

/// Which of two frames are empty; `None` where neither is.
fn empty_side(a: &Mesh, b: &Mesh) -> Option<EmptySide> {
    match (a.is_empty(), b.is_empty()) {
        (false, false) => None,
        (true, true) => Some(EmptySide::Both),
        _ => Some(EmptySide::One),
    }
}

/// `#F` marks: the faces with all corners in the part.
fn faces_of(frame: &Frame, part: u8) -> Result<Vec<bool>, SequenceError> {
    let labels = &frame.mesh.labels;
    if labels.is_empty() {
        return Err(SequenceError::NoLabels { file: frame.file.clone(), frame: frame.index });
    }
    let inside = |face: &[u32; 3]| face.iter().all(|&vertex| labels[vertex as usize] == part);
    let marks: Vec<bool> = frame.mesh.faces.iter().map(inside).collect();
    if !marks.contains(&true) {
        return Err(SequenceError::NoPart { file: frame.file.clone(), frame: frame.index, part });
    }
    Ok(marks)
}
