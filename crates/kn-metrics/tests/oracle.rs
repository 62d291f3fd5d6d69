//! All mesh pairs of the oracle (`docs/data.md`) against the values of independent reference
//! programs.

use std::collections::HashMap;
use std::path::Path;

use kn_metrics::{
    DEFAULT_LEVELS, IndexedMesh, Interpolation, MeshRef, Msdm2, Msdm2Surface, PointCloud,
    TriangleTree, msdm2, p2s, point_distortion,
};

type Mesh = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// An OFF file of triangles.
fn read_off(path: &Path) -> Mesh {
    let text = std::fs::read_to_string(path).unwrap();
    let mut words = text.split_ascii_whitespace().skip(1);
    let mut count = || words.next().unwrap().parse::<usize>().unwrap();
    let (vertices, faces, _edges) = (count(), count(), count());
    let numbers: Vec<f64> = words.map(|word| word.parse().unwrap()).collect();
    let (positions, rest) = numbers.split_at(3 * vertices);
    let positions = positions.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    let faces = rest.chunks_exact(4).take(faces);
    (positions, faces.map(|f| [f[1] as u32, f[2] as u32, f[3] as u32]).collect())
}

/// The rows of `oracle.csv`, by column.
fn rows(folder: &Path) -> Vec<HashMap<String, String>> {
    let text = std::fs::read_to_string(folder.join("oracle.csv")).unwrap();
    let mut lines = text.lines().map(fields);
    let header = lines.next().unwrap();
    lines.map(|row| header.iter().cloned().zip(row).collect()).collect()
}

/// Fields of a CSV line; a quoted one may hold commas.
fn fields(line: &str) -> Vec<String> {
    let (mut fields, mut quoted) = (vec![String::new()], false);
    for character in line.chars() {
        match character {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            other => fields.last_mut().unwrap().push(other),
        }
    }
    fields
}

fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap()
}

/// Pairs whose score hangs on ties that the reference breaks by its internal order: the allowed
/// error of the symmetric score, where that of the oracle's README is too narrow.
const TIES: [(&str, &str, f64); 5] = [
    // Most vertices share few closest corners and sides.
    ("spot_translate_2", "msdm2", 3e-2),
    ("spot_rot90", "msdm2", 9e-3),
    ("spot_noise_n_0p003_x1e3", "msdm2", 1e-3),
    // Symmetric meshes: queries as close to several distant points as rounding can tell.
    ("multi_noise_n_0p002", "msdm2_proj", 2e-6),
    ("torus_scale2", "msdm2_proj", 3e-6),
];

fn allowed(row: &HashMap<String, String>, prefix: &str) -> f64 {
    let id = row["id"].as_str();
    if let Some(tie) = TIES.iter().find(|tie| (tie.0, tie.1) == (id, prefix)) {
        return tie.2;
    }
    if prefix == "msdm2" {
        f64::max(2e-4, 3.0 * number(row, "tie_sym"))
    } else {
        projected_tolerance(id)
    }
}

/// Errors of the symmetric score and of those of both directions; these may move three
/// times as far, since their errors partly cancel in the mean.
fn errors(
    row: &HashMap<String, String>,
    expected: &HashMap<String, String>,
    prefix: &str,
    found: &Msdm2,
) -> Vec<String> {
    let allowed = allowed(row, prefix);
    let scores = [
        ("sym", found.symmetric, allowed),
        ("AtoB", found.forward.score, 3.0 * allowed),
        ("BtoA", found.backward.score, 3.0 * allowed),
    ];
    let mut errors = Vec::new();
    for (name, score, allowed) in scores {
        let column = format!("{prefix}_{name}");
        let error = (number(expected, &column) - score).abs();
        if error.is_nan() || error > allowed {
            errors.push(format!("{} {column}: error {error:e}, allowed {allowed:e}", row["id"]));
        }
    }
    errors
}

fn projected_tolerance(id: &str) -> f64 {
    if id.contains("0p03") {
        3e-4
    } else if id.contains("noise") && (id.contains("spot") || id.contains("torus")) {
        2e-5
    } else {
        1e-6
    }
}

