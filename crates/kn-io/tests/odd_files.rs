//! Files as scanners and tools write them: what is odd, but means one thing, is read.

use kn_io::{MeshErrorKind, ReadOptions, Scan, read_mesh};
use kn_mesh::Mesh;
use std::fs;

/// Four vertices and the two triangles of a square, in OBJ.
const VERTICES: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
const FACES: &str = "f 1 2 3\nf 1 3 4\n";

fn try_read(name: &str, bytes: &[u8]) -> Result<Scan, kn_io::MeshError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join(name);
    fs::write(&path, bytes).expect("written");
    read_mesh(&path, &ReadOptions::default())
}

fn read(name: &str, bytes: &[u8]) -> Scan {
    try_read(name, bytes)
        .unwrap_or_else(|error| panic!("{error} in {:?}", String::from_utf8_lossy(bytes)))
}

/// The square: its faces are the first ones, whatever vertices are there beside them.
#[track_caller]
fn assert_square(mesh: &Mesh, label: &str) {
    let corners = |face: &[u32; 3]| face.map(|vertex| mesh.positions[vertex as usize]);
    let faces: Vec<_> = mesh.faces.iter().map(corners).collect();
    let (a, b, c, d) = ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]);
    assert_eq!(faces, [[a, b, c], [a, c, d]], "{label}");
}

#[test]
fn obj_as_it_is_found() {
    let file = |before: &str, between: &str, after: &str| {
        format!("{before}{VERTICES}{between}{FACES}{after}")
    };
    let slashes = |tail: &str| {
        let corner = |n: u32| format!("{n}{tail}");
        let face = |n: [u32; 3]| format!("f {}\n", n.map(corner).join(" "));
        format!("{VERTICES}{}{}", face([1, 2, 3]), face([1, 3, 4]))
    };
    // A file, and what its note has to contain.
    let cases = [
        (file("", "", "\0"), ""),
        (file("", "", "\0\0\0\0"), ""),
        (file("", "\0\n", ""), ""),
        (file("", "", "\x1a"), ""),
        (file("$ made by hand\n", "", ""), "lines that are not OBJ statements (1)"),
        (file("", "@ x\n%\n", "=\n"), "lines that are not OBJ statements (3)"),
        (file("", "\u{feff}\n", ""), "lines that are not OBJ statements (1)"),
        (slashes("/"), ""),
        (slashes("//"), ""),
        (slashes("/1/"), ""),
        (slashes("/1/1/"), ""),
        (slashes("/7/7/7"), ""),
        (file("", "", "f\n"), "faces with fewer than 3 corners (1)"),
        (file("", "f 2\n", "f 1 2\n"), "faces with fewer than 3 corners (2)"),
        (
            file("v nan 0 0\n", "", "").replace("f 1 2 3\nf 1 3 4", "f 2 3 4\nf 2 4 5"),
            "NaN and in no face (1)",
        ),
        (file("", "v -nan(ind) 1.#QNAN -1.#IND\nv inf 0 0\n", ""), "NaN and in no face (2)"),
        (file("", "", "v 0 0 1e999\n"), "NaN and in no face (1)"),
        (file("", "", "v 5 5 5 nan nan nan\n"), "colours (1)"),
        (file("", "", "v 5 5 5 red green blue\n"), "colours (1)"),
        (file("", "", "v 5 5 5 1 2\nv 5 5 5 1 2 3 4 5\n"), "further numbers of vertices (7)"),
        (file("# C:\\scans\\\n", "", ""), ""),
        (file("o C:\\scans\\\ng a\\\n", "", ""), "objects (1)"),
        (file("", "f \\\n", "").replace("f \\\nf 1 2 3", "f 1 \\\n 2 \\ \n 3"), ""),
        (file("", "", "").replace("f 1 2 3", "fo 1 2 3"), ""),
        (file("", "", "").replace(' ', "\t"), ""),
    ];
    for (text, note) in cases {
        for end in ["\n", "\r\n", "\r"] {
            let text = text.replace('\n', end);
            let scan = read("a.obj", text.as_bytes());
            assert_square(&scan.mesh, &text);
            let notes = scan.notes.to_string();
            assert!(
                notes.contains(note) && notes.is_empty() == note.is_empty(),
                "{text:?}: {notes}"
            );
        }
    }
}

#[test]
fn a_vertex_that_is_nan_keeps_its_number_and_may_not_be_used() {
    let text = format!("v nan 0 0\n{VERTICES}f 2 3 4\n");
    let mesh = read("a.obj", text.as_bytes()).mesh;
    assert_eq!((mesh.positions.len(), &mesh.faces[..]), (5, &[[1, 2, 3]][..]));
    for face in ["f 1 2 3\n", "f 5 4 3 2 1\n"] {
        let error = try_read("a.obj", format!("{text}{face}").as_bytes()).expect_err("NaN is used");
        assert!(
            error.to_string().ends_with("line 1: a coordinate is NaN or infinite, or beyond 1e38"),
            "{error}"
        );
    }
}

