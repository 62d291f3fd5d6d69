//! Every setting out of its range and every contradiction is refused by `Encoder::new`, in a sentence
//! that names the settings.

use kn_codec::params::{BodyPart, Combination, FileNames, FrameRate, Weights};
use kn_codec::{
    AffineChoice, BoundingBox, CombinationChoice, Decimation, DistortionMeasure, EncodeError,
    Encoder, EncoderConfig, Grid, GridChoice, NodeChoice, Preset, Setting, SmoothingChoice,
    StepChoice,
};

fn default() -> EncoderConfig {
    EncoderConfig::default()
}

fn bits(bits: u8) -> EncoderConfig {
    default().with_bits(bits)
}

fn step(step: f64, side: Option<f64>) -> EncoderConfig {
    let bounds = side.map(|side| BoundingBox { min: [0.0; 3], max: [side; 3] });
    default().with_grid(GridChoice::Step { step, bounds })
}

fn bounds(min: [f64; 3], max: [f64; 3]) -> EncoderConfig {
    let bounds = Some(BoundingBox { min, max });
    default().with_grid(GridChoice::Bits { bits: 11, bounds })
}

fn lossless(step: f64) -> EncoderConfig {
    let grid = Grid { origin: [0.0; 3], step };
    default().with_grid(GridChoice::Lossless(grid)).with_group_length(1)
}

fn fixed(combination: &str) -> EncoderConfig {
    default().with_combination(combination.parse::<Combination>().expect("a combination"))
}

fn names(prefix: &str, digits: u8) -> EncoderConfig {
    default().with_names(FileNames { prefix: prefix.into(), digits, first: 0 })
}

fn motion_step(step: f64) -> EncoderConfig {
    default().with_translation_step(StepChoice::Fixed(step))
}

/// Settings out of their range.
fn out_of_range() -> Vec<(EncoderConfig, Setting)> {
    let smoothing = default().with_smoothing(SmoothingChoice::Strength(6));
    let origin = Grid { origin: [0.0, f64::NAN, 0.0], step: 1.0 };
    let origin = lossless(1.0).with_grid(GridChoice::Lossless(origin));
    let mut cases = vec![
        (bits(3), Setting::Bits),
        (bits(21), Setting::Bits),
        (step(0.0, None), Setting::Step),
        (step(-1.0, None), Setting::Step),
        (step(f64::NAN, None), Setting::Step),
        (step(f64::INFINITY, None), Setting::Step),
        (bounds([0.0; 3], [1.0, -1.0, 1.0]), Setting::Bounds),
        (bounds([f64::NAN; 3], [1.0; 3]), Setting::Bounds),
        (bounds([0.0; 3], [f64::INFINITY; 3]), Setting::Bounds),
        (lossless(0.0), Setting::Lossless),
        (origin, Setting::Lossless),
        (default().with_frame_rate(FrameRate::new(0, 1)), Setting::FrameRate),
        (default().with_frame_rate(FrameRate::new(1, 0)), Setting::FrameRate),
        (default().with_fraction_bits(9), Setting::FractionBits),
        (default().with_group_length(0), Setting::GroupLength),
        (names("../up", 4), Setting::Names),
        (names(&"long".repeat(64), 4), Setting::Names),
        (names("scan_", 10), Setting::Names),
        (default().with_decimation(Decimation::Faces(0)), Setting::DecimationFaces),
        (smoothing, Setting::Smoothing),
        (default().with_nodes(0), Setting::Nodes),
        (default().with_nodes(4097), Setting::Nodes),
        (default().with_nodes(NodeChoice::Cost { most: 0 }), Setting::Nodes),
        (default().with_nodes(NodeChoice::Cost { most: 4097 }), Setting::Nodes),
        (default().with_nodes_per_vertex(0), Setting::NodesPerVertex),
        (default().with_nodes_per_vertex(9), Setting::NodesPerVertex),
        (default().with_nodes_per_vertex(200), Setting::NodesPerVertex),
        (default().with_weights(Weights::gaussian(0)), Setting::Weights),
        (default().with_weights(Weights::gaussian(1 << 20)), Setting::Weights),
        (default().with_affine(AffineChoice::Labels(Vec::new())), Setting::Affine),
    ];
    for share in [0.0, -0.5, 1.5, f64::NAN] {
        cases.push((default().with_decimation(Decimation::Share(share)), Setting::DecimationFaces));
    }
    for number in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let decimation = Decimation::Error(number);
        cases.push((default().with_decimation(decimation), Setting::DecimationError));
        cases.push((motion_step(number), Setting::TranslationStep));
        cases.push((default().with_rotation_step(number), Setting::RotationStep));
        cases.push((default().with_scale_step(number), Setting::ScaleStep));
        cases.push((default().with_shear_step(number), Setting::ShearStep));
    }
    for lambda in [-1.0, f64::NAN, f64::INFINITY] {
        cases.push((default().with_lambda(lambda), Setting::Lambda));
    }
    cases
}

