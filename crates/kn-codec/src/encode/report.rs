//! Reports of the encoder about its frames.

use crate::decode::FrameKind;
use crate::encode::failure::FitFailure;
use crate::encode::frame_error::FrameError;
use crate::encode::quantise::unit_step;
use kn_bitstream::params::{Combination, TranslationMode};
use kn_bitstream::{MotionFrame, translation_step};
use kn_segment::Segmentation;

/// The report of one frame.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FrameReport {
    /// The frame became an I-frame.
    Intra(IntraReport),
    /// The frame became a P-frame.
    Predicted(PredictedReport),
}

/// The part of a report that I-frames and P-frames share.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CodedFrame {
    /// Place in the sequence, from 0: display order.
    pub index: u64,
    /// Place in the stream, from 0: decode order. Equal to `index` in streams of this version.
    pub decode_index: u64,
    /// Bytes of the frame's units; a GoF's key nodes count with its first P-frame.
    pub bytes: u64,
    /// Vertices of the decoded frame.
    pub vertices: u32,
    /// Faces of the decoded frame.
    pub faces: u32,
    /// Faces of the input frame.
    pub input_faces: u32,
    /// The result of the segmentation, without its labels; `None` where it did not run.
    pub parts: Option<Segmentation>,
}

/// The report of an I-frame.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct IntraReport {
    /// The part that all frames have.
    pub frame: CodedFrame,
    /// Largest distance from a vertex of the scan to the decimated surface, before quantisation,
    /// world units; 0 where nothing was decimated.
    pub decimation_error: f64,
    /// `#V` of the input frame: the decoded vertex of each vertex, or [`crate::DROPPED`]. `None`
    /// unless [`crate::IntraConfig::vertex_maps`] asks for it.
    pub vertex_map: Option<Vec<u32>>,
    /// The reason why the GoF before ended early. `None` where that GoF was full, and at the first
    /// frame.
    pub reason: Option<FitFailure>,
}

/// The report of a P-frame.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PredictedReport {
    /// The part that all frames have.
    pub frame: CodedFrame,
    /// Bytes of the key nodes, which are part of the frame's bytes; 0 except in the first P-frame
    /// of a GoF.
    pub node_bytes: u64,
    /// Number of key nodes of the GoF.
    pub nodes: u32,
    /// Number of affine key nodes among them.
    pub affine_nodes: u32,
    /// Components of affine nodes.
    pub combination: Combination,
    /// Prediction of the translations.
    pub translation: TranslationMode,
    /// Quantiser steps.
    pub steps: StepReport,
    /// Cost of the frame; `None` where nothing was chosen by cost.
    pub cost: Option<CostReport>,
    /// RMS distance from the fitted mesh to the scan before quantisation, world units.
    pub fit_rms: f64,
    /// Distance between the decoded frame and its scan.
    pub error: FrameError,
    /// The bound for it, which follows from [`crate::MotionConfig::max_error`].
    pub error_bound: FrameError,
}

impl FrameReport {
    /// The part that all frames have.
    pub fn frame(&self) -> &CodedFrame {
        match self {
            Self::Intra(report) => &report.frame,
            Self::Predicted(report) => &report.frame,
        }
    }

    pub(crate) fn frame_mut(&mut self) -> &mut CodedFrame {
        match self {
            Self::Intra(report) => &mut report.frame,
            Self::Predicted(report) => &mut report.frame,
        }
    }

    /// Whether the frame is an I-frame or a P-frame.
    pub fn kind(&self) -> FrameKind {
        match self {
            Self::Intra(_) => FrameKind::Intra,
            Self::Predicted(_) => FrameKind::Predicted,
        }
    }

    /// The report, where the frame is an I-frame.
    pub fn intra(&self) -> Option<&IntraReport> {
        match self {
            Self::Intra(report) => Some(report),
            Self::Predicted(_) => None,
        }
    }

    /// The report, where the frame is a P-frame.
    pub fn predicted(&self) -> Option<&PredictedReport> {
        match self {
            Self::Predicted(report) => Some(report),
            Self::Intra(_) => None,
        }
    }
}

/// Quantiser steps of a P-frame; 0 where no node carries the component.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport {
    /// Quantiser step of translations, in grid steps.
    pub translation: f64,
    /// Quantiser step of angles, in radians.
    pub rotation: f64,
    /// Quantiser step of scales.
    pub scale: f64,
    /// Quantiser step of shears.
    pub shear: f64,
}

impl StepReport {
    /// The steps of a frame.
    pub(crate) fn new(motion: &MotionFrame, fraction_bits: u8) -> Self {
        let unit = f64::from(1_u32 << fraction_bits);
        let parameter = |step: u8, list: &[[i32; 3]]| {
            if list.is_empty() { 0.0 } else { unit_step(step) }
        };
        Self {
            translation: translation_step(motion.translation_step) as f64 / unit,
            rotation: parameter(motion.rotation_step, &motion.rotation),
            scale: parameter(motion.scale_step, &motion.scale),
            shear: parameter(motion.shear_step, &motion.shear),
        }
    }
}

/// The cost J = D + λR of a P-frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CostReport {
    /// D, as [`crate::DistortionMeasure`] says.
    pub distortion: f64,
    /// R: bytes of the motion, without the framing of the unit and without key nodes.
    pub bytes: u64,
    /// J.
    pub total: f64,
}

/// Totals of a sequence.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Number of frames.
    pub frames: u64,
    /// Number of I-frames.
    pub intra_frames: u64,
    /// Bytes of the whole file.
    pub bytes: u64,
    /// Bytes of I-frames.
    pub intra_bytes: u64,
    /// Bytes of P-frames with their key nodes.
    pub predicted_bytes: u64,
}
