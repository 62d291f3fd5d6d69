//! The check of the settings: every range and every contradiction, before any frame is seen.

use crate::encode::choices::{
    AffineChoice, CombinationChoice, Decimation, DistortionMeasure, NodeChoice, SmoothingChoice,
    StepChoice,
};
use crate::encode::config::{
    EncoderConfig, GridChoice, IntraConfig, MotionConfig, RateConfig, SequenceConfig,
};
use crate::encode::settings::{Setting, SettingsError};
use kn_bitstream::params::{FrameRate, MAX_DIGITS, name_text};
use kn_bitstream::{COORDINATE_LIMIT, MAX_SMOOTHING};
use kn_fit::MAX_NODES;
use kn_mesh::BoundingBox;
use std::ops::RangeInclusive;

/// Range of the number of bits for the longest side of the box.
const BITS: RangeInclusive<u8> = 4..=20;
/// Range of Q (`header.nodes.range`).
const NODES_PER_VERTEX: RangeInclusive<u8> = 1..=8;
/// Largest number of fractional bits (`header.fraction.range`).
const MAX_FRACTION_BITS: u8 = 8;
/// Largest number of bytes of a name's prefix.
const MAX_PREFIX: usize = 255;

type Checked = Result<(), SettingsError>;

impl EncoderConfig {
    /// Checks that every setting is in its range and that no two contradict each other.
    ///
    /// # Errors
    /// The first check that fails, as a sentence that names the settings.
    pub fn validate(&self) -> Checked {
        let Self { sequence, intra, motion, rate } = self;
        check_sequence(sequence)?;
        check_grid(&sequence.grid)?;
        check_intra(intra)?;
        check_motion(motion)?;
        check_steps(motion)?;
        check_rate(rate)?;
        check_lossless(sequence, intra)?;
        check_components(motion)?;
        check_measure(motion, rate)
    }
}

/// Checks one setting, and makes the sentence where it is out of its range.
fn in_range(setting: Setting, holds: bool, rule: &str, value: impl std::fmt::Display) -> Checked {
    require(holds, &[setting], || format!("{{0}} is {value}; it must be {rule}"))
}

fn require(holds: bool, settings: &[Setting], sentence: impl FnOnce() -> String) -> Checked {
    if holds { Ok(()) } else { Err(SettingsError::new(settings, sentence())) }
}

fn is_positive(value: f64) -> bool {
    value > 0.0 && value.is_finite()
}

fn check_sequence(sequence: &SequenceConfig) -> Checked {
    let FrameRate { numerator, denominator } = sequence.frame_rate;
    let rate = format!("{numerator}/{denominator}");
    in_range(Setting::FrameRate, numerator > 0 && denominator > 0, "more than 0", rate)?;
    let bits = sequence.fraction_bits;
    in_range(Setting::FractionBits, bits <= MAX_FRACTION_BITS, "from 0 to 8", bits)?;
    let length = sequence.group_length;
    in_range(Setting::GroupLength, length > 0, "from 1 to 255", length)?;
    let Some(names) = &sequence.names else { return Ok(()) };
    let text = name_text(names.prefix.as_bytes());
    let rule = "text of at most 255 bytes without control characters, '/', '\\' and ':'";
    let fits = names.prefix.len() <= MAX_PREFIX && text.is_some();
    let prefix = format_args!("{:?}", names.prefix).to_string();
    in_range(Setting::Names, fits, rule, prefix)?;
    let fits = names.digits <= MAX_DIGITS;
    in_range(Setting::Names, fits, "padded to at most 9 digits", format!("of {}", names.digits))
}

