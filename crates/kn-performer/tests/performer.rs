//! Properties of the synthetic performer that the rest of the workspace relies on.

use kn_mesh::Mesh;
use kn_mesh::vec3::distance;
use kn_performer::{Action, Performer, PerformerConfig, part};
use std::collections::HashMap;

const ACTIONS: [Action; 5] =
    [Action::Stand, Action::Walk, Action::Turn, Action::Dance, Action::Poses];

/// A small figure as the scanner would see it in a perfect world.
fn clean(action: Action) -> PerformerConfig {
    PerformerConfig { vertices: 4_000, action, noise: 0.0, holes: 0, ..Default::default() }
}

fn performer(config: PerformerConfig) -> Performer {
    Performer::new(config).expect("allowed settings")
}

/// The number of times that every directed edge occurs.
fn directed_edges(mesh: &Mesh) -> HashMap<[u32; 2], usize> {
    let mut edges = HashMap::new();
    for f in &mesh.faces {
        for edge in [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]] {
            *edges.entry(edge).or_default() += 1;
        }
    }
    edges
}

/// Edges with a face on one side only.
fn boundary_edges(mesh: &Mesh) -> usize {
    let edges = directed_edges(mesh);
    edges.keys().filter(|[a, b]| !edges.contains_key(&[*b, *a])).count()
}

/// V − E + F of a closed mesh.
fn euler_characteristic(mesh: &Mesh) -> i64 {
    let edges = directed_edges(mesh).len() / 2;
    mesh.positions.len() as i64 - edges as i64 + mesh.faces.len() as i64
}

/// The value below which `share` of the values lie.
fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share) as usize]
}

#[test]
fn the_same_seed_gives_the_same_frames_in_any_order() {
    let config = PerformerConfig { vertices: 3_000, ..Default::default() };
    let (a, b) = (performer(config.clone()), performer(config.clone()));
    let first = a.frame(3);
    b.frame(9);
    assert!(first == b.frame(3), "a frame depends on what was made before it");
    let single = pool(1).install(|| a.frame(3));
    assert!(first == single, "a frame depends on the number of threads");
    let other = performer(PerformerConfig { seed: 2, ..config });
    assert!(first != other.frame(3), "the seed changes nothing");
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool")
}

#[test]
fn frames_are_closed_manifolds_of_the_asked_size() {
    for action in ACTIONS {
        let performer = performer(clean(action));
        for index in [0, 17] {
            let mesh = performer.frame(index);
            assert_eq!(mesh.positions.len(), 4_000, "{action:?}");
            assert_eq!(mesh.labels.len(), mesh.positions.len());
            assert!(mesh.positions.iter().flatten().all(|c| c.is_finite()));
            assert_eq!(boundary_edges(&mesh), 0, "{action:?} frame {index} is not closed");
            let edges = directed_edges(&mesh);
            assert!(edges.values().all(|&n| n == 1), "{action:?} frame {index} is not manifold");
        }
    }
}

#[test]
fn no_face_is_degenerate() {
    let mesh = performer(PerformerConfig { vertices: 4_000, ..Default::default() }).frame(5);
    for face in &mesh.faces {
        let [a, b, c] = face.map(|v| mesh.positions[v as usize]);
        let longest = distance(a, b).max(distance(b, c)).max(distance(c, a));
        let half = (distance(a, b) + distance(b, c) + distance(c, a)) / 2.0;
        let heron =
            half * (half - distance(a, b)) * (half - distance(b, c)) * (half - distance(c, a));
        assert!(heron.max(0.0).sqrt() > 1e-3 * longest * longest, "{a:?} {b:?} {c:?}");
    }
}

#[test]
fn every_size_is_met() {
    for vertices in [1_000, 7_000, 25_000] {
        let mesh = performer(PerformerConfig { vertices, ..clean(Action::Walk) }).frame(2);
        assert_eq!(mesh.positions.len(), vertices);
    }
}

