//! Writes `spec/coverage.md`.

use std::path::Path;

use kn_conform::{Spec, coverage, coverage_page, load_corpus};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../spec"));
    let spec = Spec::load(folder)?;
    let streams = load_corpus(&folder.join("conformance"))?;
    std::fs::write(folder.join("coverage.md"), coverage_page(&coverage(&spec, &streams)))?;
    Ok(())
}
