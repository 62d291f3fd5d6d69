//! The worked examples of the chapters as one JSON file.

use std::path::Path;

use kn_conform::{Example, Expected, Spec};
use serde_json::{Map, Value, json};

/// Writes `spec/examples.json` in the checkout at `root`.
///
/// # Errors
/// The specification cannot be read, or the file cannot be written.
pub fn write(root: &Path) -> anyhow::Result<()> {
    let folder = root.join("spec");
    let spec = Spec::load(&folder)?;
    Ok(std::fs::write(folder.join("examples.json"), examples_json(&spec))?)
}

/// A list with an object for each example, in the order of the chapters.
pub fn examples_json(spec: &Spec) -> String {
    let all = Value::Array(spec.examples.iter().map(example_value).collect());
    format!("{all:#}\n")
}

fn example_value(example: &Example) -> Value {
    let given: Map<String, Value> =
        example.given.iter().map(|(name, value)| (name.clone(), json!(value))).collect();
    let bytes: String = example.bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    let mut value = json!({
        "place": example.place,
        "structure": example.structure,
        "given": given,
        "bytes": bytes,
    });
    match &example.expected {
        Expected::Reject(rule) => value["rule"] = json!(rule),
        Expected::Trace(lines) => {
            value["elements"] = lines.iter().map(|line| element_value(line)).collect();
        }
    }
    value
}

/// Of a line `bit name = value`.
fn element_value(line: &str) -> Value {
    let (place, value) = line.split_once(" = ").unwrap_or((line, ""));
    let (bit, name) = place.split_once(' ').unwrap_or(("", place));
    json!({ "bit": bit.parse::<u64>().unwrap_or_default(), "name": name, "value": value })
}