#[test]
fn the_figure_is_as_tall_as_a_human_and_stands_on_the_ground() {
    let mesh = performer(clean(Action::Stand)).frame(0);
    let bounds = mesh.bounding_box().expect("vertices");
    assert!((1.68..1.82).contains(&(bounds.max[1] - bounds.min[1])), "{bounds:?}");
    assert!(bounds.min[1].abs() < 0.03, "{bounds:?}");
}

#[test]
fn every_label_is_there_and_mostly_in_one_piece() {
    for (ball, tunic) in [(false, true), (true, false)] {
        let config = PerformerConfig { ball, tunic, vertices: 8_000, ..clean(Action::Walk) };
        let mesh = performer(config).frame(11);
        let parts = if ball { part::COUNT + 1 } else { part::COUNT };
        for label in 0..parts as u8 {
            let (all, largest) = label_pieces(&mesh, label);
            assert!(all >= 20, "label {label} has {all} vertices");
            assert!(largest * 100 >= all * 95, "label {label}: {largest} of {all} in one piece");
        }
        assert!(mesh.labels.iter().all(|&l| usize::from(l) < parts));
    }
}

/// Vertices with a label, and how many of them hang together.
fn label_pieces(mesh: &Mesh, label: u8) -> (usize, usize) {
    let mut neighbours: HashMap<u32, Vec<u32>> = HashMap::new();
    for [a, b] in directed_edges(mesh).into_keys() {
        if mesh.labels[a as usize] == label && mesh.labels[b as usize] == label {
            neighbours.entry(a).or_default().push(b);
        }
    }
    let all: Vec<u32> =
        (0..mesh.labels.len() as u32).filter(|&v| mesh.labels[v as usize] == label).collect();
    let mut seen = vec![false; mesh.labels.len()];
    let mut largest = 0;
    for &start in &all {
        let mut stack = vec![start];
        let mut size = 0;
        while let Some(v) = stack.pop() {
            if !std::mem::replace(&mut seen[v as usize], true) {
                size += 1;
                stack.extend(neighbours.get(&v).into_iter().flatten());
            }
        }
        largest = largest.max(size);
    }
    (all.len(), largest)
}

#[test]
fn connectivity_differs_between_frames_and_genus_changes_where_limbs_touch() {
    let performer = performer(clean(Action::Dance));
    let frames: Vec<Mesh> = (0..12).map(|i| performer.frame(8 * i)).collect();
    assert!(frames.windows(2).all(|pair| pair[0].faces != pair[1].faces));
    let mut genera: Vec<i64> = frames.iter().map(euler_characteristic).collect();
    genera.sort_unstable();
    genera.dedup();
    assert!(genera.len() > 1, "all frames have Euler characteristic {genera:?}");
}

#[test]
fn holes_have_rims_of_plausible_size() {
    let config = PerformerConfig { holes: 5, vertices: 6_000, ..Default::default() };
    let mesh = performer(config).frame(1);
    let rim = boundary_edges(&mesh);
    assert!((30..=140).contains(&rim), "{rim} boundary edges");
    assert!(directed_edges(&mesh).values().all(|&n| n == 1));
    assert!(mesh.positions.len() > 5_700);
}

#[test]
fn noise_moves_the_surface_by_millimetres() {
    let smooth = performer(clean(Action::Stand));
    let noisy = performer(PerformerConfig { noise: 1.0, ..clean(Action::Stand) });
    let away = |p: &Performer| {
        let mesh = p.frame(4);
        let distances = mesh.positions.iter().map(|&at| smooth.distance(4, at));
        let squares = distances.map(|distance| distance * distance);
        (squares.sum::<f64>() / mesh.positions.len() as f64).sqrt()
    };
    let (without, with) = (away(&smooth), away(&noisy));
    assert!(without < 0.0012, "{without} m without noise");
    assert!((0.0005..0.005).contains(&with) && with > without, "{with} m with noise");
}

