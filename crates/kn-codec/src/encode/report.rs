//! What an encoder tells about its frames.

use crate::decode::FrameKind;
use crate::encode::failure::FitFailure;
use crate::encode::quantise::unit_step;
use kn_bitstream::params::{Combination, TranslationMode};
use kn_bitstream::{MotionFrame, translation_step};
use kn_segment::Segmentation;

/// What became of one frame.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FrameReport {
    /// The frame became an I-frame.
    Intra(IntraReport),
    /// The frame became a P-frame.
    Predicted(PredictedReport),
}

/// What every coded frame has.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CodedFrame {
    /// Place in the sequence, from 0: display order.
    pub index: u64,
    /// Place in the stream, from 0: decode order. Equal to `index` today.
    pub decode_index: u64,
    /// Bytes of the frame's units; a GoF's key nodes count with its first P-frame.
    pub bytes: u64,
    /// Vertices of the decoded frame.
    pub vertices: u32,
    /// Faces of the decoded frame.
    pub faces: u32,
    /// Faces of the input frame.
    pub input_faces: u32,
    /// What the segmentation found, where it was asked for labels; the labels are not kept.
    pub parts: Option<Segmentation>,
}

/// What became of a frame that is an I-frame.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct IntraReport {
    /// What every coded frame has.
    pub frame: CodedFrame,
    /// Largest distance from a vertex of the scan to the decimated surface, before quantisation,
    /// world units; 0 where nothing was decimated.
    pub decimation_error: f64,
    /// `#V` decoded vertex of each vertex of the input frame, or [`crate::DROPPED`], where
    /// [`crate::IntraConfig::vertex_maps`] asks for it.
    pub vertex_map: Option<Vec<u32>>,
    /// Why it begins its GoF early: what the motion could not explain. `None` where the GoF
    /// before was full, and at the first frame.
    pub reason: Option<FitFailure>,
}

/// What became of a frame that is a P-frame.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PredictedReport {
    /// What every coded frame has.
    pub frame: CodedFrame,
    /// Of its bytes, those of the key nodes; 0 but in the first P-frame of a GoF.
    pub node_bytes: u64,
    /// Key nodes of the GoF.
    pub nodes: u32,
    /// Of these, affine ones.
    pub affine_nodes: u32,
    /// Components of affine nodes.
    pub combination: Combination,
    /// What translations are predicted from.
    pub translation: TranslationMode,
    /// Quantiser steps.
    pub steps: StepReport,
    /// What the frame costs, where anything was chosen by cost.
    pub cost: Option<CostReport>,
    /// RMS distance from the fitted mesh to the scan before quantisation, world units.
    pub fit_rms: f64,
}

impl FrameReport {
    /// What every coded frame has.
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

    /// I or P.
    pub fn kind(&self) -> FrameKind {
        match self {
            Self::Intra(_) => FrameKind::Intra,
            Self::Predicted(_) => FrameKind::Predicted,
        }
    }

    /// The report of an I-frame.
    pub fn intra(&self) -> Option<&IntraReport> {
        match self {
            Self::Intra(report) => Some(report),
            Self::Predicted(_) => None,
        }
    }

    /// The report of a P-frame.
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
    /// Of translations, in grid steps.
    pub translation: f64,
    /// Of angles, in radians.
    pub rotation: f64,
    /// Of scales.
    pub scale: f64,
    /// Of shears.
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

/// J = D + λR of a P-frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CostReport {
    /// D, as [`crate::DistortionMeasure`] says.
    pub distortion: f64,
    /// R: bytes of the motion, without the framing of the unit and without key nodes.
    pub bytes: u64,
    /// J.
    pub total: f64,
}

/// What became of the sequence.
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
