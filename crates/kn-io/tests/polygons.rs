//! Polygons become triangles that fill them, whatever their form, and frames that have the same
//! faces are cut in the same way.

// Tests may use the platform's functions.
#![allow(clippy::disallowed_methods)]

use kn_io::{ReadOptions, Scan, read_mesh};

fn read(name: &str, text: &str) -> Scan {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join(name);
    std::fs::write(&path, text).expect("written");
    read_mesh(&path, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

type Points = Vec<[f64; 3]>;

/// An OBJ file with one polygon.
fn polygon(points: &[[f64; 3]]) -> Scan {
    let vertices: String =
        points.iter().map(|[x, y, z]| format!("v {x:.6} {y:.6} {z:.6}\n")).collect();
    let face: String = (1..=points.len()).map(|corner| format!(" {corner}")).collect();
    read("a.obj", &format!("{vertices}f{face}\n"))
}

fn area(scan: &Scan) -> f64 {
    let mesh = &scan.mesh;
    let corner = |vertex: u32| glam::DVec3::from(mesh.positions[vertex as usize]);
    let area =
        |&[a, b, c]: &[u32; 3]| (corner(b) - corner(a)).cross(corner(c) - corner(a)).length() / 2.0;
    mesh.faces.iter().map(area).sum()
}

/// The area of a polygon in the plane z = 0, by its outline (Gauss).
fn outlined(points: &[[f64; 3]]) -> f64 {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>().abs() / 2.0
}

/// A polygon in the plane z = 0 with one radius for each corner.
fn star(radii: &[f64]) -> Points {
    let angle = |corner: usize| corner as f64 / radii.len() as f64 * std::f64::consts::TAU;
    let place =
        |(corner, r): (usize, &f64)| [r * angle(corner).cos(), r * angle(corner).sin(), 0.0];
    radii.iter().enumerate().map(place).collect()
}

fn in_plane(points: &[[f64; 2]]) -> Points {
    points.iter().map(|[x, y]| [*x, *y, 0.0]).collect()
}

/// Polygons that no fan around their first corner fills, and some that one does.
fn shapes() -> Vec<(&'static str, Points)> {
    let arrow = [[0.0, 0.0], [1.0, 0.35], [2.0, 0.0], [1.0, 2.0]];
    let comb = [
        [0.0, 0.0],
        [5.0, 0.0],
        [5.0, 3.0],
        [4.0, 3.0],
        [4.0, 1.0],
        [3.0, 1.0],
        [3.0, 3.0],
        [2.0, 3.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 3.0],
        [0.0, 3.0],
    ];
    let spiral = [
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [1.0, 4.0],
        [1.0, 2.0],
        [2.0, 2.0],
        [2.0, 3.0],
        [3.0, 3.0],
        [3.0, 1.0],
        [0.0, 1.0],
    ];
    let ell = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    let gear: Vec<f64> = (0..40).map(|corner| if corner % 4 < 2 { 1.0 } else { 0.7 }).collect();
    let circle = vec![1.0; 17];
    let many: Vec<f64> = (0..600).map(|at| 1.0 + 0.3 * f64::from(at * at % 7)).collect();
    vec![
        ("arrow", in_plane(&arrow)),
        ("comb", in_plane(&comb)),
        ("spiral", in_plane(&spiral)),
        ("L with corners on straight edges", in_plane(&ell)),
        ("star", star(&[1.0, 0.4, 1.0, 0.4, 1.0, 0.4, 1.0, 0.4, 1.0, 0.4])),
        ("gear", star(&gear)),
        ("circle", star(&circle)),
        ("600 corners", star(&many)),
    ]
}

#[test]
fn every_form_is_filled_from_every_corner_in_every_plane() {
    for (name, points) in shapes() {
        let turns = points.len().min(12);
        for turn in 0..turns {
            let mut points = points.clone();
            points.rotate_left(turn);
            for reversed in [false, true] {
                if reversed {
                    points.reverse();
                }
                for tilt in [0.0, 0.4, 1.3, std::f64::consts::FRAC_PI_2] {
                    let (sin, cos) = tilt.sin_cos();
                    let tilted: Points =
                        points.iter().map(|[x, y, _]| [7.0 + x * cos, *y - 3.0, x * sin]).collect();
                    let scan = polygon(&tilted);
                    let wanted = outlined(&points);
                    let label = format!("{name}, turn {turn}, reversed {reversed}, tilt {tilt}");
                    assert!((area(&scan) - wanted).abs() < 1e-4 * wanted, "{label}");
                    assert_eq!(scan.mesh.faces.len(), points.len() - 2, "{label}");
                    check_sides(&scan, points.len(), &label);
                }
            }
        }
    }
}

/// Each side of the polygon is the side of one triangle, in its direction; every other side of a
/// triangle is one of another triangle in the other direction.
fn check_sides(scan: &Scan, corners: usize, label: &str) {
    let mut sides = std::collections::BTreeMap::new();
    for &[a, b, c] in &scan.mesh.faces {
        for side in [(a, b), (b, c), (c, a)] {
            *sides.entry(side).or_insert(0) += 1;
        }
    }
    for at in 0..corners as u32 {
        assert_eq!(sides.remove(&(at, (at + 1) % corners as u32)), Some(1), "{label}: side {at}");
    }
    for ((a, b), count) in &sides {
        assert_eq!((*count, sides.get(&(*b, *a))), (1, Some(&1)), "{label}: side {a} {b}");
    }
}

#[test]
fn a_hole_that_an_edge_joins_to_the_rim_stays_a_hole() {
    let vertices = "v 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nv 1 1 0\nv 1 2 0\nv 3 2 0\nv 3 1 0\n";
    let again = "v 0 0 0\nv 1 1 0\n";
    for face in ["f 1 2 3 4 1 5 6 7 8 5\n", "f 1 2 3 4 9 10 6 7 8 5\n", "f 5 1 2 3 4 1 5 6 7 8\n"] {
        let scan = read("a.obj", &format!("{vertices}{again}{face}"));
        assert!((area(&scan) - 10.0).abs() < 1e-6, "{face}");
        assert_eq!(scan.mesh.faces.len(), 8, "{face}");
    }
}

#[test]
fn a_warped_quad_is_cut_where_it_does_not_fold() {
    for height in [0.0, 0.1, 0.25, 0.5, -0.5] {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.35, 0.0], [2.0, 0.0, 0.0], [1.0, 2.0, height]];
        for turn in 0..4 {
            let mut turned = points.to_vec();
            turned.rotate_left(turn);
            let scan = polygon(&turned);
            // Both triangles have the edge from the reflex corner to the far one.
            let (reflex, far) = ((5 - turn as u32) % 4, (7 - turn as u32) % 4);
            let both =
                scan.mesh.faces.iter().all(|face| face.contains(&reflex) && face.contains(&far));
            assert!(both, "height {height}, turn {turn}: {:?}", scan.mesh.faces);
        }
    }
}

