//! `kn encode`: scans in, a .knm file out.

mod choices;
mod names;
mod report;
mod survey;

use crate::Outcome;
use crate::arguments::Global;
use crate::output::write_file;
use crate::progress;
use anyhow::{Result, anyhow};
use choices::{AffineArgument, FrameRate, InfluenceArgument, LabelArgument, NodeArgument};
use choices::{PlacementArgument, UnitArgument, UpAxis};
use kn_codec::{Encoder, EncoderConfig, GridChoice, Summary};
use kn_deform::Combination;
use kn_mesh::clean;
use kn_mesh::io::{Inputs, ReadOptions};
use names::name_pattern;
use report::Report;
use serde_json::{Value, json};
use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;
use survey::Survey;

/// Encode scans, one mesh a frame, into a .knm file
#[derive(Debug, clap::Args)]
#[command(after_help = "\
All frames are read once before encoding begins, so that one grid fits them all and a broken scan
is found before any work is done. Seams are welded and degenerate and duplicate faces dropped; the
sum is printed, --report has it frame by frame. Where the motion does not explain a frame, a new
group begins there, and the reason is printed.

Examples:
  kn encode 'scan/*.obj' -o dance.knm
  kn encode scan/ -o dance.knm --bits 12 --gof 16 --nodes auto
  kn encode scan/f_%04d.ply -o dance.knm --step 0.5 --unit mm --labels 'scan/*.labels'
  kn encode walk.glb -o walk.knm --fps 25
  kn encode scan/ -o - | kn info -")]
pub(crate) struct EncodeArguments {
    /// A folder, a glob in quotes, a printf pattern, files, or one animated .glb (OBJ, PLY, glTF)
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,
    /// The file to write; - is standard output
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Bits for the longest side of the sequence's box
    #[arg(long, default_value_t = 11, value_parser = clap::value_parser!(u8).range(4..=20))]
    bits: u8,
    /// Step of the grid in world units, instead of --bits
    #[arg(long, conflicts_with = "bits", value_name = "LENGTH", value_parser = choices::length)]
    step: Option<f64>,
    /// Frames in a group: an I-frame, then P-frames
    #[arg(long, value_name = "N", default_value_t = 8)]
    #[arg(value_parser = clap::value_parser!(u8).range(1..))]
    gof: u8,
    /// Key nodes in a group, or `auto`: as many as pay for their bytes
    #[arg(long, value_name = "N|auto", default_value = "150")]
    nodes: NodeArgument,
    /// Where key nodes are put
    #[arg(long, value_enum, default_value_t = PlacementArgument::Generated)]
    placement: PlacementArgument,
    /// Frames per second, such as 30, 29.97 or 30000/1001
    #[arg(long, default_value = "30", value_name = "RATE")]
    fps: FrameRate,
    /// Body parts of the vertices: a glob of .labels files, `colours` (of the vertices, by the
    /// palette), or `none` [default: a PLY property `label` where there is one]
    #[arg(long, value_name = "GLOB|colours|none")]
    labels: Option<LabelArgument>,
    /// What happens in a region without key nodes: an error, or the nearest nodes of any region
    #[arg(long, value_enum, default_value_t = InfluenceArgument::Fallback)]
    influence: InfluenceArgument,
    /// Which key nodes are affine: none, those of the torso, or all
    #[arg(long, value_enum, default_value_t = AffineArgument::Labels)]
    affine: AffineArgument,
    /// Components of affine nodes: T, RT, TS, TH, RTS, RTH, TSH or RTSH
    #[arg(long, default_value = "RTSH", value_parser = choices::combination)]
    combination: Combination,
    /// Unit of the coordinates; carried, not interpreted
    #[arg(long, value_enum, default_value_t = UnitArgument::Unspecified)]
    unit: UnitArgument,
    /// The axis that points up
    #[arg(long, value_enum, default_value_t = UpAxis::Y)]
    up: UpAxis,
    /// Write what happened to every frame to this file, as JSON
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
}

