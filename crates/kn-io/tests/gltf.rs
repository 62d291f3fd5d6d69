//! glTF: what is written reads back, in our reader and in the gltf crate's; scenes, skins, morph
//! targets and animations pose as the specification says; broken files are errors.

use kn_io::{GlbWriter, Inputs, LabelSource, MeshError, ReadOptions, Scan, read_mesh, write_mesh};
use kn_mesh::Mesh;
use proptest::prelude::*;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn tetrahedron(shift: f64) -> Mesh {
    let positions = vec![
        [shift, 0.0, 0.0],
        [1.0 + shift, 0.25, 0.0],
        [0.125, 1.0 + 2.0 * shift, 0.0],
        [0.0, 0.0, 1.0 - shift],
    ];
    let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    Mesh::new(positions, faces)
}

fn write_sequence(path: &Path, frame_rate: f64, frames: &[Mesh]) {
    let mut writer = GlbWriter::create(path, frame_rate).expect("writable");
    for frame in frames {
        writer.push(frame).expect("valid");
    }
    writer.finish().expect("written");
}

fn read_sequence(path: PathBuf, frame_rate: f64) -> Vec<Mesh> {
    let options = ReadOptions { frame_rate, ..ReadOptions::default() };
    let inputs = Inputs::find(&[path], options).expect("readable");
    inputs.frames().map(|frame| frame.expect("readable").mesh).collect()
}

#[test]
fn a_mesh_comes_back_and_the_gltf_crate_agrees() {
    let folder = folder();
    let path = folder.path().join("a.glb");
    let mesh = tetrahedron(0.125);
    write_mesh(&path, &mesh).expect("written");
    assert_eq!(read_mesh(&path, &ReadOptions::default()).expect("readable").mesh, mesh);

    let bytes = std::fs::read(&path).expect("there");
    let document = gltf::Gltf::from_slice(&bytes).expect("valid for the gltf crate");
    let blob = document.blob.as_deref();
    let primitive = document.meshes().next().and_then(|mesh| mesh.primitives().next());
    let primitive = primitive.expect("one primitive");
    let reader = primitive.reader(|_| blob);
    let positions: Vec<_> = reader.read_positions().expect("positions").collect();
    let indices: Vec<_> = reader.read_indices().expect("indices").into_u32().collect();
    let positions: Vec<_> = positions.into_iter().map(|p| p.map(f64::from)).collect();
    assert_eq!(positions, mesh.positions);
    assert_eq!(indices, mesh.faces.concat());
}

#[test]
fn a_sequence_changes_positions_and_faces_frame_by_frame() {
    let folder = folder();
    let path = folder.path().join("a.glb");
    let mut other = tetrahedron(0.5);
    other.positions.push([2.0; 3]);
    other.faces.push([4, 0, 1]);
    let frames: Vec<Mesh> = (0..4)
        .map(|frame| tetrahedron(f64::from(frame) * 0.25))
        .chain([other.clone(), other])
        .chain([tetrahedron(0.75)])
        .collect();
    for frame_rate in [30.0, 23.976, 1.0, 1000.0] {
        write_sequence(&path, frame_rate, &frames);
        assert_eq!(read_sequence(path.clone(), frame_rate), frames, "at {frame_rate} fps");
    }
    // At rest a viewer sees the first frame, and nothing of the others.
    let scan = read_mesh(&path, &ReadOptions::default()).expect("readable");
    assert_eq!(scan.mesh, frames[0]);
    assert_eq!(scan.notes.to_string(), "not carried: animations (1)");
    assert_eq!(std::fs::read_dir(folder.path()).expect("folder").count(), 1, "no left-overs");
}

#[test]
fn long_runs_split_and_still_come_back() {
    let folder = folder();
    let path = folder.path().join("a.glb");
    let frames: Vec<Mesh> = (0..600).map(|frame| tetrahedron(f64::from(frame % 64))).collect();
    write_sequence(&path, 30.0, &frames);
    assert_eq!(read_sequence(path, 30.0), frames);
}

