//! glTF files as they are found: each case is a small file that differs from a tidy one in one way.

use kn_io::{Inputs, ReadOptions, Scan, read_mesh};
use kn_mesh::Mesh;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A tetrahedron of 4 vertices and 4 faces.
const CORNERS: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
const FACES: [[u16; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

/// Its document, and its bytes with `more` behind them.
fn tidy(more: &[u8]) -> (Value, Vec<u8>) {
    let mut data: Vec<u8> = CORNERS.concat().iter().flat_map(|x| x.to_le_bytes()).collect();
    data.extend(FACES.concat().iter().flat_map(|index| index.to_le_bytes()));
    data.extend(more);
    let document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 24 },
            { "buffer": 0, "byteOffset": 72, "byteLength": more.len() },
        ],
        "buffers": [{ "byteLength": data.len() }],
    });
    (document, data)
}

/// A document with the member at a path of keys and numbers set.
fn with(mut document: Value, path: &str, value: Value) -> Value {
    let (parent, key) = path.rsplit_once('/').expect("a path");
    let parent = document.pointer_mut(parent).expect("a parent");
    match parent {
        Value::Array(items) => items.push(value),
        _ => parent[key] = value,
    }
    document
}

/// GLB whose chunks are `pad` bytes longer than their content and follow each other without a gap.
fn glb(json: &str, data: &[u8], pad: usize) -> Vec<u8> {
    let json = format!("{json}{}", " ".repeat(pad));
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend(((28 + json.len() + data.len() + pad) as u32).to_le_bytes());
    bytes.extend((json.len() as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(json.bytes());
    bytes.extend(((data.len() + pad) as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(data);
    bytes.extend(vec![0; pad]);
    bytes
}

struct Found {
    _folder: TempDir,
    path: PathBuf,
}

fn written(bytes: &[u8]) -> Found {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("found.glb");
    std::fs::write(&path, bytes).expect("written");
    Found { _folder: folder, path }
}

fn read(document: &Value, data: &[u8]) -> Result<Scan, String> {
    let found = written(&glb(&document.to_string(), data, 0));
    read_mesh(&found.path, &ReadOptions::default()).map_err(|error| error.to_string())
}

fn frames(path: &Path, frame_rate: f64) -> Vec<Mesh> {
    let options = ReadOptions { frame_rate, ..ReadOptions::default() };
    let inputs = Inputs::find(&[path.to_owned()], options).expect("readable");
    inputs.frames().map(|frame| frame.expect("readable").mesh).collect()
}

/// Whether a mesh is the tetrahedron.
fn assert_tetrahedron(scan: &Scan, what: &str) {
    let expected = CORNERS.map(|corner| corner.map(f64::from));
    assert_eq!(scan.mesh.positions, expected, "{what}");
    assert_eq!(scan.mesh.faces, FACES.map(|face| face.map(u32::from)), "{what}");
}

#[test]
fn what_has_nothing_to_do_with_the_shape_does_no_harm() {
    let (document, data) = tidy(&[]);
    let extras = [json!("note"), json!(7), json!([1, null]), json!({ "a": [{}] }), json!(false)];
    for extras in extras {
        let places = ["/asset", "/scenes/0", "/nodes/0", "/meshes/0", "/accessors/0"];
        let mut changed = with(document.clone(), "/extras", extras.clone());
        for place in
            places.into_iter().chain(["/bufferViews/0", "/buffers/0", "/meshes/0/primitives/0"])
        {
            changed = with(changed, &format!("{place}/extras"), extras.clone());
        }
        assert_tetrahedron(&read(&changed, &data).expect("readable"), &extras.to_string());
    }
    let cases = [
        ("/scenes/-", json!({})),
        ("/scenes/0/name", json!(null)),
        ("/accessors/0/count", json!(4.0)),
        ("/bufferViews/1/byteOffset", json!(48.0)),
        ("/meshes/0/primitives/0/mode", json!(4.0)),
        ("/asset/version", json!("2.1")),
        ("/asset/minVersion", json!("2.0")),
        ("/materials", json!([{ "pbrMetallicRoughness": 3, "doubleSided": "yes" }])),
        ("/images", json!([{ "uri": "a.dds" }])),
        ("/cameras", json!([{ "type": "unheard of" }])),
        ("/skins", json!(null)),
        ("/extensionsRequired", json!(["KHR_xmp_json_ld", "VRMC_vrm", "EXT_structural_metadata"])),
        ("/extensionsRequired", json!(["MSFT_texture_dds", "KHR_materials_unlit"])),
    ];
    for (path, value) in cases {
        let changed = with(document.clone(), path, value);
        assert_tetrahedron(&read(&changed, &data).expect("readable"), path);
    }
    let required = with(document.clone(), "/extensionsRequired", json!(["ACME_paint"]));
    let used = json!([{ "extensions": { "ACME_paint": {} } }]);
    assert_tetrahedron(
        &read(&with(required, "/materials", used), &data).expect("harmless"),
        "paint",
    );
}

#[test]
fn chunks_need_not_be_aligned() {
    let (document, data) = tidy(&[]);
    for pad in 0..6 {
        let found = written(&glb(&document.to_string(), &data, pad));
        let scan = read_mesh(&found.path, &ReadOptions::default()).expect("readable");
        assert_tetrahedron(&scan, &format!("{pad} bytes"));
    }
    let nul = document.to_string() + "\0\0";
    let found = written(&glb(&nul, &data, 0));
    assert_tetrahedron(&read_mesh(&found.path, &ReadOptions::default()).expect("readable"), "NUL");
}

#[test]
fn what_cannot_be_read_is_refused_by_its_name() {
    let (document, data) = tidy(&[]);
    let draco = json!({ "KHR_draco_mesh_compression": { "bufferView": 2 } });
    let mut bare = with(document.clone(), "/meshes/0/primitives/0/extensions", draco);
    bare["accessors"][0] = json!({ "componentType": 5126, "count": 4, "type": "VEC3" });
    let required = |name: &str| with(document.clone(), "/extensionsRequired", json!([name]));
    let unknown = with(required("ACME_shape"), "/nodes/0/extensions", json!({ "ACME_shape": {} }));
    let later = with(document.clone(), "/asset", json!({ "version": "2.1", "minVersion": "2.1" }));
    let cases = [
        (with(document.clone(), "/asset/version", json!("1.0")), "the file is glTF 1.0"),
        (later, "needs glTF version 2.1"),
        (required("KHR_draco_mesh_compression"), "decompress it"),
        (bare, "KHR_draco_mesh_compression"),
        (required("ACME_shape"), "requires the glTF extension ACME_shape"),
        (unknown, "requires the glTF extension ACME_shape"),
    ];
    for (document, expected) in cases {
        let said = read(&document, &data).expect_err(expected);
        assert!(said.contains(expected), "{said}");
    }
    let mut old = glb("{}", &[], 0);
    old[4] = 1;
    let found = written(&old);
    let said = read_mesh(&found.path, &ReadOptions::default()).expect_err("old").to_string();
    assert!(said.contains("glTF 1.0"), "{said}");
}

#[test]
fn hidden_nodes_and_what_is_below_them_are_left_out() {
    let (document, data) = tidy(&[]);
    let visible = |visible: bool| json!({ "KHR_node_visibility": { "visible": visible } });
    let nodes = |parent: bool, child: bool| {
        json!([
            { "mesh": 0, "extensions": visible(parent), "children": [1] },
            { "mesh": 0, "translation": [5, 0, 0], "extensions": visible(child) },
        ])
    };
    for (parent, child, faces) in [(true, true, 8), (true, false, 4), (false, true, 0)] {
        let scan = read(&with(document.clone(), "/nodes", nodes(parent, child)), &data);
        assert_eq!(scan.map_or(0, |scan| scan.mesh.faces.len()), faces, "{parent} {child}");
    }
}

#[test]
fn every_instance_of_a_node_is_read() {
    let places: [f32; 6] = [0.0, 0.0, 0.0, 10.0, 0.0, 0.0];
    let scales: [f32; 6] = [1.0, 1.0, 1.0, -1.0, 1.0, 1.0];
    let more: Vec<u8> = places.iter().chain(&scales).flat_map(|x| x.to_le_bytes()).collect();
    let (document, data) = tidy(&more);
    let two = |offset: usize| json!({ "bufferView": 2, "byteOffset": offset, "componentType": 5126, "count": 2, "type": "VEC3" });
    let document = with(with(document, "/accessors/-", two(0)), "/accessors/-", two(24));
    let instancing =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 2, "SCALE": 3 } } });
    let document = with(document, "/nodes/0/extensions", instancing);
    let mesh = read(&document, &data).expect("readable").mesh;
    assert_eq!((mesh.positions.len(), mesh.faces.len()), (8, 8));
    assert_eq!(mesh.positions[5], [9.0, 0.0, 0.0]);
    assert_eq!(mesh.faces[4], [4, 5, 6], "the mirrored instance is turned");
}

