//! Settings of `kn encode` for I-frames: lossless, decimated, with vertex maps.

mod common;

use common::{FRAMES, Scans, fails, kn, names_in, succeeds};
use kn_io::{read_mesh, write_mesh};
use kn_mesh::Mesh;
use serde_json::Value;
use std::fs;
use std::path::Path;

fn mesh(path: &Path) -> Mesh {
    read_mesh(path, &Default::default()).expect("a mesh").mesh
}

/// The vertex of the decoded mesh for each vertex of the file, `None` where it is gone.
fn vertex_map(path: &Path) -> Vec<Option<usize>> {
    let text = fs::read_to_string(path).expect("a vertex map");
    let target = |line: &str| (line != "-").then(|| line.parse().expect("an index"));
    text.lines().map(target).collect()
}

/// Faces of every frame, as `kn info` counts them.
fn face_counts(scans: &Scans) -> Vec<u64> {
    let info: Value =
        serde_json::from_str(&succeeds(["info", &scans.text("a.knm"), "--json"])).expect("JSON");
    let frames = info["frames"].as_array().expect("an array");
    frames.iter().map(|frame| frame["faces"].as_u64().expect("a number")).collect()
}

fn squared_distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum()
}

#[test]
fn lossless_gives_every_coordinate_back() {
    let scans = Scans::new();
    // Five decimals, as scanners write them.
    for index in 0..FRAMES {
        let mut scan = mesh(&scans.file(index));
        for x in scan.positions.as_flattened_mut() {
            *x = (*x * 1e5).round() / 1e5;
        }
        write_mesh(&scans.file(index), &scan).expect("written");
    }
    let maps = scans.text("maps");
    let (input, output) = (scans.text("scan/*.obj"), scans.text("a.knm"));
    succeeds(["encode", &input, "-o", &output, "--lossless", "--vertex-maps", &maps]);
    succeeds(["decode", &scans.text("a.knm"), "-o", &scans.text("out"), "--format", "ply"]);
    for index in 0..FRAMES {
        let name = format!("f_{:02}", index + 8);
        let (scan, decoded) =
            (mesh(&scans.file(index)), mesh(&scans.path(&format!("out/{name}.ply"))));
        let map = vertex_map(&scans.path(&format!("maps/{name}.map")));
        assert_eq!(map.len(), scan.positions.len());
        for (position, target) in scan.positions.iter().zip(map) {
            let target = target.expect("nothing is decimated");
            let bits = |p: [f64; 3]| p.map(|x| (x + 0.0).to_bits());
            assert_eq!(bits(decoded.positions[target]), bits(*position), "{name}");
        }
        assert_eq!(decoded.faces.len(), scan.faces.len());
    }
}

#[test]
fn lossless_refuses_what_lies_on_no_grid() {
    let scans = Scans::new();
    for index in 0..FRAMES {
        let mut scan = mesh(&scans.file(index));
        for x in scan.positions.as_flattened_mut() {
            *x = (*x * 1e3).round() / 1e3;
        }
        if index == 2 {
            scan.positions[5][1] = std::f64::consts::PI * 1e-7;
        }
        write_mesh(&scans.file(index), &scan).expect("written");
    }
    let message =
        fails(["encode", &scans.text("scan/*.obj"), "-o", &scans.text("a.knm"), "--lossless"]);
    assert!(
        message.contains("f_10.obj: frame 2: --lossless: vertex 5 has a coordinate 0.00000031"),
        "{message}"
    );
    scans.assert_untouched();
}

/// Adds a vertex that no face uses to every scan.
fn add_stray(scans: &Scans, vertex: &str) {
    for index in 0..FRAMES {
        let obj = std::fs::read_to_string(scans.file(index)).expect("a scan");
        let first_face = obj.find("\nf ").expect("faces");
        // After the other vertices, so that the faces stay as they are.
        let stray = format!("{}\nv {vertex}{}", &obj[..first_face], &obj[first_face..]);
        std::fs::write(scans.file(index), stray).expect("written");
    }
}

#[test]
fn a_vertex_in_no_face_changes_nothing() {
    let scans = Scans::new();
    let plain = std::fs::read(scans.encoded()).expect("written");
    add_stray(&scans, "100 0 0");
    let maps = scans.text("maps");
    let output = kn(scans.encode("scan/*.obj", &["--vertex-maps", &maps]));
    let said = common::stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("5 in no face dropped") && said.contains("2047 of them"), "{said}");
    assert!(std::fs::read(scans.path("a.knm")).expect("written") == plain);
    let map = vertex_map(&scans.path("maps/f_08.map"));
    assert_eq!(map.iter().position(Option::is_none), Some(map.len() - 1));
    // It is not measured either.
    let found = succeeds(["compare", &scans.text("scan"), &scans.text("a.knm"), "--fast"]);
    let side = found.split("longest side ").nth(1).and_then(|rest| rest.split(',').next());
    assert!(
        side.and_then(|side| side.parse::<f64>().ok()).is_some_and(|side| side < 3.0),
        "{found}"
    );
}