#[test]
fn frames_have_names_and_can_be_read_twice() {
    let folder = folder();
    let path = folder.path().join("dance.glb");
    write_sequence(&path, 25.0, &[tetrahedron(0.0), tetrahedron(1.0)]);
    let options = ReadOptions { frame_rate: 25.0, ..ReadOptions::default() };
    let inputs = Inputs::find(&[path], options).expect("readable");
    for _ in 0..2 {
        let names: Vec<_> = inputs.frames().map(|f| f.expect("readable").name).collect();
        assert_eq!(names, ["dance_0000", "dance_0001"]);
    }
    std::fs::write(folder.path().join("a.labels"), "0\n1\n2\n3\n").expect("written");
    std::fs::write(folder.path().join("b.labels"), "3\n2\n1\n99\n").expect("written");
    let inputs = inputs.with_labels(folder.path()).expect("one per frame");
    assert_eq!(inputs.read(0).expect("readable").mesh.labels, [0, 1, 2, 3]);
    let message = inputs.read(1).expect_err("label 99").to_string();
    assert!(message.contains("b.labels (frame 1), line 4: label 99"), "{message}");
}

/// A glTF file around some JSON; `{data}` is the length and `{uri}` the bytes of its buffer.
fn gltf_file(json: &str, data: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut encoded = String::new();
    for chunk in data.chunks(3) {
        let word = chunk.iter().fold(0u32, |word, &byte| word << 8 | u32::from(byte));
        let word = word << (8 * (3 - chunk.len()));
        for digit in 0..=chunk.len() {
            encoded.push(char::from(DIGITS[(word >> (18 - 6 * digit)) as usize & 63]));
        }
    }
    let buffer = format!(
        "\"buffers\": [{{\"byteLength\": {}, \"uri\": \"data:;base64,{encoded}\"}}]",
        data.len()
    );
    format!("{{\"asset\": {{\"version\": \"2.0\"}}, {buffer}, {json}}}")
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

fn read_gltf(json: &str, data: &[u8], options: &ReadOptions) -> Result<Scan, MeshError> {
    let folder = folder();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, gltf_file(json, data)).expect("written");
    read_mesh(&path, options)
}

fn message(json: &str, data: &[u8]) -> String {
    let error = read_gltf(json, data, &ReadOptions::default()).expect_err("must fail").to_string();
    error.rsplit_once("a.gltf").map_or(error.clone(), |(_, tail)| tail.to_owned())
}

/// Three corners of a triangle; accessor 0.
const CORNERS: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

const ONE_TRIANGLE: &str = r#"
    "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}]"#;

#[test]
fn nodes_multiply_and_mirrors_turn_faces() {
    let json = ONE_TRIANGLE.replace(
        r#""nodes": [{"mesh": 0}]"#,
        r#""scene": 0, "scenes": [{"nodes": [2, 0]}], "nodes": [
            {"mesh": 0, "translation": [5, 0, 0]},
            {"mesh": 0, "scale": [-1, 1, 1]},
            {"children": [1], "matrix": [2,0,0,0, 0,2,0,0, 0,0,2,0, 0,0,7,1]},
            {"mesh": 0, "name": "outside the scene"}]"#,
    );
    let scan = read_gltf(&json, &floats(&CORNERS), &ReadOptions::default()).expect("readable");
    let expected = [
        [0.0, 0.0, 7.0],
        [-2.0, 0.0, 7.0],
        [0.0, 2.0, 7.0],
        [5.0, 0.0, 0.0],
        [6.0, 0.0, 0.0],
        [5.0, 1.0, 0.0],
    ];
    assert_eq!(scan.mesh.positions, expected);
    assert_eq!(scan.mesh.faces, [[0, 2, 1], [3, 4, 5]]);
}

