//! Choices of the encoder by J = D + λR.

use kn_bitstream::params::{Combination, InfluenceMode};
use kn_codec::{
    AffineChoice, CombinationChoice, CostReport, Encoder, EncoderConfig, LabelChoice, NodeChoice,
    PredictedReport, StepChoice,
};
use kn_mesh::Mesh;
use kn_performer::{Performer, PerformerConfig};

/// J of one way may exceed that of a way which looks at more by this factor: choices are made frame
/// by frame, and each changes what the next frame begins with.
const SLACK: f64 = 1.01;

fn performer() -> Vec<Mesh> {
    let config = PerformerConfig { vertices: 2500, ..PerformerConfig::default() };
    let performer = Performer::new(config).expect("the settings are in range");
    (0..4).map(|index| performer.frame(3 * index)).collect()
}

fn config() -> EncoderConfig {
    EncoderConfig::default().with_group_length(4).with_nodes(40).with_labels(LabelChoice::Given)
}

/// The stream, and the reports of its P-frames.
fn encode(frames: &[Mesh], config: EncoderConfig) -> (Vec<u8>, Vec<PredictedReport>) {
    let mut encoder = Encoder::new(Vec::new(), config).expect("sound settings");
    frames.iter().for_each(|frame| encoder.push(frame).expect("a sound frame"));
    let reports: Vec<_> = encoder.drain_reports().collect();
    let finished = encoder.finish().expect("a vector takes everything");
    let reports = reports.into_iter().chain(finished.reports);
    (finished.writer, reports.filter_map(|report| report.predicted().cloned()).collect())
}

/// J of all P-frames.
fn cost(reports: &[PredictedReport]) -> f64 {
    let total = |report: &PredictedReport| report.cost.expect("chosen by cost").total;
    reports.iter().map(total).sum()
}

#[test]
fn a_forced_combination_is_obeyed() {
    let frames = performer();
    for combination in [Combination::ALL[0], Combination::ALL[5], Combination::RTSH] {
        let forced = config().with_combination(combination);
        let (_, reports) = encode(&frames, forced);
        assert_eq!(reports.len(), 3);
        assert!(reports.iter().all(|report| report.combination == combination));
    }
}

#[test]
fn what_looks_at_more_costs_no_more() {
    let frames = performer();
    let with = |combination| encode(&frames, config().with_combination(combination)).1;
    let first = with(CombinationChoice::FirstP);
    assert!(first.iter().all(|report| report.combination == first[0].combination));
    let each = cost(&with(CombinationChoice::PerFrame));
    let ahead = with(CombinationChoice::LookAhead);
    assert!(ahead.iter().all(|report| report.combination == ahead[0].combination));
    assert!(each <= SLACK * cost(&first), "{each} against {}", cost(&first));
    assert!(cost(&ahead) <= SLACK * cost(&first), "{} against {}", cost(&ahead), cost(&first));
}

#[test]
fn steps_by_cost_cost_no_more_than_usual_ones() {
    let frames = performer();
    let first_frame = |motion_step| {
        let (_, reports) = encode(&frames, config().with_translation_step(motion_step));
        reports[0].cost.expect("chosen by cost").total
    };
    assert!(first_frame(StepChoice::Cost) <= first_frame(StepChoice::Fixed(2.0)));
}

#[test]
fn as_many_nodes_as_pay() {
    let moving = performer();
    let still = [(); 4].map(|()| moving[0].clone());
    let nodes = |frames: &[Mesh], lambda| {
        let config = config().with_lambda(lambda).with_nodes(NodeChoice::default());
        encode(frames, config).1[0].nodes
    };
    let (cheap, usual, dear) = (nodes(&moving, 1e-6), nodes(&moving, 3e-5), nodes(&moving, 1e-3));
    assert!(cheap > usual && usual > dear && dear >= 1, "{cheap}, {usual}, {dear} nodes");
    let (idle, usual) = (nodes(&still, 3e-5), usual);
    assert!(idle < usual, "{idle} nodes for what rests, {usual} for what moves");
    let few = config().with_nodes(NodeChoice::Cost { most: 7 });
    assert!(encode(&moving, few).1[0].nodes <= 7);
}

/// However little moves: a region without a node would follow the nodes of another.
#[test]
fn every_region_keeps_a_node() {
    let moving = performer();
    let still = [(); 3].map(|()| moving[0].clone());
    let influence = InfluenceMode::Strict;
    let config =
        config().with_influence(influence).with_nodes(NodeChoice::default()).with_lambda(1e-3);
    // It would be an error.
    let (_, reports) = encode(&still, config);
    assert_eq!(reports.len(), 2);
}

#[test]
fn bytes_fall_with_lambda() {
    let frames = performer();
    let bytes = |lambda| {
        let (_, reports) = encode(&frames, config().with_lambda(lambda));
        let sum = |sum: u64, report: &PredictedReport| {
            let CostReport { bytes, distortion, total } = report.cost.expect("chosen by cost");
            assert!((total - distortion - lambda * bytes as f64).abs() < 1e-12);
            sum + bytes
        };
        reports.iter().fold(0, sum)
    };
    let [fine, usual, coarse] = [1e-6, 3e-5, 1e-3].map(bytes);
    assert!(fine > usual && usual > coarse, "{fine} {usual} {coarse}");
}

#[test]
fn nodes_are_affine_where_that_pays() {
    let frames = performer();
    let affine = |lambda| {
        let affine = AffineChoice::Cost;
        let (_, reports) = encode(&frames, config().with_affine(affine).with_lambda(lambda));
        reports[0].affine_nodes
    };
    let (free, dear) = (affine(0.0), affine(1.0));
    assert!(free > 0 && dear == 0, "{free} and {dear} affine nodes");
}

#[test]
fn choices_do_not_depend_on_threads() {
    let frames = performer();
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let combination = CombinationChoice::PerFrame;
        let chosen = config().with_affine(AffineChoice::Cost).with_combination(combination);
        pool.install(|| encode(&frames, chosen))
    };
    let (one, three) = (with(1), with(3));
    assert_eq!(one.1, three.1);
    assert!(one.0 == three.0, "the streams differ");
}
