//! `kn register` beside the best registration peers: distances, CPU seconds, growth.
//!
//! `cargo build --release && cargo run --release -p kn-lab -- registration-table [RUNS]`
//!
//! Every pair of `KN_DATA/pairs` (`docs/data.md`) is registered by the whole process, with the
//! number of nodes of `spare_coarse_r5`, so many times (3). In brackets stands what is asked for:
//! of the distances (1e-4 of the diagonal) the better of `spare_coarse_r5` and `proto_q4` on that
//! pair, of CPU seconds a third of the former's, at most half a second, of the growth from 10 k to
//! 40 k vertices four times. Seconds are the least of all runs, in hundredths; other work on the
//! machine adds to them.

use anyhow::{Context, Result, ensure};
use kn_io::{ReadOptions, read_mesh, write_mesh};
use kn_performer::{Performer, PerformerConfig};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

const PEERS: [&str; 2] = ["spare_coarse_r5", "proto_q4"];
/// Columns of the peers' table, and the fields of `kn register --json` that they bound.
const DISTANCES: [(&str, &str); 3] =
    [("s2t_rms_e4", "s2t"), ("t2s_rms_e4", "t2s"), ("gt_rmse_e4", "truth")];
/// Ticks of `/proc` a second.
const TICKS: f64 = 100.0;

/// One pair to register.
struct Pair {
    name: String,
    folder: PathBuf,
    nodes: usize,
    /// Bounds of the three distances; not a number where there is no truth.
    distances: [f64; 3],
    cpu: f64,
}

/// The result of a registration.
struct Measured {
    json: serde_json::Value,
    cpu: f64,
    wall: f64,
    stretch: f64,
}

pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let runs = arguments.first().map_or(Ok(3), |text| text.parse())?;
    let scratch = tempfile::tempdir()?;
    if let Some(folder) = kn_testdata::data("pairs") {
        println!("| pair | nodes | s2t | t2s | truth | steps | CPU s | wall / CPU | stretch |");
        println!("|---|---|---|---|---|---|---|---|---|");
        for pair in pairs(&folder)? {
            print_pair(&pair, &register(&pair.folder, pair.nodes, runs, scratch.path())?);
        }
    }
    let [small, large] = [10_000, 40_000].map(|vertices| -> Result<f64> {
        let folder = scratch.path().join(vertices.to_string());
        write_performers(&folder, vertices)?;
        Ok(register(&folder, 200, runs, scratch.path())?.cpu)
    });
    let (small, large) = (small?, large?);
    println!("\n10 k vertices {small:.2} CPU s, 40 k {large:.2}: {:.2} (4) times", large / small);
    Ok(())
}

/// The pairs with their bounds.
fn pairs(folder: &Path) -> Result<Vec<Pair>> {
    let table = std::fs::read_to_string(kn_testdata::peers("registration.csv"))?;
    let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().context("an empty table")?;
    let column = |name: &str| head.iter().position(|title| *title == name).context("a column");
    let rows: Vec<Vec<&str>> = lines.filter(|row| PEERS.contains(&row[1])).collect();
    let number = |row: &[&str], name: &str| -> Result<f64> { Ok(row[column(name)?].parse()?) };
    let mut pairs = Vec::new();
    for row in rows.iter().filter(|row| row[1] == PEERS[0]) {
        let same = || rows.iter().filter(|other| other[0] == row[0]);
        let best = |(name, _): (&str, &str)| -> Result<f64> {
            same().map(|row| number(row, name)).try_fold(f64::NAN, |best, v| Ok(best.min(v?)))
        };
        let [s2t, t2s, truth] = DISTANCES.map(best);
        pairs.push(Pair {
            name: row[0].into(),
            folder: folder.join(row[0]),
            nodes: number(row, "nodes")? as usize,
            distances: [s2t?, t2s?, truth?],
            cpu: (number(row, "cpu_s_min")? / 3.0).min(0.5),
        });
    }
    Ok(pairs)
}

/// Two frames of the performer.
fn write_performers(folder: &Path, vertices: usize) -> Result<()> {
    std::fs::create_dir_all(folder)?;
    let performer = Performer::new(PerformerConfig { vertices, ..PerformerConfig::default() })?;
    for (index, name) in [(0, "source.obj"), (1, "target.obj")] {
        write_mesh(&folder.join(name), &performer.frame(index))?;
    }
    Ok(())
}

/// Runs `kn register` on a folder with `source.obj`, `target.obj` and perhaps `truth.obj`.
fn register(folder: &Path, nodes: usize, runs: usize, scratch: &Path) -> Result<Measured> {
    let program = std::env::current_exe()?;
    let program = program.parent().context("a folder above")?.join("kn");
    ensure!(program.exists(), "{} is missing: cargo build --release", program.display());
    let (source, out) = (folder.join("source.obj"), scratch.join("out.obj"));
    let mut command = Command::new(program);
    command.arg("register").arg(&source).arg(folder.join("target.obj")).arg("-o").arg(&out);
    command.args(["--json", "--quiet", "--nodes", &nodes.to_string()]);
    if folder.join("truth.obj").exists() {
        command.arg("--truth").arg(folder.join("truth.obj"));
    }
    let (mut cpu, mut wall, mut json) = (f64::INFINITY, f64::INFINITY, Vec::new());
    for _ in 0..runs.max(1) {
        let (before, start) = (children_seconds(), Instant::now());
        let output = command.output()?;
        ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        wall = wall.min(start.elapsed().as_secs_f64());
        cpu = cpu.min(children_seconds() - before);
        json = output.stdout;
    }
    let json = serde_json::from_slice(&json)?;
    Ok(Measured { json, cpu, wall, stretch: largest_stretch(&source, &out)? })
}

/// CPU seconds of all processes that have been waited for; not a number but on Linux.
fn children_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The name, in brackets, may have spaces.
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or("").split_whitespace().collect();
    let ticks = |index: usize| fields.get(index).and_then(|text| text.parse::<f64>().ok());
    (ticks(13).unwrap_or(f64::NAN) + ticks(14).unwrap_or(f64::NAN)) / TICKS
}

/// By how much the edge that grew most has grown; edges of less than a thousandth of the diagonal
/// stand for rounding, not for a shape.
fn largest_stretch(source: &Path, out: &Path) -> Result<f64> {
    let source = read_mesh(source, &ReadOptions::default())?.mesh;
    let out = read_mesh(out, &ReadOptions::default())?.mesh;
    let least = 1e-3 * source.bounding_box().context("no vertices")?.diagonal();
    let length = |positions: &[[f64; 3]], a: u32, b: u32| {
        let (a, b) = (positions[a as usize], positions[b as usize]);
        (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
    };
    let edges = source.faces.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let growth = edges
        .map(|(a, b)| length(&out.positions, a, b) / length(&source.positions, a, b).max(least));
    Ok(growth.fold(0.0, f64::max))
}

fn print_pair(pair: &Pair, measured: &Measured) {
    let distances = DISTANCES.iter().zip(pair.distances).map(|((_, field), bound)| {
        let value = measured.json[field].as_f64();
        value.map_or(String::new(), |value| format!("{:.2} ({bound:.2})", 1e4 * value))
    });
    let distances: Vec<String> = distances.collect();
    println!(
        "| {} | {} | {} | {} | {:.2} ({:.2}) | {:.2} | {:.2} |",
        pair.name,
        pair.nodes,
        distances.join(" | "),
        measured.json["iterations"],
        measured.cpu,
        pair.cpu,
        measured.wall / measured.cpu,
        measured.stretch
    );
}
