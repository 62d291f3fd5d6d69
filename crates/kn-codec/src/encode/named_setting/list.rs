//! The list of settings that have a name.

use super::NamedSetting;
use crate::encode::choices::{
    AffineChoice, CombinationChoice, Decimation, DistortionMeasure, NodePlacement,
    TranslationChoice,
};
use crate::encode::config::GridChoice;
use crate::encode::settings::Setting;
use kn_bitstream::params::{Combination, InfluenceMode, Named};
use kn_fit::PartStart;
use std::fmt;
use std::str::FromStr;

/// The list of settings. A new one is a new entry here.
pub(super) const SETTINGS: &[NamedSetting] = &[
    NamedSetting::new(Setting::Bits, "bits", "N", |config, text| {
        let bits = byte(text)?;
        put(&mut config.sequence.grid, GridChoice::Bits { bits, bounds: None })
    })
    .about("Bits for the longest side of the sequence's box [default: 11]"),
    NamedSetting::new(Setting::Step, "step", "LENGTH", |config, text| {
        let step = length(text)?;
        put(&mut config.sequence.grid, GridChoice::Step { step, bounds: None })
    })
    .about("Step of the grid in world units, instead of bits")
    .excludes("bits"),
    NamedSetting::new(Setting::GroupLength, "gof", "N", |config, text| {
        put(&mut config.sequence.group_length, byte(text)?)
    })
    .about("Frames in a GoF: an I-frame, then P-frames [default: 8]"),
    NamedSetting::new(Setting::DecimationFaces, "iframe_faces", "N|P%", |config, text| {
        put(&mut config.intra.decimation, Some(parse(text)?))
    })
    .about(
        "Decimate I-frames to at most this number of faces, such as 5000, or to a share, such as \
         25%",
    ),
    NamedSetting::new(Setting::DecimationError, "iframe_error", "LENGTH", |config, text| {
        put(&mut config.intra.decimation, Some(Decimation::Error(length(text)?)))
    })
    .about(
        "Decimate I-frames as far as no vertex lies further than this from the surface, in world \
         units",
    )
    .excludes("iframe_faces"),
    NamedSetting::new(Setting::MaxError, "pframe_error", "P%", |config, text| {
        put(&mut config.motion.max_error, percent(text)?)
    })
    .about(
        "Begin a new GoF where a P-frame would be farther from its scan (RMS) than an I-frame by \
         more than this share of the scan's size [default: 1%]",
    )
    .expert(),
    NamedSetting::new(Setting::Nodes, "nodes", "N|AUTO", |config, text| {
        put(&mut config.motion.nodes, parse(text)?)
    })
    .about(
        "Number of key nodes in a GoF, or `auto`: as many as pay for their bytes [default: auto, \
         or the preset's]",
    ),
    NamedSetting::new(Setting::Placement, "placement", "PLACEMENT", |config, text| {
        put(&mut config.motion.placement, parse(text)?)
    })
    .about("Places of the key nodes [default: generated]")
    .values(values::<NodePlacement>)
    .expert(),
    NamedSetting::new(Setting::Influence, "influence", "INFLUENCE", |config, text| {
        put(&mut config.motion.influence, parse(text)?)
    })
    .about("Region without key nodes: an error, or moved by the nearest nodes of any region")
    .values(values::<InfluenceMode>)
    .expert(),
    NamedSetting::new(Setting::Affine, "affine", "AFFINE", |config, text| {
        put(&mut config.motion.affine, parse(text)?)
    })
    .about("Affine key nodes: none, those of the torso, those that pay for their bytes, or all")
    .values(values::<AffineChoice>)
    .expert(),
    NamedSetting::new(Setting::Choice, "choice", "CHOICE", |config, text| {
        put(&mut config.motion.combination, parse(text)?)
    })
    .about("Choice of the components of affine nodes by least J = D + λR [default: first-p]")
    .values(values::<CombinationChoice>)
    .expert(),
    NamedSetting::new(Setting::Combination, "combination", "COMBINATION", |config, text| {
        put(&mut config.motion.combination, CombinationChoice::Fixed(parse(text)?))
    })
    .about("Components of affine nodes instead of a choice")
    .values(|| Combination::ALL.map(|one| (one.name().into(), String::new())).into())
    .excludes("choice")
    .expert(),
    NamedSetting::new(Setting::Distortion, "distortion", "DISTORTION", |config, text| {
        put(&mut config.rate.distortion, parse(text)?)
    })
    .about("Measure of D [default: surrogate]")
    .values(values::<DistortionMeasure>)
    .expert(),
    NamedSetting::new(Setting::Lambda, "lambda", "D", |config, text| {
        put(&mut config.rate.lambda, number(text)?)
    })
    .about("λ: the distortion that a byte of a P-frame is worth [default: 3e-5]")
    .expert(),
    NamedSetting::new(Setting::PartStart, "part_start", "PART_START", |config, text| {
        put(&mut config.motion.part_start, parse(text)?)
    })
    .about(
        "Segment-guided correspondence: whether labelled parts are first aligned rigidly, before \
         their nodes move [default: on]",
    )
    .values(values::<PartStart>)
    .expert(),
    NamedSetting::new(Setting::Translation, "translation", "TRANSLATION", |config, text| {
        put(&mut config.motion.translation, parse(text)?)
    })
    .about(
        "Prediction of translations: none, as in the paper, or the cheapest in each frame \
         [default: cost]",
    )
    .values(values::<TranslationChoice>)
    .expert(),
    NamedSetting::new(Setting::Smoothing, "smoothing", "AUTO|N", |config, text| {
        put(&mut config.intra.smoothing, parse(text)?)
    })
    .about("Strength of the smoothing of I-frames: auto, or 0 (none) to 5 [default: auto]")
    .expert(),
    NamedSetting::new(Setting::Weights, "weights", "WEIGHTS", |config, text| {
        put(&mut config.motion.weights, parse(text)?)
    })
    .about("Weights by distance: inverse-square, sumner or gaussian:SIGMA (in grid steps)")
    .expert(),
    NamedSetting::new(Setting::NodesPerVertex, "nodes_per_vertex", "N", |config, text| {
        put(&mut config.motion.nodes_per_vertex, byte(text)?)
    })
    .about("Key nodes that move a vertex, Q [default: 4]")
    .expert(),
    NamedSetting::new(Setting::TranslationStep, "motion_step", "STEPS|AUTO", |config, text| {
        put(&mut config.motion.translation_step, parse(text)?)
    })
    .about(
        "Quantiser step of translations in grid steps, or `auto`: all steps by least J in every \
         P-frame [default: auto]",
    )
    .expert(),
    NamedSetting::new(Setting::RotationStep, "rotation_step", "STEPS", |config, text| {
        put(&mut config.motion.rotation_step, Some(length(text)?))
    })
    .about(
        "Quantiser step of rotations: the distance that it moves a vertex, in grid steps [default: \
         that of translations, or by least J]",
    )
    .expert(),
    NamedSetting::new(Setting::ScaleStep, "scale_step", "STEPS", |config, text| {
        put(&mut config.motion.scale_step, Some(length(text)?))
    })
    .about("Quantiser step of scales [default: twice that of translations, or by least J]")
    .expert(),
    NamedSetting::new(Setting::ShearStep, "shear_step", "STEPS", |config, text| {
        put(&mut config.motion.shear_step, Some(length(text)?))
    })
    .about("Quantiser step of shears [default: twice that of translations, or by least J]")
    .expert(),
];

/// Sets a field.
fn put<T>(field: &mut T, value: T) -> Result<(), String> {
    *field = value;
    Ok(())
}

fn parse<T: FromStr<Err: fmt::Display>>(text: &str) -> Result<T, String> {
    text.parse().map_err(|error: T::Err| error.to_string())
}

fn byte(text: &str) -> Result<u8, String> {
    text.parse().map_err(|_| "give a whole number from 0 to 255".into())
}

fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "give a number".into())
}

fn length(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(length) if length > 0.0 && length.is_finite() => Ok(length),
        _ => Err("give a positive number".into()),
    }
}

fn percent(text: &str) -> Result<f64, String> {
    match text.strip_suffix('%').map(str::parse::<f64>) {
        Some(Ok(percent)) if percent > 0.0 && percent.is_finite() => Ok(percent / 100.0),
        _ => Err("give a positive share in percent, such as 1%".into()),
    }
}

fn values<T: Named>() -> Vec<(String, String)> {
    T::all().iter().map(|value| (value.name().to_owned(), value.about())).collect()
}
