//! Items as single lines.

use quote::ToTokens;
use syn::{Attribute, Fields, Item, Meta, TraitItem, Visibility};

/// Tokens as one line, spaced as rustfmt would.
pub(crate) fn line(tokens: &impl ToTokens) -> String {
    let mut text = tokens.to_token_stream().to_string();
    for (from, to) in [
        (" :: ", "::"),
        (":: ", "::"),
        (" , ", ", "),
        (" ,", ","),
        (" : ", ": "),
        (" ;", ";"),
        ("< ", "<"),
        (" <", "<"),
        (" >", ">"),
        ("- >", "->"),
        ("->", " -> "),
        (" (", "("),
        ("( ", "("),
        (" )", ")"),
        ("& ", "&"),
        ("[ ", "["),
        (" ]", "]"),
        ("' ", "'"),
        ("  ", " "),
    ] {
        text = text.replace(from, to);
    }
    text.trim().to_owned()
}

/// Visibility and name of an item that has both.
pub(crate) fn head(item: &Item) -> Option<(&Visibility, String)> {
    let (visibility, name) = match item {
        Item::Const(item) => (&item.vis, &item.ident),
        Item::Static(item) => (&item.vis, &item.ident),
        Item::Enum(item) => (&item.vis, &item.ident),
        Item::Struct(item) => (&item.vis, &item.ident),
        Item::Union(item) => (&item.vis, &item.ident),
        Item::Trait(item) => (&item.vis, &item.ident),
        Item::Type(item) => (&item.vis, &item.ident),
        Item::Fn(item) => (&item.vis, &item.sig.ident),
        _ => return None,
    };
    Some((visibility, name.to_string()))
}

/// An item without what it holds, under the name by which it is exported.
pub(crate) fn item(item: &Item, name: &str) -> String {
    match item {
        Item::Const(item) => format!("const {name}: {}", line(&item.ty)),
        Item::Static(item) => format!("static {name}: {}", line(&item.ty)),
        Item::Type(item) => format!("type {name} = {}", line(&item.ty)),
        Item::Fn(item) => line(&item.sig),
        Item::Trait(item) => {
            format!("trait {name}{}: {}", line(&item.generics), line(&item.supertraits))
        }
        Item::Enum(item) => {
            format!("{}enum {name}{}", marks(&item.attrs), line(&item.generics))
        }
        Item::Struct(item) => {
            let fields = match &item.fields {
                Fields::Unnamed(fields) => fields_line(fields.unnamed.iter()),
                Fields::Named(_) | Fields::Unit => String::new(),
            };
            format!("{}struct {name}{}{fields}", marks(&item.attrs), line(&item.generics))
        }
        other => line(other),
    }
}

/// The parts of an item: fields, variants, methods of a trait.
pub(crate) fn parts(item: &Item) -> Vec<String> {
    match item {
        Item::Struct(item) => {
            let fields = item.fields.iter().filter(|f| matches!(f.vis, Visibility::Public(_)));
            let named =
                fields.filter_map(|f| Some(format!("{}: {}", f.ident.as_ref()?, line(&f.ty))));
            named.chain(derives(&item.attrs)).collect()
        }
        Item::Enum(item) => {
            let variants = item.variants.iter().map(|variant| {
                let mut bare = variant.clone();
                bare.attrs.clear();
                bare.fields.iter_mut().for_each(|field| field.attrs.clear());
                line(&bare)
            });
            variants.chain(derives(&item.attrs)).collect()
        }
        Item::Trait(item) => {
            let parts = item.items.iter().filter_map(|part| match part {
                TraitItem::Fn(part) => Some(line(&part.sig)),
                TraitItem::Const(part) => Some(format!("const {}: {}", part.ident, line(&part.ty))),
                TraitItem::Type(part) => Some(format!("type {}", part.ident)),
                _ => None,
            });
            parts.collect()
        }
        _ => Vec::new(),
    }
}

/// Fields of a tuple struct; a private one is `_`.
fn fields_line<'a>(fields: impl Iterator<Item = &'a syn::Field>) -> String {
    let shown = fields.map(|field| match field.vis {
        Visibility::Public(_) => line(&field.ty),
        _ => "_".to_owned(),
    });
    format!("({})", shown.collect::<Vec<_>>().join(", "))
}

fn marks(attributes: &[Attribute]) -> &'static str {
    let closed = attributes.iter().any(|attribute| attribute.path().is_ident("non_exhaustive"));
    if closed { "#[non_exhaustive] " } else { "" }
}

fn derives(attributes: &[Attribute]) -> Vec<String> {
    let lists = attributes.iter().filter_map(|attribute| match &attribute.meta {
        Meta::List(list) if list.path.is_ident("derive") => Some(list.tokens.to_string()),
        _ => None,
    });
    let names: Vec<String> = lists
        .flat_map(|list| list.split(',').map(|name| name.replace(' ', "")).collect::<Vec<_>>())
        .collect();
    names.into_iter().filter(|name| !name.is_empty()).map(|name| format!("impl {name}")).collect()
}
