//! The public items of the published crates against the list that is checked in.

use crate::{public, source};
use anyhow::{Context, Result};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const LISTS: &str = "docs/api";

/// Prints what was added and removed since the lists were accepted. `false` where anything was.
pub(crate) fn check(root: &Path) -> Result<bool> {
    let mut sound = true;
    for (name, items) in current(root)? {
        let accepted = std::fs::read_to_string(list_of(root, &name)).unwrap_or_default();
        let accepted: BTreeSet<String> = accepted.lines().map(str::to_owned).collect();
        for gone in accepted.difference(&items) {
            println!("- {gone}");
        }
        for new in items.difference(&accepted) {
            println!("+ {new}");
        }
        let same = accepted == items;
        sound &= same;
        println!("{name}: {} public items{}", items.len(), if same { "" } else { ", changed" });
    }
    let stale = stale(root)?;
    for file in &stale {
        println!("{}: no such crate", file.display());
    }
    if !(sound && stale.is_empty()) {
        println!(
            "The public API differs from {LISTS}. If this is meant: cargo run -p kn-checks -- api \
             --accept, commit the lists, and say in CHANGELOG.md what changed."
        );
    }
    Ok(sound && stale.is_empty())
}

/// Writes the lists.
pub(crate) fn accept(root: &Path) -> Result<bool> {
    std::fs::create_dir_all(root.join(LISTS))?;
    for file in stale(root)? {
        std::fs::remove_file(&file)?;
    }
    for (name, items) in current(root)? {
        let mut text: Vec<String> = items.into_iter().collect();
        text.push(String::new());
        let file = list_of(root, &name);
        std::fs::write(&file, text.join("\n")).with_context(|| file.display().to_string())?;
    }
    Ok(true)
}

fn list_of(root: &Path, name: &str) -> PathBuf {
    root.join(LISTS).join(format!("{name}.txt"))
}

/// The libraries that are published, with their items.
fn current(root: &Path) -> Result<Vec<(String, BTreeSet<String>)>> {
    let folders = source::crates(root)?.into_iter().filter(|folder| is_published(folder));
    folders
        .map(|folder| {
            let name = folder.file_name().context("a named folder")?.to_string_lossy().into_owned();
            Ok((name, public::list(&source::read_crate(&folder)?)))
        })
        .collect()
}

fn is_published(folder: &Path) -> bool {
    let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap_or_default();
    folder.join("src/lib.rs").exists() && !manifest.lines().any(|line| line == "publish = false")
}

/// Lists of crates that are no longer there.
fn stale(root: &Path) -> Result<Vec<PathBuf>> {
    let names: BTreeSet<String> = current(root)?.into_iter().map(|(name, _)| name).collect();
    let Ok(entries) = std::fs::read_dir(root.join(LISTS)) else { return Ok(Vec::new()) };
    let mut files = Vec::new();
    for entry in entries {
        let file = entry?.path();
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if !names.contains(&name) {
            files.push(file);
        }
    }
    Ok(files)
}
