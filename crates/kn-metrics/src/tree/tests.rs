use proptest::prelude::*;

use super::{Closest, TreeError, TriangleTree};
use kn_mesh::vec3::{Vec3, cross, distance_squared, dot, mul_add, norm_squared, sub};

/// The closest point straight from the definition: the foot on the plane if it is inside, else
/// the best of the three sides.
fn distance_to_face(point: Vec3, [a, b, c]: [Vec3; 3]) -> f64 {
    let to_segment = |a: Vec3, b: Vec3| {
        let ab = sub(b, a);
        let t = dot(sub(point, a), ab) / norm_squared(ab);
        let t = if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.0 };
        distance_squared(point, mul_add(a, t, ab))
    };
    let normal = cross(sub(b, a), sub(c, a));
    let side = |a: Vec3, b: Vec3| dot(cross(sub(b, a), sub(point, a)), normal) > 0.0;
    let sides = to_segment(a, b).min(to_segment(b, c)).min(to_segment(c, a));
    if side(a, b) && side(b, c) && side(c, a) {
        sides.min(dot(sub(point, a), normal).powi(2) / norm_squared(normal))
    } else {
        sides
    }
}

impl TriangleTree {
    /// The closest of all faces.
    fn closest_by_scan(&self, point: Vec3) -> Closest {
        let mut best = (0, self.triangles[0].closest(point));
        for (face, triangle) in self.triangles.iter().enumerate().skip(1) {
            let foot = triangle.closest(point);
            if foot.distance_squared < best.1.distance_squared {
                best = (face as u32, foot);
            }
        }
        self.answer(point, best.0, best.1)
    }
}

/// Vertices on a coarse lattice give degenerate faces, coincident vertices and exact ties.
fn lattice_mesh() -> impl Strategy<Value = (Vec<Vec3>, Vec<[u32; 3]>)> {
    let vertex = [-4i32..5, -4i32..5, -4i32..5].prop_map(|v| v.map(f64::from));
    let faces = prop::collection::vec([0u32..30, 0u32..30, 0u32..30], 1..200);
    (prop::collection::vec(vertex, 30), faces)
}

fn smooth_mesh() -> impl Strategy<Value = (Vec<Vec3>, Vec<[u32; 3]>)> {
    let vertex = [-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64];
    let faces = prop::collection::vec([0u32..30, 0u32..30, 0u32..30], 1..200);
    (prop::collection::vec(vertex, 30), faces)
}

