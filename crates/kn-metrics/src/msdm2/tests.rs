use std::path::Path;

use super::direction::Scratch;
use super::machine::Baseline;
use super::*;
use crate::tree::Closest;
use kn_mesh::vec3::distance_squared;

mod limits;

/// A torus of `around × across` quads cut into triangles; `bump` moves each vertex along its
/// normal by a value from −1..=1.
fn torus(around: u32, across: u32, bump: impl Fn(u32) -> f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let turn = |i: u32, n: u32| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
    let vertex = |index: u32| {
        let (u, v) = (turn(index / across, around), turn(index % across, across));
        let radius = 0.4 + bump(index);
        let ring = 1.0 + radius * libm::cos(v);
        [ring * libm::cos(u), ring * libm::sin(u), radius * libm::sin(v)]
    };
    let quad = |index: u32| {
        let (i, j) = (index / across, index % across);
        let at = |i: u32, j: u32| (i % around) * across + j % across;
        let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        [[a, b, c], [a, c, d]]
    };
    let count = around * across;
    ((0..count).map(vertex).collect(), (0..count).flat_map(quad).collect())
}

/// A hash in −1..=1.
fn noise(index: u32) -> f64 {
    let mixed = index.wrapping_add(1).wrapping_mul(0x9e37_79b9);
    let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x85eb_ca6b);
    f64::from((mixed ^ (mixed >> 13)) as i32) / f64::from(i32::MAX)
}

fn surface((positions, faces): &(Vec<Vec3>, Vec<[u32; 3]>)) -> Msdm2Surface {
    Msdm2Surface::new(positions, faces, DEFAULT_LEVELS).unwrap()
}

fn scores(result: &Msdm2) -> [f64; 2] {
    [result.forward.score, result.backward.score]
}

fn assert_scores(found: [f64; 2], expected: [f64; 2]) {
    let near = (0..2).all(|i| (found[i] - expected[i]).abs() < 1e-9);
    assert!(near, "{found:?} instead of {expected:?}");
}

/// Frozen once the 44 pairs of the oracle agreed.
#[test]
fn own_meshes_keep_their_values() {
    let smooth = surface(&torus(90, 45, |i| 0.0005 * noise(i + 7000)));
    let noisy = surface(&torus(90, 45, |i| 0.002 * noise(i)));
    let coarse = surface(&torus(61, 29, |_| 0.0));
    let of = |a, b, interpolation| scores(&msdm2(a, b, interpolation));
    for (found, expected) in [
        (of(&smooth, &noisy, Interpolation::Projected), [0.420620421005, 0.419840569804]),
        (of(&smooth, &noisy, Interpolation::AtVertex), [0.420657049038, 0.408835772104]),
        (of(&smooth, &coarse, Interpolation::Projected), [0.182790726894, 0.276279588247]),
        (of(&noisy, &coarse, Interpolation::Projected), [0.321126481159, 0.469156299693]),
    ] {
        assert_scores(found, expected);
    }
}

#[test]
fn a_mesh_is_equal_to_itself() {
    let mesh = surface(&torus(40, 20, |i| 0.01 * noise(i)));
    let result = msdm2(&mesh, &mesh, Interpolation::AtVertex);
    assert!(result.symmetric < 1e-12 && result.forward == result.backward);
    assert_eq!(result.forward.local.len(), 800);
}

#[test]
fn size_and_place_do_not_matter() {
    let (a, b) = (torus(40, 20, |i| 0.01 * noise(i + 900)), torus(40, 20, |i| 0.01 * noise(i)));
    let moved = |mesh: &(Vec<Vec3>, Vec<[u32; 3]>), scale: f64| {
        let position = |p: &Vec3| [p[0] * scale + 3.0 * scale, p[1] * scale, p[2] * scale];
        surface(&(mesh.0.iter().map(position).collect(), mesh.1.clone()))
    };
    let expected = scores(&msdm2(&surface(&a), &surface(&b), Interpolation::Projected));
    for scale in [1e-6, 1e-3, 1e3, 1e9] {
        let found = msdm2(&moved(&a, scale), &moved(&b, scale), Interpolation::Projected);
        assert_scores(scores(&found), expected);
    }
}

#[test]
fn each_level_has_its_own_curvature() {
    let mesh = torus(40, 20, |i| 0.01 * noise(i));
    let one = Msdm2Surface::new(&mesh.0, &mesh.1, 1).unwrap();
    let five = Msdm2Surface::new(&mesh.0, &mesh.1, 5).unwrap();
    for (one, five) in one.curvature.iter().zip(five.curvature.chunks(5)) {
        assert!((one - five[0]).abs() <= 1e-12 * one && five[0] > five[4]);
    }
    // The curvature that a surface has not prepared is computed for the comparison.
    let other = surface(&torus(40, 20, |_| 0.0));
    let found = msdm2(&one, &other, Interpolation::AtVertex);
    let narrow = Msdm2Surface::new(&other.positions, &other.faces, 1).unwrap();
    assert_eq!(found, msdm2(&one, &narrow, Interpolation::AtVertex));
}