#[test]
fn primitives_of_one_vertex_array_share_their_vertices() {
    let json = r#"
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [
            {"attributes": {"POSITION": 0, "COLOR_0": 3}, "indices": 1, "material": 0},
            {"attributes": {"POSITION": 0, "COLOR_0": 3}, "indices": 2, "mode": 5},
            {"attributes": {"POSITION": 0, "_CUSTOM": 2, "NORMAL": 0}, "indices": 1},
            {"attributes": {"POSITION": 0}, "mode": 0}]}],
        "materials": [{}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR"},
            {"bufferView": 1, "byteOffset": 3, "componentType": 5121, "count": 4, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC4"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 8},
            {"buffer": 0, "byteOffset": 56, "byteLength": 16}]"#;
    let mut data = floats(&CORNERS);
    data.extend(floats(&[1.0, 1.0, 0.0]));
    data.extend([0, 1, 2, 0, 1, 2, 3, 0]);
    data.extend([255, 204, 0, 255, 204, 0, 0, 255, 255, 102, 0, 255, 128, 128, 128, 255]);
    let scan = read_gltf(json, &data, &ReadOptions::default()).expect("readable");
    assert_eq!(scan.mesh.positions.len(), 8, "four shared by two primitives, four of the third");
    assert_eq!(scan.mesh.faces, [[0, 1, 2], [0, 1, 2], [1, 3, 2], [4, 5, 6]]);
    assert_eq!(
        scan.notes.to_string(),
        "not carried: colours (4), custom attributes (4), materials (1), normals (4), \
         primitives of points or lines (1)"
    );
    let json = json.replace(
        r#"{"attributes": {"POSITION": 0, "_CUSTOM": 2, "NORMAL": 0}, "indices": 1},"#,
        "",
    );
    let colours = ReadOptions { labels: LabelSource::Colours, ..ReadOptions::default() };
    let scan = read_gltf(&json, &data, &colours).expect("readable");
    assert_eq!(scan.mesh.labels, [0, 1, 2, 14]);
}

#[test]
fn sparse_and_quantised_accessors_are_read() {
    let json = r#"
        "extensionsRequired": ["KHR_mesh_quantization"],
        "nodes": [{"mesh": 0, "scale": [2, 2, 2]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5122, "normalized": true, "count": 3,
            "type": "VEC3", "sparse": {"count": 1,
                "indices": {"bufferView": 1, "componentType": 5123},
                "values": {"bufferView": 2}}}],
        "bufferViews": [{"buffer": 0, "byteLength": 24, "byteStride": 8},
            {"buffer": 0, "byteOffset": 24, "byteLength": 2},
            {"buffer": 0, "byteOffset": 26, "byteLength": 6}]"#;
    let mut data = Vec::new();
    let raw: [i16; 16] = [0, 0, 0, 9, 32767, 0, 0, 9, 0, -32768, 0, 9, 1, 0, 32767, -32767];
    data.extend(raw.iter().flat_map(|value| value.to_le_bytes()));
    let scan = read_gltf(json, &data, &ReadOptions::default()).expect("readable");
    assert_eq!(scan.mesh.positions, [[0.0; 3], [0.0, 2.0, -2.0], [0.0, -2.0, 0.0]]);
}

