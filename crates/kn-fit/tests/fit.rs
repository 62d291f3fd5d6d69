//! Fits of whole frames: known motion, all combinations, dirt, and what never may happen.

use kn_bitstream::params::{Combination, InfluenceMode, Weights};
use kn_deform::{BindOptions, Influence, bind};
use kn_fit::{
    FitError, FitMeasures, FitOptions, FitReport, FitSource, FitTarget, Fitter, GenerateOptions,
    MeasureOptions, NodeCount, NodeSource, RankBy, RegisterOptions, generate_nodes, place_farthest,
    register,
};
use kn_performer::{Action, Performer, PerformerConfig};
use proptest::prelude::*;

type Points = Vec<[f64; 3]>;
type Faces = Vec<[u32; 3]>;

fn performer(seed: u64, vertices: usize, action: Action) -> Performer {
    let config = PerformerConfig { seed, vertices, action, ..PerformerConfig::default() };
    Performer::new(config).expect("settings in range")
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

/// Influence of nodes at vertices, on a grid of 1 mm.
fn influence(positions: &Points, nodes: &[u32]) -> Influence {
    let grid: Vec<[i32; 3]> =
        positions.iter().map(|p| p.map(|c| (1000.0 * c).round() as i32)).collect();
    let sites: Vec<[i32; 3]> = nodes.iter().map(|&v| grid[v as usize]).collect();
    let options = BindOptions {
        nodes_per_vertex: 4,
        weights: Weights::INVERSE_SQUARE,
        mode: InfluenceMode::Fallback,
    };
    let mut influence = Influence::default();
    let regions = (vec![0; grid.len()], vec![0; sites.len()]);
    bind(&grid, &regions.0, &sites, &regions.1, &options, &mut influence).expect("nodes");
    influence
}

struct Scene {
    positions: Points,
    faces: Faces,
    nodes: Points,
    affine: Vec<bool>,
    influence: Influence,
    target: FitTarget,
}

impl Scene {
    fn new(seed: u64, vertices: usize, nodes: usize, frames: [u32; 2]) -> Self {
        let performer = performer(seed, vertices, Action::Dance);
        let (source, target) = (performer.frame(frames[0]), performer.frame(frames[1]));
        let positions = source.positions.clone();
        let chosen =
            place_farthest(&positions, &source.faces, None, None, nodes).expect("a figure");
        Self {
            influence: influence(&positions, &chosen),
            nodes: chosen.iter().map(|&v| positions[v as usize]).collect(),
            affine: (0..chosen.len()).map(|node| node % 2 == 0).collect(),
            positions,
            faces: source.faces,
            target: FitTarget::new(&target.positions, &target.faces).expect("a figure"),
        }
    }

    fn source(&self) -> FitSource<'_> {
        FitSource {
            positions: &self.positions,
            faces: &self.faces,
            influence: &self.influence,
            nodes: &self.nodes,
            affine: &self.affine,
            labels: None,
        }
    }
}

/// Limits of a frame that is explained.
const LIMITS: MeasureOptions =
    MeasureOptions { far: 0.025, stretched: 3.0, grown: 0.01, gaping: 0.25 };

fn measured() -> FitOptions {
    FitOptions { measures: Some(LIMITS), ..FitOptions::default() }
}

fn measures(report: &FitReport) -> FitMeasures {
    report.measures.expect("asked for")
}

/// Whether no part of either mesh is missing in the other.
fn explains(report: &FitReport) -> bool {
    let FitMeasures { lost, new, .. } = measures(report);
    lost.share < 0.01 && new.share < 0.01
}

#[test]
fn a_dancing_figure_is_followed() {
    let scene = Scene::new(3, 4000, 120, [0, 3]);
    let source = scene.source();
    let mut fitter = Fitter::new(&source).expect("consistent");
    let fit = fitter.fit_frame(&source, &scene.target, &measured()).expect("a fit");
    assert!(fit.report.source_to_target.rms < 0.01, "{:?}", fit.report);
    assert!(fit.report.target_to_source.rms < 0.01, "{:?}", fit.report);
    assert!(explains(&fit.report), "{:?}", fit.report);
    assert!(measures(&fit.report).tear.area < 0.01, "{:?}", fit.report);
    assert!(fitter.deformed().iter().flatten().all(|c| c.is_finite()));
}

