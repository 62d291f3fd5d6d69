//! The oldest Rust that dependencies ask for.

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Prints the dependencies that ask for a newer Rust than `rust-version` of the workspace.
pub(crate) fn check(root: &Path) -> Result<bool> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["metadata", "--format-version", "1", "--locked"])
        .current_dir(root)
        .output()
        .context("cargo metadata does not start")?;
    ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout)?;
    let packages = metadata["packages"].as_array().context("a list of packages")?;
    let ours = packages.iter().filter(|package| package["source"].is_null());
    let ours = ours.filter_map(|package| version(&package["rust_version"])).min();
    let ours = ours.context("no package of the workspace has a rust-version")?;
    let newer = packages.iter().filter(|p| version(&p["rust_version"]).is_some_and(|v| v > ours));
    let newer: Vec<String> = newer
        .map(|package| {
            let text = |name: &str| package[name].as_str().unwrap_or("?").to_owned();
            format!("{} {} asks for Rust {}", text("name"), text("version"), text("rust_version"))
        })
        .collect();
    newer.iter().for_each(|package| println!("{package}"));
    let [major, minor, patch] = ours;
    println!(
        "{} packages, {} newer than Rust {major}.{minor}.{patch}",
        packages.len(),
        newer.len()
    );
    Ok(newer.is_empty())
}

fn version(value: &Value) -> Option<[u32; 3]> {
    let mut parts = value.as_str()?.split('.').map(|part| part.parse().ok());
    Some([parts.next()??, parts.next().flatten().unwrap_or(0), parts.next().flatten().unwrap_or(0)])
}
