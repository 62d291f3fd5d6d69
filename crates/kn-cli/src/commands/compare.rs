//! `kn compare`: measures the distortion between two meshes or sequences.

mod output;

use crate::arguments::{FrameRange, Global};
use crate::frames::FrameFiles;
use crate::output::{is_dash, print, print_json, write_file};
use crate::outputs::Outputs;
use crate::{Outcome, heatmap, progress, stream};
use anyhow::{Result, ensure};
use kn_bitstream::params::{BodyPart, NameError, Named};
use kn_io::{check_scalar_format, write_mesh_with_scalar};
use kn_mesh::Mesh;
use kn_sequence::{
    CompareOptions, CompareSequences, MeasuredPair, PointSampling, Sequence, SequenceOptions,
    compare_sequences_with,
};
use output::Report;
use std::path::{Path, PathBuf};

/// Measure the distortion between two meshes or sequences
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Each side is a mesh (OBJ, PLY, OFF, STL, glTF), a folder, a pattern in quotes, or a .knm file. Relative
distances and decibels refer to the box of the whole reference: its diagonal and its longest side.
RMS and PSNR are those of 100,000 samples of each surface (--samples). Hausdorff distance, D1 and D2
take the vertices too.
Meshes are compared as they are in their files; against a .knm file, whose scans were welded before
encoding, they are welded too. Frames of a .knm file are checked against their digests. Sequences of
different length are an error, unless --frames names only frames that both have. Two empty frames
are equal, and do not count in means; where one is empty, distances are the diagonal and MSDM2 is 1.

Exit codes: 0 measured, 2 an error.

Examples:
  kn compare a.obj b.obj
  kn compare 'scan/*.obj' dance.knm
  kn compare 'scan/*.obj' dance.knm --json | jq .mean
  kn compare scan/ dance.knm --csv rows.csv --frames 0..7
  kn compare a.ply b.ply --grid 1024
  kn compare a.ply b.ply --heatmap error.png --values error.ply
  kn compare 'scan/*.obj' dance.knm --part torso --labels 'scan/*.labels'")]
pub(crate) struct CompareArguments {
    /// The reference
    #[arg(value_name = "REFERENCE")]
    reference: PathBuf,
    /// The mesh or sequence that is measured against the reference
    #[arg(value_name = "OTHER")]
    other: PathBuf,
    #[command(flatten)]
    files: FrameFiles,
    /// Print JSON: {mean, mean_predicted, frames, box, samples, grid}; mean_predicted is of the
    /// P-frames of a stream, grid is there with --grid
    #[arg(long)]
    json: bool,
    /// Also write a row per frame to this file; - is standard output, without the table
    #[arg(long, value_name = "FILE", conflicts_with = "json")]
    csv: Option<PathBuf>,
    /// Measure these frames only: 5, 3..7 (both included), 3.. or ..7
    #[arg(long, value_name = "RANGE", default_value = "..")]
    frames: FrameRange,
    /// Point-to-surface distances only, without MSDM2, D1 and D2
    #[arg(long)]
    fast: bool,
    /// Samples of each surface for distances, D1 and D2, uniform by area
    #[arg(long, value_name = "N", default_value_t = 100_000,
        value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    samples: u32,
    /// Measure D1 and D2 along a grid as MPEG does, with this many lines (1024 in MPEG's test
    /// conditions) on the longest side of the box, in place of vertices and samples
    #[arg(long, value_name = "LINES", conflicts_with_all = ["fast", "part"],
        value_parser = clap::value_parser!(u32).range(2..=65_536))]
    grid: Option<u32>,
    /// Measure one body part only, by its number or name such as `torso`: the points of its faces
    /// against the whole other side; implies --fast
    #[arg(long, value_name = "PART", value_parser = part_of_name)]
    part: Option<u8>,
    /// Labels of the reference's vertices, files beside its meshes, for --part
    #[arg(long, value_name = "GLOB", requires = "part")]
    labels: Option<PathBuf>,
    /// Weld both sides and drop degenerate and duplicate faces first, as kn encode does
    #[arg(long)]
    clean: bool,
    /// Draw both sides' first frame, of those that are not empty, from four sides, coloured by the local difference
    #[arg(long, value_name = "FILE.png")]
    heatmap: Option<PathBuf>,
    /// Write the other side's first frame with the local difference as the vertex property `error`
    #[arg(long, value_name = "FILE.ply")]
    values: Option<PathBuf>,
    /// The local difference that --heatmap and --values show
    #[arg(long, value_enum, default_value_t = LocalError::Distance)]
    local: LocalError,
}

/// A difference that every vertex has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum LocalError {
    /// The distance to the other surface, world units
    Distance,
    /// The vertex's MSDM2, 0 to 1
    Msdm2,
}

/// A part by its number or by its name in any case.
fn part_of_name(text: &str) -> Result<u8, String> {
    let number = text.parse().ok().and_then(BodyPart::from_label);
    let part = number.map_or_else(|| text.parse(), Ok);
    part.map(BodyPart::label).map_err(|_: NameError| {
        let names: Vec<String> = BodyPart::all().iter().map(BodyPart::to_string).collect();
        format!("the parts are 0 to 14 or {}", names.join(", "))
    })
}