#[test]
fn no_material_library_can_fail_a_read() {
    let libraries: [&[u8]; 9] = [
        b"newmtl skin\nKd 0.8\n",
        b"newmtl skin\nKs 1 1\n",
        b"newmtl skin\nKa\nNs\nd\nTr\nillum\n",
        b"newmtl skin\nKd spectral a.rfl 1\nKa xyz 1 1 1\n",
        b"newmtl\nKd 1 1 1\nmap_Kd\nmap_Bump -bm\n",
        b"Kd 1 1 1\n",
        b"\xFF\xFE\x00\x01 \0\0",
        b"",
        b"newmtl a\\\n\\",
    ];
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.obj");
    for name in ["skin.mtl", "a b.mtl", ".", "", "skin.mtl\0", "gone.mtl", "../a.mtl", "/dev/zero"]
    {
        for library in libraries {
            fs::write(folder.path().join("skin.mtl"), library).expect("written");
            fs::write(folder.path().join("a b.mtl"), library).expect("written");
            fs::write(&path, format!("mtllib {name}\nusemtl x\n{VERTICES}{FACES}"))
                .expect("written");
            let scan = read_mesh(&path, &ReadOptions::default()).expect("readable");
            assert_square(&scan.mesh, name);
        }
    }
}

const PLY_VERTICES: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

/// A PLY file in ascii.
fn ply(header: &str, values: &str) -> String {
    format!("ply\nformat ascii 1.0\n{header}end_header\n{values}")
}

const XYZ: &str = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const LIST: &str = "element face 2\nproperty list uchar int vertex_indices\n";
const TRIANGLES: &str = "3 0 1 2\n3 0 2 3\n";

#[test]
fn ply_in_ascii_as_it_is_found() {
    let square = ply(&format!("{XYZ}{LIST}"), &format!("{PLY_VERTICES}{TRIANGLES}"));
    let with = |from: &str, to: &str| {
        assert!(square.contains(from), "{from}");
        square.replace(from, to)
    };
    let cases = [
        square.clone(),
        with("vertex_indices", "vertex_list"),
        with("vertex_indices", "Vertex_Indices"),
        with("vertex_indices", "corners"),
        with("property float x", "PROPERTY Float X"),
        with("ply\nformat ascii", "PLY\nFormat ASCII"),
        with("element face", "\n\nelement face"),
        with("element face", "  element   face"),
        with("end_header", " end_header "),
        with("format ascii 1.0", "comment a\\\nobj_info b\nformat ascii 1.0"),
        with("uchar int vertex", "int64 uint64 vertex"),
        with("uchar int vertex", "uint8 float32 vertex"),
        with("3 0 2 3\n", "\n3 0 2 3\n\n"),
        with("3 0 2 3\n", "3 0 2 3"),
        with("3 0 2 3\n", "3 0 2 3\n\0"),
        with("3 0 1 2", "+3 0 1.0 2e0"),
        ply(
            &format!("{XYZ}element face 3\nproperty list uchar int vertex_indices\n"),
            &format!("{PLY_VERTICES}0\n{TRIANGLES}"),
        ),
        ply(
            &format!("{XYZ}element face 3\nproperty list uchar int vertex_indices\n"),
            &format!("{PLY_VERTICES}{TRIANGLES}2 0 1\n"),
        ),
        ply(
            &format!("{XYZ}{LIST}property float q\nproperty float q\n"),
            &format!("{PLY_VERTICES}3 0 1 2 0.5 0.5\n3 0 2 3 0.5 0.5\n"),
        ),
        ply(
            &format!(
                "{XYZ}element face 2\nproperty list uchar float texcoord\nproperty list uchar int vertex_list\n"
            ),
            &format!("{PLY_VERTICES}0 3 0 1 2\n2 0.5 0.5 3 0 2 3\n"),
        ),
        ply(
            &format!("{XYZ}property float x\n{LIST}"),
            &format!("{}{TRIANGLES}", PLY_VERTICES.replace('\n', " 9\n")),
        ),
        ply(
            &format!("{XYZ}property float red\nproperty float green\nproperty float blue\n{LIST}"),
            &format!("{}{TRIANGLES}", PLY_VERTICES.replace('\n', " nan nan nan\n")),
        ),
        ply(
            &format!("{}{LIST}", XYZ.replace('4', "5")),
            &format!("{PLY_VERTICES}nan nan -nan(ind)\n{TRIANGLES}"),
        ),
        ply(&format!("{LIST}{XYZ}"), &format!("{TRIANGLES}{PLY_VERTICES}")),
        ply(
            &format!("{XYZ}element tristrips 1\nproperty list int int vertex_indices\n"),
            &format!("{PLY_VERTICES}7 0 1 2 -1 0 2 3\n"),
        ),
        ply(
            &format!("{XYZ}element tristrips 2\nproperty list int int vertex_indices\n"),
            &format!("{PLY_VERTICES}3 0 1 2\n5 0 2 3 -1 -1\n"),
        ),
    ];
    for text in cases {
        for end in ["\n", "\r\n", "\r"] {
            let text = text.replace('\n', end);
            assert_square(&read("a.ply", text.as_bytes()).mesh, &text);
        }
    }
}