#[test]
fn a_skin_follows_its_joints_through_an_animation() {
    // Joint 1 turns by 90° about z around (1, 0, 0) within a second; its child stays with it.
    let json = r#"
        "nodes": [{"mesh": 0, "skin": 0, "translation": [100, 0, 0]},
                  {"translation": [1, 0, 0], "children": [2]}, {"translation": [0, 0, 3]}],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": 3}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}}]}],
        "animations": [{"channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}],
                        "samplers": [{"input": 4, "output": 5}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5121, "count": 3, "type": "VEC4"},
            {"bufferView": 2, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC4"},
            {"bufferView": 3, "componentType": 5126, "count": 2, "type": "MAT4"},
            {"bufferView": 4, "componentType": 5126, "count": 2, "type": "SCALAR"},
            {"bufferView": 5, "componentType": 5126, "count": 2, "type": "VEC4"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 12},
            {"buffer": 0, "byteOffset": 48, "byteLength": 12},
            {"buffer": 0, "byteOffset": 60, "byteLength": 128},
            {"buffer": 0, "byteOffset": 188, "byteLength": 8},
            {"buffer": 0, "byteOffset": 196, "byteLength": 32}]"#;
    let mut data = floats(&[2.0, 0.0, 0.0, 2.0, 0.0, 3.0, 1.0, 1.0, 0.0]);
    data.extend([0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0]);
    data.extend([255, 0, 0, 0, 254, 0, 0, 0, 128, 127, 0, 0]);
    let bind =
        |z: f32| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0, -z, 1.0];
    data.extend(floats(&bind(0.0)));
    data.extend(floats(&bind(3.0)));
    let half = std::f32::consts::FRAC_1_SQRT_2;
    data.extend(floats(&[0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half]));

    let folder = folder();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, gltf_file(json, &data)).expect("written");
    let frames = read_sequence(path, 2.0);
    let root = std::f64::consts::SQRT_2 / 2.0;
    let expected = [
        [[2.0, 0.0, 0.0], [2.0, 0.0, 3.0], [1.0, 1.0, 0.0]],
        [[1.0 + root, root, 0.0], [1.0 + root, root, 3.0], [1.0 - root, root, 0.0]],
        [[1.0, 1.0, 0.0], [1.0, 1.0, 3.0], [0.0, 0.0, 0.0]],
    ];
    assert_eq!(frames.len(), 3);
    for (frame, expected) in frames.iter().zip(expected) {
        for (position, expected) in frame.positions.iter().zip(expected) {
            let off = (0..3).map(|axis| (position[axis] - expected[axis]).abs());
            assert!(off.fold(0.0, f64::max) < 1e-6, "{position:?}, not {expected:?}");
        }
    }
}

#[test]
fn broken_scenes_are_named() {
    let with = |from: &str, to: &str| message(&ONE_TRIANGLE.replace(from, to), &floats(&CORNERS));
    assert!(with("\"count\": 3", "\"count\": 4").contains("accessor 0 reaches outside its buffer"));
    assert!(with("\"byteLength\": 36", "\"byteLength\": 35").contains("outside its buffer"));
    assert!(
        with("\"count\": 3", "\"count\": 2").contains("2 face indices do not make whole triangles")
    );
    assert!(with("\"POSITION\": 0", "\"POSITION\": 7").contains("accessor 7 does not exist"));
    assert!(with("\"POSITION\": 0", "\"NORMAL\": 0").contains("a primitive has no POSITION"));
    assert!(with("{\"mesh\": 0}", "{\"mesh\": 3}").contains("the mesh of node 0 does not exist"));
    assert!(with("{\"mesh\": 0}", "{\"children\": [0]}").contains("the nodes are not a tree"));
    assert!(with("{\"mesh\": 0}", "{\"children\": [9]}").contains("node 9 does not exist"));
    let twice = "\"scenes\": [{\"nodes\": [0, 0]}], \"nodes\"";
    assert!(with("\"nodes\"", twice).contains("node 0 is not a root of scene 0"));
    assert!(with("5126", "9999").contains("accessor 0 has an unknown type"));
    assert!(with("VEC3", "VEC2").contains("accessor 0 should have 3 components"));
    assert!(with("\"buffer\": 0", "\"buffer\": 5").contains("outside its buffer"));
    assert!(with("\"mesh\": 0", "\"mesh\": 0, \"scale\": [0, 0, 0]").contains("no vertices"));
    assert!(with("\"nodes\"", "\"scene\": 4, \"nodes\"").contains("scene 4 does not exist"));
    let required = "\"extensionsRequired\": [\"KHR_draco_mesh_compression\"], \"nodes\"";
    assert!(with("\"nodes\"", required).contains("glTF extension KHR_draco_mesh_compression"));
    assert!(with("\"count\": 3", "\"count\": 99999999999").contains("is more than 268435456"));
    assert!(with("\"nodes\"", "\"nodes\"}").contains("glTF: JSON"));
    let mut corners = CORNERS;
    corners[4] = f32::INFINITY;
    let error = message(ONE_TRIANGLE, &floats(&corners));
    assert_eq!(error, ", vertex 1: a coordinate is NaN or infinite, or beyond 1e38");
    let short = ONE_TRIANGLE.replace("\"count\": 3", "\"count\": 3, \"normalized\": false");
    assert!(message(&short, &floats(&CORNERS[..6])).contains("outside its buffer"));
}

