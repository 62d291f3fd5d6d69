//! `kn rd`: the rate-distortion laboratory.

mod cell;
mod clock;
mod config;
mod curves;
mod deltas;
mod export;
mod markdown;
mod performer;
mod pictures;
mod queue;
mod report;
mod results;
mod sequences;
mod store;
mod tables;

use crate::Outcome;
use crate::arguments::Global;
use crate::choices::count;
use crate::output::write_file;
use crate::outputs::Outputs;
use crate::progress;
use anyhow::{Context, Result, bail, ensure};
use cell::Cell;
use config::Config;
use curves::Curve;
use pictures::Artist;
use results::{CellResult, CellRow, Failure, Study};
use sequences::Sequence;
use sha2::{Digest, Sha256};
use std::num::NonZeroU16;
use std::path::{Path, PathBuf};
use store::Store;

/// Compare codecs: a matrix of sequences, presets and rate points, measured and reported
#[derive(Debug, clap::Args)]
#[command(after_help = "\
The configuration is TOML; docs/rd/example.toml in the repository is one with every key. A stream
is encoded, decoded and measured for every sequence, preset and rate point; settings are the
preset's, then those of the preset's entry, of the sequence and of the rate point, under the names
of the flags of kn encode. Curves of other codecs come from CSV tables. The command writes

  report.html             curves, Bjontegaard deltas, pictures, tables; needs nothing beside it
  report.md               the tables as Markdown
  results.csv             a row for each stream; can be a table of another configuration
  results.json            everything
  cells/ pictures/        streams with their measurements; those that exist are not made again

Results are kept by content: frames, settings and version. Another build of kn makes them again,
unless --keep is given. After an interruption the same command continues.

Defined results: a codec without overlap with the anchor gets a reason instead of a delta; a delta
over less than three quarters of the range is marked; a sequence that is shorter than the picture's
frame shows its last one; rows of a table without a rate, and sequences that are not in the
configuration, are left out.

Exit codes: 0 done, 1 some streams failed (the report names them), 2 an error.

Examples:
  kn rd docs/rd/example.toml
  KN_DATA=scans kn rd ablation.toml -o ablation --jobs 2
  kn rd ablation.toml -o ablation --report-only")]
pub(crate) struct RdArguments {
    /// The configuration
    #[arg(value_name = "CONFIG.toml")]
    config: PathBuf,
    /// The folder for results [default: rd- and the configuration's name, in the current folder]
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Streams to work on at a time; they share the threads [default: one per thread]
    #[arg(long, value_name = "N", value_parser = count)]
    jobs: Option<NonZeroU16>,
    /// Run everything again
    #[arg(long)]
    fresh: bool,
    /// Keep results of other builds of the same version
    #[arg(long, conflicts_with = "fresh")]
    keep: bool,
    /// Write report and tables from results.json, with the configuration's anchors and tables
    #[arg(long, conflicts_with_all = ["fresh", "keep", "jobs"])]
    report_only: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &RdArguments, global: &Global) -> Result<Outcome> {
    let config = Config::read(&arguments.config)?;
    let foreign = foreign_curves(&config)?;
    check_anchors(&config, &foreign)?;
    check_cells(&config)?;
    let output = arguments.output();
    let inputs = config.tables.iter().map(|table| config.path(&table.path));
    check_reports(&output, &arguments.config, inputs.collect::<Result<_>>()?)?;
    let study = if arguments.report_only {
        export::read(&output)?
    } else {
        Run::new(arguments, &config, &output, global)?.study()?
    };
    let report = finish(&config, &study, foreign, &output)?;
    for failure in &study.failures {
        let Failure { sequence, codec, point, reason } = failure;
        eprintln!("kn: {sequence}, {codec}, {point}: {reason}");
    }
    global.note(report.display());
    Ok(if study.failures.is_empty() { Outcome::Good } else { Outcome::Bad })
}

/// Writes tables and report; returns the report's path.
fn finish(config: &Config, study: &Study, foreign: Vec<Curve>, output: &Path) -> Result<PathBuf> {
    let mut curves = curves::of_cells(&study.cells);
    let known = |curve: &Curve| study.sequences.iter().any(|one| one.name == curve.sequence);
    curves.extend(foreign.into_iter().filter(known));
    let deltas = deltas::all(&curves, &config.anchors);
    export::write(output, study, &deltas)?;
    let text = markdown::render(config, study, &curves, &deltas);
    write_file(&output.join("report.md"), |out| Ok(out.write_all(text.as_bytes())?))?;
    let material = report::Material { config, study, curves: &curves, deltas: &deltas };
    let html = material.render(output)?;
    let path = output.join("report.html");
    write_file(&path, |out| Ok(out.write_all(html.as_bytes())?))?;
    Ok(path)
}

/// The report must not replace what it is made from: a table may be the results.csv of another
/// study, and not of this one.
fn check_reports(output: &Path, config: &Path, tables: Vec<PathBuf>) -> Result<()> {
    let inputs = tables.iter().map(PathBuf::as_path).chain([config]);
    let mut outputs = Outputs::beside(inputs);
    let names = ["report.html", "report.md", "results.csv", "results.json"];
    names.iter().try_for_each(|name| outputs.inside("--output", &output.join(name)))
}

/// The curves of all tables.
fn foreign_curves(config: &Config) -> Result<Vec<Curve>> {
    let mut curves: Vec<Curve> = Vec::new();
    for table in &config.tables {
        let path = config.path(&table.path)?;
        curves.extend(tables::read(&path, &table.columns, table.codecs.as_deref())?);
    }
    for curve in &curves {
        let (codec, same) = (&curve.codec, |name: &String| *name == curve.codec);
        ensure!(
            !config.codecs.iter().any(|own| same(&own.name)),
            "the name '{codec}' is that of a preset and of a codec in a table"
        );
    }
    Ok(curves)
}

