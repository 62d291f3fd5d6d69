//! Distortion of P-frames, frame by frame, with rigid and with affine key nodes.
//!
//! `cargo run --release -p kn-lab -- motion-table [FOLDER FIRST COUNT]`
//!
//! The frames FIRST to FIRST + COUNT − 1 of a folder of `frame_0000.obj` files are one GoF: an
//! I-frame at 11 bits and P-frames that are chained. Body parts come from the segmenter. Distances
//! are in 1e-4 of the diagonal of the box of all frames in the folder. Without arguments: frames 4
//! to 11 of the sequence dancer (`docs/data.md`), and where that is absent a few of the performer.

use crate::coding::{Surface, code, without_choices};
use anyhow::{Context, Result, ensure};
use kn_codec::params::Weights;
use kn_codec::{AffineChoice, GridChoice, NodePlacement};
use kn_io::{Inputs, ReadOptions};
use kn_mesh::{BoundingBox, Mesh, clean};
use kn_performer::{Performer, PerformerConfig};
use kn_segment::{SegmentOptions, Segmenter};
use std::path::PathBuf;

/// Area-uniform samples on each surface.
const SAMPLES: usize = 100_000;

/// One setting of the table.
struct Setting {
    name: &'static str,
    nodes: usize,
    affine: AffineChoice,
    weights: Weights,
    placement: NodePlacement,
    labelled: bool,
}

fn settings() -> Vec<Setting> {
    use NodePlacement::{Farthest, Generated};
    let row = |name, nodes, weights, placement, affine: AffineChoice| {
        let labelled = matches!(affine, AffineChoice::Labels(_));
        Setting { name, nodes, affine, weights, placement, labelled }
    };
    let torso = AffineChoice::torso;
    vec![
        row(
            "rigid, 300 farthest nodes, Sumner",
            300,
            Weights::SUMNER,
            Farthest,
            AffineChoice::None,
        ),
        row(
            "rigid, 300 farthest nodes",
            300,
            Weights::INVERSE_SQUARE,
            Farthest,
            AffineChoice::None,
        ),
        row("rigid, 300 nodes, Sumner", 300, Weights::SUMNER, Generated, AffineChoice::None),
        row(
            "rigid, 150 farthest nodes",
            150,
            Weights::INVERSE_SQUARE,
            Farthest,
            AffineChoice::None,
        ),
        row("rigid, 150 nodes", 150, Weights::INVERSE_SQUARE, Generated, AffineChoice::None),
        row("affine torso, 150 farthest nodes", 150, Weights::INVERSE_SQUARE, Farthest, torso()),
        row("affine torso, 150 nodes", 150, Weights::INVERSE_SQUARE, Generated, torso()),
        row("affine torso, 150 nodes, Sumner", 150, Weights::SUMNER, Generated, torso()),
        row("all affine, 150 nodes", 150, Weights::INVERSE_SQUARE, Generated, AffineChoice::All),
        row("all affine, 150 nodes, Sumner", 150, Weights::SUMNER, Generated, AffineChoice::All),
    ]
}

pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let (frames, bounds) = match arguments {
        [folder, first, count] => read(folder.into(), first.parse()?, count.parse()?)?,
        [] => match kn_testdata::data("dancer") {
            Some(dancer) => read(dancer, 4, 8)?,
            None => performer()?,
        },
        _ => anyhow::bail!("usage: motion-table [FOLDER FIRST COUNT]"),
    };
    let mut segmenter = Segmenter::new(SegmentOptions::default());
    let labelled = frames.iter().map(|frame| {
        let labels = segmenter.segment(&frame.positions, &frame.faces)?.labels;
        Ok(frame.clone().with_labels(labels))
    });
    let labelled: Vec<Mesh> = labelled.collect::<Result<_>>()?;
    let surfaces: Vec<Surface> = frames.iter().skip(1).map(Surface::new).collect::<Result<_>>()?;
    for setting in settings() {
        let frames = if setting.labelled { &labelled } else { &frames };
        let config = without_choices()
            .with_grid(GridChoice::Bits { bits: 11, bounds: Some(bounds) })
            .with_group_length(u8::try_from(frames.len())?)
            .with_nodes(setting.nodes)
            .with_affine(setting.affine.clone())
            .with_weights(setting.weights)
            .with_placement(setting.placement);
        let (bytes, decoded) = code(frames, config)?;
        let measured = surfaces.iter().zip(&decoded[1..]);
        let measured = measured.map(|(scan, shown)| measure(scan, shown, &bounds));
        print_setting(&setting, bytes, &measured.collect::<Result<Vec<_>>>()?);
    }
    Ok(())
}

/// Cleaned frames of a folder, and the box of all that are in it.
fn read(folder: PathBuf, first: usize, count: usize) -> Result<(Vec<Mesh>, BoundingBox)> {
    let inputs = Inputs::find(&[folder], ReadOptions::default())?;
    let mut bounds: Option<BoundingBox> = None;
    let mut frames = Vec::new();
    for frame in inputs.frames() {
        let frame = frame?;
        bounds = match (bounds, frame.mesh.bounding_box()) {
            (Some(a), Some(b)) => Some(a.union(b)),
            (a, b) => a.or(b),
        };
        let number = frame.path.file_stem().and_then(|stem| stem.to_str()?.get(6..)?.parse().ok());
        if number.is_some_and(|number: usize| (first..first + count).contains(&number)) {
            frames.push(clean(&frame.mesh)?.mesh);
        }
    }
    ensure!(frames.len() == count, "{} of the {count} frames were found", frames.len());
    Ok((frames, bounds.context("the frames have no box")?))
}

fn performer() -> Result<(Vec<Mesh>, BoundingBox)> {
    let config = PerformerConfig { vertices: 4_000, ..PerformerConfig::default() };
    let performer = Performer::new(config)?;
    let unlabelled = |index| performer.frame(index).with_labels(Vec::new());
    let frames: Vec<Mesh> = (0..3).map(unlabelled).collect();
    let boxes = frames.iter().filter_map(Mesh::bounding_box);
    let bounds = boxes.reduce(|a, b| a.union(b)).context("the figure has no box")?;
    Ok((frames, bounds))
}

/// P2S and Hausdorff in 1e-4 of the diagonal, and MSDM2.
type Distortion = [f64; 3];

fn measure(scan: &Surface, shown: &Mesh, bounds: &BoundingBox) -> Result<Distortion> {
    let shown = Surface::new(shown)?;
    let distance = scan.distance(&shown, SAMPLES)?;
    let unit = 1e-4 * bounds.diagonal();
    Ok([distance.rms() / unit, distance.hausdorff() / unit, scan.msdm2(&shown)])
}

fn print_setting(setting: &Setting, bytes: u64, frames: &[Distortion]) {
    let count = frames.len() as f64;
    let mean = |number: usize| frames.iter().map(|frame| frame[number]).sum::<f64>() / count;
    println!("{}, {:.0} bytes a P-frame", setting.name, bytes as f64 / count);
    for (number, name, digits) in [(0, "P2S", 1), (2, "MSDM2", 3), (1, "Hausdorff", 0)] {
        let each = frames.iter().map(|frame| format!(" {:6.digits$}", frame[number]));
        println!("  {name:9}{} | {:.*}", each.collect::<String>(), digits + 1, mean(number));
    }
}
