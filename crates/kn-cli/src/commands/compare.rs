//! `kn compare`: how far two meshes or sequences are apart.

mod output;

use crate::arguments::{FrameRange, Global};
use crate::distortion::{self, Measures, Scale, Surface};
use crate::output::{is_dash, print, print_json, write_file};
use crate::outputs::Outputs;
use crate::sequence::{Frame, Reader, Sequence};
use crate::table::counted;
use crate::{Outcome, heatmap, progress, stream};
use anyhow::{Context, Result, bail};
use kn_io::{check_scalar_format, write_mesh_with_scalar};
use kn_mesh::parts::PART_NAMES;
use kn_mesh::{BoundingBox, Mesh};
use output::{Comparison, FrameRow};
use std::path::PathBuf;

/// Measure the distortion between two meshes or sequences
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Each side is a mesh (OBJ, PLY, OFF, glTF), a folder, a pattern in quotes, or a .knm file. Relative
distances and decibels refer to the box of the whole reference: its diagonal and its longest side.
Meshes are compared as they are in their files; against a .knm file, whose scans were welded before
encoding, they are welded too. Frames of a .knm file are checked against their digests. Sequences of
different length are an error, unless --frames names only frames that both have.

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
    /// Print JSON: {mean, mean_predicted, frames, box}; mean_predicted is of the P-frames of a stream
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
    arguments.check_outputs(&reference, &other)?;
    let bounds = reference.bounds()?;
    let (comparison, drawn) = arguments.measure(&reference, &other, &bounds, global)?;
    arguments.print(&comparison)?;
    arguments.write(&comparison, drawn)?;
    Ok(Outcome::Good)
}

impl CompareArguments {
    fn measure(
        &self,
        reference: &Sequence,
        other: &Sequence,
        bounds: &BoundingBox,
        global: &Global,
    ) -> Result<(Comparison, Drawn)> {
        let scale = Scale::from(*bounds);
        let fast = self.fast || self.part.is_some();
        let measures = if fast { Measures::DISTANCE } else { Measures::ALL };
        let bar = progress::bar(global, "measuring", None);
        let (mut left, mut right) = (reference.reader()?, other.reader()?);
        let (mut frames, mut drawn) = (Vec::new(), Drawn::default());
        let mut count = 0;
        while let Some((a, b)) = self.next_pair(&mut left, &mut right)? {
            let index = a.index;
            count = index + 1;
            if self.frames.contains(index) {
                let first = frames.is_empty().then_some(&mut drawn);
                frames.push(self.measure_pair(&a, &b, first, measures, &scale)?);
                bar.step();
            }
            if index >= self.frames.last() {
                break;
            }
        }
        let comparison = Comparison::new(frames, &scale).with_context(|| {
            let [reference, other] = self.names();
            let (asked, there) = (self.frames.first(), counted(count, "frame"));
            format!("there is no frame {asked} to measure: {reference} and {other} have {there}")
        })?;
        Ok((comparison, drawn))
    }

    fn names(&self) -> [String; 2] {
        [&self.reference, &self.other].map(|path| stream::name_of(path))
    }

    fn measure_pair(
        &self,
        a: &Frame,
        b: &Frame,
        first: Option<&mut Drawn>,
        measures: Measures,
        scale: &Scale,
    ) -> Result<FrameRow> {
        let surfaces = (surface(a, measures)?, surface(b, measures)?);
        if let Some(drawn) = first {
            *drawn = self.draw((a, &surfaces.0), (b, &surfaces.1))?;
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
        let [reference, other] = self.names();
        let (short, long, index) = match (left.next_frame()?, right.next_frame()?) {
            (Some(a), Some(b)) => return Ok(Some((a, b))),
            (None, None) => return Ok(None),
            (Some(a), None) => (other, reference, a.index),
            (None, Some(b)) => (reference, other, b.index),
        };
        bail!("{short}: frame {index}: there is no such frame, but {long} has it")
    }

    /// The picture and the values per vertex, where asked for.
    fn draw(
        &self,
        (a, surface_a): (&Frame, &Surface),
        (b, surface_b): (&Frame, &Surface),
    ) -> Result<Drawn> {
        let mut drawn = Drawn::default();
        if self.heatmap.is_none() && self.values.is_none() {
            return Ok(drawn);
        }
        let [on_a, on_b] = match self.local {
            LocalError::Distance => {
                [surface_b.distances_of(surface_a), surface_a.distances_of(surface_b)]
            }
            LocalError::Msdm2 => {
                surface_a.local_msdm2(surface_b).context("--local msdm2 needs MSDM2: no --fast")?
            }
        };
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
    fn check_outputs(&self, reference: &Sequence, other: &Sequence) -> Result<()> {
        let mut outputs = Outputs::beside(reference.files().chain(other.files()));
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
    fn print(&self, comparison: &Comparison) -> Result<()> {
        if self.csv.as_deref().is_some_and(is_dash) {
            return Ok(());
        }
        if self.json {
            return print_json(comparison);
        }
        print(|out| Ok(comparison.write_table(out)?))
    }

    fn write(&self, comparison: &Comparison, drawn: Drawn) -> Result<()> {
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

/// What shows the first frame, where it was asked for.
#[derive(Default)]
struct Drawn {
    /// A PNG file.
    picture: Vec<u8>,
    /// The other side's mesh and a difference per vertex.
    values: Option<(Mesh, Vec<f32>)>,
}

fn surface(frame: &Frame, measures: Measures) -> Result<Surface> {
    Surface::new(&frame.mesh, measures)
        .with_context(|| format!("{}: frame {}", frame.file, frame.index))
}