#[test]
fn isolated_vertices_are_counted_and_skipped() {
    let (mut positions, faces) = torus(40, 20, |i| 0.01 * noise(i));
    let reference = surface(&torus(40, 20, |_| 0.0));
    let clean =
        msdm2(&reference, &surface(&(positions.clone(), faces.clone())), Interpolation::AtVertex);
    positions.push([50.0, 0.0, 0.0]);
    let found = msdm2(&reference, &surface(&(positions, faces)), Interpolation::AtVertex);
    assert_eq!((found.forward.isolated, found.forward.local[800]), (1, 0.0));
    assert_eq!(scores(&found), scores(&clean));
}

#[test]
fn degenerate_and_non_manifold_faces_give_finite_values() {
    let (positions, mut faces) = torus(40, 20, |i| 0.01 * noise(i));
    let clean = surface(&(positions.clone(), faces.clone()));
    faces.extend([[0, 0, 1], [5, 5, 5], [7, 8, 9], [100, 101, 300]]);
    let dirty = surface(&(positions, faces));
    let result = msdm2(&clean, &dirty, Interpolation::AtVertex);
    assert!(result.symmetric.is_finite() && result.symmetric > 0.0 && result.symmetric < 1.0);
    assert!(result.forward.local.iter().chain(&result.backward.local).all(|x| x.is_finite()));
}

#[test]
fn coincident_unconnected_vertices_are_kept_apart() {
    let whole = torus(40, 20, |i| 0.01 * noise(i));
    let corners = whole.1.iter().flatten().map(|&vertex| whole.0[vertex as usize]).collect();
    let faces = (0..whole.1.len() as u32).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]);
    let soup = (corners, faces.collect());
    let found = msdm2(&surface(&whole), &surface(&soup), Interpolation::AtVertex);
    // Nothing bends in a soup of faces.
    assert_eq!((found.forward.isolated, found.forward.local.len()), (0, 4800));
    assert!(found.symmetric > 0.5 && found.symmetric < 1.0);
    let points = crate::PointCloud::from_vertices(&soup.0, &soup.1).unwrap();
    assert_eq!(points.len(), 800);
}

#[test]
fn orientation_does_not_matter() {
    let mesh = torus(40, 20, |i| 0.01 * noise(i));
    let flipped = mesh.1.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let found =
        msdm2(&surface(&mesh), &surface(&(mesh.0.clone(), flipped)), Interpolation::Projected);
    assert!(found.symmetric < 1e-12, "{}", found.symmetric);
}

/// The pair `torus_scale2` of the oracle by its recipe: a torus written with nine digits, against
/// the double of what was written.
#[test]
fn an_oracle_pair_made_by_its_recipe_keeps_its_values() {
    let written = |x: f64| format!("{x:.8e}").parse::<f64>().unwrap();
    let positions = torus(64, 32, |_| 0.0).0;
    // The diagonals of its quads alternate.
    let quad = |index: u32| {
        let (i, j) = (index / 32, index % 32);
        let at = |i: u32, j: u32| i % 64 * 32 + j % 32;
        let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
    };
    let faces: Vec<[u32; 3]> = (0..64 * 32).flat_map(quad).collect();
    let original: Vec<Vec3> = positions.iter().map(|p| p.map(written)).collect();
    let double = original.iter().map(|p| p.map(|x| written(2.0 * x))).collect();
    let (a, b) = (surface(&(original, faces.clone())), surface(&(double, faces)));
    let near = |found: f64, expected: f64, tolerance| {
        assert!((found - expected).abs() < tolerance, "{found} instead of {expected}");
    };
    let projected = msdm2(&a, &b, Interpolation::Projected);
    near(projected.forward.score, 0.144636579562, 1e-5);
    near(projected.backward.score, 0.154604076884, 1e-5);
    // Three times what re-ordering moves the reference's own score by.
    near(msdm2(&a, &b, Interpolation::AtVertex).symmetric, 0.142797851801, 3.0 * 0.00167);
}

#[test]
fn each_direction_has_its_own_unit() {
    let small = surface(&torus(40, 20, |i| 0.01 * noise(i)));
    let (positions, faces) = torus(40, 20, |i| 0.01 * noise(i + 900));
    let large = surface(&(positions.iter().map(|p| p.map(|x| 1.5 * x)).collect(), faces));
    let found = msdm2(&small, &large, Interpolation::AtVertex);
    let swapped = msdm2(&large, &small, Interpolation::AtVertex);
    // The box of the distorted mesh decides, whichever is called the reference.
    assert_eq!((&found.forward, &found.backward), (&swapped.backward, &swapped.forward));
    assert!(large.side > 1.4 * small.side && found.forward.score != found.backward.score);
}