/// Quads that stretch, shear and bend a little from frame to frame, as those of a tracked mesh do.
#[test]
fn frames_with_the_same_quads_are_cut_in_the_same_way() {
    let frame = |time: f64| {
        let mut text = String::new();
        for (y, x) in (0..9).flat_map(|y| (0..9).map(move |x| (y, x))) {
            let (x, y) = (f64::from(x), f64::from(y));
            let wave = 0.3 * (x + 2.0 * time).sin();
            text += &format!(
                "v {:.4} {:.4} {wave:.4}\n",
                x + 0.3 * (y + time).sin(),
                y + 0.2 * (x - time).cos()
            );
        }
        for (y, x) in (0..8).flat_map(|y| (0..8).map(move |x| (y, x))) {
            let low = y * 9 + x + 1;
            text += &format!("f {} {} {} {}\n", low, low + 1, low + 10, low + 9);
        }
        read("a.obj", &text).mesh.faces
    };
    let first = frame(0.0);
    for step in 1..30 {
        assert_eq!(frame(f64::from(step) * 0.2), first, "step {step}");
    }
}

#[test]
fn a_polygon_that_repeats_corners_or_has_no_area_does_no_harm() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 3 0 0\n";
    for (faces, triangles) in [
        ("f 1 2 3 3\n", 1),
        ("f 1 1 2 3 4 4 1\n", 2),
        ("f 1 2 3\nf 1 1 1 1\n", 1),
        ("f 1 2 3\nf 1 2 1 2\n", 3),
        ("f 1 2 5 6\n", 2),
        ("f 1 2 5 6 2\n", 3),
        ("f 1 3 2 4\n", 2),
        ("f 1 3 2 4 5\n", 3),
    ] {
        let scan = read("a.obj", &format!("{vertices}{faces}"));
        assert_eq!(scan.mesh.faces.len(), triangles, "{faces}");
    }
    let notes = read("a.obj", &format!("{vertices}f 1 2 3 4\nf 2 2 2 2\n")).notes.to_string();
    assert_eq!(
        notes,
        "1 polygon cut into 2 triangles; not carried: faces with fewer than 3 corners (1)"
    );
}

#[test]
fn triangles_keep_their_place_between_polygons() {
    let scan = read(
        "a.off",
        "OFF\n4 4 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3\n3 2 3 0\n4 3 2 1 0\n",
    );
    let faces = [[0, 1, 2], [0, 1, 2], [0, 2, 3], [2, 3, 0], [3, 2, 1], [3, 1, 0]];
    assert_eq!(scan.mesh.faces, faces);
}

#[test]
fn coordinates_of_any_size_are_cut() {
    for size in [1e-300, 1e-40, 1e-20, 1e20, 1e37] {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.2, 0.2], [0.0, 1.0], [-0.5, 0.2]];
        let vertices: String =
            points.iter().map(|[x, y]| format!("v {:e} {:e} 0\n", x * size, y * size)).collect();
        let scan = read("a.obj", &format!("{vertices}f 1 2 3 4 5\n"));
        assert_eq!(scan.mesh.faces.len(), 3, "{size:e}");
    }
}