/// Settings that are sound alone and contradict each other.
fn contradictions() -> Vec<(EncoderConfig, Vec<Setting>)> {
    use Setting::{
        Affine, Bounds, DecimationError, DecimationFaces, Distortion, GroupLength, Lossless,
        RotationStep, ScaleStep, ShearStep, Smoothing, Step, TranslationStep,
    };
    let strength = SmoothingChoice::Strength(1);
    let measured = fixed("RTSH").with_translation_step(StepChoice::Fixed(2.0));
    let (rigid, all) = (AffineChoice::None, AffineChoice::All);
    vec![
        (lossless(1.0).with_group_length(2), vec![Lossless, GroupLength]),
        (lossless(1.0).with_decimation(Decimation::Faces(9)), vec![Lossless, DecimationFaces]),
        (lossless(1.0).with_decimation(Decimation::Share(0.5)), vec![Lossless, DecimationFaces]),
        (lossless(1.0).with_decimation(Decimation::Error(0.5)), vec![Lossless, DecimationError]),
        (lossless(1.0).with_smoothing(strength), vec![Lossless, Smoothing]),
        (step(2.0, Some(1.0)), vec![Step, Bounds]),
        (step(1e-7, Some(1.0)), vec![Step, Bounds]),
        (default().with_affine(rigid.clone()).with_scale_step(1.0), vec![ScaleStep, Affine]),
        (default().with_affine(rigid).with_shear_step(1.0), vec![ShearStep, Affine]),
        (fixed("RTH").with_scale_step(1.0), vec![ScaleStep, Setting::Combination]),
        (fixed("RTS").with_shear_step(1.0), vec![ShearStep, Setting::Combination]),
        (
            fixed("TS").with_affine(all).with_rotation_step(1.0),
            vec![RotationStep, Setting::Combination, Affine],
        ),
        (fixed("RT").with_affine(AffineChoice::Cost), vec![Affine, Setting::Combination]),
        (fixed("T").with_affine(AffineChoice::Cost), vec![Affine, Setting::Combination]),
        (
            measured.with_distortion(DistortionMeasure::Msdm2),
            vec![Distortion, TranslationStep, Setting::Combination],
        ),
    ]
}

/// Asserts that the settings are refused, and that the sentence names `settings`.
#[track_caller]
fn is_refused(config: EncoderConfig, settings: &[Setting]) {
    let shown = format!("{config:?}");
    let Err(error) = Encoder::new(Vec::new(), config) else { panic!("accepted: {shown}") };
    let EncodeError::Settings(refused) = &error else { panic!("{error}") };
    assert_eq!(refused.settings(), settings, "{error}");
    let sentence = error.to_string();
    for setting in settings {
        assert!(sentence.contains(&setting.to_string()), "{sentence} does not name {setting}");
    }
    assert!(!sentence.contains('{'), "{sentence}");
}

#[test]
fn settings_out_of_their_range_are_refused() {
    for (config, setting) in out_of_range() {
        is_refused(config, &[setting]);
    }
}

#[test]
fn contradictions_are_refused() {
    for (config, settings) in contradictions() {
        is_refused(config, &settings);
    }
}

#[test]
fn the_ends_of_the_ranges_and_all_presets_are_accepted() {
    let sound = [
        bits(4),
        bits(20),
        step(1.0, Some(1.0)),
        step(1.0, Some(0.0)),
        lossless(0.5),
        lossless(0.5).with_smoothing(SmoothingChoice::Strength(0)),
        default().with_fraction_bits(0),
        default().with_group_length(255),
        names("", 9),
        default().with_decimation(Decimation::Share(1.0)),
        default().with_decimation(Decimation::Faces(1)),
        default().with_smoothing(SmoothingChoice::Strength(5)),
        default().with_nodes(1),
        default().with_nodes(4096),
        default().with_nodes_per_vertex(8),
        default().with_weights(Weights::gaussian((1 << 20) - 1)),
        default().with_affine(AffineChoice::Labels(vec![BodyPart::Other])),
        default().with_lambda(0.0),
        fixed("TS").with_scale_step(1.0),
        fixed("RTSH").with_affine(AffineChoice::None),
        default().with_combination(CombinationChoice::LookAhead).with_shear_step(1.0),
    ];
    for config in sound.into_iter().chain(Preset::all().iter().map(Preset::config)) {
        let shown = format!("{config:?}");
        assert!(Encoder::new(Vec::new(), config).is_ok(), "{shown}");
    }
}

#[test]
fn a_sentence_names_settings_as_the_caller_does() {
    let error = lossless(1.0).with_group_length(8).validate().expect_err("a contradiction");
    let told =
        "sequence.grid (lossless) needs I-frames only; sequence.group_length is 8 and must be 1";
    assert_eq!(error.to_string(), told);
    let flag = |setting| if setting == Setting::Lossless { "--lossless" } else { "--gof" };
    assert_eq!(error.describe(flag), "--lossless needs I-frames only; --gof is 8 and must be 1");
}
