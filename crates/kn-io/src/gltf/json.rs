//! The JSON of a glTF file: what the reader uses of it, and nothing else.
//!
//! Everything else is read over, whatever its type. What files have where the schema wants
//! something a little different is taken as it is meant: `66.0` for 66, `null` for nothing.

use super::super::Fault;
use super::bad;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Number, Value};
use std::collections::BTreeMap;

/// The extensions of an object, by name.
pub(super) type Extensions = Map<String, Value>;

/// A glTF document.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Root {
    pub(super) accessors: Vec<Accessor>,
    pub(super) animations: Vec<Animation>,
    pub(super) buffers: Vec<Buffer>,
    pub(super) buffer_views: Vec<BufferView>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) nodes: Vec<Node>,
    pub(super) scene: Option<usize>,
    pub(super) scenes: Vec<Scene>,
    pub(super) skins: Vec<Skin>,
    /// These are counted.
    pub(super) cameras: Value,
    pub(super) materials: Value,
    pub(super) textures: Value,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<usize>,
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
    pub(super) count: u64,
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) normalized: bool,
    pub(super) sparse: Option<Sparse>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Sparse {
    pub(super) count: u64,
    pub(super) indices: SparseArray,
    pub(super) values: SparseArray,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct SparseArray {
    pub(super) buffer_view: usize,
    pub(super) byte_offset: u64,
    /// Of indices alone.
    pub(super) component_type: u32,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: usize,
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: Option<u64>,
    pub(super) extensions: Extensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) byte_length: u64,
    pub(super) uri: Option<String>,
    pub(super) extensions: Extensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Mesh {
    pub(super) primitives: Vec<Primitive>,
    pub(super) weights: Option<Vec<f64>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Primitive {
    pub(super) attributes: BTreeMap<String, usize>,
    pub(super) extensions: Extensions,
    pub(super) indices: Option<usize>,
    pub(super) mode: Option<u32>,
    pub(super) targets: Vec<BTreeMap<String, usize>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub(super) children: Vec<usize>,
    pub(super) extensions: Extensions,
    pub(super) matrix: Option<[f64; 16]>,
    pub(super) mesh: Option<usize>,
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
    pub(super) skin: Option<usize>,
    pub(super) translation: Option<[f64; 3]>,
    pub(super) weights: Option<Vec<f64>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Scene {
    pub(super) nodes: Vec<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Skin {
    pub(super) inverse_bind_matrices: Option<usize>,
    pub(super) joints: Vec<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Animation {
    pub(super) channels: Vec<Channel>,
    pub(super) samplers: Vec<Sampler>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Channel {
    pub(super) sampler: usize,
    pub(super) target: Target,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Target {
    pub(super) extensions: Extensions,
    pub(super) node: Option<usize>,
    pub(super) path: String,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Sampler {
    pub(super) input: usize,
    pub(super) interpolation: Option<String>,
    pub(super) output: usize,
}

/// Parses the JSON of a file into its tree. Blanks, NUL and a byte order mark around it do no harm.
pub(super) fn parse(bytes: &[u8]) -> Result<Value, Fault> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let end = bytes.iter().rposition(|byte| !byte.is_ascii_whitespace() && *byte != 0);
    let bytes = &bytes[..end.map_or(0, |last| last + 1)];
    let mut tree = serde_json::from_slice(bytes).map_err(|error| bad(format!("JSON: {error}")))?;
    tidy(&mut tree);
    Ok(tree)
}

/// The structure that a tree holds.
pub(super) fn structure<T: DeserializeOwned>(tree: Value) -> Result<T, Fault> {
    serde_json::from_value(tree).map_err(|error| bad(format!("JSON: {error}")))
}

/// Drops members that are null, and turns numbers like 66.0 into integers.
fn tidy(tree: &mut Value) {
    match tree {
        Value::Object(members) => {
            members.retain(|_, value| !value.is_null());
            members.values_mut().for_each(tidy);
        }
        Value::Array(items) => items.iter_mut().for_each(tidy),
        Value::Number(number) => {
            let whole = number.as_f64().filter(|value| number.is_f64() && value.fract() == 0.0);
            if let Some(value) = whole.filter(|value| value.abs() < 9e15) {
                *number = Number::from(value as i64);
            }
        }
        _ => {}
    }
}

/// The number of items of a list that is only counted.
pub(super) fn count(list: &Value) -> u64 {
    list.as_array().map_or(0, |items| items.len() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_is_taken_as_it_is_meant() {
        let text = b"\xEF\xBB\xBF {\"scene\": 1.0, \"nodes\": null, \"extras\": [1, null, \"x\"],
            \"scenes\": [{}, {\"nodes\": [0], \"extras\": 7, \"name\": null}],
            \"accessors\": [{\"count\": 66.0, \"extras\": \"note\", \"type\": \"VEC3\"}]} \0\0";
        let root: Root = structure(parse(text).expect("JSON")).expect("a document");
        assert_eq!((root.scene, root.nodes.len(), root.accessors[0].count), (Some(1), 0, 66));
        assert_eq!(root.scenes[1].nodes, [0]);
        let node = b"{\"translation\": [123456.789, 5e-1, -2.0]}";
        let node: Node = structure(parse(node).expect("JSON")).expect("a node");
        assert_eq!(node.translation, Some([123_456.789, 0.5, -2.0]));
        for broken in ["", "{", "[]", "{\"scene\": -1}", "{\"scene\": 0.5}", "{} {}"] {
            let root = parse(broken.as_bytes()).and_then(structure::<Root>);
            assert!(root.is_err() || broken == "[]", "{broken}");
        }
    }
}
