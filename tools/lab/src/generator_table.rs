//! Gain of the key-node generator over farthest points, GoF by GoF.
//!
//! `cargo run --release -p kn-lab -- generator-table [NODES [FOLDER..]]`
//!
//! Every folder of `frame_0000.obj` files is coded twice in GoFs of eight frames, 11 bits, rigid
//! nodes and no labels: with nodes by farthest points and with generated ones. Without folders:
//! `dancer`, `liam` and `tshirt_turn` of `KN_DATA` (`docs/data.md`). P2S is the mean of both
//! directions' RMS, in 1e-4 of the diagonal of the box of all frames.

use crate::coding::{Surface, code, without_choices};
use anyhow::{Context, Result};
use kn_codec::{AffineChoice, GridChoice, NodePlacement};
use kn_io::{Inputs, LabelSource, ReadOptions};
use kn_mesh::{BoundingBox, Mesh, clean};
use std::path::PathBuf;

const GROUP: usize = 8;
/// Area-uniform samples on each surface.
const SAMPLES: usize = 50_000;

pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let mut arguments = arguments.iter();
    let nodes: usize = arguments.next().map_or(Ok(150), |text| text.parse())?;
    let mut folders: Vec<PathBuf> = arguments.map(PathBuf::from).collect();
    if folders.is_empty() {
        folders.extend(["dancer", "liam", "tshirt_turn"].into_iter().filter_map(kn_testdata::data));
    }
    println!("GoF | farthest: P2S, MSDM2, bytes | generated: P2S, MSDM2, bytes | gain of P2S");
    for folder in folders {
        let name = folder.display().to_string();
        let (frames, bounds) = read(folder)?;
        for (number, group) in frames.chunks(GROUP).enumerate() {
            let scans: Vec<Surface> = group[1..].iter().map(Surface::new).collect::<Result<_>>()?;
            let measure = |placement| -> Result<[f64; 3]> {
                let config = without_choices()
                    .with_grid(GridChoice::Bits { bits: 11, bounds: Some(bounds) })
                    .with_group_length(GROUP as u8)
                    .with_nodes(nodes)
                    .with_placement(placement)
                    .with_affine(AffineChoice::None);
                let (bytes, shown) = code(group, config)?;
                mean(&scans, &shown[1..], bytes, &bounds)
            };
            let farthest = measure(NodePlacement::Farthest)?;
            let generated = measure(NodePlacement::Generated)?;
            let row = |[p2s, msdm2, bytes]: [f64; 3]| format!("{p2s:5.2} {msdm2:.4} {bytes:4.0}");
            let gain = 100.0 * (generated[0] / farthest[0] - 1.0);
            println!("{name} {number} | {} | {} | {gain:.1} %", row(farthest), row(generated));
        }
    }
    Ok(())
}

/// Cleaned frames of a folder, and their box.
fn read(folder: PathBuf) -> Result<(Vec<Mesh>, BoundingBox)> {
    let options = ReadOptions { labels: LabelSource::None, ..ReadOptions::default() };
    let inputs = Inputs::find(&[folder], options)?;
    let frames = inputs.frames().map(|frame| Ok(clean(&frame?.mesh)?.mesh));
    let frames: Vec<Mesh> = frames.collect::<Result<_>>()?;
    let boxes = frames.iter().filter_map(Mesh::bounding_box);
    let bounds = boxes.reduce(|a, b| a.union(b)).context("the frames have no box")?;
    Ok((frames, bounds))
}

/// P2S, MSDM2 and bytes of a P-frame.
fn mean(scans: &[Surface], shown: &[Mesh], bytes: u64, bounds: &BoundingBox) -> Result<[f64; 3]> {
    let count = scans.len() as f64;
    let mut sums = [0.0, 0.0, bytes as f64];
    for (scan, shown) in scans.iter().zip(shown) {
        let shown = Surface::new(shown)?;
        let distance = scan.distance(&shown, SAMPLES)?;
        let both = distance.from_reference.rms() + distance.from_other.rms();
        sums[0] += 0.5 * both / (1e-4 * bounds.diagonal());
        sums[1] += scan.msdm2(&shown);
    }
    Ok(sums.map(|sum| sum / count))
}