#[test]
fn lossless_keeps_a_vertex_in_no_face() {
    let scans = Scans::new();
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 7 0 0\nf 1 2 3\n";
    std::fs::write(scans.path("square.obj"), square).expect("written");
    let stream = scans.text("a.knm");
    succeeds(["encode", &scans.text("square.obj"), "-o", &stream, "--lossless"]);
    succeeds(["decode", &stream, "-o", &scans.text("out")]);
    let decoded = mesh(&scans.path("out/square.obj"));
    assert!(decoded.positions.contains(&[7.0, 0.0, 0.0]), "{:?}", decoded.positions);
}

#[test]
fn vertex_maps_lead_to_the_rounded_vertex() {
    let scans = Scans::new();
    let (step, maps) = (0.002, scans.text("maps"));
    succeeds(scans.encode("scan/*.obj", &["--step", "0.002", "--vertex-maps", &maps]));
    succeeds(["decode", &scans.text("a.knm"), "-o", &scans.text("out"), "--format", "ply"]);
    // One for each I-frame: frames 0 and 3 of GoFs of three.
    assert_eq!(names_in(&scans.path("maps")), ["f_08.map", "f_11.map"]);
    for name in ["f_08", "f_11"] {
        let scan = mesh(&scans.path(&format!("scan/{name}.obj")));
        let decoded = mesh(&scans.path(&format!("out/{name}.ply")));
        for (position, target) in
            scan.positions.iter().zip(vertex_map(&scans.path(&format!("maps/{name}.map"))))
        {
            let vertex = decoded.positions[target.expect("nothing is decimated")];
            // Rounding moves a coordinate by half a step, smoothing by as much again at most.
            let near = (0..3).all(|i| (position[i] - vertex[i]).abs() <= 1.001 * step);
            assert!(near, "{name}: {position:?} to {vertex:?}");
        }
    }
}

#[test]
fn iframes_are_decimated_to_a_number_or_a_share_of_faces() {
    let scans = Scans::new();
    let whole = mesh(&scans.file(0)).faces.len() as u64;
    for (faces, most) in [("600", 600), ("25%", whole / 4)] {
        let maps = scans.text("maps");
        succeeds(scans.encode("scan", &["--iframe-faces", faces, "--vertex-maps", &maps]));
        let counts = face_counts(&scans);
        assert_eq!(counts.len(), FRAMES);
        assert!(counts[0] <= most && counts[0] > most / 2, "{faces}: {counts:?}");
        assert_eq!(counts[1], counts[0], "P-frames deform the coarser mesh");
        let map = vertex_map(&scans.path("maps/f_08.map"));
        let kept = map.iter().flatten().count();
        assert!(kept > 0 && kept < map.len(), "{kept} of {} vertices", map.len());
    }
    for faces in ["0", "0%", "101%", "-3", "many"] {
        let refused = kn(scans.encode("scan", &[&format!("--iframe-faces={faces}")]));
        assert_eq!(refused.status.code(), Some(2), "{faces}");
    }
}

#[test]
fn iframes_are_decimated_within_an_error() {
    let scans = Scans::new();
    let error = 0.01;
    succeeds(scans.encode("scan", &["--iframe-error", "0.01"]));
    let whole = mesh(&scans.file(0)).faces.len() as u64;
    assert!(face_counts(&scans)[0] < whole * 9 / 10, "{:?}", face_counts(&scans));
    succeeds(["decode", &scans.text("a.knm"), "-o", &scans.text("out")]);
    let decoded = mesh(&scans.path("out/f_08.obj"));
    // A vertex of the scan is no further from the surface; from the vertices, by an edge at most.
    let longest = decoded
        .faces
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|edge| edge.map(|v| decoded.positions[v as usize]))
        .map(|[a, b]| squared_distance(a, b))
        .fold(0.0, f64::max)
        .sqrt();
    for position in mesh(&scans.file(0)).positions {
        let nearest = decoded.positions.iter().map(|&p| squared_distance(p, position));
        assert!(nearest.fold(f64::MAX, f64::min).sqrt() <= error + longest);
    }
    assert_eq!(kn(scans.encode("scan", &["--iframe-error=-1"])).status.code(), Some(2));
}
