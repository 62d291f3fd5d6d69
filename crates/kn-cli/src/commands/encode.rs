//! `kn encode`: encodes scans into a .knm file.

mod report;
pub(crate) mod survey;
mod vertex_maps;

use crate::Outcome;
use crate::arguments::Global;
use crate::choices::{self, named};
use crate::frames::FrameFiles;
use crate::output::{name_of, write_file};
use crate::outputs::Outputs;
use crate::progress;
use crate::settings::{Settings, check_settings};
use anyhow::{Context, Result, bail};
use clap::ArgAction;
use kn_bitstream::params::{FileNames, FrameRate, UnitOfLength, UpAxis, is_frame_name};
use kn_codec::{
    AffineChoice, Encoder, EncoderConfig, FrameReport, GridChoice, LabelChoice, NodeChoice, Preset,
    StepChoice, Summary,
};
use kn_io::{InputFrame, Inputs, ReadOptions};
use kn_mesh::{Cleaned, Grid};
use kn_sequence::{LabelOrigin, SequenceError, clean_scan, clean_surface};
use report::Report;
use serde_json::{Value, json};
use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;
use survey::Survey;
use vertex_maps::VertexMaps;

/// Encode scans, one mesh a frame, into a .knm file
#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
#[command(after_help = "\
All frames are read once before encoding begins, so that one grid fits them all and a broken scan
is found before any work is done. Seams are welded. Degenerate and duplicate faces are dropped, and
so are vertices that no face uses, unless --lossless is given. The sum is printed; --report has it
for each frame. Where the motion does not explain a frame, a new GoF begins there, and the reason is
printed. A scan without faces is an empty frame.

Examples:
  kn encode 'scan/*.obj' -o dance.knm
  kn encode scan/ -o dance.knm --bits 12 --gof 16
  kn encode scan/ -o small.knm --preset baseline --nodes 200
  kn encode scan/f_%04d.ply -o dance.knm --step 0.5 --unit mm --labels 'scan/*.labels'
  kn encode scan/ -o thin.knm --iframe-faces 25%
  kn encode scan/ -o fine.knm --lambda 1e-5 --choice per-frame --affine cost
  kn encode walk.glb -o walk.knm --fps 25
  kn encode scan/ -o - | kn info -")]
pub(crate) struct EncodeArguments {
    /// A folder, a glob in quotes, a printf pattern, files, or one animated .glb (OBJ, PLY, glTF)
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,
    /// The file to write; - is standard output
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// The settings to start from; the flags below change them
    #[arg(long, value_name = "NAME", default_value = "default", hide_default_value = true)]
    #[arg(value_parser = choices::preset())]
    preset: &'static Preset,
    #[command(flatten)]
    settings: Settings,
    /// Frames per second, such as 30, 29.97 or 30000/1001
    #[arg(long, default_value = "30", value_name = "RATE")]
    fps: FrameRate,
    #[command(flatten)]
    frames: FrameFiles,
    /// Body parts of the vertices: a glob of .labels files, `auto` (found in the scans),
    /// `colours` (of the vertices, by the palette), `property` (a PLY property `label`), or `none`
    /// [default: property where there is one, else auto]
    #[arg(long, value_name = "GLOB|auto|colours|property|none")]
    labels: Option<LabelOrigin>,
    /// Unit of the coordinates; the stream carries it, the codec does not use it
    #[arg(long, value_parser = named::<UnitOfLength>())]
    #[arg(default_value_t = UnitOfLength::Unspecified)]
    unit: UnitOfLength,
    /// The axis that points up
    #[arg(long, value_parser = named::<UpAxis>(), default_value_t = UpAxis::Y)]
    up: UpAxis,
    /// Give every coordinate back to the last bit: for integers, fixed fractions and decimals of at
    /// most 20 bits; all frames are I-frames
    #[arg(long, conflicts_with_all = ["bits", "step", "gof", "iframe_faces", "iframe_error"])]
    lossless: bool,
    /// Write the decoded vertex of every vertex of an I-frame to this folder, one a line; - is none
    #[arg(long, value_name = "FOLDER")]
    vertex_maps: Option<PathBuf>,
    /// Write a report of every frame to this file, as JSON
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Print help
    #[arg(short, long, action = ArgAction::HelpShort)]
    help: Option<bool>,
    /// Print help with the expert settings: key nodes, components, steps, prediction
    #[arg(long, action = ArgAction::HelpLong)]
    help_all: Option<bool>,
}

