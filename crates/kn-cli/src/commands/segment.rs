//! `kn segment`: finds the body parts of scans.

mod preview;

use crate::arguments::Global;
use crate::choices::named;
use crate::frames::FrameFiles;
use crate::output::{OutputFolder, print, print_json, write_file};
use crate::outputs::Outputs;
use crate::table::table;
use crate::{Outcome, progress};
use anyhow::{Result, ensure};
use kn_bitstream::params::UpAxis;
use kn_io::{Inputs, ReadOptions, write_labels};
use kn_segment::{SegmentOptions, Segmentation};
use kn_sequence::{
    LabelFindings, LabelOrigin, LabelledScan, LabelledScans, check_scans, segment_scans,
};
use preview::Preview;
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Find the body parts of scans: a .labels file for each, or a check of such files
#[derive(Debug, clap::Args)]
#[command(after_help = "\
A file NAME.labels holds one integer a line for each vertex of the scan, in the file's order: 0
head, 1 to 3 left upper arm, lower arm and hand, 4 to 6 the right ones, 7 torso, 8 to 10 left thigh,
leg and foot, 11 to 13 the right ones, 14 anything else, such as a held ball. Left is that of the
person.

Scans are segmented in their order, and parts are tracked from frame to frame. Where one frame does
not show which side is left, or shows a hand on the hip, the other frames help. Hands and lower arms
that cannot be told from the torso join it. A frame in which no person is found is 14 everywhere;
the file of an empty frame is empty.

kn encode finds the labels by itself. Use files to correct labels by hand. Use --check for the
labels of another tool: it reports parts in two pieces that are far apart, and swapped sides.

Exit codes: 0 done; 1 a frame without a person, or a doubt that --check has; 2 an error.

Examples:
  kn segment 'scan/*.obj' -o labels/
  kn segment scan/ -o labels/ --preview parts.png --json > confidence.json
  kn segment scan/ --check 'scan/*.labels' --preview parts.png
  kn encode scan/ -o dance.knm --labels 'labels/*.labels'")]
pub(crate) struct SegmentArguments {
    /// A folder, a glob in quotes, a printf pattern, files, or one animated .glb (OBJ, PLY, glTF)
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,
    #[command(flatten)]
    frames: FrameFiles,
    /// The folder for the .labels files
    #[arg(short, long, value_name = "FOLDER", required_unless_present = "check")]
    output: Option<PathBuf>,
    /// Look at these labels instead of finding new ones: a glob of .labels files
    #[arg(long, value_name = "GLOB", conflicts_with = "output")]
    check: Option<PathBuf>,
    /// Draw some of the frames, coloured by part, into this PNG file
    #[arg(long, value_name = "FILE.png")]
    preview: Option<PathBuf>,
    /// The axis that points up
    #[arg(long, value_parser = named::<UpAxis>(), default_value_t = UpAxis::Y)]
    up: UpAxis,
    /// Print JSON: every frame's confidence by part, and the warnings
    #[arg(long)]
    json: bool,
}

/// The result of a frame.
#[derive(Debug, Serialize)]
struct Row {
    frame: usize,
    name: String,
    vertices: usize,
    /// Mean confidence of the body parts; none where labels are checked.
    trust: Option<f32>,
    confidence: Value,
    doubts: Vec<String>,
    #[serde(skip)]
    good: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &SegmentArguments, global: &Global) -> Result<Outcome> {
    let inputs = arguments.find_inputs()?;
    inputs.notes().iter().for_each(|note| global.note(note));
    let outputs = arguments.check_outputs(&inputs)?;
    let mut preview = arguments.preview.as_ref().map(|_| Preview::new(inputs.len()));
    let output = arguments.output.as_deref().map(|folder| LabelFiles::create(folder, outputs));
    let mut output = output.transpose()?;
    let bar = progress::bar(global, "segmenting", Some(inputs.len() as u64));
    let mut rows = Vec::new();
    for scan in arguments.label(&inputs) {
        let scan = scan?;
        if let Some(output) = &mut output {
            output.push(&scan)?;
        }
        rows.push(Row::of(&scan));
        if let Some(preview) = &mut preview {
            preview.push(scan.index, &scan.name, scan.mesh);
        }
        bar.step();
    }
    drop(bar);
    if let (Some(preview), Some(path)) = (preview, &arguments.preview) {
        let picture = preview.draw(arguments.up)?;
        write_file(path, |out| Ok(picture.write_png(out)?))?;
    }
    output.map(LabelFiles::publish).transpose()?;
    print_rows(&rows, arguments.json)?;
    Ok(if rows.iter().all(|row| row.good) { Outcome::Good } else { Outcome::Bad })
}

