//! `kn register`: one mesh deformed onto another.

use crate::Outcome;
use crate::arguments::Global;
use crate::output::print;
use crate::outputs::Outputs;
use crate::table::table;
use anyhow::{Context, Result, anyhow, ensure};
use kn_codec::{EarlierFrames, FailureTuning};
use kn_fit::{FitError, FitOptions, RegisterOptions, Registration, Side, register};
use kn_io::{MeshFormat, ReadOptions, read_mesh, write_mesh};
use kn_mesh::vec3::distance_squared;
use kn_mesh::{Cleaned, Mesh, clean};
use kn_metrics::{Distances, TriangleTree, distances_to_surface};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Deform a mesh onto another with key nodes
#[derive(Debug, clap::Args)]
#[command(after_help = "\
OUT has the faces and the vertices of SOURCE in the same order; only positions change. The meshes
need no common connectivity, but they should stand in the same place and have similar poses. Parts
that the motion does not explain are reported on standard error.

Distances are those of the deformed vertices to the surface of TARGET (s2t), of its vertices to the
deformed surface (t2s), the larger of both maxima (hausdorff) and to the true positions (truth),
all relative to the diagonal of TARGET's box.

Examples:
  kn register a.obj b.obj -o a_as_b.obj
  kn register a.obj b.obj -o a_as_b.ply --nodes 400
  kn register a.obj b.obj -o out.obj --truth a_in_b.obj --json | jq .truth")]
pub(crate) struct RegisterArguments {
    /// The mesh to deform (OBJ, PLY, OFF, STL, glTF)
    #[arg(value_name = "SOURCE")]
    source: PathBuf,
    /// The mesh to deform it to
    #[arg(value_name = "TARGET")]
    target: PathBuf,
    /// The deformed source (.obj, .ply, .glb)
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Key nodes
    #[arg(long, value_name = "N", default_value_t = 200)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=4096))]
    nodes: u16,
    /// The true positions of the source's vertices, to measure against
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    /// Print JSON: {s2t, t2s, hausdorff, truth, nodes, iterations, seconds}
    #[arg(long)]
    json: bool,
}

/// The output of --json.
#[derive(Debug, Serialize)]
struct Measured {
    #[serde(flatten)]
    distances: Relative,
    /// Key nodes that were used.
    nodes: usize,
    /// Correspondence steps.
    iterations: usize,
    /// Of the registration, without reading, measuring and writing.
    seconds: f64,
}

/// Distances of the deformed source from the target, relative to the diagonal of the target's box.
#[derive(Debug, Serialize)]
struct Relative {
    /// RMS from the deformed vertices to the target's surface.
    s2t: f64,
    /// RMS from the target's vertices to the deformed surface.
    t2s: f64,
    /// The largest distance of both directions.
    hausdorff: f64,
    /// RMS to the true positions, where they were given.
    truth: Option<f64>,
}

/// Runs the command.
pub(crate) fn run(arguments: &RegisterArguments, global: &Global) -> Result<Outcome> {
    arguments.check_output()?;
    let (source, target) = rayon::join(|| read(&arguments.source), || read(&arguments.target));
    let (source, target) = (source?, target?);
    let truth = arguments.truth.as_ref().map(|path| read_truth(path, &source)).transpose()?;
    let start = Instant::now();
    let (deformed, registration) = arguments.deform(&source, &target)?;
    let seconds = start.elapsed().as_secs_f64();
    let distances = Relative::measure(&deformed, &target, truth.as_deref());
    let measured = Measured {
        distances: distances.with_context(|| arguments.pair())?,
        nodes: registration.nodes.len(),
        iterations: registration.report.steps,
        seconds,
    };
    write_mesh(&arguments.output, &deformed)?;
    let tuning = FailureTuning::default();
    if let Some(failure) = tuning.judge(&registration.report, &EarlierFrames::default()) {
        global.note(format_args!("{}: not explained: {failure}", arguments.target.display()));
    }
    measured.print(arguments.json)?;
    Ok(Outcome::Good)
}

impl RegisterArguments {
    /// Before any work.
    fn check_output(&self) -> Result<()> {
        MeshFormat::of_path(&self.output)?;
        let inputs = [&self.source, &self.target].into_iter().chain(&self.truth);
        Outputs::beside(inputs.map(PathBuf::as_path)).file("--output", &self.output)
    }

    fn pair(&self) -> String {
        format!("{} and {}", self.source.display(), self.target.display())
    }