/// Runs the command.
pub(crate) fn run(arguments: &EncodeArguments, global: &Global) -> Result<Outcome> {
    let start = Instant::now();
    let mut config = arguments.config()?;
    let inputs = arguments.find_inputs()?;
    let outputs = arguments.check_outputs(&inputs)?;
    let maps = arguments.vertex_maps.as_deref().map(|folder| VertexMaps::new(folder, outputs));
    let mut maps = maps.transpose()?;
    let survey = Survey::new(&inputs, global)?;
    inputs.notes().iter().for_each(|note| global.note(note));
    survey.tell(arguments.lossless, global);
    arguments.fit_to(&mut config, &survey)?;
    let step = config.sequence.grid.step().context("the grid has no step")?;
    let settings = arguments.settings(&config, &survey);
    let labelled = survey.labelled || config.intra.labels == LabelChoice::Auto;
    let lost = !labelled && matches!(config.motion.affine, AffineChoice::Labels(_));
    let mut report = Report::default();
    let summary = write_file(&arguments.output, |writer| {
        let clean = if arguments.lossless { clean_scan } else { clean_surface };
        encode((&inputs, clean), config, writer, (&mut report, &mut maps), global)
    })
    .map_err(|error| survey.name_file(error))?;
    let seconds = start.elapsed().as_secs_f64();
    maps.map(VertexMaps::publish).transpose()?;
    if let Some(path) = &arguments.report {
        let json = report.to_json(settings, &summary, seconds);
        write_file(path, |writer| Ok(serde_json::to_writer_pretty(writer, &json)?))?;
    }
    if lost {
        global.note("no labels: every key node is rigid (see --labels and --affine)");
    }
    let steps = survey.steps(step);
    global.note(format_args!("grid: step {step:.3e}, the longest side has {steps:.0} of them"));
    report.tell(&summary, seconds, &name_of(&arguments.output), global);
    Ok(Outcome::Good)
}

/// Cleans a scan.
type Clean = fn(&InputFrame) -> Result<Cleaned, SequenceError>;

/// Reads, cleans and encodes every frame.
fn encode(
    (inputs, clean): (&Inputs, Clean),
    config: EncoderConfig,
    writer: &mut dyn Write,
    (report, maps): (&mut Report, &mut Option<VertexMaps>),
    global: &Global,
) -> Result<Summary> {
    let bar = progress::bar(global, "encoding", Some(inputs.len() as u64));
    let up_axis = config.sequence.up_axis;
    let mut encoder = Encoder::new(writer, config)?;
    for frame in inputs.frames() {
        let frame = frame?;
        let cleaned = clean(&frame)?;
        report.labels.check(&frame.path, frame.index, &cleaned.mesh, up_axis);
        report.read(frame.path, &cleaned.report, frame.notes);
        let name = Some(&frame.name[..]).filter(|name| is_frame_name(name));
        encoder.push_named(&cleaned.mesh, name.unwrap_or_default())?;
        if let Some(maps) = maps {
            maps.read(frame.name, cleaned.vertex_map);
        }
        for frame in encoder.drain_reports() {
            tell(frame, report, maps)?;
        }
        bar.step();
    }
    let finished = encoder.finish()?;
    for frame in finished.reports {
        tell(frame, report, maps)?;
    }
    Ok(finished.summary)
}

fn tell(frame: FrameReport, report: &mut Report, maps: &mut Option<VertexMaps>) -> Result<()> {
    if let Some(maps) = maps {
        maps.coded(frame.intra().and_then(|report| report.vertex_map.as_deref()))?;
    }
    report.coded(frame);
    Ok(())
}