#[test]
fn a_node_far_away_moves_its_mesh_in_binary64() {
    let (document, data) = tidy(&[]);
    let far = [691_234.567, 0.1, -5_334_567.891];
    let document = with(document, "/nodes/0/translation", json!(far));
    let mesh = read(&document, &data).expect("readable").mesh;
    assert_eq!(mesh.positions[3], [far[0], far[1], far[2] + 3.0]);
}

/// An animation from 0 to half a second: two values of a property, with the given target.
fn animated(target: Value, values: &[f32], kind: &str) -> Vec<u8> {
    let more: Vec<u8> =
        [0.0, 0.5].iter().chain(values).flat_map(|x: &f32| x.to_le_bytes()).collect();
    let (mut document, data) = tidy(&more);
    let accessors = document["accessors"].as_array_mut().expect("a list");
    accessors.push(json!({ "bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR" }));
    accessors.push(json!({
        "bufferView": 2, "byteOffset": 8, "componentType": 5126, "count": 2, "type": kind,
    }));
    document["animations"] = json!([{
        "channels": [{ "sampler": 0, "target": target }],
        "samplers": [{ "input": 2, "output": 3 }],
    }]);
    glb(&document.to_string(), &data, 0)
}

#[test]
fn an_animation_is_sampled_at_the_rate_that_is_asked_for() {
    let moves = [0.0, 0.0, 0.0, 8.0, 0.0, 0.0];
    let pointer = |to: &str| json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": to } } });
    let targets = [json!({ "node": 0, "path": "translation" }), pointer("/nodes/0/translation")];
    for target in targets {
        let found = written(&animated(target, &moves, "VEC3"));
        for (frame_rate, count) in [(8.0, 5), (30.0, 16), (2.0, 2), (25.0, 13)] {
            let frames = frames(&found.path, frame_rate);
            assert_eq!(frames.len(), count, "at {frame_rate} fps");
            let step = 16.0 / frame_rate;
            assert!((frames[1].positions[0][0] - step).abs() < 1e-6, "at {frame_rate} fps");
        }
    }
    // What moves a material moves no mesh: one frame, and a note.
    let found = written(&animated(pointer("/materials/0/emissiveFactor"), &moves, "VEC3"));
    let shown = frames(&found.path, 30.0);
    assert_eq!((shown.len(), shown[0].faces.len()), (1, 4));
    let scan = read_mesh(&found.path, &ReadOptions::default()).expect("readable");
    assert!(scan.notes.to_string().contains("animated properties that move nothing (1)"));
    let visibility = pointer("/nodes/0/extensions/KHR_node_visibility/visible");
    let found = written(&animated(visibility, &[1.0, 0.0], "SCALAR"));
    let options = ReadOptions { frame_rate: 2.0, allow_empty: true, ..ReadOptions::default() };
    let inputs = Inputs::find(std::slice::from_ref(&found.path), options).expect("readable");
    assert_eq!(inputs.read(0).expect("seen").mesh.faces.len(), 4);
    assert!(inputs.read(1).expect("read").mesh.is_empty(), "nothing is left to see");
}