    /// The source with its vertices where the target has them.
    fn deform(&self, source: &Mesh, target: &Mesh) -> Result<(Mesh, Registration)> {
        // Seams of a scan are cuts that would gape; what is welded comes out at all its places.
        let (from, to) = (cleaned(source, &self.source)?, cleaned(target, &self.target)?);
        let measures = Some(FailureTuning::default().measures);
        let fit = FitOptions { measures, ..FitOptions::default() };
        let options = RegisterOptions { nodes: self.nodes.into(), fit };
        let (from_mesh, to_mesh) = (&from.mesh, &to.mesh);
        let registration = register(
            &from_mesh.positions,
            &from_mesh.faces,
            &to_mesh.positions,
            &to_mesh.faces,
            &options,
        )
        .map_err(|error| self.name_file(error))?;
        let mut deformed = source.clone();
        for (position, &vertex) in deformed.positions.iter_mut().zip(&from.vertex_map) {
            *position = registration.positions[vertex as usize];
        }
        Ok((deformed, registration))
    }

    /// Says which file an error is about.
    fn name_file(&self, error: FitError) -> anyhow::Error {
        let file = match error {
            FitError::NoSurface { mesh: Side::Target }
            | FitError::NotFinite { mesh: Side::Target, .. }
            | FitError::BadFace { mesh: Side::Target, .. }
            | FitError::Tree { mesh: Side::Target, .. } => &self.target,
            _ => &self.source,
        };
        anyhow!(error).context(file.display().to_string())
    }
}

fn read(path: &Path) -> Result<Mesh> {
    Ok(read_mesh(path, &ReadOptions::default())?.mesh)
}

/// The positions of a mesh with as many vertices as the source.
fn read_truth(path: &Path, source: &Mesh) -> Result<Vec<[f64; 3]>> {
    let options = ReadOptions { allow_empty: true, ..ReadOptions::default() };
    let truth = read_mesh(path, &options)?.mesh.positions;
    let (found, expected) = (truth.len(), source.positions.len());
    ensure!(
        found == expected,
        "{}: {found} true positions for the {expected} vertices of the source",
        path.display()
    );
    Ok(truth)
}

fn cleaned(mesh: &Mesh, path: &Path) -> Result<Cleaned> {
    clean(mesh).map_err(|fault| anyhow!("{}: {fault}", path.display()))
}

impl Relative {
    /// From the vertices of each surface, those that have a face, to the other surface.
    fn measure(deformed: &Mesh, target: &Mesh, truth: Option<&[[f64; 3]]>) -> Result<Self> {
        let (s2t, t2s) = rayon::join(|| one_way(deformed, target), || one_way(target, deformed));
        let (s2t, t2s) = (s2t?, t2s?);
        let diagonal = target.bounding_box().context("the target has no vertex")?.diagonal();
        Ok(Self {
            s2t: s2t.rms() / diagonal,
            t2s: t2s.rms() / diagonal,
            hausdorff: s2t.max.max(t2s.max) / diagonal,
            truth: truth.map(|truth| rms_to_truth(deformed, truth) / diagonal),
        })
    }
}

impl Measured {
    fn print(&self, json: bool) -> Result<()> {
        if json {
            let line = serde_json::to_string(self)?;
            return print(|out| Ok(writeln!(out, "{line}")?));
        }
        let mut table = table(&["", "of diagonal"]);
        let Self { distances, nodes, iterations, seconds } = self;
        let truth = distances.truth.map(|truth| ("RMS to the truth", truth));
        let rows = [
            ("source to target, RMS", distances.s2t),
            ("target to source, RMS", distances.t2s),
            ("Hausdorff", distances.hausdorff),
        ];
        for (name, distance) in rows.into_iter().chain(truth) {
            table.add_row([name.to_owned(), format!("{distance:.3e}")]);
        }
        print(|out| {
            writeln!(out, "{table}")?;
            Ok(writeln!(out, "{nodes} key nodes, {iterations} iterations, {seconds:.2} s")?)
        })
    }
}

/// From the vertices of a surface to another surface.
fn one_way(from: &Mesh, to: &Mesh) -> Result<Distances> {
    let mut used = vec![false; from.positions.len()];
    from.faces.iter().flatten().for_each(|&vertex| used[vertex as usize] = true);
    let tree = TriangleTree::new(&to.positions, &to.faces)?;
    Ok(distances_to_surface(&from.positions, Some(&used), &tree)?)
}

fn rms_to_truth(deformed: &Mesh, truth: &[[f64; 3]]) -> f64 {
    let squared = |(a, b): (&[f64; 3], &[f64; 3])| distance_squared(*a, *b);
    let sum: f64 = deformed.positions.iter().zip(truth).map(squared).sum();
    (sum / truth.len() as f64).sqrt()
}
