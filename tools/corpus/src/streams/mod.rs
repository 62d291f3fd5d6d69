//! Makes `spec/conformance` anew: `cargo run --release -p kn-corpus -- streams`.
//!
//! Core streams come from the encoder. Uncommon and faulty ones are texts, written here by hand or
//! made from a sound text by a few edits, and assembled by the syntax tables. Expected frames are
//! those of our decoder, stages those of the literal one.

mod core_streams;
mod core_translations;
mod decisions;
mod faulty;
mod faulty_conquests;
mod faulty_meshes;
mod faulty_motion;
mod meshes;
mod shapes;
mod texts;
mod uncommon;
mod uncommon_labels;
mod uncommon_last_bits;
mod uncommon_meshes;
mod uncommon_motion;
mod uncommon_paths;
mod uncommon_readings;
mod uncommon_smoothing;

use std::path::Path;

use anyhow::{Result, bail};
use kn_conform::{Description, Outcome, Spec, node_labels, run_ours_on};

/// A stream to be: its text and what it is about.
#[derive(Clone)]
struct Draft {
    name: String,
    text: String,
    danger: String,
    /// The rule that it breaks; none for a sound stream.
    rule: Option<&'static str>,
    covers: &'static [&'static str],
}

/// Writes the corpus of the checkout at `root`.
pub(crate) fn write(root: &Path) -> Result<()> {
    let spec_folder = root.join("spec");
    let spec = Spec::load(&spec_folder)?;
    let corpus = spec_folder.join("conformance");
    let folders = [
        ("core", core_streams::drafts(&spec)?),
        ("uncommon", uncommon_drafts()?),
        ("faulty", faulty_drafts()?),
    ];
    let mut failures = Vec::new();
    for (folder, drafts) in folders {
        let folder = corpus.join(folder);
        if folder.exists() {
            std::fs::remove_dir_all(&folder)?;
        }
        std::fs::create_dir_all(&folder)?;
        for draft in drafts {
            if let Err(error) = write_stream(&spec, &folder, &draft) {
                failures.push(format!("{}: {error}", draft.name));
            }
        }
    }
    if failures.is_empty() { Ok(()) } else { bail!("{}", failures.join("\n")) }
}

fn uncommon_drafts() -> Result<Vec<Draft>> {
    let lists = [
        uncommon::drafts()?,
        uncommon_labels::drafts()?,
        uncommon_last_bits::drafts()?,
        uncommon_meshes::drafts()?,
        uncommon_motion::drafts()?,
        uncommon_paths::drafts()?,
        uncommon_readings::drafts()?,
        uncommon_smoothing::drafts()?,
    ];
    Ok(lists.concat())
}

fn faulty_drafts() -> Result<Vec<Draft>> {
    Ok([faulty::drafts()?, faulty_meshes::drafts()?, uncommon_motion::faulty()?].concat())
}

/// Writes a stream's three files, if our decoder finds of it what the draft says.
fn write_stream(spec: &Spec, folder: &Path, draft: &Draft) -> Result<()> {
    let stream = spec.assemble(&draft.text, &node_labels)?;
    let path = folder.join(&draft.name).with_extension("knm");
    std::fs::write(&path, &stream)?;
    std::fs::write(path.with_extension("txt"), &draft.text)?;
    let frames = match (run_ours_on(&path), draft.rule) {
        (Outcome::Frames(frames), None) => frames,
        (Outcome::Refused { rule, .. }, Some(expected)) if rule.as_deref() == Some(expected) => {
            Vec::new()
        }
        (outcome, _) => bail!("not as expected: {outcome:?}"),
    };
    let stages = match draft.rule {
        None => spec.reconstruct(&stream)?.stages,
        Some(_) => Vec::new(),
    };
    let description = Description {
        danger: draft.danger.clone(),
        covers: draft.covers.iter().map(|&id| id.to_owned()).collect(),
        rule: draft.rule.map(str::to_owned),
        frames,
        stages,
    };
    let json = serde_json::to_string_pretty(&description)? + "\n";
    std::fs::write(path.with_extension("json"), json)?;
    Ok(())
}
