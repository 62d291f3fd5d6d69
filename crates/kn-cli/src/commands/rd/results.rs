//! Results of a run: the files of the cells, and results.json.

use kn_metrics::{Comparison, Metric};
use serde::{Deserialize, Serialize};

/// The results of a study. With the configuration they are all data of a report.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Study {
    /// Version of kn.
    pub(super) version: String,
    /// Digest of the program.
    pub(super) build: String,
    /// Processors of the machine, and cells encoded at a time.
    pub(super) cores: usize,
    pub(super) jobs: usize,
    /// The command line.
    pub(super) command: String,
    pub(super) sequences: Vec<SequenceInfo>,
    pub(super) cells: Vec<CellRow>,
    /// Cells without a result, and why.
    pub(super) failures: Vec<Failure>,
    pub(super) pictures: Vec<PictureRow>,
}

/// One sequence.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct SequenceInfo {
    pub(super) name: String,
    pub(super) input: String,
    pub(super) frames: u64,
    pub(super) first: u64,
    pub(super) fps: f64,
    /// Means over the frames.
    pub(super) vertices: f64,
    pub(super) faces: f64,
    pub(super) labelled: bool,
    /// The box of all frames, world units.
    pub(super) side: f64,
    pub(super) diagonal: f64,
    /// SHA-256 of the cleaned frames.
    pub(super) digest: String,
}

/// A cell under the names of the configuration.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct CellRow {
    pub(super) sequence: String,
    pub(super) codec: String,
    pub(super) point: String,
    /// A command that writes the same stream.
    pub(super) command: String,
    #[serde(flatten)]
    pub(super) result: CellResult,
}

/// A cell that could not be run.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Failure {
    pub(super) sequence: String,
    pub(super) codec: String,
    pub(super) point: String,
    pub(super) reason: String,
}

/// The measured values of one stream.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct CellResult {
    pub(super) key: String,
    pub(super) version: String,
    pub(super) build: String,
    /// All settings of the encoder.
    pub(super) settings: String,
    /// The whole file.
    pub(super) bytes: u64,
    /// Processor seconds on so many threads: encoding, decoding, measuring.
    pub(super) threads: usize,
    pub(super) encode_seconds: f64,
    pub(super) decode_seconds: f64,
    pub(super) measure_seconds: f64,
    pub(super) frames: Vec<FrameResult>,
}

/// The measured values of one frame.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct FrameResult {
    pub(super) index: u64,
    /// I or P.
    pub(super) kind: String,
    pub(super) bytes: u64,
    pub(super) vertices: u32,
    pub(super) nodes: u32,
    #[serde(flatten)]
    pub(super) comparison: Comparison,
}

impl FrameResult {
    pub(super) fn is_predicted(&self) -> bool {
        self.kind == "P"
    }
}

/// The frames that a rate is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Share {
    /// The whole file against all frames.
    All,
    /// P-frames with their key nodes against P-frames.
    Predicted,
}

impl CellResult {
    fn frames_of(&self, share: Share) -> impl Iterator<Item = &FrameResult> {
        self.frames.iter().filter(move |frame| share == Share::All || frame.is_predicted())
    }

    /// Mean bytes a frame; `None` where there is no such frame.
    pub(super) fn bytes_per_frame(&self, share: Share) -> Option<f64> {
        let count = self.frames_of(share).count();
        let bytes = match share {
            Share::All => self.bytes,
            Share::Predicted => self.frames_of(share).map(|frame| frame.bytes).sum(),
        };
        (count > 0).then(|| bytes as f64 / count as f64)
    }

    /// Mean bytes of the I-frames.
    pub(super) fn intra_bytes(&self) -> Option<f64> {
        let intra = || self.frames.iter().filter(|frame| !frame.is_predicted());
        let bytes: u64 = intra().map(|frame| frame.bytes).sum();
        (intra().count() > 0).then(|| bytes as f64 / intra().count() as f64)
    }

    /// The mean of a metric, where it was measured on every frame.
    pub(super) fn mean(&self, metric: Metric, share: Share) -> Option<f64> {
        Comparison::mean(self.frames_of(share).map(|frame| &frame.comparison))?.get(metric)
    }
}

/// A picture of a decoded frame, or of the scan where `codec` is none.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct PictureRow {
    pub(super) sequence: String,
    pub(super) codec: Option<String>,
    pub(super) point: Option<String>,
    pub(super) frame: u64,
    pub(super) bytes_per_frame: Option<f64>,
    /// The PNG, in the folder of the results.
    pub(super) file: String,
    /// Its error map, and where the scale of that ends, world units.
    pub(super) error_file: Option<String>,
    pub(super) scale_end: f64,
}