impl SegmentArguments {
    fn find_inputs(&self) -> Result<Inputs> {
        let labels = self.check.clone().map_or(LabelOrigin::None, LabelOrigin::Files);
        let options = self.frames.options(ReadOptions::default());
        Ok(labels.find_inputs(&self.inputs, options)?)
    }

    /// Before any work.
    fn check_outputs(&self, inputs: &Inputs) -> Result<Outputs> {
        let mut outputs = Outputs::beside(inputs.files());
        outputs.prints()?;
        if let Some(preview) = &self.preview {
            outputs.picture("--preview", preview)?;
        }
        Ok(outputs)
    }

    /// Finds or checks the labels of the scans.
    fn label(&self, inputs: &Inputs) -> LabelledScans {
        let options = SegmentOptions { up_axis: self.up };
        match self.check {
            None => segment_scans(inputs, options),
            Some(_) => check_scans(inputs, options),
        }
    }
}

impl Row {
    fn of(scan: &LabelledScan) -> Self {
        let found = match &scan.findings {
            LabelFindings::Found(found) => Some(found),
            LabelFindings::Checked(_) | LabelFindings::NoFaces => None,
        };
        Self {
            frame: scan.index,
            name: scan.name.clone(),
            vertices: scan.file_labels.len(),
            trust: found.map(|found| (found.trust * 1e3).round() / 1e3),
            confidence: found.map_or(Value::Null, confidence_json),
            doubts: scan.findings.warnings(),
            good: scan.findings.is_good(),
        }
    }

    /// The part that is trusted least.
    fn weakest(&self) -> Option<(&str, f64)> {
        let parts = self.confidence.as_object()?.iter();
        let trusts = parts.filter_map(|(name, trust)| Some((name.as_str(), trust.as_f64()?)));
        trusts.min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// The confidence of every part that some vertex has, by name, with three decimals.
pub(super) fn confidence_json(found: &Segmentation) -> Value {
    let rounded = |trust: f32| (f64::from(trust) * 1e3).round() / 1e3;
    let parts = found.parts().map(|(part, trust)| (part.to_string(), rounded(trust).into()));
    parts.collect::<Map<_, _>>().into()
}

/// Label files that appear together at the end.
struct LabelFiles {
    folder: OutputFolder,
    outputs: Outputs,
    names: HashSet<String>,
}

impl LabelFiles {
    fn create(folder: &Path, outputs: Outputs) -> Result<Self> {
        Ok(Self { folder: OutputFolder::create(folder)?, outputs, names: HashSet::new() })
    }

    fn push(&mut self, scan: &LabelledScan) -> Result<()> {
        let name = format!("{}.labels", scan.name);
        ensure!(
            self.names.insert(name.clone()),
            "{}: frame {}: another frame has the same name, {name}",
            scan.path.display(),
            scan.index
        );
        self.outputs.inside("--output", &self.folder.target(&name))?;
        write_file(&self.folder.place(&name), |out| Ok(write_labels(out, &scan.file_labels)?))
    }

    fn publish(self) -> Result<usize> {
        self.folder.publish()
    }
}

fn print_rows(rows: &[Row], as_json: bool) -> Result<()> {
    if as_json {
        return print_json(&json!({ "frames": rows }));
    }
    let mut table = table(&["frame", "vertices", "trust", "weakest", "part and doubts"]);
    for row in rows {
        let weakest = row.weakest();
        let number =
            |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.2}"));
        let part = weakest.map(|(name, _)| name.to_owned());
        let words: Vec<String> = part.into_iter().chain(row.doubts.iter().cloned()).collect();
        table.add_row([
            row.name.clone(),
            row.vertices.to_string(),
            number(row.trust.map(f64::from)),
            number(weakest.map(|(_, trust)| trust)),
            words.join("; "),
        ]);
    }
    print(|out| Ok(writeln!(out, "{table}")?))
}
