//! Crates as trees of modules.

use anyhow::{Context, Result};
use std::path::{Path, PathBuf};
use syn::{Item, Visibility};

/// A module with its own modules apart.
pub(crate) struct Module {
    pub(crate) name: String,
    pub(crate) public: bool,
    /// Everything but modules and what is compiled for tests only.
    pub(crate) items: Vec<Item>,
    pub(crate) modules: Vec<Module>,
}

impl Module {
    /// The child of that name.
    pub(crate) fn child(&self, name: &str) -> Option<&Module> {
        self.modules.iter().find(|module| module.name == name)
    }

    /// This module and all below it.
    pub(crate) fn all(&self) -> Vec<&Module> {
        let below = self.modules.iter().flat_map(Module::all);
        std::iter::once(self).chain(below).collect()
    }
}

/// The members of the workspace at `root` that have a library or a binary, by folder.
pub(crate) fn crates(root: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for group in ["crates", "tools"] {
        let Ok(entries) = std::fs::read_dir(root.join(group)) else { continue };
        for entry in entries {
            let folder = entry?.path();
            if folder.join("Cargo.toml").exists() {
                found.push(folder);
            }
        }
    }
    found.sort();
    Ok(found)
}

/// The module tree of a crate's library, or of its binary where it has no library.
pub(crate) fn read_crate(folder: &Path) -> Result<Module> {
    let source = folder.join("src");
    let library = source.join("lib.rs");
    let root = if library.exists() { library } else { source.join("main.rs") };
    let name = folder.file_name().context("a folder with a name")?.to_string_lossy();
    read_module(&root, &source, name.replace('-', "_"), true)
}

/// `folder` is where the files of its modules are.
fn read_module(file: &Path, folder: &Path, name: String, public: bool) -> Result<Module> {
    let text = std::fs::read_to_string(file).with_context(|| file.display().to_string())?;
    let syntax = syn::parse_file(&text).with_context(|| file.display().to_string())?;
    from_items(syntax.items, folder, name, public)
}

fn from_items(items: Vec<Item>, folder: &Path, name: String, public: bool) -> Result<Module> {
    let mut module = Module { name, public, items: Vec::new(), modules: Vec::new() };
    for item in items {
        match item {
            Item::Mod(child) if is_for_tests(&child.attrs) => {}
            Item::Mod(child) => {
                let name = child.ident.to_string();
                let public = matches!(child.vis, Visibility::Public(_));
                let below = folder.join(&name);
                module.modules.push(match child.content {
                    Some((_, items)) => from_items(items, &below, name, public)?,
                    None => read_module(&file_of(folder, &name), &below, name, public)?,
                });
            }
            item => module.items.push(item),
        }
    }
    Ok(module)
}

fn file_of(folder: &Path, name: &str) -> PathBuf {
    let file = folder.join(format!("{name}.rs"));
    if file.exists() { file } else { folder.join(name).join("mod.rs") }
}

/// Whether `#[cfg(test)]` is among the attributes.
pub(crate) fn is_for_tests(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute.parse_args::<syn::Path>().is_ok_and(|path| path.is_ident("test"))
    })
}

/// All Rust files below a folder, but not those of `target` folders, in order.
pub(crate) fn rust_files(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let Ok(entries) = std::fs::read_dir(folder) else { return Ok(files) };
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() && !path.ends_with("target") && !path.ends_with(".git") {
            files.extend(rust_files(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// A crate called `krate` that is one text.
#[cfg(test)]
pub(crate) fn from_text(text: &str) -> Module {
    let items = syn::parse_file(text).expect("Rust").items;
    from_items(items, Path::new(""), "krate".into(), true).expect("no files")
}