#[test]
fn a_single_flipped_face_is_taken_in_the_order_of_indices() {
    let (positions, mut faces) = torus(40, 20, |i| 0.01 * noise(i));
    let clean = surface(&(positions.clone(), faces.clone()));
    faces[300].swap(1, 2);
    let found = msdm2(&clean, &surface(&(positions, faces)), Interpolation::Projected);
    assert!(found.symmetric > 0.0 && found.symmetric < 1.0, "{}", found.symmetric);
}

#[test]
fn threads_do_not_matter() {
    let (a, b) = (torus(80, 41, |_| 0.0), hard());
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let surface = |mesh: &(Vec<Vec3>, Vec<[u32; 3]>)| {
            Msdm2Surface::new(&mesh.0, &mesh.1, MAX_LEVELS).unwrap()
        };
        pool.install(|| msdm2(&surface(&a), &surface(&b), Interpolation::AtVertex))
    };
    let one = run(1);
    assert!(one == run(2) && one == run(8));
}

/// A noisy torus with what floods find hard: a vertex with twenty neighbours, and two connected
/// vertices at one place.
pub(super) fn hard() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut positions, mut faces) = torus(90, 45, |i| 0.01 * noise(i));
    let apex = positions.len() as u32;
    positions.push([1.5, 0.0, 0.03]);
    for i in 0..20 {
        let turn = f64::from(i) * std::f64::consts::TAU / 20.0;
        positions.push([1.5 + 0.03 * libm::cos(turn), 0.03 * libm::sin(turn), 0.0]);
        faces.push([apex, apex + 1 + i, apex + 1 + (i + 1) % 20]);
    }
    positions.push(positions[7]);
    faces.push([7, positions.len() as u32 - 1, 8]);
    (positions, faces)
}

fn closest_faces(original: &Msdm2Surface, distorted: &Msdm2Surface) -> Vec<Closest> {
    matching::preferred(original, &original.tree.closest_all(&distorted.positions))
}

/// The mean over the levels at one vertex.
fn local_of(direction: &Direction<'_>, vertex: usize, scratch: &mut Scratch) -> f64 {
    let mut local = [0.0];
    direction.local(Baseline, vertex, scratch, &mut local);
    local[0]
}

#[test]
fn the_machine_does_not_matter() {
    let prepared = |(positions, faces): (Vec<Vec3>, Vec<[u32; 3]>)| {
        Msdm2Surface::new(&positions, &faces, MAX_LEVELS).unwrap()
    };
    let (a, b) = (prepared(torus(80, 41, |_| 0.0)), prepared(hard()));
    let matches = closest_faces(&a, &b);
    let direction = Direction::new(&b, &a, &matches, MAX_LEVELS, &[Interpolation::AtVertex]);
    let mut scratch = Scratch::new(b.positions.len(), MAX_LEVELS);
    let mut samples = 0;
    for (vertex, &local) in direction.evaluate()[0].local.iter().enumerate() {
        assert!(local == local_of(&direction, vertex, &mut scratch), "vertex {vertex}");
        samples += scratch.count(MAX_LEVELS - 1);
    }
    assert!(samples > 50 * b.positions.len(), "neighbourhoods of several waves");
}

