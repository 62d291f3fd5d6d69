//! What an encoder tells about its frames.

use crate::decode::FrameKind;
use kn_bitstream::TranslationMode;
use kn_deform::Combination;
use kn_fit::segment::Segmentation;

/// What became of one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameReport {
    /// Position in the sequence, from 0.
    pub index: u64,
    /// I or P.
    pub kind: FrameKind,
    /// Bytes of the frame's units; a group's key nodes count with its first P-frame.
    pub bytes: u64,
    /// Of these, bytes of the key nodes.
    pub node_bytes: u64,
    /// Vertices and faces of the decoded frame.
    pub vertices: u32,
    /// Faces of the decoded frame.
    pub faces: u32,
    /// Key nodes, 0 for an I-frame.
    pub nodes: u32,
    /// Components of affine nodes; `None` for an I-frame.
    pub combination: Option<Combination>,
    /// What translations are predicted from; `None` for an I-frame.
    pub translation: Option<TranslationMode>,
    /// Faces of the input frame.
    pub input_faces: u32,
    /// Largest distance from a vertex of the scan to the decimated surface, before quantisation,
    /// world units; 0 where nothing was decimated.
    pub decimation_error: f64,
    /// `#V` decoded vertex of each vertex of the input frame, or [`crate::GONE`], of an I-frame where
    /// [`crate::EncoderConfig::vertex_maps`] asks for it.
    pub vertex_map: Option<Vec<u32>>,
    /// RMS distance from the fitted mesh to the scan before quantisation, world units; 0 for an
    /// I-frame.
    pub fit_rms: f64,
    /// What the segmentation found, where it was asked for labels; the labels are not kept.
    pub parts: Option<Segmentation>,
    /// Why this I-frame begins its group early: what the motion could not explain.
    pub reason: Option<String>,
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
