//! The report of `kn encode`: a summary for the terminal, and all frames as JSON for `--report`.

use crate::arguments::Global;
use crate::commands::segment::confidence_json;
use crate::stream;
use crate::table::{counted, grouped};
use kn_codec::{CostReport, FrameReport, PredictedReport, StepReport, Summary};
use kn_io::ReadNotes;
use kn_mesh::CleanReport;
use kn_segment::Segmentation;
use kn_sequence::LabelWarnings;
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The frames that are read and coded so far.
#[derive(Debug, Default)]
pub(super) struct Report {
    frames: Vec<FrameEntry>,
    cleaned: CleanReport,
    notes: ReadNotes,
    /// Warnings about the labels that came with the scans.
    pub(super) labels: LabelWarnings,
}

/// One frame as the JSON has it.
#[derive(Debug, Default, Serialize)]
struct FrameEntry {
    file: PathBuf,
    cleaned: Value,
    polygons: u64,
    not_carried: BTreeMap<String, u64>,
    coded: Option<CodedEntry>,
}

#[derive(Debug, Serialize)]
struct CodedEntry {
    kind: &'static str,
    bytes: u64,
    node_bytes: u64,
    vertices: u32,
    faces: u32,
    nodes: u32,
    affine_nodes: u32,
    combination: Option<&'static str>,
    translation: Option<String>,
    steps: Option<Value>,
    cost: Option<Value>,
    input_faces: u32,
    decimation_error: f64,
    fit_rms: f64,
    error: Option<ErrorEntry>,
    parts: Option<PartsEntry>,
    reason: Option<String>,
}

/// The error of a P-frame and its bound, as shares of the scan's size.
#[derive(Clone, Copy, Debug, Serialize)]
struct ErrorEntry {
    rms: f64,
    region: f64,
    rms_bound: f64,
    region_bound: f64,
}

impl From<&PredictedReport> for ErrorEntry {
    fn from(report: &PredictedReport) -> Self {
        let (error, bound) = (report.error, report.error_bound);
        Self {
            rms: error.rms,
            region: error.region,
            rms_bound: bound.rms,
            region_bound: bound.region,
        }
    }
}

/// Result of the segmentation.
#[derive(Debug, Serialize)]
struct PartsEntry {
    person: bool,
    confidence: Value,
    doubts: Vec<String>,
}

impl From<Segmentation> for PartsEntry {
    fn from(found: Segmentation) -> Self {
        Self {
            person: found.found_a_person(),
            confidence: confidence_json(&found),
            doubts: found.warnings.iter().map(ToString::to_string).collect(),
        }
    }
}

impl Report {
    /// A frame has been read and cleaned.
    pub(super) fn read(&mut self, file: PathBuf, cleaned: &CleanReport, notes: ReadNotes) {
        self.cleaned += *cleaned;
        self.notes += &notes;
        let ReadNotes { polygons, ignored: not_carried, .. } = notes;
        let cleaned = cleaned_json(cleaned);
        self.frames.push(FrameEntry { file, cleaned, polygons, not_carried, coded: None });
    }

    /// A frame has been coded; frames are read before they are coded.
    pub(super) fn coded(&mut self, frame: FrameReport) {
        let common = frame.frame();
        let entry = usize::try_from(common.index).ok().and_then(|at| self.frames.get_mut(at));
        let Some(entry) = entry else { return };
        let (intra, predicted) = (frame.intra(), frame.predicted());
        entry.coded = Some(CodedEntry {
            kind: stream::kind_letter(frame.kind()),
            bytes: common.bytes,
            node_bytes: predicted.map_or(0, |report| report.node_bytes),
            vertices: common.vertices,
            faces: common.faces,
            nodes: predicted.map_or(0, |report| report.nodes),
            affine_nodes: predicted.map_or(0, |report| report.affine_nodes),
            combination: predicted.map(|report| report.combination.name()),
            translation: predicted.map(|report| report.translation.to_string()),
            steps: predicted.map(|report| steps_json(report.steps)),
            cost: predicted.and_then(|report| report.cost).map(cost_json),
            input_faces: common.input_faces,
            decimation_error: intra.map_or(0.0, |report| report.decimation_error),
            fit_rms: predicted.map_or(0.0, |report| report.fit_rms),
            error: predicted.map(ErrorEntry::from),
            parts: common.parts.clone().map(PartsEntry::from),
            reason: intra.and_then(|report| report.reason).map(|reason| reason.to_string()),
        });
    }

    /// Tells the user the sum, and why I-frames came early.
    pub(super) fn tell(&self, summary: &Summary, seconds: f64, name: &str, global: &Global) {
        self.tell_reasons(global);
        if self.cleaned.changed() {
            global.note(format_args!("cleaned: {}", self.cleaned));
        }
        if !self.notes.is_empty() {
            global.note(&self.notes);
        }
        self.labels.iter().for_each(|warning| global.note(warning));
        self.tell_decimation(global);
        self.tell_error(global);
        self.tell_parts(global);
        let predicted = summary.frames - summary.intra_frames;
        let mean = |bytes: u64, frames: u64| grouped(bytes.checked_div(frames).unwrap_or(0));
        global.note(format_args!(
            "{name}: {} bytes, {} of {} bytes on average, {} of {}{}; {seconds:.1} s",
            grouped(summary.bytes),
            counted(summary.intra_frames, "I-frame"),
            mean(summary.intra_bytes, summary.intra_frames),
            counted(predicted, "P-frame"),
            mean(summary.predicted_bytes, predicted),
            self.node_numbers(),
        ));
    }

