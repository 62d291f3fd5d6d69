//! `kn compare`: how far two meshes or sequences are apart.

mod output;

use crate::arguments::{FrameRange, Global};
use crate::distortion::{self, Measures, Scale, Surface};
use crate::output::write_file;
use crate::sequence::{Frame, Reader, Sequence};
use crate::{Outcome, heatmap, progress, stream};
use anyhow::{Context, Result, bail};
use kn_mesh::BoundingBox;
use kn_mesh::io::write_mesh_with_scalar;
use kn_mesh::parts::PART_NAMES;
use output::{Comparison, FrameRow};
use std::io::{self, Write};
use std::path::PathBuf;

/// Measure the distortion between two meshes or sequences
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Each side is a mesh (OBJ, PLY, OFF, glTF), a folder, a pattern in quotes, or a .knm file. Relative
distances and decibels refer to the box of the whole reference: its diagonal and its longest side.
Meshes are compared as they are in their files; against a .knm file, whose scans were welded before
encoding, they are welded too. Sequences of different length are an error, unless --frames names
only frames that both have.

Exit codes: 0 measured, 2 an error.

Examples:
  kn compare a.obj b.obj
  kn compare 'scan/*.obj' dance.knm
  kn compare 'scan/*.obj' dance.knm --json | jq .mean
  kn compare scan/ dance.knm --csv rows.csv --frames 0..7
  kn compare a.ply b.ply --heatmap error.png --values error.ply
  kn compare 'scan/*.obj' dance.knm --part torso --labels 'scan/*.labels'")]
pub(crate) struct CompareArguments {
    /// The reference
    #[arg(value_name = "REFERENCE")]
    reference: PathBuf,
    /// What is measured against it
    #[arg(value_name = "OTHER")]
    other: PathBuf,
    /// Print JSON: {mean, frames, box}
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
    /// Draw both sides' first frame from four sides, coloured by the local difference
    #[arg(long, value_name = "FILE.png")]
    heatmap: Option<PathBuf>,
    /// Write the other side's first frame with the local difference as the vertex property `error`
    #[arg(long, value_name = "FILE.ply")]
    values: Option<PathBuf>,
    /// What --heatmap and --values show
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
    let number = text.parse().ok().filter(|&part: &u8| usize::from(part) < PART_NAMES.len());
    let named = PART_NAMES.iter().position(|name| name.eq_ignore_ascii_case(text));
    number
        .or(named.map(|part| part as u8))
        .ok_or_else(|| format!("the parts are 0 to 14 or {}", PART_NAMES.join(", ")))
}

/// `#F` marks: the faces with all corners in the part.
fn faces_of(frame: &Frame, part: u8) -> Result<Vec<bool>> {
    let labels = &frame.mesh.labels;
    if labels.is_empty() {
        bail!("{}: frame {}: the mesh has no labels", frame.file, frame.index);
    }
    let inside = |face: &[u32; 3]| face.iter().all(|&vertex| labels[vertex as usize] == part);
    let marks: Vec<bool> = frame.mesh.faces.iter().map(inside).collect();
    if !marks.contains(&true) {
        let name = PART_NAMES[usize::from(part)];
        bail!("{}: frame {}: no face belongs to the part {name}", frame.file, frame.index);
    }
    Ok(marks)
}

/// Runs the command.
pub(crate) fn run(arguments: &CompareArguments, global: &Global) -> Result<Outcome> {
    let streams = [&arguments.reference, &arguments.other].map(|path| stream::is_stream(path));
    let clean = arguments.clean || streams[0] != streams[1];
    let (labelled, labels) = (arguments.part.is_some(), arguments.labels.as_deref());
    let reference = Sequence::open(&arguments.reference, clean, labelled, labels)?;
    let other = Sequence::open(&arguments.other, clean, labelled, None)?;
    let bounds = reference.bounds()?;
    let comparison = arguments.measure(&reference, &other, &bounds, global)?;
    arguments.print(&comparison)?;
    Ok(Outcome::Good)
}

