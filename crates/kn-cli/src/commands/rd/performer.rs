//! Frames of a synthetic performer, generated once and kept as files.

use super::config::PerformerEntry;
use super::sequences::hex;
use crate::arguments::Global;
use crate::nearest::nearest;
use crate::output::OutputFolder;
use crate::progress;
use anyhow::{Result, bail, ensure};
use kn_io::write_mesh;
use kn_performer::{Action, Performer, PerformerConfig};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

const MOTIONS: [(&str, Action); 5] = [
    ("stand", Action::Stand),
    ("walk", Action::Walk),
    ("turn", Action::Turn),
    ("dance", Action::Dance),
    ("poses", Action::Poses),
];

/// More frames than anybody compares codecs on would fill a disk by mistake.
const MOST_FRAMES: u32 = 10_000;

/// The folder with the frames; what is already there is not generated again.
///
/// # Errors
/// A recipe out of range, a folder that cannot be written.
pub(super) fn generate(
    recipe: &PerformerEntry,
    fps: f64,
    output: &Path,
    global: &Global,
) -> Result<PathBuf> {
    ensure!((1..=MOST_FRAMES).contains(&recipe.frames), "performer: 1 to {MOST_FRAMES} frames");
    let config = configuration(recipe, fps)?;
    let version = env!("CARGO_PKG_VERSION");
    let mut digest = Sha256::new();
    digest.update(format!("{version} {config:?} {}", recipe.frames));
    let folder = output.join("performer").join(&hex(digest)[..16]);
    let name = |frame: u32| format!("f_{frame:04}.ply");
    if (0..recipe.frames).all(|frame| folder.join(name(frame)).is_file()) {
        return Ok(folder);
    }
    let performer = Performer::new(config)?;
    let bar = progress::bar(global, "generating", Some(recipe.frames.into()));
    let mut files = OutputFolder::create(&folder)?;
    for frame in 0..recipe.frames {
        write_mesh(&files.place(&name(frame)), &performer.frame(frame))?;
        bar.step();
    }
    files.publish()?;
    Ok(folder)
}

fn configuration(recipe: &PerformerEntry, fps: f64) -> Result<PerformerConfig> {
    let natural = PerformerConfig::default();
    Ok(PerformerConfig {
        seed: recipe.seed.unwrap_or(natural.seed),
        vertices: recipe.vertices.unwrap_or(natural.vertices),
        action: recipe.motion.as_deref().map_or(Ok(natural.action), action)?,
        fps,
        intensity: recipe.intensity.unwrap_or(natural.intensity),
        noise: recipe.noise.unwrap_or(natural.noise),
        holes: recipe.holes.unwrap_or(natural.holes),
        ball: recipe.ball.unwrap_or(natural.ball),
        tunic: recipe.tunic.unwrap_or(natural.tunic),
    })
}

fn action(name: &str) -> Result<Action> {
    let names = || MOTIONS.iter().map(|motion| motion.0);
    match MOTIONS.iter().find(|motion| motion.0 == name) {
        Some(&(_, action)) => Ok(action),
        None => bail!(
            "performer: there is no motion '{name}'{} (there are {})",
            nearest(name, names()),
            names().collect::<Vec<_>>().join(", ")
        ),
    }
}