#[test]
fn carried_points_lie_on_the_target_frames_surface() {
    for (action, from, to) in [(Action::Dance, 0, 1), (Action::Poses, 3, 4), (Action::Walk, 5, 12)]
    {
        let performer = performer(clean(action));
        let mesh = performer.frame(from);
        let there = performer.transport(&mesh, from, to);
        let error = |i: usize| {
            let (before, after) =
                (performer.distance(from, mesh.positions[i]), performer.distance(to, there[i]));
            (after - before).abs()
        };
        let errors: Vec<f64> = (0..there.len()).map(error).collect();
        // Half a millimetre; the rest goes under the tunic or into a fold.
        let near = quantile(errors, 0.9);
        assert!(near < 5e-4, "{action:?}: {near}");
    }
}

#[test]
fn carrying_there_and_back_is_the_identity() {
    let performer = performer(clean(Action::Poses));
    let mesh = performer.frame(0);
    let there = mesh.with_positions(performer.transport(&mesh, 0, 1));
    let back = performer.transport(&there, 1, 0);
    let errors = (0..back.len()).map(|i| distance(back[i], mesh.positions[i])).collect();
    let error = quantile(errors, 0.9);
    assert!(error < 5e-4, "{error}");
}

#[test]
fn poses_jump_by_up_to_a_third_of_the_height() {
    let performer = performer(PerformerConfig { vertices: 2_000, ..clean(Action::Poses) });
    let mesh = performer.frame(0);
    let mut farthest = 0.0_f64;
    for to in 1..6 {
        let there = performer.transport(&mesh, 0, to);
        let moves = (0..there.len()).map(|i| distance(there[i], mesh.positions[i])).collect();
        farthest = farthest.max(quantile(moves, 0.99));
    }
    assert!((0.2..0.6).contains(&farthest), "{farthest} m");
}

#[test]
fn slow_motion_is_slow_and_intensity_scales_it() {
    let step = |config: PerformerConfig| {
        let performer = performer(config);
        let mesh = performer.frame(30);
        let there = performer.transport(&mesh, 30, 31);
        (0..there.len()).map(|i| distance(there[i], mesh.positions[i])).sum::<f64>()
            / there.len() as f64
    };
    let small = |action| PerformerConfig { vertices: 2_000, ..clean(action) };
    let (stand, dance) = (step(small(Action::Stand)), step(small(Action::Dance)));
    assert!(stand < 0.002 && dance > 3.0 * stand, "{stand} against {dance} m a frame");
    let calm = step(PerformerConfig { intensity: 0.3, ..small(Action::Dance) });
    assert!(calm < 0.7 * dance, "{calm} against {dance} m a frame");
}

#[test]
fn settings_out_of_range_are_errors_that_name_the_setting() {
    let base = PerformerConfig::default;
    for (config, name) in [
        (PerformerConfig { vertices: 10, ..base() }, "vertices"),
        (PerformerConfig { vertices: usize::MAX, ..base() }, "vertices"),
        (PerformerConfig { fps: f64::NAN, ..base() }, "fps"),
        (PerformerConfig { intensity: -1.0, ..base() }, "intensity"),
        (PerformerConfig { noise: f64::INFINITY, ..base() }, "noise"),
        (PerformerConfig { holes: u32::MAX, ..base() }, "holes"),
    ] {
        let error = Performer::new(config).expect_err(name);
        assert_eq!(error.setting, name);
        assert!(error.to_string().contains(name));
    }
}

#[test]
fn late_frames_cost_nothing_extra_and_stay_in_place() {
    let performer = performer(PerformerConfig { vertices: 2_000, ..clean(Action::Walk) });
    let mesh = performer.frame(4_000_000_000);
    let bounds = mesh.bounding_box().expect("vertices");
    assert!(bounds.max.iter().chain(&bounds.min).all(|c| c.abs() < 2.5), "{bounds:?}");
}
