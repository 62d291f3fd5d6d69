//! The public items of a crate, one line each.

use crate::render::{self, line};
use crate::source::Module;
use std::collections::BTreeSet;
use syn::{ImplItem, Item, UseTree, Visibility};

/// Lists a crate's public items under the paths by which others name them.
///
/// Re-exports of the crate's own items are followed; those of other crates are listed as they
/// stand. Implementations are attributed to types by name.
pub(crate) fn list(root: &Module) -> BTreeSet<String> {
    let mut listing = Listing { root, lines: BTreeSet::new() };
    listing.module(root, &root.name);
    listing.lines
}

struct Listing<'a> {
    root: &'a Module,
    lines: BTreeSet<String>,
}

impl<'a> Listing<'a> {
    fn module(&mut self, module: &'a Module, path: &str) {
        for item in &module.items {
            match item {
                Item::Use(item) if is_public(&item.vis) => {
                    self.reexport(module, &item.tree, &mut Vec::new(), path);
                }
                Item::Macro(item)
                    if item.attrs.iter().any(|a| a.path().is_ident("macro_export")) =>
                {
                    let name = item.ident.as_ref().map(ToString::to_string).unwrap_or_default();
                    self.lines.insert(format!("{}: macro {name}", self.root.name));
                }
                item => self.item(item, path, None),
            }
        }
        for child in module.modules.iter().filter(|child| child.public) {
            self.lines.insert(format!("{path}: mod {}", child.name));
            self.module(child, &format!("{path}::{}", child.name));
        }
    }

    /// One item that is no re-export, with what belongs to it.
    fn item(&mut self, item: &Item, path: &str, alias: Option<&str>) {
        let Some((visibility, name)) = render::head(item) else { return };
        if !is_public(visibility) {
            return;
        }
        let shown = alias.unwrap_or(&name);
        self.lines.insert(format!("{path}: {}", render::item(item, shown)));
        let path = format!("{path}::{shown}");
        self.lines.extend(render::parts(item).iter().map(|part| format!("{path}: {part}")));
        if matches!(item, Item::Struct(_) | Item::Enum(_)) {
            self.implementations(&name, &path);
        }
    }

    fn implementations(&mut self, name: &str, path: &str) {
        for module in self.root.all() {
            for item in &module.items {
                if names_in_macro(item, name) {
                    let traits = ["Display", "FromStr", "Named"];
                    self.lines.extend(traits.map(|of_trait| format!("{path}: impl {of_trait}")));
                }
                let Item::Impl(item) = item else { continue };
                let syn::Type::Path(of) = item.self_ty.as_ref() else { continue };
                if of.path.segments.last().is_none_or(|last| last.ident != name) {
                    continue;
                }
                if let Some((_, of_trait, _)) = &item.trait_ {
                    self.lines.insert(format!("{path}: impl {}", line(of_trait)));
                    continue;
                }
                self.lines.extend(item.items.iter().filter_map(|part| match part {
                    ImplItem::Fn(part) if is_public(&part.vis) => {
                        Some(format!("{path}: {}", line(&part.sig)))
                    }
                    ImplItem::Const(part) if is_public(&part.vis) => {
                        Some(format!("{path}: const {}: {}", part.ident, line(&part.ty)))
                    }
                    _ => None,
                }));
            }
        }
    }

    /// Follows one `pub use` of `module` to what it names.
    fn reexport(
        &mut self,
        module: &'a Module,
        tree: &UseTree,
        before: &mut Vec<String>,
        path: &str,
    ) {
        match tree {
            UseTree::Path(part) => {
                before.push(part.ident.to_string());
                self.reexport(module, &part.tree, before, path);
                before.pop();
            }
            UseTree::Group(group) => {
                for tree in &group.items {
                    self.reexport(module, tree, before, path);
                }
            }
            UseTree::Name(name) => self.named(module, before, &name.ident.to_string(), None, path),
            UseTree::Rename(name) => {
                let alias = name.rename.to_string();
                self.named(module, before, &name.ident.to_string(), Some(&alias), path);
            }
            UseTree::Glob(_) => match self.find(module, before) {
                Some(of) => self.module(of, path),
                None => {
                    self.lines.insert(format!("{path}: use {}::*", before.join("::")));
                }
            },
        }
    }