/// Settings of all cells, before any sequence is opened.
fn check_cells(config: &Config) -> Result<()> {
    for entry in &config.sequences {
        for codec in &config.codecs {
            for rate in &config.rates {
                cell::encoder_config(entry, codec, rate)?;
            }
        }
    }
    Ok(())
}

fn check_anchors(config: &Config, foreign: &[Curve]) -> Result<()> {
    let own = config.codecs.iter().map(|codec| codec.name.as_str());
    let known: Vec<&str> = own.chain(foreign.iter().map(|curve| curve.codec.as_str())).collect();
    match config.anchors.iter().find(|anchor| !known.contains(&anchor.as_str())) {
        Some(anchor) => {
            let hint = crate::nearest::nearest(anchor, known);
            bail!("the anchor '{anchor}' is neither a preset nor a codec of a table{hint}")
        }
        None => Ok(()),
    }
}

impl RdArguments {
    fn output(&self) -> PathBuf {
        let named = || {
            let stem = self.config.file_stem().unwrap_or_default();
            PathBuf::from(format!("rd-{}", stem.to_string_lossy()))
        };
        self.output.clone().unwrap_or_else(named)
    }
}

/// A run with everything that it needs.
struct Run<'r> {
    arguments: &'r RdArguments,
    config: &'r Config,
    output: &'r Path,
    global: &'r Global,
    store: Store,
    build: String,
}

impl<'r> Run<'r> {
    fn new(
        arguments: &'r RdArguments,
        config: &'r Config,
        output: &'r Path,
        global: &'r Global,
    ) -> Result<Self> {
        let (store, build) = (Store::open(output)?, build_digest()?);
        Ok(Self { arguments, config, output, global, store, build })
    }

    /// Runs what is not there yet.
    fn study(&self) -> Result<Study> {
        let sequences: Result<Vec<Sequence>> = self
            .config
            .sequences
            .iter()
            .map(|entry| Sequence::open(entry, self.config, self.output, self.global))
            .collect();
        let sequences = sequences?;
        let mut study = Study {
            version: env!("CARGO_PKG_VERSION").into(),
            build: self.build.clone(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            jobs: self.jobs(),
            command: std::env::args().collect::<Vec<_>>().join(" "),
            sequences: sequences.iter().map(|sequence| sequence.info.clone()).collect(),
            cells: Vec::new(),
            failures: Vec::new(),
            pictures: Vec::new(),
        };
        self.run_cells(&sequences, &mut study)?;
        self.draw(&sequences, &mut study)?;
        Ok(study)
    }

    /// Streams at a time.
    fn jobs(&self) -> usize {
        self.arguments.jobs.map_or(rayon::current_num_threads(), |jobs| usize::from(jobs.get()))
    }

    fn run_cells(&self, sequences: &[Sequence], study: &mut Study) -> Result<()> {
        let mut cells = Vec::new();
        for (sequence, entry) in sequences.iter().zip(&self.config.sequences) {
            for codec in &self.config.codecs {
                for rate in &self.config.rates {
                    let metrics = self.config.metrics.options();
                    cells.push((Cell::new((sequence, entry), codec, rate, metrics)?, entry));
                }
            }
        }
        let bar = progress::bar_over("streams", self.global, "encoding", Some(cells.len() as u64));
        let jobs = self.jobs();
        let threads = (rayon::current_num_threads() / jobs).max(1);
        let results = queue::run(cells.len(), jobs, threads, |index| {
            let result = self.cell(&cells[index].0);
            bar.step();
            result
        })?;
        for ((cell, entry), result) in cells.iter().zip(results) {
            let [sequence, codec, point] =
                [&cell.sequence.info.name, &cell.codec.name, &cell.rate.name].map(String::clone);
            let command = cell.command(entry)?;
            match result {
                Ok(result) => {
                    study.cells.push(CellRow { sequence, codec, point, command, result });
                }
                Err(error) => {
                    let reason = crate::message(&error);
                    study.failures.push(Failure { sequence, codec, point, reason });
                }
            }
        }
        Ok(())
    }

    /// The result that is there, or a new one.
    fn cell(&self, cell: &Cell<'_>) -> Result<CellResult> {
        let current = |result: &CellResult| {
            !self.arguments.fresh && (self.arguments.keep || result.build == self.build)
        };
        match self.store.load(&cell.key).filter(current) {
            Some(result) => Ok(result),
            None => cell.run(&self.store, &self.build),
        }
    }

    fn draw(&self, sequences: &[Sequence], study: &mut Study) -> Result<()> {
        let Some(entry) = self.config.pictures else { return Ok(()) };
        let artist = Artist::new(entry, &self.store, self.output)?;
        let bar =
            progress::bar_over("sequences", self.global, "drawing", Some(sequences.len() as u64));
        for sequence in sequences {
            let of_sequence = |cell: &&CellRow| cell.sequence == sequence.info.name;
            let cells: Vec<&CellRow> = study.cells.iter().filter(of_sequence).collect();
            study.pictures.extend(artist.draw(sequence, &cells)?);
            bar.step();
        }
        Ok(())
    }
}

/// SHA-256 of this program: another build may encode differently.
fn build_digest() -> Result<String> {
    let path = std::env::current_exe().context("the program's own file")?;
    let program = std::fs::read(&path).with_context(|| path.display().to_string())?;
    let mut digest = Sha256::new();
    digest.update(program);
    Ok(sequences::hex(digest)[..16].to_owned())
}
