//! OBJ, PLY and OFF: what is written reads back the same, what is broken is named, and no cut or
//! changed byte makes the readers panic.

use kn_io::{
    LabelSource, MAX_FILE_BYTES, MeshError, MeshErrorKind, Place, ReadOptions, Scan, read_mesh,
    write_mesh, write_mesh_in, write_mesh_with_scalar,
};
use kn_mesh::{Mesh, Precision};
use proptest::prelude::*;
use std::path::PathBuf;
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn read_with(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Scan, MeshError> {
    let folder = folder();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("written");
    read_mesh(&path, options)
}

fn read(name: &str, text: &str) -> Result<Scan, MeshError> {
    read_with(name, text.as_bytes(), &ReadOptions::default())
}

fn good(name: &str, text: &str) -> Scan {
    read(name, text).unwrap_or_else(|error| panic!("{error}"))
}

/// The message of a file that must not read, without the folder.
fn message(name: &str, text: &str) -> String {
    let error = read(name, text).expect_err("must fail");
    let message = error.to_string();
    message.rsplit_once('/').map_or(message.clone(), |(_, tail)| tail.to_owned())
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

#[test]
fn obj_keeps_every_vertex_in_file_order() {
    let scan = good("a.obj", "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 5 5 5\nv 0 1 0\nf 5 2 3\n");
    assert_eq!(scan.mesh.positions.len(), 5);
    assert_eq!(scan.mesh.positions[3], [5.0; 3]);
    assert_eq!(scan.mesh.faces, [[4, 1, 2]]);
    assert!(scan.notes.is_empty());
}

#[test]
fn obj_corners_polygons_and_negative_indices() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n\
                f 1/1/1 2/1/1 3/1/1 4/1/1\nf -4//1 -3//-1 \\\n -1\nf 1/1 3/1 4/1 # tail\nf 1 2 5\nv 2 2 2\n";
    let scan = good("a.obj", text);
    assert_eq!(scan.mesh.faces, [[0, 1, 2], [0, 2, 3], [0, 1, 3], [0, 2, 3], [0, 1, 4]]);
    assert_eq!(
        scan.notes.to_string(),
        "1 polygon cut into 2 triangles; not carried: normals (1), texture coordinates (1)"
    );
}

#[test]
fn obj_lists_what_it_does_not_carry() {
    let folder = folder();
    let path = folder.path().join("a.obj");
    let text = format!(
        "mtllib my skin.mtl\nmtllib /etc/x.mtl\nmtllib gone.mtl\no body\ng arm\ns 1\nusemtl skin\n\
         {TRIANGLE}v 0 0 1 0.5\nv 0 0 2 1 0 0\nf 1 2 3\nl 1 2\np 1\ncurv 0 1 1 2\n"
    );
    std::fs::write(&path, text).expect("written");
    let library = "newmtl skin\nKd 1 1 1\nmap_Kd skin.png\nnewmtl hair\n";
    std::fs::write(folder.path().join("my skin.mtl"), library).expect("written");
    let scan = read_mesh(&path, &ReadOptions::default()).expect("readable");
    let line = scan.notes.to_string();
    for part in [
        "materials of my skin.mtl (2)",
        "textures of my skin.mtl (1)",
        "material library gone.mtl: not there (1)",
        "material library /etc/x.mtl: not beside the mesh (1)",
        "objects (1)",
        "groups (1)",
        "smoothing groups (1)",
        "uses of a material (1)",
        "vertex weights (1)",
        "colours (1)",
        "lines (1)",
        "points (1)",
        "statements \"curv\" (1)",
    ] {
        assert!(line.contains(part), "{part} in {line}");
    }
    assert!(!line.contains('\n'));
}

#[test]
fn broken_obj_files_name_the_line_and_the_reason() {
    let with = |tail: &str| message("a.obj", &format!("{TRIANGLE}{tail}"));
    assert_eq!(
        with("f 1 2 4\n"),
        "a.obj, line 4: face index 4 is out of range: there are 3 vertices"
    );
    assert!(with("f 1 2 -4\n").contains("line 4: face index -4 is out of range"));
    assert!(with("f 0 1 2\n").contains("line 4: face index 0 is out of range"));
    assert!(with("f 1 2 x\n").contains("line 4: \"x\" is not a face corner"));
    for corner in ["1/x", "x//", "/1", "1.0", "99999999999999999999"] {
        assert!(with(&format!("f 1 2 {corner}\n")).contains("is not a face corner"), "{corner}");
    }
    assert_eq!(
        with("v 0 nan 0\n"),
        "a.obj, line 4: a coordinate is NaN or infinite, or beyond 1e38"
    );
    assert!(with("v 0 -inf 0\n").contains("NaN or infinite"));
    assert!(with("v 0 1e999 0\nf 1 2 4\n").contains("line 4: a coordinate is NaN or infinite"));
    assert!(with("v 0 0\n").contains("line 4: a vertex has 3 coordinates, not 2"));
    assert!(with("v 0 0 abc\n").contains("\"abc\" is not a number"));
    assert_eq!(with(""), "a.obj: the mesh has no faces");
    assert_eq!(message("a.obj", ""), "a.obj: the file is empty");
    assert_eq!(message("a.obj", "# nothing\n"), "a.obj: the mesh has no vertices");
    let html = message("a.obj", "<html>\nnot found\n");
    assert_eq!(
        html,
        "a.obj, line 1: \"<html>\" is not an OBJ statement, and the file has no vertices"
    );
    assert!(message("a.xyz", "0 0 0").contains("no known mesh format"));
}

#[test]
fn a_mesh_without_faces_is_read_on_request() {
    assert!(matches!(read("a.obj", TRIANGLE), Err(MeshError { kind: MeshErrorKind::NoFaces, .. })));
    let options = ReadOptions { allow_empty: true, ..ReadOptions::default() };
    let scan = read_with("a.obj", TRIANGLE.as_bytes(), &options).expect("allowed");
    assert_eq!((scan.mesh.positions.len(), scan.mesh.faces.len()), (3, 0));
}

#[test]
fn a_missing_file_is_named() {
    let error = read_mesh(&PathBuf::from("/nowhere/f_3.obj"), &ReadOptions::default());
    assert!(error.expect_err("absent").to_string().starts_with("/nowhere/f_3.obj: No such file"));
}

#[test]
fn a_file_over_the_limit_is_refused_unread() {
    let folder = folder();
    let path = folder.path().join("a.obj");
    let file = std::fs::File::create(&path).expect("writable");
    file.set_len(MAX_FILE_BYTES + 1).expect("sparse");
    let message = read_mesh(&path, &ReadOptions::default()).expect_err("too large").to_string();
    assert!(message.ends_with("bytes in the file: 1073741825 is more than 1073741824"));
}

const ASCII_PLY: &str = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\n\
    property double x\nproperty float y\nproperty float z\nproperty float nx\n\
    property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar label\n\
    element face 2\nproperty uchar flag\nproperty list uchar int vertex_index\n\
    element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n\
    0.1 0 0 1 255 204 0 3\n1 0 0 1 204 0 0 4\n1 1 0 1 0 153 51 5\n0 1 0 1 128 128 128 6\n\
    9 4 0 1 2 3\n8 3 0 2 1\n0 1\n";

#[test]
fn ply_properties_are_used_or_listed() {
    let scan = good("a.ply", ASCII_PLY);
    assert_eq!(scan.mesh.positions[0], [0.1, 0.0, 0.0]);
    assert_eq!(scan.mesh.faces, [[0, 1, 2], [0, 2, 3], [0, 2, 1]]);
    assert_eq!(scan.mesh.labels, [3, 4, 5, 6]);
    assert_eq!(
        scan.notes.to_string(),
        "1 polygon cut into 2 triangles; not carried: colours (4), elements \"edge\" (1), \
         face property \"flag\" (2), normal components (4)"
    );
    let colours = ReadOptions { labels: LabelSource::Colours, ..ReadOptions::default() };
    let scan = read_with("a.ply", ASCII_PLY.as_bytes(), &colours).expect("readable");
    assert_eq!(scan.mesh.labels, [0, 1, 7, 14]);
    let none = ReadOptions { labels: LabelSource::None, ..ReadOptions::default() };
    let scan = read_with("a.ply", ASCII_PLY.as_bytes(), &none).expect("readable");
    assert!(scan.mesh.labels.is_empty() && scan.notes.ignored["labels"] == 4);
}

#[test]
fn broken_ply_files_name_the_place_and_the_reason() {
    let with = |from: &str, to: &str| message("a.ply", &ASCII_PLY.replace(from, to));
    assert!(
        with("8 3 0 2 1", "8 3 0 2 4")
            .contains("a.ply, line 25: face index 4 is out of range: there are 4 vertices")
    );
    assert!(with("8 3 0 2 1", "8 3 0 2").contains("line 25: the line has too few values"));
    assert!(with("8 3 0 2 1", "8 3 0 2 1 1").contains("line 25: \"1\" is one value too many"));
    assert!(with("8 3 0 2 1", "8 -3 0 2").contains("-3 is not a length for a list of face 1"));
    assert!(with("8 3 0 2 1", "8 3 0 2 1.5").contains("face index 1.5 is not an integer"));
    assert!(with("1 1 0 1 0 153", "1 nan 0 1 0 153").contains("line 22: a coordinate is NaN"));
    assert!(with("0 153 51 5", "0 153 51 99").contains("vertex 2: label 99 is out of range"));
    assert!(with("element edge 1", "element edge 2").contains("ends early: edge 1 of 2"));
    assert!(with("element vertex 4", "element vertex x").contains("line 4: PLY header"));
    assert!(with("property float z\n", "").contains("the vertices have no x, y and z"));
    assert!(with("vertex_index", "q\nproperty list uchar int p").contains("no list of element"));
    assert!(with("int vertex_index", "float q").contains("\"face\" is called vertex_indices"));
    assert!(with("element edge 1", "element vertex 1").contains("two elements \"vertex\""));
    assert!(with("comment made", "made").contains("line 3: PLY header: \"made\" is not a keyword"));
    assert!(with("format ascii 1.0\n", "").contains("there is no line \"format\""));
    assert!(with("property double x", "property real x").contains("\"real\" is not a type"));
    assert!(
        with("element edge 1\nproperty int vertex1\nproperty int vertex2", "element edge 9")
            .contains("element \"edge\" has no property")
    );
    let header_only = &ASCII_PLY[..ASCII_PLY.find("element face").expect("there")];
    assert!(message("a.ply", header_only).contains("the file ends early: in the PLY header"));
    assert!(with("element edge", "element tristrips").contains("no list of element \"tristrips\""));
    assert!(message("a.ply", "obj").contains("line 1: PLY header: the first line is not \"ply\""));
}

#[test]
fn binary_ply_places_are_vertices_and_faces() {
    let folder = folder();
    let path = folder.path().join("a.ply");
    let mesh = sample();
    write_mesh(&path, &mesh).expect("written");
    let bytes = std::fs::read(&path).expect("there");
    let start = bytes.len() - 2 * 13 - 4 * 13;

    let mut broken = bytes.clone();
    broken[start + 13..start + 17].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = read_with("a.ply", &broken, &ReadOptions::default()).expect_err("NaN");
    assert_eq!(error.place, Place::Vertex(1));
    let mut broken = bytes.clone();
    let last = broken.len() - 4;
    broken[last..].copy_from_slice(&4u32.to_le_bytes());
    let error = read_with("a.ply", &broken, &ReadOptions::default()).expect_err("range");
    assert_eq!(error.place, Place::Face(1));
    let mut longer = bytes;
    longer.extend([1, 2, 3]);
    let scan = read_with("a.ply", &longer, &ReadOptions::default()).expect("readable");
    assert_eq!(scan.notes.ignored["bytes after the last element"], 3);
}

/// ply-rs-bw as a second reader of what we write.
#[test]
fn another_reader_sees_what_was_written() {
    use ply_rs_bw::{parser::Parser, ply::DefaultElement, ply::Property};
    let folder = folder();
    let path = folder.path().join("a.ply");
    let mesh = sample();
    write_mesh(&path, &mesh).expect("written");
    let bytes = std::fs::read(&path).expect("there");
    let ply = Parser::<DefaultElement>::new().read_ply(&mut &bytes[..]).expect("readable");
    for (vertex, element) in ply.payload["vertex"].iter().enumerate() {
        let [x, y, z] = mesh.positions[vertex].map(|x| Property::Float(x as f32));
        assert_eq!([&element["x"], &element["y"], &element["z"]], [&x, &y, &z]);
        assert_eq!(element["label"], Property::UChar(mesh.labels[vertex]));
    }
    for (face, element) in ply.payload["face"].iter().enumerate() {
        assert_eq!(element["vertex_indices"].to_u32_list(), Some(mesh.faces[face].to_vec()));
    }
}

#[test]
fn a_header_that_promises_the_moon_costs_nothing() {
    for kind in ["ascii", "binary_little_endian"] {
        let text = format!(
            "ply\nformat {kind} 1.0\nelement vertex 18446744073709551615\nproperty float x\n\
             property float y\nproperty float z\nelement face 4294967296\n\
             property list uint int vertex_indices\nend_header\n"
        );
        assert!(message("a.ply", &text).contains("ends early: vertex 0 of"));
    }
    assert!(message("a.off", "OFF\n99999999999999 9 9\n").contains("ends early: vertex 0 of"));
}

#[test]
fn big_endian_and_little_endian_agree() {
    let header = |order: &str| {
        format!(
            "ply\r\nformat binary_{order}_endian 1.0\r\nelement vertex 3\r\nproperty double x\r\n\
             property short y\r\nproperty float z\r\nelement face 1\r\n\
             property list ushort uint vertex_indices\r\nend_header\r\n"
        )
    };
    let (mut little, mut big) = (header("little").into_bytes(), header("big").into_bytes());
    for (x, y, z) in [(0.5f64, -3i16, 0.1f32), (1.5, 300, 7.0), (-2.0, 1, 1e-30)] {
        little.extend(x.to_le_bytes().into_iter().chain(y.to_le_bytes()).chain(z.to_le_bytes()));
        big.extend(x.to_be_bytes().into_iter().chain(y.to_be_bytes()).chain(z.to_be_bytes()));
    }
    little.extend(3u16.to_le_bytes());
    big.extend(3u16.to_be_bytes());
    for index in [2u32, 0, 1] {
        little.extend(index.to_le_bytes());
        big.extend(index.to_be_bytes());
    }
    let little = read_with("a.ply", &little, &ReadOptions::default()).expect("readable");
    let big = read_with("a.ply", &big, &ReadOptions::default()).expect("readable");
    assert_eq!(little, big);
    assert_eq!(little.mesh.positions[0], [0.5, -3.0, f64::from(0.1f32)]);
    assert_eq!(little.mesh.faces, [[2, 0, 1]]);
}

#[test]
fn off_reads_with_comments_and_colours() {
    let text = "OFF # by hand\n4 2 0\n\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n3 0 1 2\n";
    let scan = good("a.off", text);
    assert_eq!(scan.mesh.faces, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    assert_eq!(scan.notes.ignored["colours of faces"], 1);
    let with = |from: &str, to: &str| message("a.off", &text.replace(from, to));
    assert!(with("3 0 1 2\n", "3 0 1 4\n").contains("line 9: face index 4 is out of range"));
    assert!(with("3 0 1 2\n", "3 0 1\n").contains("a face of 3 corners lists fewer"));
    assert!(with("3 0 1 2\n", "").contains("ends early: face 1 of 2"));
    assert!(with("1 1 0\n", "1 inf 0\n").contains("line 6: a coordinate is NaN"));
    assert!(with("OFF", "nOFF").contains("\"nOFF\" is not OFF"));
}

fn sample() -> Mesh {
    let positions = [[0.1f32, -0.0, 1e-40], [3e37, 1.0 / 3.0, -2.5], [1.0; 3], [7.0; 3]];
    let positions = positions.map(|p| p.map(f64::from)).to_vec();
    Mesh::new(positions, vec![[2, 1, 0], [3, 1, 0]]).with_labels(vec![0, 14, 7, 7])
}

#[test]
fn every_cut_of_a_small_file_is_an_error_or_a_mesh() {
    let folder = folder();
    for name in ["a.obj", "a.ply"] {
        let path = folder.path().join(name);
        write_mesh(&path, &sample()).expect("written");
        let bytes = std::fs::read(&path).expect("there");
        for length in 0..bytes.len() {
            let result = read_with(name, &bytes[..length], &ReadOptions::default());
            if name == "a.ply" {
                result.expect_err("a cut PLY is never whole");
            }
        }
    }
    for length in 0..ASCII_PLY.len() {
        let _ = read("a.ply", &ASCII_PLY[..length]);
    }
}

#[test]
fn scalars_are_written_for_ply_only_and_only_if_they_fit() {
    let folder = folder();
    let path = folder.path().join("a.ply");
    write_mesh_with_scalar(&path, &sample(), "error", &[0.0, 0.5, 1.0, 2.0]).expect("written");
    let scan = read_mesh(&path, &ReadOptions::default()).expect("readable");
    assert_eq!(scan.mesh, sample());
    assert_eq!(scan.notes.ignored["vertex property \"error\""], 4);
    let fails = |name: &str, property: &str, values: &[f32]| {
        let path = folder.path().join(name);
        let error = write_mesh_with_scalar(&path, &sample(), property, values);
        error.expect_err("must fail").to_string()
    };
    assert!(fails("a.obj", "error", &[0.0; 4]).contains("to .ply only"));
    assert!(fails("a.ply", "an error", &[0.0; 4]).contains("letters, digits and _"));
    assert!(fails("a.ply", "error", &[0.0; 3]).contains("3 values of error for 4 vertices"));
}

fn meshes() -> impl Strategy<Value = Mesh> {
    let number = prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO;
    let coordinate = number.prop_map(|x| x % kn_mesh::MAX_COORDINATE);
    let positions = prop::collection::vec(prop::array::uniform3(coordinate), 1..40);
    (positions, prop::collection::vec([0u32..1000, 0..1000, 0..1000], 1..60), any::<bool>())
        .prop_map(|(positions, faces, labelled)| {
            let count = positions.len() as u32;
            let labels =
                if labelled { (0..count).map(|v| (v % 15) as u8).collect() } else { vec![] };
            let faces = faces.iter().map(|f| f.map(|v| v % count)).collect();
            Mesh::new(positions, faces).with_labels(labels)
        })
}

fn bits(mesh: &Mesh) -> Vec<[u64; 3]> {
    mesh.positions.iter().map(|p| p.map(f64::to_bits)).collect()
}

/// What is left of a mesh in a precision.
fn rounded(mesh: &Mesh, precision: Precision) -> Mesh {
    let rounded = |x: f64| match precision {
        Precision::Single => f64::from(x as f32),
        Precision::Double => x,
    };
    mesh.with_positions(mesh.positions.iter().map(|p| p.map(rounded)).collect())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn files_read_back_to_the_same_bits(mesh in meshes()) {
        let folder = folder();
        let precisions = [Precision::Single, Precision::Double];
        for (name, precision) in ["a.obj", "a.ply"].into_iter().flat_map(|n| precisions.map(|p| (n, p))) {
            let path = folder.path().join(name);
            write_mesh_in(&path, &mesh, precision).expect("written");
            let scan = read_mesh(&path, &ReadOptions::default()).expect("readable");
            // Decimals of a binary32 number are read back in binary64, beside that number.
            prop_assert_eq!(bits(&rounded(&scan.mesh, precision)), bits(&rounded(&mesh, precision)));
            prop_assert_eq!(&scan.mesh.faces, &mesh.faces);
            if name == "a.ply" {
                prop_assert_eq!(&scan.mesh.labels, &mesh.labels);
            }
            prop_assert!(scan.notes.is_empty(), "{}", scan.notes);
        }
    }

    #[test]
    fn changed_bytes_never_panic(
        mesh in meshes(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        let folder = folder();
        for name in ["a.obj", "a.ply"] {
            let path = folder.path().join(name);
            write_mesh(&path, &mesh).expect("written");
            let mut bytes = std::fs::read(&path).expect("there");
            for (at, value) in &changes {
                let at = at.index(bytes.len());
                bytes[at] = *value;
            }
            if let Ok(scan) = read_with(name, &bytes, &ReadOptions::default()) {
                prop_assert_eq!(scan.mesh.check(), Ok(()));
            }
        }
    }
}
