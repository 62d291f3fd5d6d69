use super::*;

/// A bent sheet of `n × n` squares of side 1 / n, moved by `z`.
fn sheet(n: u32, z: f64) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let position = |i: u32| {
        let (x, y) = (f64::from(i % (n + 1)) / f64::from(n), f64::from(i / (n + 1)) / f64::from(n));
        [x, y, z + 0.1 * libm::sin(5.0 * x)]
    };
    let corner = |i: u32| i % n + i / n * (n + 1);
    let faces =
        (0..n * n).map(corner).flat_map(|c| [[c, c + 1, c + n + 2], [c, c + n + 2, c + n + 1]]);
    ((0..(n + 1) * (n + 1)).map(position).collect(), faces.collect())
}

fn compared(n: u32, z: f64, options: &CompareOptions) -> Comparison {
    let (a, b) = (sheet(n, 0.0), sheet(n, z));
    compare(MeshRef::new(&a.0, &a.1), MeshRef::new(&b.0, &b.1), options).expect("comparable")
}

#[test]
fn a_moved_sheet_is_as_far_as_it_was_moved() {
    let found = compared(20, 0.01, &CompareOptions::perceptual());
    let rms = found.get(Metric::P2sRmsWorld).expect("measured");
    assert!((0.008..=0.010).contains(&rms), "{rms}");
    let sheet = sheet(20, 0.0);
    let diagonal = MeshRef::new(&sheet.0, &sheet.1).bounding_box().expect("a box").diagonal();
    assert!((found.get(Metric::P2sRms).expect("measured") * diagonal - rms).abs() < 1e-12);
    assert!(found.get(Metric::Msdm2).is_some() && found.get(Metric::D1Psnr).is_none());
}

#[test]
fn equal_meshes_are_at_no_distance() {
    let found = compared(8, 0.0, &CompareOptions::default());
    // A sample inside a face is on it up to the last bits.
    assert!(found.get(Metric::P2sRms).is_some_and(|rms| rms < 1e-15));
    assert!(found.get(Metric::P2sPsnr).is_some_and(|psnr| psnr > 250.0));
    assert!(found.get(Metric::Msdm2).is_some_and(|msdm2| msdm2 < 1e-6));
    assert_eq!(found.get(Metric::D1Psnr), Some(f64::INFINITY));
    assert_eq!(found.iter().count(), Metric::ALL.len());
}

#[test]
fn means_are_of_what_all_have() {
    let one: Comparison = [(Metric::P2sRms, 1.0), (Metric::Msdm2, 0.5)].into_iter().collect();
    let two: Comparison = [(Metric::P2sRms, 3.0)].into_iter().collect();
    let mean = Comparison::mean([&one, &two]).expect("two");
    assert_eq!((mean.get(Metric::P2sRms), mean.get(Metric::Msdm2)), (Some(2.0), None));
    assert_eq!(Comparison::mean([]), None);
}

#[test]
fn marked_faces_are_measured_alone() {
    let options = CompareOptions::distances();
    let surface = |(positions, faces): (Vec<[f64; 3]>, Vec<[u32; 3]>)| {
        Surface::new(MeshRef::new(&positions, &faces), &options).expect("a surface")
    };
    let (a, b) = (surface(sheet(4, 0.0)), surface(sheet(4, 0.5)));
    let marks = vec![true; a.mesh().faces.len()];
    let all = FaceMarks { reference: &marks, distorted: &marks };
    let found = compare_faces(&a, &b, all, &options).expect("comparable");
    assert!(found.get(Metric::P2sRmsWorld).is_some_and(|rms| (0.3..=0.5).contains(&rms)));
    let short = FaceMarks { reference: &marks[1..], distorted: &marks };
    let length = P2sError::MaskLength { expected: 32, found: 31 };
    assert_eq!(compare_faces(&a, &b, short, &options), Err(CompareError::Distance(length)));
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let sheet = sheet(4, 0.0);
    let (mesh, empty) = (MeshRef::new(&sheet.0, &sheet.1), MeshRef::new(&[], &[]));
    let options = CompareOptions::distances();
    assert_eq!(compare(mesh, empty, &options), Err(CompareError::Mesh(TreeError::NoFaces)));
    let surface = Surface::new(mesh, &options).expect("a surface");
    let found = compare_surfaces(&surface, &surface, &CompareOptions::perceptual());
    assert_eq!(found, Err(CompareError::NotPrepared));
    assert_eq!("msdm2_ab".parse(), Ok(Metric::Msdm2Forward));
    assert!("msdm3".parse::<Metric>().is_err_and(|error| error.to_string().contains("msdm3")));
}

/// What `compare` has to end with, wherever the meshes are: a value for every metric.
#[test]
fn meshes_anywhere_are_measured() {
    let sheet = sheet(60, 0.0);
    let turned = |p: &[f64; 3]| [0.6 * p[0] - 0.8 * p[2], p[1], 0.8 * p[0] + 0.6 * p[2]];
    let moved = |far: f64, scale: f64| {
        move |p: &[f64; 3]| {
            let [x, y, z] = turned(p);
            [scale * x + far, scale * y - 0.4 * far, scale * z + 0.7 * far]
        }
    };
    let places =
        [(0.0, 1.0), (1.0, 1.0), (30.0, 1.0), (1e4, 1.0), (1e8, 1.0), (0.0, 1e3), (0.1, 1e-4)];
    for (far, scale) in places {
        let place = moved(far, scale);
        let other: Vec<[f64; 3]> = sheet.0.iter().map(place).collect();
        let reference = MeshRef::new(&sheet.0, &sheet.1);
        let options = CompareOptions::default();
        let found = compare(reference, MeshRef::new(&other, &sheet.1), &options).expect("measured");
        assert!(found.iter().count() == Metric::ALL.len());
        assert!(found.iter().all(|(_, value)| !value.is_nan()), "{far} {scale}: {found:?}");
        let rms = found.get(Metric::P2sRmsWorld).expect("measured");
        let way = far * 1.65_f64.sqrt();
        assert!(far < 30.0 || (rms / way - 1.0).abs() < 2.0 / far, "{far}: {rms}");
    }
}

#[test]
fn the_grid_is_on_request() {
    let mut options = CompareOptions::distances();
    let coarse = |options: &CompareOptions| {
        let (a, b) = (sheet(1, 0.0), sheet(1, 0.01));
        compare(MeshRef::new(&a.0, &a.1), MeshRef::new(&b.0, &b.1), options).expect("comparable")
    };
    assert_eq!(coarse(&options).get(Metric::D1Psnr), None);
    options.points = Some(PointSampling::Grid(1024));
    let grid = coarse(&options).get(Metric::D1Psnr).expect("measured");
    options.points = Some(PointSampling::Surface);
    let surface = coarse(&options).get(Metric::D1Psnr).expect("measured");
    // Every point is 0.01 from its twin.
    assert!((grid - surface).abs() < 0.5 && surface > 40.0, "{grid} {surface}");
}
