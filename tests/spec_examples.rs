//! Each worked example of the specification: kn-bitstream and the interpreter of the tables read it
//! to the printed trace, and both write it back to the same bytes. Two named tests an example.
//! `spec/examples.json` has the same examples.

use std::path::Path;
use std::sync::Arc;

use kn_bitstream::Rule;
use kn_conform::{Example, Expected, Spec, TraceLine, example_trace, example_written};
use libtest_mimic::{Arguments, Failed, Trial};

fn main() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("spec");
    let spec = Arc::new(Spec::load(&folder).unwrap_or_else(|error| panic!("spec: {error}")));
    let trials = spec.examples.iter().cloned().flat_map(|example| {
        let (product, tables) = (example.clone(), example);
        let spec = Arc::clone(&spec);
        [
            Trial::test(format!("{} product", product.place), move || check_product(&product)),
            Trial::test(format!("{} tables", tables.place), move || check_tables(&spec, &tables)),
        ]
    });
    let json = Trial::test("examples.json", {
        let (spec, path) = (Arc::clone(&spec), folder.join("examples.json"));
        move || check_json(&spec, &path)
    });
    libtest_mimic::run(&Arguments::from_args(), trials.chain([json]).collect()).exit();
}

fn check_json(spec: &Spec, path: &Path) -> Result<(), Failed> {
    if std::fs::read_to_string(path)? == kn_corpus::examples::examples_json(spec) {
        Ok(())
    } else {
        Err("cargo run --release -p kn-corpus -- examples".into())
    }
}

fn check_product(example: &Example) -> Result<(), Failed> {
    match (&example.expected, example_trace(example)) {
        (Expected::Reject(rule), Ok(_)) => Err(format!("not refused by {rule}").into()),
        (Expected::Reject(rule), Err(error)) => same_rule(rule, error.rule(), &error.to_string()),
        (Expected::Trace(lines), Ok(trace)) => {
            same_trace(lines, &trace)?;
            same_bytes(&example.bytes, &example_written(example)?)
        }
        (Expected::Trace(_), Err(error)) => Err(error.to_string().into()),
    }
}

fn check_tables(spec: &Spec, example: &Example) -> Result<(), Failed> {
    match (&example.expected, spec.parse_example(example)) {
        (Expected::Reject(rule), Ok(_)) => Err(format!("not refused by {rule}").into()),
        (Expected::Reject(rule), Err(failure)) => {
            same_rule(rule, failure.rule, &failure.to_string())
        }
        (Expected::Trace(lines), Ok(trace)) => {
            same_trace(lines, &trace)?;
            same_bytes(&example.bytes, &spec.assemble_example(example, &trace)?)
        }
        (Expected::Trace(_), Err(failure)) => Err(failure.to_string().into()),
    }
}

fn same_rule(expected: &str, found: Option<Rule>, message: &str) -> Result<(), Failed> {
    if found.is_some_and(|rule| rule.id() == expected) {
        Ok(())
    } else {
        Err(format!("refused by {found:?}, not by {expected}: {message}").into())
    }
}

fn same_trace(expected: &[String], found: &[TraceLine]) -> Result<(), Failed> {
    let found: Vec<String> = found.iter().map(TraceLine::to_string).collect();
    if expected == found {
        Ok(())
    } else {
        Err(format!("expected\n{}\nfound\n{}", expected.join("\n"), found.join("\n")).into())
    }
}

fn same_bytes(expected: &[u8], found: &[u8]) -> Result<(), Failed> {
    if expected == found {
        Ok(())
    } else {
        Err(format!("written back as {found:02x?}, not {expected:02x?}").into())
    }
}