#[test]
fn every_second_triangle_of_a_strip_is_turned() {
    let header = format!("{XYZ}element tristrips 1\nproperty list int int vertex_indices\n");
    let text = ply(&header, &format!("{PLY_VERTICES}10 0 1 3 2 -1 0 1 3 2 -1\n"));
    let mesh = read("a.ply", text.as_bytes()).mesh;
    assert_eq!(mesh.faces, [[0, 1, 3], [3, 1, 2], [0, 1, 3], [3, 1, 2]]);
}

#[test]
fn ply_in_binary_with_every_line_end() {
    for (order, big) in [("little", false), ("big", true)] {
        for end in ["\n", "\r\n", "\r"] {
            // The first value begins with the bytes 10 and 13: no end of a line.
            let header = format!(
                "ply\nformat binary_{order}_endian 1.0\nelement vertex 4\nproperty ushort pad\n\
                 property float x\nproperty uchar pad\nproperty float y\nproperty uchar pad\n\
                 property double z\n{LIST}end_header\n"
            );
            let mut bytes = header.replace('\n', end).into_bytes();
            let mut put = |little: &[u8]| match big {
                true => bytes.extend(little.iter().rev()),
                false => bytes.extend(little),
            };
            for [x, y] in [[0f32, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
                put(&if big { [13, 10] } else { [10, 13] });
                put(&x.to_le_bytes());
                put(&[10]);
                put(&y.to_le_bytes());
                put(&[13]);
                put(&0f64.to_le_bytes());
            }
            for face in [[0i32, 1, 2], [0, 2, 3]] {
                put(&[3]);
                face.iter().for_each(|index| put(&index.to_le_bytes()));
            }
            let scan = read("a.ply", &bytes);
            assert_square(&scan.mesh, &header);
            assert_eq!(scan.notes.to_string(), "not carried: vertex property \"pad\" (12)");
        }
    }
}

#[test]
fn off_as_it_is_found() {
    let body = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
    let further = |tail: &str| {
        let vertices = PLY_VERTICES.replace('\n', &format!("{tail}\n"));
        format!("4 2 5\n{vertices}{TRIANGLES}")
    };
    let cases = [
        format!("OFF\n4 2 5\n{body}"),
        format!("OFF 4 2 5\n{body}"),
        format!("OFF4 2 5\n{body}"),
        format!("off\n4 2\n{body}"),
        format!("4 2 5\n{body}"),
        format!("# c\n\nOFF # by hand\n# d\n4 2 5 # e\n\n{body}"),
        format!("COFF\n{}", further(" 255 0 0 255")),
        format!("NOFF\n{}", further(" nan nan nan")),
        format!("STCNOFF\n{}", further(" 0 0 1 1 0 0 1 0.5 0.5")),
        format!("4OFF\n{}", further(" 1")),
        format!("OFF\n4 4 5\n{body}0\n2 0 1\n"),
        format!(
            "OFF\n5 2 5\nnan nan nan\n{}",
            body.replace("3 0 1 2\n3 0 2 3", "3 1 2 3\n3 1 3 4")
        ),
        format!("OFF\n4 2 5\n{}", body.replace("3 0 1 2", "3 0 1 2 0.5 0.5 0.5")),
        format!("OFF\n4 2 5\n{body}\0"),
    ];
    for text in cases {
        for end in ["\n", "\r\n", "\r"] {
            let text = text.replace('\n', end);
            assert_square(&read("a.off", text.as_bytes()).mesh, &text);
        }
    }
    let halved = format!("4OFF\n4 2 5\n{}{TRIANGLES}", "0 0 0 2\n2 0 0 2\n2 2 0 2\n0 2 0 2\n");
    assert_square(&read("a.off", halved.as_bytes()).mesh, "homogeneous");
}

/// Binary OFF of the square, with these further floats of a vertex.
fn binary_off(keyword: &str, further: &[f32]) -> Vec<u8> {
    let mut bytes = format!("{keyword} BINARY\n").into_bytes();
    [4i32, 2, 5].iter().for_each(|count| bytes.extend(count.to_be_bytes()));
    for position in [[0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]] {
        position.iter().chain(further).for_each(|x| bytes.extend(x.to_be_bytes()));
    }
    for face in [[3i32, 0, 1, 2, 0], [3, 0, 2, 3, 0]] {
        face.iter().for_each(|number| bytes.extend(number.to_be_bytes()));
    }
    bytes
}

#[test]
fn binary_off_is_read_and_no_cut_is_whole() {
    for (keyword, further) in [
        ("OFF", &[][..]),
        ("COFF", &[1.0; 4]),
        ("NOFF", &[0.0; 3]),
        ("4OFF", &[1.0]),
        ("STCNOFF", &[0.5; 9]),
    ] {
        let bytes = binary_off(keyword, further);
        assert_square(&read("a.off", &bytes).mesh, keyword);
        for length in 0..bytes.len() {
            try_read("a.off", &bytes[..length]).expect_err("a cut file is never whole");
        }
    }
    let mut wrong = binary_off("OFF", &[]);
    let at = wrong.len() - 8;
    wrong[at..at + 4].copy_from_slice(&7i32.to_be_bytes());
    let error = try_read("a.off", &wrong).expect_err("no such vertex");
    assert!(
        error.to_string().ends_with("face 1: face index 7 is out of range: there are 4 vertices")
    );
}

/// Text STL of the square.
fn stl(indent: &str) -> String {
    let facet = |corners: [&str; 3]| {
        let vertices: String =
            corners.iter().map(|corner| format!("{indent}{indent}vertex {corner}\n")).collect();
        format!("facet normal nan 0 0\n{indent}outer loop\n{vertices}{indent}endloop\nendfacet\n")
    };
    let first = facet(["0 0 0", "1 0 0", "1 1 0"]);
    let second = facet(["-0.0 0 0e9", "1.0 1e0 0", "0 1 0"]);
    format!("solid a b\n{first}{second}endsolid a b\n")
}

/// Binary STL of the square.
fn binary_stl(header: &str, count: u32) -> Vec<u8> {
    let mut bytes = header.as_bytes().to_vec();
    bytes.resize(80, 0);
    bytes.extend(count.to_le_bytes());
    let corners = [
        [[0f32; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]],
        [[0.0; 3], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
    ];
    for triangle in corners {
        bytes.extend([0; 12]);
        triangle.as_flattened().iter().for_each(|x| bytes.extend(x.to_le_bytes()));
        bytes.extend([0, 0]);
    }
    bytes
}

#[test]
fn stl_is_read_and_its_triangles_are_joined() {
    let text = stl("  ");
    for text in [
        text.clone(),
        text.to_uppercase(),
        text.replace("endfacet\nfacet", "endfacet\nendsolid\nsolid\nfacet"),
        stl("\t"),
    ] {
        for end in ["\n", "\r\n", "\r"] {
            let scan = read("a.stl", text.replace('\n', end).as_bytes());
            assert_square(&scan.mesh, &text);
            assert_eq!(scan.mesh.positions.len(), 4, "equal positions are one vertex");
        }
    }
    for bytes in [binary_stl("kn", 2), binary_stl("solid of a scanner", 2), binary_stl("", 0)] {
        let scan = read("a.stl", &bytes);
        assert_square(&scan.mesh, "binary");
        assert_eq!(scan.mesh.positions.len(), 4);
    }
    let mut longer = binary_stl("solid", 2);
    longer.extend([1, 2, 3]);
    let scan = read("a.stl", &longer);
    assert_eq!(scan.notes.to_string(), "not carried: bytes after the last triangle (3)");
}

#[test]
fn broken_stl_names_the_place() {
    let message = |bytes: &[u8]| try_read("a.stl", bytes).expect_err("must fail").to_string();
    let text = stl(" ");
    let with = |from: &str, to: &str| message(text.replace(from, to).as_bytes());
    assert!(with("vertex 1 0 0", "vertex 1 0").contains("line 5: \"\" is not a number"));
    assert!(with("vertex 1 0 0", "vertex nan 0 0").contains("line 5: a coordinate is NaN"));
    assert!(with("vertex 1 0 0", "vertx 1 0 0").contains("line 5: \"vertx\" is not expected here"));
    assert!(with("endsolid a b\n", "").contains("there is no \"endsolid\""));
    assert!(message(&binary_stl("", 3)).contains("ends early: triangle 2 of 3 is not there"));
    assert!(message(&binary_stl("", 2)[..70]).contains("ends early: in the STL header"));
    let empty = try_read("a.stl", b"solid\nendsolid\n").expect_err("nothing in it");
    assert!(matches!(empty.kind, MeshErrorKind::Empty(_)), "{empty}");
}