fn check_grid(grid: &GridChoice) -> Checked {
    match *grid {
        GridChoice::Bits { bits, bounds } => {
            in_range(Setting::Bits, BITS.contains(&bits), "from 4 to 20", bits)?;
            check_bounds(bounds)
        }
        GridChoice::Step { step, bounds } => {
            in_range(Setting::Step, is_positive(step), "a positive number", step)?;
            check_bounds(bounds)?;
            bounds.map_or(Ok(()), |bounds| check_step(step, &bounds))
        }
        GridChoice::Lossless(grid) => {
            let sound = is_positive(grid.step) && grid.origin.iter().all(|c| c.is_finite());
            let rule = "a grid with a positive step and a finite origin";
            let value = format!("{:?} with step {}", grid.origin, grid.step);
            in_range(Setting::Lossless, sound, rule, value)
        }
    }
}

fn check_bounds(bounds: Option<BoundingBox>) -> Checked {
    let Some(BoundingBox { min, max }) = bounds else { return Ok(()) };
    let sound = (0..3).all(|k| min[k].is_finite() && max[k].is_finite() && min[k] <= max[k]);
    let value = format!("{min:?} to {max:?}");
    in_range(Setting::Bounds, sound, "finite, with no side below 0", value)
}

/// Checks that a step is smaller than the box, and that coordinates can number the steps of the
/// box.
fn check_step(step: f64, bounds: &BoundingBox) -> Checked {
    let side = bounds.longest_side();
    let pair = [Setting::Step, Setting::Bounds];
    require(side == 0.0 || step <= side, &pair, || {
        format!("{{0}} is {step}, which is longer than the longest side of {{1}}, {side}")
    })?;
    require(side / step < f64::from(COORDINATE_LIMIT), &pair, || {
        format!(
            "{{0}} is {step}; the longest side of {{1}} is {side}, which is 2^20 steps or more: \
             choose a longer step"
        )
    })
}

fn check_intra(intra: &IntraConfig) -> Checked {
    match intra.decimation {
        None => {}
        Some(Decimation::Faces(faces)) => {
            in_range(Setting::DecimationFaces, faces > 0, "1 or more", faces)?;
        }
        Some(Decimation::Share(share)) => {
            let holds = share > 0.0 && share <= 1.0;
            let percent = format!("{}%", 100.0 * share);
            in_range(Setting::DecimationFaces, holds, "more than 0% and at most 100%", percent)?;
        }
        Some(Decimation::Error(error)) => {
            in_range(Setting::DecimationError, is_positive(error), "a positive number", error)?;
        }
    }
    match intra.smoothing {
        SmoothingChoice::Strength(strength) => {
            let rule = "auto, or from 0 to 5";
            in_range(Setting::Smoothing, strength <= MAX_SMOOTHING, rule, strength)
        }
        SmoothingChoice::Auto => Ok(()),
    }
}

fn check_motion(motion: &MotionConfig) -> Checked {
    let share = motion.max_error;
    in_range(Setting::MaxError, is_positive(share), "a positive share of the scan's size", share)?;
    let most = motion.nodes.most();
    let rule = match motion.nodes {
        NodeChoice::Fixed(_) => "auto, or from 1 to 4096",
        NodeChoice::Cost { .. } => "auto with at most 1 to 4096 nodes",
    };
    in_range(Setting::Nodes, (1..=MAX_NODES).contains(&most), rule, most)?;
    let q = motion.nodes_per_vertex;
    in_range(Setting::NodesPerVertex, NODES_PER_VERTEX.contains(&q), "from 1 to 8", q)?;
    if let Some(sigma) = motion.weights.sigma() {
        let holds = (1..COORDINATE_LIMIT as u32).contains(&sigma);
        let rule = "gaussian with a sigma from 1 to 1048575 grid steps";
        in_range(Setting::Weights, holds, rule, motion.weights)?;
    }
    let names_a_part = motion.affine != AffineChoice::Labels(Vec::new());
    in_range(
        Setting::Affine,
        names_a_part,
        "labels with at least one part",
        "labels without a part",
    )
}

fn check_steps(motion: &MotionConfig) -> Checked {
    let step = match motion.translation_step {
        StepChoice::Fixed(step) => Some(step),
        StepChoice::Cost => None,
    };
    let steps = [
        (Setting::TranslationStep, step),
        (Setting::RotationStep, motion.rotation_step),
        (Setting::ScaleStep, motion.scale_step),
        (Setting::ShearStep, motion.shear_step),
    ];
    for (setting, step) in steps {
        if let Some(step) = step {
            in_range(setting, is_positive(step), "a positive number of grid steps", step)?;
        }
    }
    Ok(())
}

