//! Writes frames of the synthetic performer as OBJ files with labels beside them, for measuring.
//!
//! `cargo run --release -p kn-lab -- performer-frames FOLDER ACTION FRAMES [SEED [VERTICES]]`

use anyhow::{Result, bail};
use kn_mesh::Mesh;
use kn_performer::{Action, Performer, PerformerConfig};
use std::fmt::Write as _;
use std::path::Path;

pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let [folder, action, frames, rest @ ..] = arguments else {
        bail!("usage: performer-frames FOLDER ACTION FRAMES [SEED [VERTICES]]");
    };
    let mut config = PerformerConfig { action: action_of(action)?, ..Default::default() };
    if let Some(seed) = rest.first() {
        config.seed = seed.parse()?;
    }
    if let Some(vertices) = rest.get(1) {
        config.vertices = vertices.parse()?;
    }
    let performer = Performer::new(config)?;
    std::fs::create_dir_all(folder)?;
    for index in 0..frames.parse()? {
        let name = Path::new(folder).join(format!("frame_{index:04}"));
        write_frame(&performer.frame(index), &name)?;
    }
    Ok(())
}

fn action_of(name: &str) -> Result<Action> {
    match name {
        "stand" => Ok(Action::Stand),
        "walk" => Ok(Action::Walk),
        "turn" => Ok(Action::Turn),
        "dance" => Ok(Action::Dance),
        "poses" => Ok(Action::Poses),
        _ => bail!("{name} is no action: stand, walk, turn, dance or poses"),
    }
}

fn write_frame(mesh: &Mesh, name: &Path) -> Result<()> {
    let (mut obj, mut labels) = (String::new(), String::new());
    for [x, y, z] in &mesh.positions {
        writeln!(obj, "v {x} {y} {z}")?;
    }
    for face in &mesh.faces {
        let [a, b, c] = face.map(|v| v + 1);
        writeln!(obj, "f {a} {b} {c}")?;
    }
    for label in &mesh.labels {
        writeln!(labels, "{label}")?;
    }
    std::fs::write(name.with_extension("obj"), obj)?;
    std::fs::write(name.with_extension("labels"), labels)?;
    Ok(())
}
