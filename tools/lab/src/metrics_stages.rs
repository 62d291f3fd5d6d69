//! CPU milliseconds of each stage of MSDM2 and of the closest points, fastest of ten runs:
//! `cargo run --release -p kn-lab -- metrics-stages [REFERENCE OTHER]`.
//!
//! Without arguments two frames of the performer are compared.

use crate::clock::cpu_seconds;
use anyhow::Result;
use std::path::Path;
use std::time::Instant;

use kn_io::{ReadOptions, read_mesh};
use kn_metrics::{DEFAULT_LEVELS, Interpolation, Msdm2Surface, TriangleTree, msdm2};
use kn_performer::{Performer, PerformerConfig};

const RUNS: usize = 10;

type Mesh = (Vec<[f64; 3]>, Vec<[u32; 3]>);

pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let [a, b] = meshes(arguments)?;
    println!("{} and {} vertices, {} threads", a.0.len(), b.0.len(), rayon::current_num_threads());
    println!("stage                      CPU ms   wall ms");
    let surface = |mesh: &Mesh| Msdm2Surface::new(&mesh.0, &mesh.1, DEFAULT_LEVELS);
    let (first, second) = report("prepare both for MSDM2", || (surface(&a), surface(&b)));
    let (first, second) = (first?, second?);
    let score = report("MSDM2, prepared", || msdm2(&first, &second, Interpolation::AtVertex));
    report("MSDM2, all", || {
        let (first, second) = rayon::join(|| surface(&a), || surface(&b));
        first.and_then(|first| Ok(msdm2(&first, &second?, Interpolation::AtVertex).symmetric))
    })?;
    let tree = report("one tree", || TriangleTree::new(&b.0, &b.1))?;
    report("closest points, all", || tree.closest_all(&a.0).len());
    println!("MSDM2 {:.6}", score.symmetric);
    Ok(())
}

fn meshes(arguments: &[String]) -> Result<[Mesh; 2]> {
    let meshes = if let [a, b] = arguments {
        let read = |path: &String| read_mesh(Path::new(path), &ReadOptions::default());
        [read(a)?.mesh, read(b)?.mesh]
    } else {
        let performer = Performer::new(PerformerConfig::default())?;
        [performer.frame(0), performer.frame(1)]
    };
    Ok(meshes.map(|mesh| (mesh.positions, mesh.faces)))
}

/// Runs a stage and prints its least CPU and wall times; returns the last result.
fn report<T>(name: &str, mut run: impl FnMut() -> T) -> T {
    let (mut cpu, mut wall) = (f64::INFINITY, f64::INFINITY);
    let mut timed = || {
        let (cpu_start, start) = (cpu_seconds(), Instant::now());
        let result = run();
        cpu = cpu.min(cpu_seconds() - cpu_start);
        wall = wall.min(start.elapsed().as_secs_f64());
        result
    };
    (1..RUNS).for_each(|_| drop(timed()));
    let result = timed();
    println!("{name:<25} {:>8.1} {:>9.1}", 1e3 * cpu, 1e3 * wall);
    result
}
