//! The segmenter on whole frames: the performer, the simulated capture, broken meshes.

use super::*;
use kn_bitstream::params::UpAxis;
use kn_mesh::Mesh;
use kn_performer::{Action, Performer, PerformerConfig};
use proptest::prelude::*;

fn performer(config: PerformerConfig) -> Performer {
    Performer::new(config).unwrap()
}

fn areas(mesh: &Mesh) -> Vec<f64> {
    let surface = surface::Surface::new(&mesh.positions, &mesh.faces, UpAxis::Y).unwrap();
    surface.areas
}

/// Share of the area whose label is the mesh's own.
fn accuracy(mesh: &Mesh, labels: &[u8]) -> f64 {
    let areas = areas(mesh);
    let right = |v: &usize| mesh.labels[*v] == labels[*v];
    (0..labels.len()).filter(right).map(|v| areas[v]).sum::<f64>() / areas.iter().sum::<f64>()
}

fn segment(segmenter: &mut Segmenter, mesh: &Mesh) -> Segmentation {
    segmenter.segment(&mesh.positions, &mesh.faces).unwrap()
}

fn fresh(mesh: &Mesh) -> Segmentation {
    segment(&mut Segmenter::new(SegmentOptions::default()), mesh)
}

/// Mean accuracy over every `stride`-th frame, and the worst.
fn over_frames(config: PerformerConfig, frames: u32, stride: u32) -> (f64, f64) {
    let performer = performer(config);
    let mut segmenter = Segmenter::new(SegmentOptions::default());
    let mut right = Vec::new();
    for i in 0..frames {
        let mesh = performer.frame(i * stride);
        right.push(accuracy(&mesh, &segment(&mut segmenter, &mesh).labels));
    }
    let worst = right.iter().copied().fold(1.0, f64::min);
    (right.iter().sum::<f64>() / right.len() as f64, worst)
}

#[test]
fn finds_the_parts_of_a_dancer_in_a_tunic() {
    let config = PerformerConfig { vertices: 3_000, ..PerformerConfig::default() };
    let (mean, worst) = over_frames(config, 4, 4);
    assert!(mean > 0.92 && worst > 0.88, "{mean} {worst}");
}

#[test]
fn finds_the_parts_in_unrelated_poses() {
    let config = PerformerConfig {
        vertices: 4_000,
        action: Action::Poses,
        tunic: false,
        ..PerformerConfig::default()
    };
    let (mean, worst) = over_frames(config, 4, 1);
    assert!(mean > 0.92 && worst > 0.88, "{mean} {worst}");
}

#[test]
fn a_held_ball_is_no_hand() {
    let config =
        PerformerConfig { vertices: 4_000, ball: true, seed: 4, ..PerformerConfig::default() };
    let mesh = performer(config).frame(0);
    let labels = fresh(&mesh).labels;
    let ball: Vec<usize> = (0..labels.len()).filter(|&v| mesh.labels[v] == OTHER).collect();
    let found = ball.iter().filter(|&&v| labels[v] == OTHER).count();
    assert!(10 * found > 8 * ball.len(), "{found} of {}", ball.len());
}

#[test]
fn finds_the_parts_of_the_simulated_capture() {
    use kn_io::{LabelSource, ReadOptions, read_mesh};
    let Some(folder) = kn_testdata::data("tshirt_turn") else { return };
    let mut segmenter = Segmenter::new(SegmentOptions::default());
    let mut sum = 0.0;
    for i in 0..24 {
        let path = format!("{}/frame_{i:04}", folder.display());
        let labels = LabelSource::File(format!("{path}.labels").into());
        let options = ReadOptions { labels, ..ReadOptions::default() };
        let mesh = read_mesh(format!("{path}.obj").as_ref(), &options).unwrap().mesh;
        sum += accuracy(&mesh, &segment(&mut segmenter, &mesh).labels) / 24.0;
    }
    assert!(sum > 0.92, "{sum}");
}

#[test]
fn left_stays_left_when_the_figure_turns_around() {
    let mesh =
        performer(PerformerConfig { vertices: 3_000, ..PerformerConfig::default() }).frame(0);
    let mut turned = mesh.clone();
    turned.positions.iter_mut().for_each(|p| *p = [-p[0], p[1], -p[2]]);
    for mesh in [mesh, turned] {
        let right = accuracy(&mesh, &fresh(&mesh).labels);
        assert!(right > 0.9, "{right}");
    }
}

#[test]
fn any_axis_can_point_up() {
    let mesh =
        performer(PerformerConfig { vertices: 3_000, ..PerformerConfig::default() }).frame(0);
    let labels = fresh(&mesh).labels;
    for up_axis in [UpAxis::X, UpAxis::Z] {
        let turn = |p: &[f64; 3]| {
            let mut q = [0.0; 3];
            (0..3).for_each(|axis| q[(axis + up_axis.index() + 2) % 3] = p[axis]);
            q
        };
        let positions: Vec<_> = mesh.positions.iter().map(turn).collect();
        let mut segmenter = Segmenter::new(SegmentOptions { up_axis });
        assert_eq!(segmenter.segment(&positions, &mesh.faces).unwrap().labels, labels);
    }
}

#[test]
fn millimetres_are_as_good_as_metres() {
    let mesh =
        performer(PerformerConfig { vertices: 3_000, ..PerformerConfig::default() }).frame(0);
    let mut large = mesh.clone();
    large.positions.iter_mut().for_each(|p| *p = p.map(|x| 1000.0 * x));
    assert!(accuracy(&large, &fresh(&large).labels) > 0.9);
}