/// Runs the command.
pub(crate) fn run(arguments: &EncodeArguments, global: &Global) -> Result<Outcome> {
    let start = Instant::now();
    let inputs = arguments.find_inputs()?;
    let survey = Survey::new(&inputs, global)?;
    let config = arguments.config(&survey);
    let mut report = Report::default();
    let summary = write_file(&arguments.output, |writer| {
        encode(&inputs, config, writer, &mut report, global)
    })
    .map_err(|error| survey.name_file(error))?;
    let seconds = start.elapsed().as_secs_f64();
    if let Some(path) = &arguments.report {
        let json = report.to_json(arguments.settings(), &summary, seconds);
        write_file(path, |writer| Ok(serde_json::to_writer_pretty(writer, &json)?))?;
    }
    if !survey.labelled && arguments.affine == AffineArgument::Labels {
        global.note("no labels: every key node is rigid (see --labels and --affine)");
    }
    report.tell(&summary, seconds, &arguments.output.display().to_string(), global);
    Ok(Outcome::Good)
}

/// Reads, cleans and encodes every frame.
fn encode(
    inputs: &Inputs,
    config: EncoderConfig,
    writer: &mut dyn Write,
    report: &mut Report,
    global: &Global,
) -> Result<Summary> {
    let bar = progress::bar(global, "encoding", Some(inputs.len() as u64));
    let mut encoder = Encoder::new(writer, config)?;
    for frame in inputs.frames() {
        let frame = frame?;
        let cleaned = clean(&frame.mesh)
            .map_err(|fault| anyhow!("{}: frame {}: {fault}", frame.path.display(), frame.index))?;
        report.read(frame.path, &cleaned.report, frame.notes);
        encoder.push(&cleaned.mesh)?;
        encoder.drain_reports().for_each(|frame| report.coded(frame));
        bar.step();
    }
    let finished = encoder.finish()?;
    finished.reports.into_iter().for_each(|frame| report.coded(frame));
    Ok(finished.summary)
}

impl EncodeArguments {
    fn find_inputs(&self) -> Result<Inputs> {
        let options = ReadOptions {
            labels: LabelArgument::source(self.labels.as_ref()),
            ..Default::default()
        };
        let inputs = Inputs::find(&self.inputs, options)?;
        match &self.labels {
            Some(LabelArgument::Files(pattern)) => Ok(inputs.with_labels(pattern)?),
            _ => Ok(inputs),
        }
    }

    fn config(&self, survey: &Survey) -> EncoderConfig {
        let bounds = survey.bounds;
        EncoderConfig {
            grid: match self.step {
                Some(step) => GridChoice::Step { step, bounds },
                None => GridChoice::Bits { bits: self.bits, bounds },
            },
            group_length: self.gof,
            nodes: self.nodes.most(),
            nodes_by_cost: self.nodes == NodeArgument::Auto,
            placement: self.placement.into(),
            frame_rate: (self.fps.numerator, self.fps.denominator),
            unit: self.unit.into(),
            up_axis: self.up as u8,
            influence: self.influence.into(),
            affine: self.affine.into(),
            combination: self.combination,
            names: name_pattern(&survey.names),
            ..EncoderConfig::default()
        }
    }

    /// The settings for the report.
    fn settings(&self) -> Value {
        json!({
            "input": self.inputs,
            "output": self.output,
            "bits": self.step.is_none().then_some(self.bits),
            "step": self.step,
            "gof": self.gof,
            "nodes": self.nodes.to_string(),
            "placement": format!("{:?}", self.placement).to_lowercase(),
            "fps": self.fps.per_second(),
            "influence": format!("{:?}", self.influence).to_lowercase(),
            "affine": format!("{:?}", self.affine).to_lowercase(),
            "combination": self.combination.name(),
            "version": env!("CARGO_PKG_VERSION"),
        })
    }
}
