//! Registers one OBJ to another and prints how near they come, relative to the target's box.
//!
//! `cargo run --release --example register -- [SOURCE TARGET [NODES [TRUTH]]]`
//!
//! Without arguments two frames of the synthetic performer are registered.

use anyhow::{Context, Result};
use kn_fit::{FitOptions, RegisterOptions, register};
use kn_mesh::Mesh;
use kn_mesh::io::{ReadOptions, read_mesh};
use kn_mesh::performer::{Performer, PerformerConfig};
use kn_metrics::TriangleTree;
use std::path::Path;

/// Source, target, number of nodes, and the true positions of the source's vertices.
type Task = (Mesh, Mesh, usize, Option<Vec<[f64; 3]>>);

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (source, target, nodes, truth): Task = match &arguments[..] {
        [] => performer()?,
        [source, target, rest @ ..] => {
            let nodes =
                rest.first().map_or(Ok(200), |n| n.parse()).context("NODES is no number")?;
            let truth = rest.get(1).map(|path| read(path)).transpose()?;
            let truth = truth.map(|mesh| mesh.positions_f64());
            (read(source)?, read(target)?, nodes, truth)
        }
        [_] => anyhow::bail!("usage: register [SOURCE TARGET [NODES [TRUTH]]]"),
    };
    let start = std::time::Instant::now();
    let (from, to) = (source.positions_f64(), target.positions_f64());
    let options = RegisterOptions { nodes, fit: FitOptions::default() };
    let result = register(&from, &source.faces, &to, &target.faces, &options)?;
    let seconds = start.elapsed().as_secs_f64();
    let diagonal = target.bounding_box().context("the target is empty")?.diagonal();
    let s2t = distances(&result.positions, &to, &target.faces)?;
    let t2s = distances(&to, &result.positions, &source.faces)?;
    let report = &result.report;
    println!(
        "nodes {}, steps {}, evaluations {}, {seconds:.2} s",
        result.nodes.len(),
        report.steps,
        report.evaluations
    );
    println!("s2t {:.3e}, t2s {:.3e}", rms(&s2t) / diagonal, rms(&t2s) / diagonal);
    println!("hausdorff {:.3e}", max(&s2t).max(max(&t2s)) / diagonal);
    if let Some(truth) = truth {
        let pairs = truth.iter().zip(&result.positions);
        let off: Vec<f64> = pairs
            .map(|(a, b)| (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt())
            .collect();
        println!("truth {:.3e}", rms(&off) / diagonal);
    }
    if let Some(failure) = report.failure {
        println!("not explained: {failure}");
    }
    Ok(())
}

/// Two frames of the performer, a number of nodes, and where the vertices of the first truly go.
fn performer() -> Result<Task> {
    let performer =
        Performer::new(PerformerConfig { vertices: 5_000, ..PerformerConfig::default() })?;
    let source = performer.frame(0);
    let moved = performer.transport(&source, 0, 2);
    let truth = moved.iter().map(|p| p.map(f64::from)).collect();
    Ok((source, performer.frame(2), 150, Some(truth)))
}

fn read(path: &str) -> Result<Mesh> {
    Ok(read_mesh(Path::new(path), &ReadOptions::default())?.mesh)
}

fn distances(from: &[[f64; 3]], to: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<Vec<f64>> {
    let tree = TriangleTree::new(to, faces)?;
    Ok(tree.closest_all(from).iter().map(|closest| closest.distance_squared.sqrt()).collect())
}

fn rms(distances: &[f64]) -> f64 {
    (distances.iter().map(|d| d * d).sum::<f64>() / distances.len() as f64).sqrt()
}

fn max(distances: &[f64]) -> f64 {
    distances.iter().copied().fold(0.0, f64::max)
}