/// The row to compare with. MSDM2 does not depend on scale, but the reference loses 4 % when a mesh
/// is a millionth in size; such a copy must give what its original gives.
fn expected(rows: &[HashMap<String, String>], index: usize) -> &HashMap<String, String> {
    let original = rows[index]["id"].strip_suffix("_x1em6");
    rows.iter().find(|row| Some(row["id"].as_str()) == original).unwrap_or(&rows[index])
}

#[test]
fn msdm2_gives_the_oracle_values() {
    let Some(folder) = kn_testdata::oracle() else { return };
    let rows = rows(&folder);
    assert_eq!(rows.len(), 44);
    let mut failures = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        let [a, b] = ["A", "B"].map(|column| {
            let (positions, faces) = read_off(&folder.join(&row[column]));
            Msdm2Surface::new(&positions, &faces, DEFAULT_LEVELS).unwrap()
        });
        let expected = expected(&rows, index);
        let found = msdm2(&a, &b, Interpolation::AtVertex);
        failures.extend(errors(row, expected, "msdm2", &found));
        let found = msdm2(&a, &b, Interpolation::Projected);
        failures.extend(errors(row, expected, "msdm2_proj", &found));
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// Both meshes in the oracle's units: the largest side of `a` is 1023, its minimum 0.
fn scaled(a: &Mesh, b: &Mesh) -> [PointCloud; 2] {
    let least = |axis: usize| a.0.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min);
    let most = |axis: usize| a.0.iter().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max);
    let min = [0, 1, 2].map(least);
    let side = (0..3).map(|axis| most(axis) - min[axis]).fold(0.0, f64::max);
    [a, b].map(|mesh| {
        let position = |p: &[f64; 3]| [0, 1, 2].map(|axis| (p[axis] - min[axis]) * 1023.0 / side);
        let positions: Vec<[f64; 3]> = mesh.0.iter().map(position).collect();
        PointCloud::from_vertices(&positions, &mesh.1).unwrap()
    })
}

fn is_near(found: f64, expected: f64, tolerance: f64) -> bool {
    found == expected || (found - expected).abs() <= tolerance * expected.abs() + 1e-8
}

#[test]
fn point_metrics_give_the_oracle_values() {
    let Some(folder) = kn_testdata::oracle() else { return };
    let mut failures = Vec::new();
    for row in rows(&folder) {
        let [a, b] = ["A", "B"].map(|column| read_off(&folder.join(&row[column])));
        let [cloud_a, cloud_b] = scaled(&a, &b);
        let found = point_distortion(&cloud_a, &cloud_b);
        for (column, found, tolerance) in [
            ("v_D1_mse_A", found.d1.from_reference, 1e-5),
            ("v_D1_mse_B", found.d1.from_other, 1e-5),
            ("v_D2_mse_A", found.d2.from_reference, 1e-5),
            ("v_D2_mse_B", found.d2.from_other, 1e-5),
            ("v_D1_psnr", found.d1_psnr(1023.0), 1e-5),
            ("v_D2_psnr", found.d2_psnr(1023.0), 1e-5),
        ] {
            let expected = number(&row, column);
            // Every new vertex is as near to both ends of its edge, up to rounding.
            let tolerance = if row["id"] == "spot_midpoint" { 3e-3 } else { tolerance };
            if !is_near(found, expected, tolerance) {
                failures.push(format!("{} {column}: {found} instead of {expected}", row["id"]));
            }
        }
        let [tree_a, tree_b] = [&a, &b].map(|m| TriangleTree::new(&m.0, &m.1).unwrap());
        let side_a = IndexedMesh::new(MeshRef::new(&a.0, &a.1), &tree_a);
        let side_b = IndexedMesh::new(MeshRef::new(&b.0, &b.1), &tree_b);
        let found = p2s(side_a, side_b, 100_000).unwrap();
        for (column, found, tolerance) in [
            ("surf_rms_AtoB", found.from_reference.rms(), 0.03),
            ("surf_rms_BtoA", found.from_other.rms(), 0.03),
            ("surf_rms_sym", found.rms(), 0.03),
            ("hausdorff_sym", found.hausdorff(), 0.07),
        ] {
            let expected = number(&row, column);
            if !is_near(found, expected, tolerance) && expected > 1e-14 {
                failures.push(format!("{} {column}: {found} instead of {expected}", row["id"]));
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}
