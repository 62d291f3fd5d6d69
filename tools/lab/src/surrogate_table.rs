//! Values of the surrogate of MSDM2, beside MSDM2, for the frames of streams.
//!
//! `cargo run --release -p kn-lab -- surrogate-table FOLDER FIRST STREAM...`
//!
//! FOLDER holds the scans that the streams were made from, the streams' first frame is the FIRST of
//! them. Prints a CSV row for each P-frame: MSDM2 (symmetric), and of the decoded surface against
//! the scan the RMS distance relative to the diagonal and the mean of 1 − cos between normals.

use anyhow::{Context, Result, ensure};
use kn_codec::{Decoder, FrameKind};
use kn_fit::{Deviation, FitTarget};
use kn_io::{Inputs, ReadOptions};
use kn_mesh::{Mesh, clean};
use kn_metrics::{DEFAULT_LEVELS, Interpolation, Msdm2Surface, msdm2};
use std::fs::File;
use std::io::BufReader;

/// Faces that are looked at, about.
const SAMPLES: usize = 4000;

pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let [folder, first, streams @ ..] = arguments else {
        anyhow::bail!("usage: surrogate-table FOLDER FIRST STREAM...");
    };
    let first: usize = first.parse().context("FIRST")?;
    let inputs = Inputs::find(&[folder.into()], ReadOptions::default())?;
    let scans: Vec<Mesh> = inputs
        .frames()
        .skip(first)
        .map(|frame| Ok(clean(&frame?.mesh)?.mesh))
        .collect::<Result<_>>()?;
    println!("stream,frame,msdm2,distance,bend");
    for name in streams {
        let mut decoder = Decoder::new(BufReader::new(File::open(name)?))?;
        let mut mesh = Mesh::default();
        while let Some(info) = decoder.next_frame(&mut mesh)? {
            ensure!((info.index as usize) < scans.len(), "{name} has more frames than scans");
            if info.kind == FrameKind::Predicted {
                let scan = &scans[info.index as usize];
                let (score, Deviation { distance, bend }) =
                    (score(scan, &mesh)?, deviation(scan, &mesh)?);
                println!("{name},{},{score:.5},{distance:.4e},{bend:.5}", info.index);
            }
        }
    }
    Ok(())
}

fn score(scan: &Mesh, mesh: &Mesh) -> Result<f64> {
    let scan = Msdm2Surface::new(&scan.positions, &scan.faces, DEFAULT_LEVELS)?;
    let shown = Msdm2Surface::new(&mesh.positions, &mesh.faces, DEFAULT_LEVELS)?;
    Ok(msdm2(&scan, &shown, Interpolation::default()).symmetric)
}

fn deviation(scan: &Mesh, mesh: &Mesh) -> Result<Deviation> {
    let target = FitTarget::new(&scan.positions, &scan.faces)?;
    let shown = mesh.positions.clone();
    let (mut centres, mut normals) = (Vec::new(), Vec::new());
    for face in mesh.faces.iter().step_by((mesh.faces.len() / SAMPLES).max(1)) {
        let [a, b, c] = face.map(|vertex| shown[vertex as usize]);
        let [u, v]: [[f64; 3]; 2] = [b, c].map(|to| std::array::from_fn(|k| to[k] - a[k]));
        centres.push(std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0));
        normals.push([
            u[1] * v[2] - u[2] * v[1],
            u[2] * v[0] - u[0] * v[2],
            u[0] * v[1] - u[1] * v[0],
        ]);
    }
    Ok(target.deviation(&centres, &normals))
}
