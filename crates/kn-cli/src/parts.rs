//! Body parts in words: what the segmentation doubts, what is odd about given labels.

use kn_bitstream::params::{BodyPart, Named};
use kn_segment::{LabelWarning, SegmentWarning};
use serde_json::{Map, Value};

/// A part's name; labels beyond the parts have none.
pub(crate) fn name(label: u8) -> String {
    BodyPart::from_label(label).map_or("no part".into(), |part| part.to_string())
}

/// The confidence of every part that is there, by name, with three decimals.
pub(crate) fn confidence_json(confidence: &[f32]) -> Value {
    let parts = BodyPart::all();
    let there = parts.iter().zip(confidence).filter(|(_, trust)| **trust > 0.0);
    let rounded = |trust: f32| (f64::from(trust) * 1e3).round() / 1e3;
    there
        .map(|(part, trust)| (part.to_string(), rounded(*trust).into()))
        .collect::<Map<_, _>>()
        .into()
}

/// The text of a warning of the segmentation.
pub(crate) fn doubt(warning: SegmentWarning) -> String {
    match warning {
        SegmentWarning::Joined { part } => {
            format!("{} cannot be told from the body and joined the torso", name(part))
        }
        SegmentWarning::SidesUnclear => "nothing shows clearly which side is left".into(),
        SegmentWarning::NoPerson => "it looks like no person: all of it is Other".into(),
        SegmentWarning::Lost => "the body was lost and searched anew".into(),
    }
}

/// The text of a warning about given labels.
pub(crate) fn oddity(warning: LabelWarning) -> String {
    match warning {
        LabelWarning::Split { part, gap } => {
            format!("{} lies in two pieces, {:.0} % of the height apart", name(part), 1e2 * gap)
        }
        LabelWarning::WrongSide { part } => {
            format!("{} grows from a limb of the other side", name(part))
        }
        LabelWarning::SidesSwapped => "left and right are swapped: the feet point backwards".into(),
        LabelWarning::Unknown { label } => format!("label {label} is no body part"),
    }
}