    /// The first early I-frames with their reasons, and the number of the others.
    fn tell_reasons(&self, global: &Global) {
        const SHOWN: usize = 3;
        let early = |frame: (usize, &'_ FrameEntry)| {
            let reason = frame.1.coded.as_ref()?.reason.clone()?;
            Some((frame.0, frame.1.file.display().to_string(), reason))
        };
        let mut early = self.frames.iter().enumerate().filter_map(early);
        for (index, file, reason) in early.by_ref().take(SHOWN) {
            global.note(format_args!("{file}: frame {index}: a new I-frame, since {reason}"));
        }
        let more = early.count();
        if more > 0 {
            let frames = counted(more as u64, "more early I-frame");
            global.note(format_args!("{frames}; --report has their reasons"));
        }
    }

    /// The least and the largest number of key nodes, in words.
    fn node_numbers(&self) -> String {
        let coded = self.frames.iter().filter_map(|frame| frame.coded.as_ref());
        let nodes: Vec<u32> = coded.map(|coded| coded.nodes).filter(|&nodes| nodes > 0).collect();
        match (nodes.iter().min(), nodes.iter().max()) {
            (Some(1), Some(1)) => " with 1 key node".into(),
            (Some(least), Some(most)) if least == most => format!(" with {most} key nodes"),
            (Some(least), Some(most)) => format!(" with {least} to {most} key nodes"),
            _ => String::new(),
        }
    }

    /// How far P-frames are from their scans, where there are any: the frame nearest to its bound.
    fn tell_error(&self, global: &Global) {
        let coded = self.frames.iter().filter_map(|frame| frame.coded.as_ref());
        let errors = coded.filter_map(|coded| coded.error);
        let used = |error: &ErrorEntry| error.rms / error.rms_bound;
        if let Some(worst) = errors.max_by(|a, b| used(a).total_cmp(&used(b))) {
            global.note(format_args!(
                "P-frames are at most {:.2} % of their scans' size away (RMS); the bound is {:.2} %",
                100.0 * worst.rms,
                100.0 * worst.rms_bound,
            ));
        }
    }

    /// In how many frames no person was found, and where first.
    fn tell_parts(&self, global: &Global) {
        let untrusted = |frame: &&FrameEntry| {
            let parts = frame.coded.as_ref().and_then(|coded| coded.parts.as_ref());
            parts.is_some_and(|parts| !parts.person)
        };
        let mut without = self.frames.iter().filter(untrusted);
        if let Some(first) = without.next() {
            global.note(format_args!(
                "no body parts found in {} of {} frames, first in {}: they are coded without",
                1 + without.count(),
                self.frames.len(),
                first.file.display(),
            ));
        }
    }

    /// Summary of the decimation of I-frames, where there was any.
    fn tell_decimation(&self, global: &Global) {
        let coded = self.frames.iter().filter_map(|frame| frame.coded.as_ref());
        let coarser = coded.filter(|coded| coded.decimation_error > 0.0);
        let (mut frames, mut before, mut after, mut error) = (0, 0, 0, 0.0_f64);
        for coded in coarser {
            frames += 1;
            before += u64::from(coded.input_faces);
            after += u64::from(coded.faces);
            error = error.max(coded.decimation_error);
        }
        let mean = |sum: u64| sum.checked_div(frames).map(grouped);
        if let (Some(before), Some(after)) = (mean(before), mean(after)) {
            global.note(format_args!(
                "decimated: {before} faces of an I-frame to {after}, vertices at most {error:.3e} away"
            ));
        }
    }

    /// All of it; `settings` are those of the command line.
    pub(super) fn to_json(&self, settings: Value, summary: &Summary, seconds: f64) -> Value {
        json!({
            "settings": settings,
            "seconds": seconds,
            "bytes": summary.bytes,
            "intra_frames": summary.intra_frames,
            "intra_bytes": summary.intra_bytes,
            "predicted_frames": summary.frames - summary.intra_frames,
            "predicted_bytes": summary.predicted_bytes,
            "cleaned": cleaned_json(&self.cleaned),
            "not_carried": self.notes.ignored,
            "frames": self.frames,
        })
    }
}

fn steps_json(steps: StepReport) -> Value {
    let StepReport { translation, rotation, scale, shear } = steps;
    json!({ "translation": translation, "rotation": rotation, "scale": scale, "shear": shear })
}

fn cost_json(cost: CostReport) -> Value {
    let CostReport { distortion, bytes, total } = cost;
    json!({ "distortion": distortion, "bytes": bytes, "total": total })
}

fn cleaned_json(report: &CleanReport) -> Value {
    json!({
        "input_vertices": report.input_vertices,
        "input_faces": report.input_faces,
        "welded": report.welded,
        "label_conflicts": report.label_conflicts,
        "degenerate": report.degenerate,
        "duplicate": report.duplicate,
        "unused": report.unused,
        "boundary_edges": report.boundary_edges,
        "non_manifold_edges": report.non_manifold_edges,
        "components": report.components,
        "isolated": report.isolated,
    })
}