#[test]
fn buffers_lie_beside_the_file_and_nowhere_else() {
    let folder = folder();
    let path = folder.path().join("a.gltf");
    let write = |uri: &str| {
        let json = format!(
            "{{\"asset\": {{\"version\": \"2.0\"}}, {ONE_TRIANGLE}, \
             \"buffers\": [{{\"byteLength\": 36, \"uri\": \"{uri}\"}}]}}"
        );
        std::fs::write(&path, json).expect("written");
        read_mesh(&path, &ReadOptions::default())
    };
    std::fs::write(folder.path().join("a b.bin"), floats(&CORNERS)).expect("written");
    assert_eq!(write("a%20b.bin").expect("readable").mesh.faces.len(), 1);
    for uri in ["../a.bin", "/dev/zero", "http://example.org/a.bin", "absent.bin"] {
        let message = write(uri).expect_err("refused").to_string();
        assert!(message.contains("is not a file beside it"), "{uri}: {message}");
    }
    std::fs::write(folder.path().join("a.bin"), floats(&CORNERS[..5])).expect("written");
    let message = write("a.bin").expect_err("short").to_string();
    assert!(message.contains("ends early: glTF buffer 0 should have 36 bytes"), "{message}");
}

#[test]
fn what_cannot_be_written_is_refused() {
    let folder = folder();
    let path = folder.path().join("a.glb");
    let no_faces = tetrahedron(0.0).replace_faces(vec![]);
    let message = write_mesh(&path, &no_faces).expect_err("no faces").to_string();
    assert!(message.contains("a.glb (frame 0): the mesh has no faces"), "{message}");
    assert!(GlbWriter::create(&path, f64::NAN).is_err());
    assert!(GlbWriter::create(&path, 30.0).expect("writable").finish().is_err());
    let absent = folder.path().join("absent/a.glb");
    let message = write_mesh(&absent, &tetrahedron(0.0)).expect_err("no folder").to_string();
    assert!(message.contains("absent/a.glb: No such file"), "{message}");
    assert_eq!(std::fs::read_dir(folder.path()).expect("folder").count(), 0, "no left-overs");
}

#[test]
fn every_cut_of_a_glb_is_an_error() {
    let folder = folder();
    let path = folder.path().join("a.glb");
    write_sequence(&path, 30.0, &[tetrahedron(0.0), tetrahedron(1.0)]);
    let bytes = std::fs::read(&path).expect("there");
    for length in 0..bytes.len() {
        std::fs::write(&path, &bytes[..length]).expect("written");
        read_mesh(&path, &ReadOptions::default()).expect_err("cut");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn changed_bytes_never_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        digits_only in any::<bool>(),
    ) {
        let folder = folder();
        let path = folder.path().join("a.glb");
        let other = tetrahedron(2.0).replace_faces(vec![[0, 1, 2]]);
        write_sequence(&path, 30.0, &[tetrahedron(0.0), tetrahedron(1.0), other]);
        let mut bytes = std::fs::read(&path).expect("there");
        // Numbers in the JSON are where a change gets furthest.
        let digits: Vec<usize> =
            (0..bytes.len()).filter(|&at| bytes[at].is_ascii_digit()).collect();
        for (at, value) in &changes {
            match digits_only {
                true => bytes[*at.get(&digits)] = b'0' + value % 10,
                false => bytes[at.index(digits.len())] = *value,
            }
        }
        std::fs::write(&path, &bytes).expect("written");
        if let Ok(scan) = read_mesh(&path, &ReadOptions::default()) {
            prop_assert_eq!(scan.mesh.check(), Ok(()));
        }
        if let Ok(inputs) = Inputs::find(&[path], ReadOptions::default()) {
            for frame in inputs.frames().take(5).flatten() {
                prop_assert_eq!(frame.mesh.check(), Ok(()));
            }
        }
    }
}