fn assert_closest(mesh: &(Vec<Vec3>, Vec<[u32; 3]>), queries: &[Vec3]) {
    let (positions, faces) = mesh;
    let tree = TriangleTree::new(positions, faces).unwrap();
    for (i, &query) in queries.iter().enumerate() {
        let found = tree.closest(query);
        assert_eq!(found, tree.closest_by_scan(query));
        assert_eq!(found, tree.closest_from(query, (i % (faces.len() + 1)) as u32));
        let corners = faces[found.face as usize].map(|v| positions[v as usize]);
        let nearest = faces
            .iter()
            .map(|face| distance_to_face(query, face.map(|v| positions[v as usize])))
            .fold(f64::INFINITY, f64::min);
        let tolerance = 1e-12 * (1.0 + norm_squared(query));
        assert!((found.distance_squared - nearest).abs() < tolerance, "{found:?} {nearest}");
        let weights = found.barycentric;
        assert!(weights.iter().all(|&w| w >= 0.0) && (weights.iter().sum::<f64>() - 1.0) < 1e-14);
        let point = (0..3).fold([0.0; 3], |sum, i| mul_add(sum, weights[i], corners[i]));
        assert!(distance_squared(point, found.point) < 1e-24);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn finds_what_a_scan_finds_among_ties(
        mesh in lattice_mesh(),
        queries in prop::collection::vec([-9i32..9, -9i32..9, -9i32..9], 1..40),
    ) {
        let queries: Vec<Vec3> = queries.into_iter().map(|q| q.map(|x| 0.5 * f64::from(x))).collect();
        assert_closest(&mesh, &queries);
    }

    #[test]
    fn finds_what_a_scan_finds(
        mesh in smooth_mesh(),
        queries in prop::collection::vec([-2.0..2.0f64, -2.0..2.0f64, -2.0..2.0f64], 1..40),
        scale in -3i32..4,
    ) {
        let scale = 100f64.powi(scale);
        let (positions, faces) = mesh;
        let queries: Vec<Vec3> = queries.into_iter().map(|q| q.map(|x| x * scale)).collect();
        let tree = TriangleTree::new(
            &positions.iter().map(|p| p.map(|x| x * scale)).collect::<Vec<_>>(),
            &faces,
        ).unwrap();
        for &query in &queries {
            prop_assert_eq!(tree.closest(query), tree.closest_by_scan(query));
        }
        let unit: Vec<Vec3> = queries.iter().map(|q| q.map(|x| x / scale)).collect();
        assert_closest(&(positions, faces), &unit);
    }
}

#[test]
fn equal_distances_go_to_the_lowest_face() {
    // A fan around the origin: above it all six faces are equally close.
    let rim = |i: usize| {
        let angle = i as f64 * std::f64::consts::FRAC_PI_3;
        [angle.cos(), angle.sin(), -0.3]
    };
    let positions: Vec<Vec3> = (0..6).map(rim).chain([[0.0; 3]]).collect();
    let faces: Vec<[u32; 3]> = (0..6).map(|i| [(i + 2) % 6, 6, (i + 3) % 6]).collect();
    let tree = TriangleTree::new(&positions, &faces).unwrap();
    let top = tree.closest([0.0, 0.0, 0.7]);
    assert_eq!((top.face, top.point, top.barycentric), (0, [0.0; 3], [0.0, 1.0, 0.0]));
    // Above the ridge between the faces 2 and 3, that is on the segment from vertex 6 to 5.
    let ridge = mul_add([0.0, 0.0, 0.2], 0.4, positions[5]);
    assert_eq!(tree.closest(ridge).face, 2);
    assert_eq!(tree.closest_from(ridge, 3).face, 2);
}

#[test]
fn faces_without_area_are_segments_and_points() {
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 5.0, 0.0]];
    let tree = TriangleTree::new(&positions, &[[1, 0, 2], [3, 3, 3]]).unwrap();
    let middle = tree.closest([2.0, 1.0, 0.0]);
    assert_eq!((middle.face, middle.point, middle.distance_squared), (0, [2.0, 0.0, 0.0], 1.0));
    let point = tree.closest([0.0, 9.0, 0.0]);
    assert_eq!((point.face, point.point, point.distance_squared), (1, [0.0, 5.0, 0.0], 16.0));
}

#[test]
fn a_needle_keeps_twelve_digits() {
    for height in [1e-3, 1e-6, 1e-9, 1e-12] {
        let face = [[0.0; 3], [1.0, 0.0, 0.0], [0.5, height, 0.0]];
        let tree = TriangleTree::new(&face, &[[0, 1, 2]]).unwrap();
        let found = tree.closest([0.25, 0.25 * height, 0.5]);
        assert!((found.distance_squared - 0.25).abs() < 1e-12);
        assert!((found.point[0] - 0.25).abs() < 1e-9, "{found:?}");
    }
}

#[test]
fn far_and_impossible_queries_are_answered() {
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let tree = TriangleTree::new(&positions, &[[0, 1, 2]]).unwrap();
    assert_eq!(tree.closest([1e30, 0.0, 0.0]).point, [1.0, 0.0, 0.0]);
    assert!(!tree.closest([f64::NAN, 0.0, 0.0]).distance_squared.is_finite());
    assert!(!tree.closest([0.0, f64::INFINITY, 0.0]).distance_squared.is_finite());
    assert_eq!(tree.closest([f64::NAN; 3]).face, 0);
}