    fn named(
        &mut self,
        at: &'a Module,
        before: &[String],
        name: &str,
        alias: Option<&str>,
        path: &str,
    ) {
        let Some(of) = self.find(at, before) else {
            let alias = alias.map(|alias| format!(" as {alias}")).unwrap_or_default();
            self.lines.insert(format!("{path}: use {}::{name}{alias}", before.join("::")));
            return;
        };
        if let Some(child) = of.child(name) {
            self.lines.insert(format!("{path}: mod {name}"));
            self.module(child, &format!("{path}::{name}"));
        }
        for item in &of.items {
            match item {
                Item::Use(item) if !matches!(item.vis, Visibility::Inherited) => {
                    self.through(of, &item.tree, &mut Vec::new(), (name, alias, path));
                }
                item if render::head(item).is_some_and(|(_, found)| found == name) => {
                    self.item(item, path, alias);
                }
                _ => {}
            }
        }
    }

    /// Looks for a name among the re-exports of a module that is itself re-exported from.
    fn through(
        &mut self,
        module: &'a Module,
        tree: &UseTree,
        before: &mut Vec<String>,
        wanted: (&str, Option<&str>, &str),
    ) {
        let (name, alias, path) = wanted;
        match tree {
            UseTree::Path(part) => {
                before.push(part.ident.to_string());
                self.through(module, &part.tree, before, wanted);
                before.pop();
            }
            UseTree::Group(group) => {
                group.items.iter().for_each(|tree| self.through(module, tree, before, wanted));
            }
            UseTree::Name(found) if found.ident == name => {
                self.named(module, before, name, alias, path);
            }
            UseTree::Rename(found) if found.rename == name => {
                let shown = alias.unwrap_or(name);
                self.named(module, before, &found.ident.to_string(), Some(shown), path);
            }
            _ => {}
        }
    }

    /// The module of the crate that a path names, seen from `from`.
    fn find(&self, from: &'a Module, path: &[String]) -> Option<&'a Module> {
        let (start, rest) = match path.first().map(String::as_str) {
            Some("crate") => (self.root, &path[1..]),
            Some("self") => (from, &path[1..]),
            _ => (from, path),
        };
        rest.iter().try_fold(start, |module, name| module.child(name))
    }
}

/// Whether an item is a call of `impl_named!` for the type.
fn names_in_macro(item: &Item, name: &str) -> bool {
    let Item::Macro(item) = item else { return false };
    let is_named = item.mac.path.segments.last().is_some_and(|last| last.ident == "impl_named");
    let mut tokens = item.mac.tokens.clone().into_iter();
    is_named && tokens.any(|token| token.to_string() == name)
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

#[cfg(test)]
mod tests {
    use super::list;
    use crate::source::from_text;

    #[test]
    fn what_others_can_name_is_listed() {
        let module = from_text(
            "mod hidden { pub struct Shown { pub a: u8, b: u8 } impl Shown { pub fn get(&self) -> u8 { 0 } fn no() {} }
               #[non_exhaustive] pub enum Choice { One, Two(u8) } pub struct Unseen; pub use inner::Deep;
               mod inner { pub struct Deep; } }
             pub mod open { pub const LIMIT: u32 = 1; pub(crate) fn internal() {} }
             pub use hidden::{Choice as Chosen, Deep, Shown};
             pub use other::Thing;
             #[cfg(test)] pub mod tests { pub fn test() {} }",
        );
        let lines: Vec<String> = list(&module).into_iter().collect();
        assert_eq!(
            lines,
            [
                "krate: #[non_exhaustive] enum Chosen",
                "krate: mod open",
                "krate: struct Deep",
                "krate: struct Shown",
                "krate: use other::Thing",
                "krate::Chosen: One",
                "krate::Chosen: Two(u8)",
                "krate::Shown: a: u8",
                "krate::Shown: fn get(&self) -> u8",
                "krate::open: const LIMIT: u32",
            ]
        );
    }
}