/// Runs the command.
pub(crate) fn run(arguments: &CompareArguments, global: &Global) -> Result<Outcome> {
    arguments.check_local()?;
    let (reference, distorted) = arguments.open()?;
    reference.notes().iter().chain(distorted.notes()).for_each(|note| global.note(note));
    arguments.check_outputs(&reference, &distorted)?;
    let bar = progress::bar(global, "measuring", None);
    let mut drawn = None;
    let options = arguments.options();
    let measured = compare_sequences_with(&reference, &distorted, &options, |pair| {
        drawn.get_or_insert_with(|| arguments.draw(&pair));
        bar.step();
    });
    drop(bar);
    let comparison = Report::new(measured?, &options.metrics);
    arguments.print(&comparison)?;
    ensure!(
        drawn.is_some() || !arguments.draws(),
        "{}: there is nothing to draw: each frame is empty on one side",
        reference.name()
    );
    arguments.write(&comparison, drawn.transpose()?.unwrap_or_default())?;
    Ok(Outcome::Good)
}

impl CompareArguments {
    /// Both sides; meshes are welded where the other side is a stream, which holds welded meshes.
    fn open(&self) -> Result<(Sequence, Sequence)> {
        let streams = [&self.reference, &self.other].map(|path| stream::is_stream(path));
        let clean = self.clean || streams[0] != streams[1];
        let mut options = SequenceOptions::default();
        options.clean = clean;
        options.read = self.files.options(options.read);
        let open = |path: &Path, labels: Option<&PathBuf>, frame_rate: Option<f64>| {
            let mut options = options.clone();
            if self.part.is_some() {
                options = options.with_labels(labels.cloned());
            }
            if let Some(frame_rate) = frame_rate {
                options = options.at_frame_rate(frame_rate);
            }
            stream::sequence(path, &options)
        };
        let labels = self.labels.as_ref();
        // An animated glTF file is sampled at the rate of the stream on the other side.
        if streams[1] {
            let other = open(&self.other, None, None)?;
            return Ok((open(&self.reference, labels, other.frame_rate()?)?, other));
        }
        let reference = open(&self.reference, labels, None)?;
        let other = open(&self.other, None, reference.frame_rate()?)?;
        Ok((reference, other))
    }

    fn options(&self) -> CompareSequences {
        let mut options = CompareSequences::default();
        if self.is_fast() {
            options.metrics = CompareOptions::distances();
        }
        options.metrics.samples = self.samples as usize;
        if let Some(lines) = self.grid {
            options.metrics.points = Some(PointSampling::Grid(lines as usize));
        }
        options.frames = self.frames.first()..=self.frames.last();
        options.part = self.part;
        options
    }

    fn is_fast(&self) -> bool {
        self.fast || self.part.is_some()
    }

    fn draws(&self) -> bool {
        self.heatmap.is_some() || self.values.is_some()
    }

    fn check_local(&self) -> Result<()> {
        let lacks = self.draws() && self.local == LocalError::Msdm2 && self.is_fast();
        ensure!(!lacks, "--local msdm2 needs MSDM2: leave out --fast and --part");
        Ok(())
    }

    /// The picture and the values per vertex, where asked for.
    fn draw(&self, pair: &MeasuredPair<'_>) -> Result<Drawn> {
        let mut drawn = Drawn::default();
        if !self.draws() {
            return Ok(drawn);
        }
        let (a, b) = (pair.reference_surface, pair.distorted_surface);
        let [on_a, on_b] = match self.local {
            LocalError::Distance => [a.vertex_distances(b), b.vertex_distances(a)],
            LocalError::Msdm2 => {
                [a.vertex_msdm2(b), b.vertex_msdm2(a)].map(Option::unwrap_or_default)
            }
        };
        let (a, b) = (pair.reference, pair.distorted);
        if self.heatmap.is_some() {
            let what = match self.local {
                LocalError::Distance => "distance between the surfaces",
                LocalError::Msdm2 => "MSDM2",
            };
            let title = format!("{what}, frame {}", a.index);
            let sides = [("reference", &a.mesh, &on_a[..]), ("other", &b.mesh, &on_b[..])];
            heatmap::turntable(&mut drawn.picture, title, sides)?;
        }
        if self.values.is_some() {
            let values = on_b.iter().map(|&error| error as f32).collect();
            drawn.values = Some((b.mesh.clone(), values));
        }
        Ok(drawn)
    }

    /// Before any work.
    fn check_outputs(&self, reference: &Sequence, distorted: &Sequence) -> Result<()> {
        let mut outputs = Outputs::beside(reference.files().chain(distorted.files()));
        match &self.csv {
            Some(csv) if is_dash(csv) => {}
            _ => outputs.prints()?,
        }
        if let Some(csv) = &self.csv {
            outputs.file("--csv", csv)?;
        }
        if let Some(heatmap) = &self.heatmap {
            outputs.picture("--heatmap", heatmap)?;
        }
        if let Some(values) = &self.values {
            check_scalar_format(values)?;
            outputs.file("--values", values)?;
        }
        Ok(())
    }

    /// The result; it comes before the files, which may fail.
    fn print(&self, comparison: &Report) -> Result<()> {
        if self.csv.as_deref().is_some_and(is_dash) {
            return Ok(());
        }
        if self.json {
            return print_json(comparison);
        }
        print(|out| Ok(comparison.write_table(out)?))
    }

    fn write(&self, comparison: &Report, drawn: Drawn) -> Result<()> {
        if let Some(path) = &self.csv {
            write_file(path, |out| Ok(comparison.write_csv(out)?))?;
        }
        if let Some(path) = &self.heatmap {
            write_file(path, |out| Ok(out.write_all(&drawn.picture)?))?;
        }
        if let (Some(path), Some((mesh, values))) = (&self.values, &drawn.values) {
            write_mesh_with_scalar(path, mesh, "error", values)?;
        }
        Ok(())
    }
}

/// The pictures and files of the first frame, where they were asked for.
#[derive(Default)]
struct Drawn {
    /// A PNG file.
    picture: Vec<u8>,
    /// The other side's mesh and a difference per vertex.
    values: Option<(Mesh, Vec<f32>)>,
}
