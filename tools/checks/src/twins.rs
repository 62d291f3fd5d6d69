//! Types that two crates define alike.

use crate::render::line;
use crate::source::{self, Module};
use anyhow::{Context, Result};
use std::path::Path;
use syn::{Item, Visibility};

/// The properties by which two types are compared.
struct Shape {
    place: String,
    name: String,
    /// Names of variants, or names and types of fields.
    parts: Vec<String>,
    is_enum: bool,
}

/// Pairs of types in two crates that look like copies of one another: enumerations with the same
/// variants (two or more), structures with the same fields and types (three or more), and types of
/// one name that share more than half of theirs. kn-conform is left out: it holds a second reading
/// of the specification that shares no code with the codec on purpose.
pub(crate) fn find(root: &Path) -> Result<Vec<String>> {
    let mut shapes = Vec::new();
    for folder in source::crates(root)? {
        let name = folder.file_name().context("a named folder")?.to_string_lossy().into_owned();
        if name != "kn-conform" {
            collect(&source::read_crate(&folder)?, &name, &mut shapes);
        }
    }
    let mut twins = Vec::new();
    for (number, a) in shapes.iter().enumerate() {
        let others = shapes[number + 1..].iter().filter(|b| a.place != b.place && alike(a, b));
        twins
            .extend(others.map(|b| format!("{}::{} and {}::{}", a.place, a.name, b.place, b.name)));
    }
    Ok(twins)
}

fn collect(module: &Module, place: &str, shapes: &mut Vec<Shape>) {
    for module in module.all() {
        for item in &module.items {
            let (name, visible, parts, is_enum) = match item {
                Item::Enum(item) => {
                    let parts = item.variants.iter().map(|variant| variant.ident.to_string());
                    (&item.ident, &item.vis, parts.collect(), true)
                }
                Item::Struct(item) => {
                    let parts = item
                        .fields
                        .iter()
                        .filter_map(|f| Some(format!("{}: {}", f.ident.as_ref()?, line(&f.ty))));
                    (&item.ident, &item.vis, parts.collect(), false)
                }
                _ => continue,
            };
            // A private type cannot be what another crate ought to have used.
            if !matches!(visible, Visibility::Inherited) {
                shapes.push(Shape { place: place.into(), name: name.to_string(), parts, is_enum });
            }
        }
    }
}

fn alike(a: &Shape, b: &Shape) -> bool {
    let common = a.parts.iter().filter(|part| b.parts.contains(part)).count();
    let all = a.parts.len().max(b.parts.len());
    let enough = if a.is_enum { 2 } else { 3 };
    let same_parts = a.is_enum == b.is_enum && common == all && all >= enough;
    same_parts || (a.name == b.name && 2 * common > all)
}

#[cfg(test)]
mod tests {
    use super::{alike, collect};
    use crate::source::from_text;

    /// Whether the first types of two crates are twins.
    fn twins(a: &str, b: &str) -> bool {
        let mut shapes = Vec::new();
        collect(&from_text(a), "a", &mut shapes);
        collect(&from_text(b), "b", &mut shapes);
        alike(&shapes[0], &shapes[1])
    }

    #[test]
    fn copies_are_found_under_other_names() {
        assert!(twins("pub enum Mode { Near, Far }", "pub(crate) enum ModeArgument { Far, Near }"));
        assert!(twins(
            "pub struct P { x: u8, y: u8, z: u8 }",
            "pub struct Q { x: u8, y: u8, z: u8 }"
        ));
    }

    #[test]
    fn different_types_are_none() {
        assert!(!twins("pub enum Mode { Near, Far }", "pub enum Mode { On, Off }"));
        assert!(!twins(
            "pub struct P { x: u8, y: u8, z: u8 }",
            "pub struct Q { x: f64, y: f64, z: f64 }"
        ));
    }
}
