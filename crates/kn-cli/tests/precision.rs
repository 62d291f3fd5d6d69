//! Scans far from the origin: nothing moves by more than half a grid step, and nothing merges.

mod common;

use common::{Scans, fails, succeeds};
use kn_io::{Inputs, ReadOptions, read_mesh, write_mesh, write_mesh_in};
use kn_mesh::vec3::{add, distance, scale};
use kn_mesh::{Mesh, Precision};
use std::fs;
use std::path::Path;

/// Where the scans stand, and what a metre is there: UTM coordinates, 100 km away, 100 km away in
/// millimetres, and not far away.
const PLACES: [([f64; 3], f64); 4] = [
    ([691_234.567, 5_334_567.891, 512.25], 1.0),
    ([1e5, 0.0, -1e5], 1.0),
    ([1e8, 1e8, 0.0], 1000.0),
    ([0.0; 3], 1.0),
];

const BITS: u32 = 14;

fn mesh(path: &Path) -> Mesh {
    read_mesh(path, &ReadOptions::default()).expect("readable").mesh
}

/// The scans' meshes, moved to a place.
fn moved(scans: &Scans, index: usize, (place, metre): ([f64; 3], f64)) -> Mesh {
    let near = mesh(&scans.file(index));
    let far = near.positions.iter().map(|&p| add(place, scale(p, metre))).collect();
    near.with_positions(far)
}

/// The largest distance from a vertex of either mesh to the nearest of the other, world units.
fn farthest(a: &Mesh, b: &Mesh) -> f64 {
    let one_way = |a: &Mesh, b: &Mesh| {
        let nearest = |&p: &[f64; 3]| {
            b.positions.iter().map(|&q| distance(p, q)).fold(f64::INFINITY, f64::min)
        };
        a.positions.iter().map(nearest).fold(0.0, f64::max)
    };
    one_way(a, b).max(one_way(b, a))
}

#[test]
fn positions_are_right_to_half_a_step_wherever_they_are() {
    for place in PLACES {
        let scans = Scans::new();
        let scan = moved(&scans, 0, place);
        let step = scan.bounding_box().expect("a box").longest_side() / f64::from((1 << BITS) - 1);
        // Half a step on each axis, and the rounding of files near the origin.
        let limit = 0.51 * step * 3.0_f64.sqrt();
        for input in ["obj", "ply", "glb"] {
            let file = scans.path(&format!("far_0.{input}"));
            write_mesh(&file, &scan).expect("written");
            let (file, stream) = (file.to_string_lossy().into_owned(), scans.text("far.knm"));
            let bits = BITS.to_string();
            let more = ["--bits", &bits, "--smoothing", "0"];
            succeeds(["encode", &file, "-o", &stream].into_iter().chain(more));
            for output in ["obj", "ply", "glb"] {
                let folder = scans.text(&format!("{input}-{output}"));
                succeeds(["decode", &stream, "-o", &folder, "--format", output]);
                let decoded = mesh(&scans.path(&format!("{input}-{output}/far_0.{output}")));
                let what = format!("{input} to {output} at {place:?}");
                assert_eq!(decoded.positions.len(), scan.positions.len(), "{what}");
                let off = farthest(&scan, &decoded);
                assert!(off <= limit, "{what}: {off:.3e}, more than {limit:.3e}");
            }
        }
    }
}

/// The figure after a word in a text, such as an RMS.
fn figure(json: &str, path: &[&str]) -> f64 {
    let json: serde_json::Value = serde_json::from_str(json).expect("JSON");
    let found = path.iter().fold(&json, |value, key| &value[*key]);
    found.as_f64().unwrap_or_else(|| panic!("no {path:?} in {json}"))
}

