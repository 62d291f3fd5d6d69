//! Figures of the structure of a checkout.

use crate::{public, source, twins};
use anyhow::{Context, Result};
use std::path::Path;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};

/// The most lines of a file and of a function, the most parameters of a function.
const FILE_LINES: usize = 400;
const FUNCTION_LINES: usize = 50;
const PARAMETERS: usize = 6;

/// Prints the figures of a checkout. `false` where a function has too many parameters or a type has
/// a twin. Lengths are printed only: a file in one piece can be right.
pub(crate) fn print(root: &Path) -> Result<bool> {
    print_crates(root)?;
    let (mut long, mut functions) = (Vec::new(), Functions::default());
    for file in source::rust_files(root)? {
        let text = std::fs::read_to_string(&file)?;
        let name = file.strip_prefix(root).unwrap_or(&file).display().to_string();
        let lines = text.lines().count();
        if lines > FILE_LINES {
            long.push(format!("{name}: {lines}"));
        }
        name.clone_into(&mut functions.file);
        functions.visit_file(&syn::parse_file(&text).with_context(|| name)?);
    }
    let twins = twins::find(root)?;
    print_list(&format!("files over {FILE_LINES} lines"), &long);
    print_list(&format!("functions with more than {PARAMETERS} parameters"), &functions.wide);
    print_list("types with a twin", &twins);
    println!("functions over {FUNCTION_LINES} lines: {}", functions.long);
    Ok(functions.wide.is_empty() && twins.is_empty())
}

fn print_crates(root: &Path) -> Result<()> {
    println!("| crate | lines of src | lines of tests | public items |");
    println!("|---|---|---|---|");
    let mut sums = [0; 3];
    for folder in source::crates(root)? {
        let name = folder.strip_prefix(root).unwrap_or(&folder).display();
        let items = public::list(&source::read_crate(&folder)?);
        let items = items.iter().filter(|line| !line.contains(": impl ")).count();
        let all = lines(&folder)?;
        let code = lines(&folder.join("src"))?;
        println!("| {name} | {code} | {} | {items} |", all - code);
        for (sum, value) in sums.iter_mut().zip([code, all - code, items]) {
            *sum += value;
        }
    }
    println!("| sum | {} | {} | {} |", sums[0], sums[1], sums[2]);
    Ok(())
}

/// Lines of all Rust files below a folder.
fn lines(folder: &Path) -> Result<usize> {
    let files = source::rust_files(folder)?;
    files.iter().map(|file| Ok(std::fs::read_to_string(file)?.lines().count())).sum()
}

fn print_list(what: &str, found: &[String]) {
    println!("{what}: {}", found.len());
    found.iter().for_each(|line| println!("  {line}"));
}

/// Looks at each function of a file.
#[derive(Default)]
struct Functions {
    file: String,
    /// Those with too many parameters. A receiver (`self`) is no parameter.
    wide: Vec<String>,
    long: usize,
}

impl Functions {
    fn look(&mut self, signature: &syn::Signature, body: &impl Spanned) {
        let parameters = signature.inputs.len() - usize::from(signature.receiver().is_some());
        let start = signature.span().start().line;
        if parameters > PARAMETERS {
            self.wide.push(format!("{}:{start} {}: {parameters}", self.file, signature.ident));
        }
        self.long += usize::from(body.span().end().line + 1 - start > FUNCTION_LINES);
    }
}

impl<'ast> Visit<'ast> for Functions {
    fn visit_item_fn(&mut self, function: &'ast syn::ItemFn) {
        self.look(&function.sig, &function.block);
        visit::visit_item_fn(self, function);
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        self.look(&function.sig, &function.block);
        visit::visit_impl_item_fn(self, function);
    }

    fn visit_trait_item_fn(&mut self, function: &'ast syn::TraitItemFn) {
        self.look(&function.sig, &function);
        visit::visit_trait_item_fn(self, function);
    }
}