impl CompareArguments {
    fn measure(
        &self,
        reference: &Sequence,
        other: &Sequence,
        bounds: &BoundingBox,
        global: &Global,
    ) -> Result<Comparison> {
        let scale = Scale::from(*bounds);
        let fast = self.fast || self.part.is_some();
        let measures = if fast { Measures::DISTANCE } else { Measures::ALL };
        let bar = progress::bar(global, "measuring", None);
        let (mut left, mut right) = (reference.reader()?, other.reader()?);
        let mut frames = Vec::new();
        while let Some((a, b)) = self.next_pair(&mut left, &mut right)? {
            let index = a.index;
            if self.frames.contains(index) {
                let is_first = frames.is_empty();
                frames.push(self.measure_pair(&a, &b, is_first, measures, &scale)?);
                bar.step();
            }
            if index >= self.frames.last() {
                break;
            }
        }
        Comparison::new(frames, &scale).context("there is no frame to measure")
    }

    fn measure_pair(
        &self,
        a: &Frame,
        b: &Frame,
        is_first: bool,
        measures: Measures,
        scale: &Scale,
    ) -> Result<FrameRow> {
        let surfaces = (surface(a, measures)?, surface(b, measures)?);
        if is_first {
            self.draw((a, &surfaces.0), (b, &surfaces.1))?;
        }
        let distortion = match self.part {
            None => distortion::measure(&surfaces.0, &surfaces.1, scale, measures),
            Some(part) => {
                let parts = [faces_of(a, part)?, faces_of(b, part)?];
                let parts = [&parts[0][..], &parts[1][..]];
                distortion::measure_part(&surfaces.0, &surfaces.1, parts, scale)
            }
        };
        let distortion = distortion.with_context(|| format!("{}: frame {}", b.file, b.index))?;
        Ok(FrameRow::new(b, distortion))
    }

    /// The next frame of both sides; sequences of different length are an error.
    fn next_pair(&self, left: &mut Reader, right: &mut Reader) -> Result<Option<(Frame, Frame)>> {
        let (short, long, index) = match (left.next_frame()?, right.next_frame()?) {
            (Some(a), Some(b)) => return Ok(Some((a, b))),
            (None, None) => return Ok(None),
            (Some(a), None) => (&self.other, &self.reference, a.index),
            (None, Some(b)) => (&self.reference, &self.other, b.index),
        };
        let (short, long) = (stream::name_of(short), stream::name_of(long));
        bail!("{short}: frame {index}: there is no such frame, but {long} has it")
    }

    /// The picture and the values per vertex, where asked for.
    fn draw(
        &self,
        (a, surface_a): (&Frame, &Surface),
        (b, surface_b): (&Frame, &Surface),
    ) -> Result<()> {
        if self.heatmap.is_none() && self.values.is_none() {
            return Ok(());
        }
        let [on_a, on_b] = match self.local {
            LocalError::Distance => {
                [surface_b.distances_of(surface_a), surface_a.distances_of(surface_b)]
            }
            LocalError::Msdm2 => {
                surface_a.local_msdm2(surface_b).context("--local msdm2 needs MSDM2: no --fast")?
            }
        };
        if let Some(path) = &self.heatmap {
            let what = match self.local {
                LocalError::Distance => "distance between the surfaces",
                LocalError::Msdm2 => "MSDM2",
            };
            let title = format!("{what}, frame {}", a.index);
            let sides = [("reference", &a.mesh, &on_a[..]), ("other", &b.mesh, &on_b[..])];
            write_file(path, |out| heatmap::turntable(out, title, sides))?;
        }
        if let Some(path) = &self.values {
            let values: Vec<f32> = on_b.iter().map(|&error| error as f32).collect();
            write_mesh_with_scalar(path, &b.mesh, "error", &values)?;
        }
        Ok(())
    }

    fn print(&self, comparison: &Comparison) -> Result<()> {
        let mut out = io::stdout().lock();
        if let Some(path) = &self.csv {
            drop(out);
            write_file(path, |out| Ok(comparison.write_csv(out)?))?;
            if crate::output::is_dash(path) {
                return Ok(());
            }
            out = io::stdout().lock();
        }
        if self.json {
            serde_json::to_writer_pretty(&mut out, comparison)?;
            writeln!(out)?;
        } else {
            comparison.write_table(&mut out)?;
        }
        Ok(())
    }
}

fn surface(frame: &Frame, measures: Measures) -> Result<Surface> {
    Surface::new(&frame.mesh, measures)
        .with_context(|| format!("{}: frame {}", frame.file, frame.index))
}