#[test]
fn bad_meshes_are_named() {
    let corner = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let error = |positions: &[Vec3], faces: &[[u32; 3]]| {
        TriangleTree::new(positions, faces).map(|_| ()).unwrap_err()
    };
    assert_eq!(error(&corner, &[]), TreeError::NoFaces);
    assert_eq!(
        error(&corner, &[[0, 1, 2], [0, 3, 1]]),
        TreeError::VertexOutOfRange { face: 1, vertex: 3, vertex_count: 3 }
    );
    let broken = [corner[0], corner[1], [0.0, f64::NAN, 0.0]];
    assert_eq!(error(&broken, &[[0, 1, 2]]), TreeError::NotFinite { vertex: 2 });
}

#[test]
fn a_list_of_queries_gives_the_single_answers() {
    let n = 40u32;
    let positions: Vec<Vec3> = (0..n * n)
        .map(|i| (f64::from(i % n), f64::from(i / n)))
        .map(|(x, y)| [x, y, (0.3 * x).sin() * (0.2 * y).cos()])
        .collect();
    let faces: Vec<[u32; 3]> = (0..n * (n - 1))
        .filter(|i| i % n + 1 < n)
        .flat_map(|i| [[i, i + 1, i + n], [i + 1, i + n + 1, i + n]])
        .collect();
    let tree = TriangleTree::new(&positions, &faces).unwrap();
    let queries: Vec<Vec3> =
        positions.iter().map(|p| [p[0] + 0.3, p[1] - 0.2, p[2] + 0.8]).collect();
    let all = tree.closest_all(&queries);
    assert_eq!(all.len(), queries.len());
    for (query, closest) in queries.iter().zip(all) {
        assert_eq!(closest, tree.closest_by_scan(*query));
    }
}

/// A sphere of radius 1 around the origin, of about `8 n²` faces.
fn sphere(n: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let turn = |i: u32, of: u32| std::f64::consts::PI * f64::from(i) / f64::from(of);
    let vertex = |i: u32| {
        let (across, around) = (turn(i / (2 * n), 2 * n), turn(i % (2 * n), n));
        let ring = across.sin();
        [ring * around.cos(), ring * around.sin(), across.cos()]
    };
    let quad = |i: u32| {
        let (a, b) = (i, i - i % (2 * n) + (i + 1) % (2 * n));
        [[a, a + 2 * n, b + 2 * n], [a, b + 2 * n, b]]
    };
    let positions = (0..2 * n * (2 * n + 1)).map(vertex).collect();
    (positions, (0..4 * n * n).flat_map(quad).collect())
}

#[test]
fn from_afar_the_distance_is_right_to_seven_digits() {
    let (positions, faces) = sphere(20);
    let tree = TriangleTree::new(&positions, &faces).unwrap();
    for exponent in 0..30 {
        let far = 4.0 * 10f64.powf(0.5 * f64::from(exponent));
        for direction in [[1.0, 0.0, 0.0], [0.3, -0.5, 0.7], [-0.9, 0.1, 1e-9]] {
            let query = direction.map(|x: f64| far * x);
            let (found, best) = (tree.closest(query), tree.closest_by_scan(query));
            let excess = found.distance_squared.sqrt() / best.distance_squared.sqrt() - 1.0;
            assert!((-1e-12..1e-7).contains(&excess), "{far:e}: {excess:e}");
        }
    }
}

/// From its centre all faces of a sphere are equally near up to their size.
#[test]
fn a_search_among_equally_near_faces_ends_early() {
    let (positions, faces) = sphere(110);
    let tree = TriangleTree::new(&positions, &faces).unwrap();
    let started = std::time::Instant::now();
    for i in 0..20_000 {
        let query = [0, 1, 2].map(|axis| 1e-4 * f64::from((i * (axis + 3) * 7919) % 997) / 997.0);
        let found = tree.closest(query).distance_squared.sqrt();
        assert!((0.999..1.001).contains(&found), "{found}");
    }
    // All 24 200 leaves for each query would take minutes without optimisation, seconds with it.
    assert!(started.elapsed().as_secs() < 60);
}