#[test]
fn refuses_what_is_no_mesh() {
    let run = |positions: &[[f64; 3]], faces: &[[u32; 3]]| {
        Segmenter::new(SegmentOptions::default()).segment(positions, faces).unwrap_err()
    };
    let corner = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let nan = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, f64::NAN, 0.0]];
    assert_eq!(run(&[], &[]), SegmentError::Empty);
    assert_eq!(run(&corner, &[]), SegmentError::Empty);
    assert_eq!(run(&nan, &[[0, 1, 2]]), SegmentError::NotFinite { vertex: 2 });
    assert_eq!(run(&corner, &[[0, 1, 3]]), SegmentError::FaceIndex { face: 0 });
    assert_eq!(run(&corner, &[[0, 1, 1]]), SegmentError::NoArea);
}

/// Faces with corners of their own: triangles of one size along a helix.
fn loose_triangles(count: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let corners = |i: u32| {
        let (angle, up) = (0.7 * f64::from(i), 1.7 * f64::from(i) / f64::from(count));
        let (x, z) = (0.2 * angle.cos(), 0.2 * angle.sin());
        [[x, up, z], [x + 0.02, up, z], [x, up + 0.02, z]]
    };
    (
        (0..count).flat_map(corners).collect(),
        (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    )
}

#[test]
fn many_small_components_are_nobody() {
    let mut person =
        performer(PerformerConfig { vertices: 2_000, ..PerformerConfig::default() }).frame(0);
    for count in [1, 2, 98, 99, 100, 101, 102, 200, 5_000] {
        let (positions, faces) = loose_triangles(count);
        let mut segmenter = Segmenter::new(SegmentOptions::default());
        for _ in 0..2 {
            let found = segmenter.segment(&positions, &faces).unwrap();
            assert!(!found.found_a_person(), "{count}");
            assert_eq!(found.labels, vec![OTHER; positions.len()]);
        }
    }
    // Beside a person they are dirt.
    let (positions, faces) = loose_triangles(60);
    let first = person.positions.len() as u32;
    person.positions.extend(positions.iter().map(|p| [p[0] + 0.8, p[1], p[2]]));
    person.faces.extend(faces.iter().map(|face| face.map(|v| v + first)));
    let found = Segmenter::new(SegmentOptions::default());
    let found = found.clone().segment(&person.positions, &person.faces).unwrap();
    assert!(found.found_a_person());
}

#[test]
fn a_bad_frame_leaves_the_past_as_it_was() {
    let frames = performer(PerformerConfig { vertices: 3_000, ..PerformerConfig::default() });
    let [first, second] = [frames.frame(0), frames.frame(1)];
    let mut plain = Segmenter::new(SegmentOptions::default());
    segment(&mut plain, &first);
    let mut disturbed = plain.clone();
    disturbed.segment(&[], &[]).unwrap_err();
    assert_eq!(segment(&mut plain, &second), segment(&mut disturbed, &second));
}

#[test]
fn true_labels_pass_the_check_and_mixed_up_ones_do_not() {
    let config = PerformerConfig {
        vertices: 4_000,
        action: Action::Stand,
        tunic: false,
        ..PerformerConfig::default()
    };
    let mesh = performer(config).frame(0);
    let check =
        |labels: &[u8]| check_labels(&mesh.positions, &mesh.faces, labels, UpAxis::Y).unwrap();
    let changed =
        |change: &dyn Fn(u8) -> u8| mesh.labels.iter().map(|&l| change(l)).collect::<Vec<_>>();
    assert_eq!(check(&mesh.labels), []);
    let part = |label: u8| BodyPart::from_label(label).unwrap();
    let swapped = changed(&|l| part(l).mirrored().label());
    assert_eq!(check(&swapped), [LabelWarning::SidesSwapped]);
    let hands = [BodyPart::LeftHand, BodyPart::RightHand];
    let wrong = hands.map(|part| LabelWarning::WrongSide { part });
    let hands = changed(&|l| {
        let part = part(l);
        if hands.contains(&part) { part.mirrored().label() } else { l }
    });
    assert_eq!(check(&hands), wrong);
    let (head, foot) = (BodyPart::Head.label(), BodyPart::RightFoot.label());
    let torn = check(&changed(&|l| if l == foot { head } else { l }));
    let [LabelWarning::Split { part: BodyPart::Head, gap }] = torn[..] else {
        panic!("{torn:?}");
    };
    assert!(gap > 0.5, "{gap}");
    assert_eq!(check(&changed(&|l| l + 2)), [LabelWarning::Unknown { label: 15 }; 1]);
    assert!(check_labels(&mesh.positions, &mesh.faces, &[], UpAxis::Y).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Any soup of triangles, islands and slivers gets labels.
    #[test]
    fn survives_triangle_soup(
        points in prop::collection::vec(prop::array::uniform3(-1e3f64..1e3), 3..300),
        picks in prop::collection::vec(prop::array::uniform3(0u32..300), 1..300),
        scale in prop::sample::select(vec![1e-12f64, 1.0, 1e12]),
    ) {
        let positions: Vec<_> = points.iter().map(|p| p.map(|x| x * scale)).collect();
        let count = positions.len() as u32;
        let faces: Vec<_> = picks.iter().map(|f| f.map(|i| i % count)).collect();
        let mut segmenter = Segmenter::new(SegmentOptions::default());
        for _ in 0..2 {
            if let Ok(found) = segmenter.segment(&positions, &faces) {
                prop_assert_eq!(found.labels.len(), positions.len());
                prop_assert!(found.labels.iter().all(|&l| l <= OTHER));
                prop_assert!(found.confidence.iter().all(|c| (0.0..=1.0).contains(c)));
            }
        }
    }
}