impl EncodeArguments {
    fn find_inputs(&self) -> Result<Inputs> {
        let origin = self.labels.clone().unwrap_or_default();
        let frame_rate = self.fps.per_second();
        let options = ReadOptions { frame_rate, ..ReadOptions::default() };
        let options = self.frames.options(options);
        Ok(origin.find_inputs(&self.inputs, options)?)
    }

    /// Before any work.
    fn check_outputs(&self, inputs: &Inputs) -> Result<Outputs> {
        let mut outputs = Outputs::beside(inputs.files());
        outputs.file("--output", &self.output)?;
        if let Some(report) = &self.report {
            outputs.file("--report", report)?;
        }
        Ok(outputs)
    }

    /// The settings, checked before any file is read. The grid is fitted to the scans later.
    fn config(&self) -> Result<EncoderConfig> {
        let preset = self.preset.config();
        let labels = match self.labels {
            None => preset.intra.labels,
            Some(LabelOrigin::Auto) => LabelChoice::Auto,
            Some(_) => LabelChoice::Given,
        };
        let mut config = preset
            .with_frame_rate(self.fps)
            .with_unit(self.unit)
            .with_up_axis(self.up)
            .with_labels(labels)
            .with_vertex_maps(self.vertex_maps.is_some());
        self.settings.apply(&mut config)?;
        if self.lossless {
            let any = Grid { origin: [0.0; 3], step: 1.0 };
            config = config.with_grid(GridChoice::Lossless(any)).with_group_length(1);
        }
        let unlabelled = self.labels == Some(LabelOrigin::None);
        if let Some(flag) = self.settings.needs_labels().filter(|_| unlabelled) {
            bail!("{flag} needs body parts, but --labels is none");
        }
        check_settings(&config)?;
        Ok(config)
    }

    /// The grid and the names that the scans ask for.
    fn fit_to(&self, config: &mut EncoderConfig, survey: &Survey) -> Result<()> {
        let sequence = &mut config.sequence;
        sequence.names = FileNames::of_all(&survey.names);
        sequence.grid = match sequence.grid {
            GridChoice::Lossless(_) => GridChoice::Lossless(survey.lossless_grid()?),
            grid => grid.with_bounds(survey.bounds),
        };
        let step = config.sequence.grid.step().context("the grid has no step")?;
        survey.check_step(step)?;
        check_settings(config)
    }

    /// The settings for the report.
    fn settings(&self, config: &EncoderConfig, survey: &Survey) -> Value {
        let (bits, step) = match config.sequence.grid {
            GridChoice::Bits { bits, .. } => (Some(bits), None),
            GridChoice::Step { step, .. } => (None, Some(step)),
            GridChoice::Lossless(grid) => (None, Some(grid.step)),
        };
        json!({
            "input": self.inputs,
            "output": self.output,
            "preset": self.preset.name(),
            "bits": bits,
            "step": step,
            "lossless": self.lossless,
            "decimation": config.intra.decimation.map(|decimation| decimation.to_string()),
            "gof": config.sequence.group_length,
            "pframe_error": config.motion.max_error,
            "nodes": config.motion.nodes.most(),
            "nodes_by_cost": matches!(config.motion.nodes, NodeChoice::Cost { .. }),
            "placement": config.motion.placement.to_string(),
            "fps": self.fps.per_second(),
            "influence": config.motion.influence.to_string(),
            "labels": labels_name(config.intra.labels, survey),
            "affine": config.motion.affine.to_string(),
            "combination": config.motion.combination.to_string(),
            "distortion": config.rate.distortion.to_string(),
            "lambda": config.rate.lambda,
            "part_start": config.motion.part_start.to_string(),
            "translation": config.motion.translation.to_string(),
            "motion_step": match config.motion.translation_step {
                StepChoice::Fixed(step) => json!(step),
                StepChoice::Cost => json!("auto"),
            },
            "version": env!("CARGO_PKG_VERSION"),
        })
    }
}

fn labels_name(choice: LabelChoice, survey: &Survey) -> &'static str {
    match choice {
        _ if survey.labelled => "given",
        LabelChoice::Auto => "auto",
        LabelChoice::Given => "none",
    }
}