#[test]
fn large_motion_loses_no_limb() {
    let mut lost = Vec::new();
    for seed in 0..6 {
        let performer = performer(seed, 3000, Action::Poses);
        let (source, target) = (performer.frame(0), performer.frame(1));
        let truth = performer.transport(&source, 0, 1);
        let options = RegisterOptions { nodes: 150, ..RegisterOptions::default() };
        let result =
            register(&source.positions, &source.faces, &target.positions, &target.faces, &options)
                .expect("two figures");
        let mut by_part = [(0.0, 0usize); 256];
        for (vertex, truth) in truth.iter().enumerate() {
            let part = &mut by_part[usize::from(source.labels[vertex])];
            part.0 += distance(result.positions[vertex], *truth).powi(2);
            part.1 += 1;
        }
        let height = 1.7;
        let worst = by_part.iter().map(|&(sum, n)| (sum / n.max(1) as f64).sqrt());
        if worst.fold(0.0, f64::max) > 0.05 * height {
            lost.push(seed);
        }
    }
    assert!(lost.len() <= 1, "limbs lost with seeds {lost:?}");
}

#[test]
fn disabled_components_stay_neutral() {
    let scene = Scene::new(5, 3000, 60, [0, 2]);
    let source = scene.source();
    let mut fitter = Fitter::new(&source).expect("consistent");
    let options = FitOptions::default();
    let fits = fitter
        .fit_combinations(&source, &scene.target, &options, &Combination::ALL)
        .expect("eight fits");
    assert_eq!(fits.len(), 8);
    for (fit, combination) in fits.iter().zip(Combination::ALL) {
        for (transform, &affine) in fit.transforms.iter().zip(&scene.affine) {
            let own = if affine { combination } else { Combination::RT };
            assert!(own.rotation || transform.rotation == [0.0; 3]);
            assert!(own.scale || transform.scale == [1.0; 3]);
            assert!(own.shear || transform.shear == [0.0; 3]);
        }
    }
    // What has more components fits at least about as well.
    let rms = |index: usize| fits[index].report.source_to_target.rms;
    assert!(rms(7) <= 1.1 * rms(0), "RTSH {} against T {}", rms(7), rms(0));
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let scene = Scene::new(7, 3000, 80, [0, 2]);
    let fit = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let source = scene.source();
            let mut fitter = Fitter::new(&source).expect("consistent");
            fitter.fit_frame(&source, &scene.target, &measured()).expect("a fit")
        })
    };
    let (one, three) = (fit(1), fit(3));
    assert_eq!(one.transforms, three.transforms);
    assert_eq!(one.report, three.report);
}

#[test]
fn a_lost_limb_is_reported() {
    let mut scene = Scene::new(9, 4000, 100, [0, 1]);
    let performer = performer(9, 4000, Action::Dance);
    let frame = performer.frame(1);
    // The target lacks everything beyond the upper arms.
    let arm = |label: u8| (2..=3).contains(&label);
    let keep = |face: &&[u32; 3]| !face.iter().any(|&v| arm(frame.labels[v as usize]));
    let faces: Faces = frame.faces.iter().filter(keep).copied().collect();
    scene.target = FitTarget::new(&frame.positions, &faces).expect("a figure");
    let source = scene.source();
    let mut fitter = Fitter::new(&source).expect("consistent");
    let fit = fitter.fit_frame(&source, &scene.target, &measured()).expect("a fit");
    let FitMeasures { lost, new, .. } = measures(&fit.report);
    assert!(lost.share > 0.01 && lost.share > new.share, "{:?}", fit.report);
    assert!(arm(performer.frame(0).labels[lost.vertex as usize]), "{:?}", fit.report);
}

#[test]
fn generated_nodes_are_as_many_as_asked_for() {
    let scene = Scene::new(11, 4000, 60, [0, 4]);
    let regions: Vec<u8> = scene.positions.iter().map(|p| u8::from(p[1] > 1.0)).collect();
    let source = NodeSource {
        positions: &scene.positions,
        faces: &scene.faces,
        regions: Some(&regions),
        affine: &vec![false; scene.positions.len()],
        bind: &|nodes| Ok(influence(&scene.positions, nodes)),
    };
    let options = GenerateOptions {
        count: NodeCount::Exactly(60),
        rank_by: RankBy::Distance,
        fit: measured(),
        explains: &explains,
    };
    let nodes =
        |options: GenerateOptions| generate_nodes(&source, &scene.target, &options).expect("nodes");
    let sixty = nodes(options).expect("a frame that tracks");
    assert_eq!(sixty.len(), 60);
    assert!(sixty.windows(2).all(|pair| pair[0] < pair[1]));
    assert!([0, 1].iter().all(|&r| sixty.iter().any(|&v| regions[v as usize] == r)));
    let by_msdm2 = nodes(GenerateOptions { rank_by: RankBy::Msdm2, ..options });
    assert_eq!(by_msdm2.map(|nodes| nodes.len()), Some(60));
    // The dearer a node, the fewer.
    let paying = |price| {
        let count = NodeCount::Paying { dense: 66, most: 100, price };
        nodes(GenerateOptions { count, ..options }).expect("a frame that tracks").len()
    };
    let (cheap, dear) = (paying(0.0), paying(0.05));
    assert!(1 <= dear && dear < cheap && cheap <= 100, "{dear} dear nodes, {cheap} cheap ones");
}

