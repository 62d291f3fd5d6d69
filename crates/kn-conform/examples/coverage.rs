//! Writes `spec/coverage.md`.

use std::path::Path;

use kn_conform::{Spec, branches, coverage, coverage_page, load_corpus};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../spec"));
    let spec = Spec::load(folder)?;
    let streams = load_corpus(&folder.join("conformance"))?;
    let page = coverage_page(&coverage(&spec, &streams), &branches(&spec, &streams)?);
    std::fs::write(folder.join("coverage.md"), page)?;
    Ok(())
}