fn check_rate(rate: &RateConfig) -> Checked {
    let holds = rate.lambda >= 0.0 && rate.lambda.is_finite();
    in_range(Setting::Lambda, holds, "0 or more", rate.lambda)
}

/// Checks lossless settings: I-frames must be neither decimated nor smoothed.
fn check_lossless(sequence: &SequenceConfig, intra: &IntraConfig) -> Checked {
    if !matches!(sequence.grid, GridChoice::Lossless(_)) {
        return Ok(());
    }
    let length = sequence.group_length;
    require(length == 1, &[Setting::Lossless, Setting::GroupLength], || {
        format!("{{0}} needs I-frames only; {{1}} is {length} and must be 1")
    })?;
    let decimation = match intra.decimation {
        None => None,
        Some(Decimation::Error(_)) => Some(Setting::DecimationError),
        Some(Decimation::Faces(_) | Decimation::Share(_)) => Some(Setting::DecimationFaces),
    };
    if let Some(decimation) = decimation {
        let sentence = "{0} keeps every vertex; {1} drops some and must be left out";
        return Err(SettingsError::new(&[Setting::Lossless, decimation], sentence));
    }
    let unmoved = matches!(intra.smoothing, SmoothingChoice::Auto | SmoothingChoice::Strength(0));
    require(unmoved, &[Setting::Lossless, Setting::Smoothing], || {
        format!("{{0}} keeps every coordinate; {{1}} is {} and must be 0", intra.smoothing)
    })
}

/// Checks that each step belongs to a component that some node carries.
fn check_components(motion: &MotionConfig) -> Checked {
    let fixed = match motion.combination {
        CombinationChoice::Fixed(combination) => Some(combination),
        _ => None,
    };
    let scale = (Setting::ScaleStep, motion.scale_step, fixed.is_none_or(|f| f.scale), "scales");
    let shear = (Setting::ShearStep, motion.shear_step, fixed.is_none_or(|f| f.shear), "shears");
    for (setting, step, carried, what) in [scale, shear] {
        let Some(step) = step else { continue };
        require(motion.affine != AffineChoice::None, &[setting, Setting::Affine], || {
            format!("{{0}} is {step}, but {{1}} is none: no node carries {what}")
        })?;
        require(carried, &[setting, Setting::Combination], || {
            format!("{{0}} is {step}, but {{1}} is {}: no node carries {what}", motion.combination)
        })?;
    }
    let Some(fixed) = fixed else { return Ok(()) };
    let turns = fixed.rotation || motion.affine != AffineChoice::All;
    let settings = [Setting::RotationStep, Setting::Combination, Setting::Affine];
    require(motion.rotation_step.is_none() || turns, &settings, || {
        format!("{{0}} is set, but {{1}} is {fixed} and {{2}} is all: no node carries rotations")
    })?;
    let stretches = fixed.scale || fixed.shear;
    let by_cost = motion.affine == AffineChoice::Cost;
    require(stretches || !by_cost, &[Setting::Affine, Setting::Combination], || {
        format!("{{0}} is cost, which weighs scales and shears, but {{1}} is {fixed} without them")
    })
}

/// Checks that a measure of D is set only where something is chosen by it.
fn check_measure(motion: &MotionConfig, rate: &RateConfig) -> Checked {
    let settings = [Setting::Distortion, Setting::TranslationStep, Setting::Combination];
    let measured = motion.is_by_cost() || rate.distortion == DistortionMeasure::Surrogate;
    require(measured, &settings, || {
        let (step, combination) = (motion.translation_step, motion.combination);
        format!(
            "{{0}} is msdm2, but {{1}} is {step} and {{2}} is {combination}: nothing is chosen by it"
        )
    })
}
