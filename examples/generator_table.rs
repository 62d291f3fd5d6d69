//! What the key-node generator gains over farthest points, group by group.
//!
//! `cargo run --release --example generator_table -- [NODES [FOLDER..]]`
//!
//! Every folder of `frame_0000.obj` files is coded twice in groups of eight frames, 11 bits, rigid
//! nodes and no labels: with nodes by farthest points and with generated ones. Without folders:
//! `dancer`, `liam` and `tshirt_turn` of `../shared/data`. P2S is the mean of both directions' RMS,
//! in 1e-4 of the diagonal of the box of all frames.

use anyhow::{Context, Result};
use kn_codec::{Decoder, Encoder, EncoderConfig, GridChoice, NodePlacement};
use kn_mesh::io::{Inputs, LabelSource, ReadOptions};
use kn_mesh::{BoundingBox, Mesh, clean};
use kn_metrics::{DEFAULT_LEVELS, Interpolation, Msdm2Surface, TriangleTree, msdm2, p2s};
use std::io::Cursor;
use std::path::PathBuf;

const GROUP: usize = 8;
/// Area-uniform samples on each surface.
const SAMPLES: usize = 50_000;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let nodes: usize = arguments.next().map_or(Ok(150), |text| text.parse())?;
    let mut folders: Vec<PathBuf> = arguments.map(PathBuf::from).collect();
    if folders.is_empty() {
        let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/data");
        folders =
            ["dancer", "liam", "tshirt_turn"].map(|name| PathBuf::from(data).join(name)).into();
        folders.retain(|folder| folder.exists());
    }
    println!("group | farthest: P2S, MSDM2, bytes | generated: P2S, MSDM2, bytes | gain of P2S");
    for folder in folders {
        let name = folder.display().to_string();
        let (frames, bounds) = read(folder)?;
        for (number, group) in frames.chunks(GROUP).enumerate() {
            let scans: Vec<Surface> = group[1..].iter().map(Surface::new).collect::<Result<_>>()?;
            let measure = |placement| -> Result<[f64; 3]> {
                let (bytes, shown) = code(group, nodes, placement, bounds)?;
                mean(&scans, &shown, bytes, &bounds)
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

/// Bytes of the P-frames, and the P-frames as they are decoded.
fn code(
    frames: &[Mesh],
    nodes: usize,
    placement: NodePlacement,
    bounds: BoundingBox,
) -> Result<(u64, Vec<Mesh>)> {
    let config = EncoderConfig {
        grid: GridChoice::Bits { bits: 11, bounds: Some(bounds) },
        group_length: GROUP as u8,
        nodes,
        placement,
        ..EncoderConfig::default()
    };
    let mut encoder = Encoder::new(Vec::new(), config)?;
    for frame in frames {
        encoder.push(frame)?;
    }
    let finished = encoder.finish()?;
    let mut decoder = Decoder::new(Cursor::new(finished.writer))?;
    let (mut decoded, mut mesh) = (Vec::new(), Mesh::default());
    while decoder.next_frame(&mut mesh)?.is_some() {
        decoded.push(mesh.clone());
    }
    decoded.remove(0);
    Ok((finished.summary.predicted_bytes, decoded))
}

/// P2S, MSDM2 and bytes of a P-frame.
fn mean(scans: &[Surface], shown: &[Mesh], bytes: u64, bounds: &BoundingBox) -> Result<[f64; 3]> {
    let count = scans.len() as f64;
    let mut sums = [0.0, 0.0, bytes as f64];
    for (scan, shown) in scans.iter().zip(shown) {
        let shown = Surface::new(shown)?;
        let distance = p2s(scan.side(), shown.side(), SAMPLES)?;
        let both = distance.from_reference.rms() + distance.from_other.rms();
        sums[0] += 0.5 * both / (1e-4 * bounds.diagonal());
        let (a, b) = (&scan.perceptual, &shown.perceptual);
        sums[1] += msdm2(a, b, Interpolation::AtVertex).symmetric;
    }
    Ok(sums.map(|sum| sum / count))
}

/// A mesh with what its distortion is measured on.
struct Surface {
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    tree: TriangleTree,
    perceptual: Msdm2Surface,
}

impl Surface {
    fn new(mesh: &Mesh) -> Result<Self> {
        let (positions, faces) = (mesh.positions_f64(), mesh.faces.clone());
        Ok(Self {
            tree: TriangleTree::new(&positions, &faces)?,
            perceptual: Msdm2Surface::new(&positions, &faces, DEFAULT_LEVELS)?,
            positions,
            faces,
        })
    }

    fn side(&self) -> (&[[f64; 3]], &[[u32; 3]], &TriangleTree) {
        (&self.positions, &self.faces, &self.tree)
    }
}
