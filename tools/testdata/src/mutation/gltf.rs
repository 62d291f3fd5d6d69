//! glTF: a mesh with a node, sometimes an animation and instances, in which values of the JSON are
//! replaced.

use super::random::Random;
use super::shape::Shape;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};

/// glTF as JSON, its buffer inside.
pub(super) fn write_text(shape: &Shape, random: &mut Random) -> Vec<u8> {
    let (mut document, buffer) = document(shape, random);
    let data = BASE64_STANDARD.encode(buffer);
    document["buffers"][0]["uri"] = json!(format!("data:application/octet-stream;base64,{data}"));
    replace_values(&mut document, random);
    document.to_string().into_bytes()
}

/// glTF in one binary file.
pub(super) fn write_binary(shape: &Shape, random: &mut Random) -> Vec<u8> {
    let (mut document, mut buffer) = document(shape, random);
    replace_values(&mut document, random);
    let mut text = document.to_string().into_bytes();
    let aligned = !random.chance(4);
    if aligned {
        text.resize(text.len().next_multiple_of(4), b' ');
        buffer.resize(buffer.len().next_multiple_of(4), 0);
    }
    let size = 12 + 8 + text.len() + 8 + buffer.len();
    let version = if random.chance(20) { random.below(4) } else { 2 };
    let mut bytes = b"glTF".to_vec();
    let mut word = |bytes: &mut Vec<u8>, value: usize| {
        bytes.extend((value as u32 + u32::from(random.chance(60))).to_le_bytes());
    };
    word(&mut bytes, version);
    word(&mut bytes, size);
    for (chunk, kind) in [(&text, b"JSON"), (&buffer, b"BIN\0")] {
        word(&mut bytes, chunk.len());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

/// The document and its buffer.
fn document(shape: &Shape, random: &mut Random) -> (Value, Vec<u8>) {
    let mut buffer = Vec::new();
    for coordinate in shape.positions.as_flattened() {
        buffer.extend((*coordinate as f32).to_le_bytes());
    }
    let indices_at = buffer.len();
    let fan = |face: &Vec<i64>| {
        let corners: Vec<u32> = face.iter().map(|&index| index as u32).collect();
        (2..corners.len()).flat_map(move |at| [corners[0], corners[at - 1], corners[at]])
    };
    let indices: Vec<u32> = shape.faces.iter().flat_map(fan).collect();
    indices.iter().for_each(|index| buffer.extend(index.to_le_bytes()));
    let keys_at = buffer.len();
    [0.0f32, 0.1, 0.2].iter().for_each(|time| buffer.extend(time.to_le_bytes()));
    for key in [[0.0f32, 0.0, 0.0], [0.1, 0.0, 0.0], [0.2, 0.1, 0.0]] {
        key.iter().for_each(|x| buffer.extend(x.to_le_bytes()));
    }
    let vertices = shape.positions.len();
    let mut document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "children": [1] }, { "mesh": 0, "translation": [1, 0, 0] }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": vertices, "type": "VEC3",
              "min": [-1, -1, -1], "max": [1, 1, 1] },
            { "bufferView": 1, "componentType": 5125, "count": indices.len(), "type": "SCALAR" },
            { "bufferView": 2, "componentType": 5126, "count": 3, "type": "SCALAR",
              "min": [0], "max": [0.2] },
            { "bufferView": 2, "byteOffset": 12, "componentType": 5126, "count": 3, "type": "VEC3" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": indices_at },
            { "buffer": 0, "byteOffset": indices_at, "byteLength": keys_at - indices_at },
            { "buffer": 0, "byteOffset": keys_at, "byteLength": buffer.len() - keys_at },
        ],
        "buffers": [{ "byteLength": buffer.len() }],
    });
    if random.chance(2) {
        document["animations"] = json!([{
            "samplers": [{ "input": 2, "output": 3, "interpolation": "LINEAR" }],
            "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }],
        }]);
    }
    (document, buffer)
}

/// Puts odd values into up to two places of the document.
fn replace_values(document: &mut Value, random: &mut Random) {
    for _ in 0..random.below(3) {
        let mut at = &mut *document;
        // Deeper with every step, so that the whole document is seldom replaced.
        for depth in 0..8 {
            if depth > 1 && random.chance(5) {
                break;
            }
            let deeper = match at {
                Value::Array(items) => !items.is_empty(),
                Value::Object(items) => !items.is_empty(),
                _ => false,
            };
            if !deeper {
                break;
            }
            at = match at {
                Value::Array(items) => {
                    let item = random.below(items.len());
                    &mut items[item]
                }
                Value::Object(items) => {
                    let item = random.below(items.len());
                    items.values_mut().nth(item).expect("below their number")
                }
                _ => unreachable!("left above"),
            };
        }
        match at {
            Value::Object(items) if random.chance(2) => {
                let (name, value) = addition(random);
                items.insert(name.into(), value);
            }
            Value::Array(items) if random.chance(2) => items.push(odd_value(random)),
            place => *place = odd_value(random),
        }
    }
}

fn odd_value(random: &mut Random) -> Value {
    match random.below(12) {
        0 => Value::Null,
        1 => json!(-1),
        2 => json!(0),
        3 => json!(1),
        4 => json!(4_294_967_296_u64),
        5 => json!(66.0),
        6 => json!(1e300),
        7 => json!("note"),
        8 => json!([]),
        9 => json!({}),
        10 => json!(true),
        _ => json!(random.below(6000)),
    }
}

fn addition(random: &mut Random) -> (&'static str, Value) {
    match random.below(9) {
        0 => ("extras", odd_value(random)),
        1 => (
            "extensionsRequired",
            json!([random.pick(&["KHR_xmp_json_ld", "KHR_draco_mesh_compression", "X"])]),
        ),
        2 => ("minVersion", json!(random.pick(&["2.0", "2.1", "x"]))),
        3 => ("byteStride", json!(random.pick(&[0, 4, 13, 252, 255]))),
        4 => ("matrix", json!(vec![0; 16])),
        5 => ("mode", json!(random.below(9))),
        6 => (
            "sparse",
            json!({ "count": random.below(9), "indices": { "bufferView": 1, "componentType": 5125 },
                               "values": { "bufferView": 0 } }),
        ),
        7 => ("skin", json!(random.below(3))),
        _ => (
            "extensions",
            json!({ "KHR_node_visibility": { "visible": odd_value(random) },
            "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": random.below(5) } } }),
        ),
    }
}
