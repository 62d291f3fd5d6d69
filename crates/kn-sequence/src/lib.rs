#![doc = include_str!("../README.md")]

mod compare;
mod error;
mod labels;
mod scan;
mod sequence;
mod stream;

pub use compare::{
    CompareSequences, FrameComparison, MeasuredPair, SequenceComparison, compare_frames,
    compare_sequences, compare_sequences_with,
};
pub use error::{ScanFault, SequenceError};
pub use kn_metrics::{CompareOptions, Comparison, Metric, PointSampling};
pub use labels::{
    LabelFindings, LabelOrigin, LabelWarnings, LabelledScan, LabelledScans, RepeatedWarning,
    check_scans, segment_scans,
};
pub use scan::{clean_scan, clean_surface};
pub use sequence::{Frame, Frames, Sequence, SequenceOptions};
pub use stream::{StreamReader, StreamSource};