#[test]
fn a_key_frame_that_cannot_be_tracked_gives_no_nodes() {
    let scene = Scene::new(11, 2000, 60, [0, 1]);
    let moved: Points = scene.positions.iter().map(|&[x, y, z]| [x, y + 0.4, z]).collect();
    // Only the upper half of the figure, and higher up.
    let upper = |face: &&[u32; 3]| face.iter().all(|&v| scene.positions[v as usize][1] > 1.0);
    let faces: Faces = scene.faces.iter().filter(upper).copied().collect();
    let target = FitTarget::new(&moved, &faces).expect("half a figure");
    let source = NodeSource {
        positions: &scene.positions,
        faces: &scene.faces,
        regions: None,
        affine: &vec![false; scene.positions.len()],
        bind: &|nodes| Ok(influence(&scene.positions, nodes)),
    };
    let options = GenerateOptions {
        count: NodeCount::Exactly(40),
        rank_by: RankBy::Distance,
        fit: measured(),
        explains: &explains,
    };
    assert_eq!(generate_nodes(&source, &target, &options), Ok(None));
}

#[test]
fn inconsistent_input_is_an_error() {
    let scene = Scene::new(1, 2000, 20, [0, 1]);
    let good = scene.source();
    let short = FitSource { affine: &scene.affine[1..], ..good };
    assert!(matches!(Fitter::new(&short), Err(FitError::Length { what: "affine", .. })));
    let few = FitSource { nodes: &scene.nodes[..1], affine: &scene.affine[..1], ..good };
    assert!(matches!(Fitter::new(&few), Err(FitError::BadInfluence { .. })));
    let mut positions = scene.positions.clone();
    positions[5][1] = f64::NAN;
    let broken = FitSource { positions: &positions, ..good };
    assert!(matches!(Fitter::new(&broken), Err(FitError::NotFinite { vertex: 5, .. })));
    assert!(FitTarget::new(&[[0.0; 3]; 3], &[[0, 1, 2]]).is_err());
    let mut fitter = Fitter::new(&good).expect("consistent");
    let other = Scene::new(1, 2000, 30, [0, 1]);
    let fit = fitter.fit_frame(&other.source(), &scene.target, &FitOptions::default());
    assert!(matches!(fit, Err(FitError::Length { what: "nodes", .. })));
}

#[test]
fn dirty_scans_are_followed() {
    let Some(folder) = kn_testdata::data("punch_dirty") else { return };
    let read = |frame: u32| {
        let path = folder.join(format!("frame_{frame:04}.obj"));
        kn_io::read_mesh(&path, &kn_io::ReadOptions::default()).expect("an OBJ").mesh
    };
    for frame in [0, 7, 15] {
        let (source, target) = (read(frame), read(frame + 1));
        let result = register(
            &source.positions,
            &source.faces,
            &target.positions,
            &target.faces,
            &RegisterOptions::default(),
        )
        .expect("two scans");
        assert!(result.positions.iter().flatten().all(|c| c.is_finite()));
        let height = 2.0;
        assert!(result.report.source_to_target.median < 0.002 * height, "{:?}", result.report);
    }
}

fn any_mesh() -> impl Strategy<Value = (Points, Faces)> {
    (3_usize..24).prop_flat_map(|vertices| {
        let coordinate = prop_oneof![Just(0.0), Just(1.0), -1.0..1.0];
        let points = prop::collection::vec(prop::array::uniform3(coordinate), vertices);
        let corner = 0..vertices as u32;
        let faces = prop::collection::vec(prop::array::uniform3(corner), 1..40);
        (points, faces)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_soup_gives_a_finite_result_or_an_error(source in any_mesh(), target in any_mesh()) {
        let options = RegisterOptions { nodes: 5, ..RegisterOptions::default() };
        let result = register(&source.0, &source.1, &target.0, &target.1, &options);
        if let Ok(result) = result {
            prop_assert!(result.positions.iter().flatten().all(|c| c.is_finite()));
        }
    }
}