#[test]
fn sequences_are_measured_registered_and_segmented_far_away_as_at_home() {
    let mut found = Vec::new();
    for place in [PLACES[3], PLACES[0]] {
        let scans = Scans::new();
        fs::create_dir(scans.path("far")).expect("made");
        for index in 0..3 {
            let path = scans.path(&format!("far/f_{index}.ply"));
            write_mesh_in(&path, &moved(&scans, index, place), Precision::Double).expect("written");
        }
        succeeds(scans.encode("far", &["--labels", "none"]));
        let compared = ["compare", &scans.text("far"), &scans.text("a.knm"), "--json"];
        let measured = succeeds(compared);
        let names = ["hausdorff", "p2s_psnr", "msdm2", "d1_psnr", "d2_psnr"];
        let (source, target) = (scans.text("far/f_0.ply"), scans.text("far/f_1.ply"));
        let out = scans.text("registered.ply");
        let registered = succeeds(["register", &source, &target, "-o", &out, "--json"]);
        succeeds(["segment", &scans.text("far"), "-o", &scans.text("labels")]);
        let labels = fs::read_to_string(scans.path("labels/f_1.labels")).expect("labels");
        let metrics = names.map(|name| figure(&measured, &["mean", name]));
        found.push((metrics, figure(&registered, &["s2t"]), labels));
    }
    let [near, far] = [&found[0], &found[1]];
    // The grid lies a little otherwise, so that single vertices are rounded another way.
    for (near, far) in near.0.iter().chain([&near.1]).zip(far.0.iter().chain([&far.1])) {
        assert!((near - far).abs() <= 0.02 * near.abs(), "{near} at home, {far} far away");
    }
    assert!(near.2 == far.2, "other labels far away");
}

#[test]
fn lossless_gives_decimals_back_or_says_why_not() {
    let scans = Scans::new();
    let decimals = |mesh: &Mesh, digits: usize| {
        let decimal = |x: f64| format!("{x:.digits$}").parse::<f64>().expect("a number");
        mesh.with_positions(mesh.positions.iter().map(|p| p.map(decimal)).collect())
    };
    let stream = scans.text("a.knm");
    for place in PLACES {
        // Millimetres, whatever the unit: on a finer lattice a body has more than 2^20 steps.
        let scan = decimals(&moved(&scans, 0, place), if place.1 == 1.0 { 3 } else { 0 });
        let file = scans.path("mm_0.obj");
        write_mesh_in(&file, &scan, Precision::Double).expect("written");
        let file = file.to_string_lossy().into_owned();
        succeeds(["encode", &file, "-o", &stream, "--lossless"]);
        let measured = succeeds(["compare", &file, &stream, "--fast", "--json"]);
        // Samples on the faces are rounded; the vertices below are exact.
        assert!(figure(&measured, &["mean", "hausdorff"]) < 1e-8 * place.1, "{place:?}");
        for format in ["obj", "ply"] {
            let folder = scans.text(format);
            succeeds(["decode", &stream, "-o", &folder, "--format", format, "--overwrite"]);
            let decoded = mesh(&scans.path(&format!("{format}/mm_0.{format}")));
            assert_eq!(farthest(&kn_mesh::clean(&scan).expect("sound").mesh, &decoded), 0.0);
        }
    }
    // Nine decimals need more than 20 bits; binary64 numbers are multiples of nothing.
    let file = scans.path("fine.ply");
    write_mesh_in(&file, &moved(&scans, 0, PLACES[0]), Precision::Double).expect("written");
    let said = fails(["encode", &file.to_string_lossy(), "-o", &scans.text("b.knm"), "--lossless"]);
    assert!(
        said.contains("--lossless: vertex") && said.contains("neither integers nor multiples"),
        "{said}"
    );
    assert!(!scans.path("b.knm").exists());
}

#[test]
fn an_animated_glb_far_away_comes_back() {
    let scans = Scans::new();
    fs::create_dir(scans.path("far")).expect("made");
    for index in 0..3 {
        let path = scans.path(&format!("far/f_{index}.obj"));
        write_mesh(&path, &moved(&scans, index, PLACES[0])).expect("written");
    }
    succeeds(scans.encode("far", &["--labels", "none", "--fps", "24"]));
    let (stream, glb) = (scans.text("a.knm"), scans.text("far.glb"));
    succeeds(["decode", &stream, "-o", &glb]);
    succeeds(["decode", &stream, "-o", &scans.text("obj")]);
    let options = ReadOptions { frame_rate: 24.0, ..ReadOptions::default() };
    let inputs = Inputs::find(&[glb.clone().into()], options).expect("readable");
    assert_eq!(inputs.len(), 3);
    for frame in inputs.frames() {
        let frame = frame.expect("readable");
        let other = mesh(&scans.path(&format!("obj/f_{}.obj", frame.index)));
        for (a, b) in frame.mesh.positions.iter().zip(&other.positions) {
            assert!(distance(*a, *b) < 1e-6, "frame {}: {a:?}, not {b:?}", frame.index);
        }
    }
    // The animation is sampled at the stream's rate.
    let measured = succeeds(["compare", &glb, &stream, "--fast", "--json"]);
    assert!(figure(&measured, &["mean", "hausdorff"]) < 1e-6);
}
