use super::cloud::Sample;
use super::*;
use kn_mesh::vec3::distance_squared;

/// Points with normals of their own.
fn merged<const N: usize>(points: [(Vec3, Vec3); N]) -> PointCloud {
    let sample = |(index, point): (usize, &(Vec3, Vec3))| Sample::new(point.0, index);
    let samples = points.iter().enumerate().map(sample).collect();
    PointCloud::merged(samples, &points.map(|point| point.1)).expect("small coordinates")
}

/// A square in the plane z, of side 8.
fn square(z: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let positions = [[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [0.0, 8.0]].map(|[x, y]| [x, y, z]);
    (positions.to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

fn grid() -> Grid {
    Grid::new([0.0; 3], [8.0, 8.0, 2.0], 9).unwrap()
}

#[test]
fn a_square_has_a_point_on_every_crossing_once() {
    let (positions, faces) = square(1.0);
    let cloud = PointCloud::from_grid(&positions, &faces, &grid()).unwrap();
    assert_eq!(cloud.len(), 81);
    assert!(cloud.points().iter().all(|p| p[2] == 1.0 && p[0].fract() == 0.0));
    assert!(cloud.normals().iter().all(|&n| n == [0.0, 0.0, 1.0]));
}

#[test]
fn d2_sees_only_the_way_along_the_normal() {
    let (positions, faces) = square(0.0);
    let cloud = PointCloud::from_vertices(&positions, &faces).unwrap();
    let moved: Vec<Vec3> = positions.iter().map(|p| [p[0] + 1.0, p[1], p[2] + 0.5]).collect();
    let moved = PointCloud::from_vertices(&moved, &faces).unwrap();
    let found = point_distortion(&cloud, &moved);
    let both = |mean| MeanSquares { from_reference: mean, from_other: mean };
    assert_eq!((found.d1, found.d2), (both(1.25), both(0.25)));
    assert!((found.d1_psnr(8.0) - 10.0 * (192f64 / 1.25).log10()).abs() < 1e-12);
    assert_eq!(point_distortion(&cloud, &cloud).d2_psnr(8.0), f64::INFINITY);
}

#[test]
fn equally_near_points_count_with_their_mean() {
    // Between two reference points; only the first has its normal along the way.
    let one = merged([([0.0; 3], [0.0, 0.0, 1.0])]);
    let two = merged([
        ([1.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ([-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ([0.0, 0.0, 7.0], [0.0, 0.0, 1.0]),
    ]);
    let found = point_distortion(&two, &one);
    assert_eq!((found.d1.from_other, found.d2.from_other), (1.0, 0.5));
    // The one point inherits the mean of all three normals.
    let third = 1.0 / 3.0f64;
    let expected = (2.0 * third.powi(2) + (7.0 * third).powi(2)) / 3.0;
    assert!((found.d2.from_reference - expected).abs() < 1e-12 && found.d1.from_reference == 17.0);
}

#[test]
fn bad_grids_and_meshes_are_refused() {
    let error = |grid: Result<Grid, PointError>| grid.unwrap_err();
    assert_eq!(error(Grid::new([0.0; 3], [0.0; 3], 1024)), PointError::BadGrid);
    assert_eq!(error(Grid::new([0.0; 3], [1.0; 3], 1)), PointError::BadGrid);
    assert_eq!(error(Grid::new([f64::NAN; 3], [1.0; 3], 9)), PointError::BadGrid);
    let (positions, faces) = square(0.0);
    let far: Vec<Vec3> = positions.iter().map(|p| p.map(|x| x * 1e9)).collect();
    let found = PointCloud::from_grid(&far, &faces, &grid()).map(|_| ());
    assert!(matches!(found, Err(PointError::TooManyPoints { .. })));
    let huge: Vec<Vec3> = positions.iter().map(|p| p.map(|x| x * 1e50)).collect();
    assert!(PointCloud::from_grid(&huge, &faces, &grid()).is_err());
    let between = [[0.2, 0.2, 0.0], [0.4, 0.2, 0.0], [0.2, 0.4, 0.0]];
    let found = PointCloud::from_grid(&between, &[[0, 1, 2]], &grid()).map(|_| ());
    assert_eq!(found, Err(PointError::NoPoints));
    assert!(PointCloud::from_vertices(&[], &[]).is_err());
}

#[test]
fn threads_do_not_matter() {
    let (a, b) = (square(0.0), square(0.7));
    let fine = Grid::new([0.0; 3], [8.0, 8.0, 2.0], 80).unwrap();
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let cloud = |mesh: &(Vec<Vec3>, Vec<[u32; 3]>)| {
            PointCloud::from_grid(&mesh.0, &mesh.1, &fine).unwrap()
        };
        pool.install(|| point_distortion(&cloud(&a), &cloud(&b)))
    };
    let one = run(1);
    assert!(one == run(2) && one == run(8));
}

#[test]
fn isolated_vertices_are_measured() {
    let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let far = [triangle[0], triangle[1], triangle[2], [0.0, 0.0, 3.0]];
    let [a, b] = [&triangle[..], &far].map(|p| PointCloud::from_vertices(p, &[[0, 1, 2]]).unwrap());
    assert_eq!((a.len(), b.len()), (3, 4));
    // The farther point is three away from its nearest, the other three are nowhere apart.
    let expected = MeanSquares { from_reference: 0.0, from_other: 9.0 / 4.0 };
    assert_eq!(point_distortion(&a, &b).d1, expected);
}

/// Points of a lattice (ties of many) or anywhere, by a generator without state.
fn points(count: u32, lattice: bool, shift: f64) -> Vec<(Vec3, Vec3)> {
    let number = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 12) / f64::from(1 << 20);
    let point = |i: u32| {
        let place = [0, 1, 2].map(|axis| number(3 * i + axis + 1));
        let place = if lattice { place.map(|x| (x * 6.0).round()) } else { place };
        (place.map(|x| x + shift), [0.0, 0.0, 1.0])
    };
    (0..count).map(point).collect()
}

#[test]
fn the_nearest_points_are_those_of_a_scan() {
    for (lattice, shift) in [(false, 0.0), (false, 0.3), (true, 0.0), (true, 0.5), (true, 40.0)] {
        let cloud = |count, shift| {
            let points = points(count, lattice, shift);
            let samples = points.iter().map(|point| Sample::new(point.0, 0)).collect();
            PointCloud::merged(samples, &[[0.0, 0.0, 1.0]]).expect("small coordinates")
        };
        let (from, to) = (cloud(400, shift), cloud(500, 0.0));
        let found = Neighbours::new(&from, &to);
        let wide = |point: &[f32; 3]| point.map(f64::from);
        for (index, point) in from.points().iter().map(wide).enumerate() {
            let squares: Vec<f64> =
                to.points().iter().map(|to| distance_squared(point, wide(to))).collect();
            let least = squares.iter().copied().fold(f64::INFINITY, f64::min);
            let equal = squares.iter().filter(|&&square| square <= least * (1.0 + 1e-9)).count();
            let near = found.nearest(index);
            assert_eq!(near.len(), equal.min(30));
            assert!(near.iter().all(|&near| squares[near as usize] <= least * (1.0 + 1e-9)));
            assert!(near.windows(2).all(|pair| pair[0] < pair[1]));
        }
    }
}

#[test]
fn vertices_and_samples_are_the_points_of_a_surface() {
    let (a, b) = (square(0.0), square(0.5));
    let cloud = |mesh: &(Vec<Vec3>, Vec<[u32; 3]>)| {
        PointCloud::from_surface(&mesh.0, &mesh.1, 1000).expect("a square")
    };
    let (a, b) = (cloud(&a), cloud(&b));
    assert_eq!((a.len(), point_distortion(&a, &a).d1.worse()), (1004, 0.0));
    let found = point_distortion(&a, &b);
    assert!((found.d1.worse() - 0.25).abs() < 1e-12 && (found.d2.worse() - 0.25).abs() < 1e-12);
    let (positions, faces) = square(1e19);
    let huge = PointCloud::from_surface(&positions, &faces, 9).map(|_| ());
    assert_eq!(huge, Err(PointError::TooLarge));
}