#[test]
fn data_compressed_with_meshopt_are_read() {
    let vertices: Vec<[u32; 3]> = CORNERS.iter().map(|p| p.map(f32::to_bits)).collect();
    let positions = meshopt::encode_vertex_buffer(&vertices).expect("encoded");
    let indices: Vec<u32> = FACES.concat().iter().map(|&index| u32::from(index)).collect();
    let triangles = meshopt::encode_index_buffer(&indices, 4).expect("encoded");
    let data = [&positions[..], &triangles].concat();
    for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let (mut document, _) = tidy(&[]);
        let view = |at: usize, length: usize, stride: usize, count: usize, mode: &str| {
            json!({ "buffer": 1, "byteLength": stride * count, "extensions": { name: {
                "buffer": 0, "byteOffset": at, "byteLength": length,
                "byteStride": stride, "count": count, "mode": mode,
            }}})
        };
        document["bufferViews"] = json!([
            view(0, positions.len(), 12, 4, "ATTRIBUTES"),
            view(positions.len(), triangles.len(), 2, 12, "TRIANGLES"),
        ]);
        document["buffers"] = json!([
            { "byteLength": data.len() },
            { "byteLength": 72, "extensions": { name: { "fallback": true } } },
        ]);
        document["extensionsRequired"] = json!([name]);
        let scan = read(&document, &data).expect("readable");
        assert_eq!(scan.mesh.positions, CORNERS.map(|corner| corner.map(f64::from)));
        // The coder turns triangles; what they are stays.
        assert_eq!(scan.mesh.faces.len(), 4);
        for broken in [json!(11), json!(-1), json!(1_u64 << 40)] {
            let mut document = document.clone();
            document["bufferViews"][0]["extensions"][name]["count"] = broken;
            read(&document, &data).expect_err("not the data's count");
        }
    }
}