fn read_off(path: &Path) -> (Vec<Vec3>, Vec<[u32; 3]>) {
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

/// Compares every stage at every vertex. The reference's choice among equally close faces is
/// checked to be such a choice, and then taken over, since curvature depends on it.
fn compare_stages(original: &Msdm2Surface, distorted: &Msdm2Surface, text: &str) {
    let rows = text.lines().filter(|line| !line.starts_with('#'));
    let rows: Vec<Vec<f64>> =
        rows.map(|row| row.split(' ').map(|word| word.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), distorted.positions.len());
    let mut matches = closest_faces(original, distorted);
    for (closest, row) in matches.iter_mut().zip(&rows) {
        let (vertex, point) = (distorted.positions[row[0] as usize], [row[1], row[2], row[3]]);
        let reference = distance_squared(vertex, point);
        assert!((closest.distance_squared - reference).abs() <= 1e-12 * reference.max(1e-6));
        closest.face = row[4] as u32;
        closest.point = point;
    }
    let direction =
        Direction::new(distorted, original, &matches, DEFAULT_LEVELS, &[Interpolation::AtVertex]);
    let mut scratch = Scratch::new(rows.len(), DEFAULT_LEVELS);
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs().max(1.0);
    for row in &rows {
        let vertex = row[0] as usize;
        let mean = local_of(&direction, vertex, &mut scratch);
        assert!(near(mean, row[17]), "vertex {vertex}: {mean} instead of {}", row[17]);
        for level in 0..DEFAULT_LEVELS {
            let stage = &row[5 + 4 * level..];
            let [own, other] = direction.record(vertex, level).curvatures();
            assert!(near(own, stage[0]), "vertex {vertex}, level {level}");
            assert!(near(other, stage[1]), "vertex {vertex}, level {level}");
            let count = scratch.count(level);
            assert_eq!(count, stage[2] as usize, "vertex {vertex}, level {level}");
        }
    }
}

#[test]
fn stages_agree_with_the_oracle() {
    let Some(folder) = kn_testdata::oracle() else { return };
    for (original, distorted) in [("sph642", "sph642_noise_n_0p01"), ("spot", "spot_simp20")] {
        let mesh = |name: &str| surface(&read_off(&folder.join(format!("meshes/{name}.off"))));
        let (a, b) = (mesh(original), mesh(distorted));
        let text = |direction: &str| {
            let file = format!("stages/{distorted}.{direction}.txt");
            std::fs::read_to_string(folder.join(file)).unwrap()
        };
        compare_stages(&a, &b, &text("ab"));
        compare_stages(&b, &a, &text("ba"));
    }
}

/// The faces that hold the closest point as well: those around its side or its corner.
fn tied(original: &Msdm2Surface, around: &[Vec<u32>], closest: &Closest) -> Vec<u32> {
    let face = original.faces[closest.face as usize];
    let on = (0..3).filter(|&i| closest.barycentric[i] != 0.0).map(|i| face[i]);
    let on: Vec<u32> = on.collect();
    let holds = |face: &u32| on.iter().all(|v| original.faces[*face as usize].contains(v));
    around[on[0] as usize].iter().copied().filter(holds).collect()
}

/// The value that a choice among equally close faces makes small, given the face, its curvature and
/// the vertex's own.
type Choice = fn(u32, f64, f64) -> f64;

const CHOICES: [Choice; 6] = [
    |face, _, _| f64::from(face),
    |face, _, _| -f64::from(face),
    |_, other, _| other,
    |_, other, _| -other,
    |_, other, own| (other - own).abs(),
    |_, other, own| -(other - own).abs(),
];

/// One direction's score when every vertex whose closest point is on a side or a corner takes the
/// same choice of face.
fn score_by(original: &Msdm2Surface, distorted: &Msdm2Surface, choice: Choice) -> f64 {
    let mut around = vec![Vec::new(); original.positions.len()];
    for (index, face) in (0..).zip(&original.faces) {
        face.iter().for_each(|&vertex| around[vertex as usize].push(index));
    }
    let own = distorted.curvature(distorted.side, 1);
    let other = original.curvature(distorted.side, 1);
    let mut matches = closest_faces(original, distorted);
    for (vertex, closest) in matches.iter_mut().enumerate() {
        let cost = |&face: &u32| {
            let closest = Closest { face, ..*closest };
            let weights = matching::opposite_areas(original, &closest, distorted.positions[vertex]);
            let corners = original.faces[face as usize].map(|corner| other[corner as usize]);
            choice(face, kn_mesh::vec3::dot(weights, corners), own[vertex])
        };
        let faces = tied(original, &around, closest);
        let best = faces.iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
        closest.face = *best.unwrap();
    }
    let direction =
        Direction::new(distorted, original, &matches, DEFAULT_LEVELS, &[Interpolation::AtVertex]);
    direction.evaluate()[0].score
}

/// Where our score is not within the oracle's tolerance, other choices among equally close faces
/// move it to both sides of the reference's.
#[test]
fn ties_explain_what_differs_from_the_oracle() {
    let Some(folder) = kn_testdata::oracle() else { return };
    for (name, original, reference) in [
        ("spot_translate_2", "spot", [0.629485074744, 0.619921572217]),
        ("spot_rot90", "spot", [0.639561726432, 0.643696741663]),
        (
            "spot_noise_n_0p003_x1e3",
            "spot_noise_n_0p003_x1e3_ref",
            [0.599123516355, 0.563223439542],
        ),
    ] {
        let mesh = |name: &str| surface(&read_off(&folder.join(format!("meshes/{name}.off"))));
        let (a, b) = (mesh(original), mesh(name));
        for (from, to, reference) in [(&a, &b, reference[0]), (&b, &a, reference[1])] {
            let scores = CHOICES.map(|choice| score_by(from, to, choice));
            let least = scores.into_iter().fold(f64::INFINITY, f64::min);
            let most = scores.into_iter().fold(0.0, f64::max);
            println!("{name}: {least:.6} to {most:.6}, the reference has {reference:.6}");
            assert!(least < reference && reference < most, "{name}");
        }
    }
}
