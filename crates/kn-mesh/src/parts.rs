//! The body parts of a scanned human: names, label values and a colour for each.

/// Names of the labels 0 to 13 in the paper's order (its body-part list), then 14 for whatever
/// belongs to no part: a held ball, a chair.
pub const PART_NAMES: [&str; 15] = [
    "Head",
    "Left upper arm",
    "Left lower arm",
    "Left hand",
    "Right upper arm",
    "Right lower arm",
    "Right hand",
    "Torso",
    "Left thigh",
    "Left leg",
    "Left foot",
    "Right thigh",
    "Right leg",
    "Right foot",
    "Other",
];

/// The label of vertices that belong to no body part.
pub const OTHER_LABEL: u8 = 14;

/// The largest label value of any segmentation; 255 is never a label.
pub const MAX_LABEL: u8 = 254;

/// 8-bit sRGB colours of the labels 0 to 14, for pictures and for labels given as vertex colours.
///
/// A family of hues per limb (left arm reds, right arm blues, left leg pinks, right leg teals),
/// lighter towards its end.
pub const PART_COLOURS: [[u8; 3]; 15] = [
    [255, 204, 0],
    [204, 0, 0],
    [255, 102, 0],
    [255, 153, 102],
    [0, 0, 204],
    [0, 102, 255],
    [102, 178, 255],
    [0, 153, 51],
    [153, 0, 102],
    [204, 51, 153],
    [255, 153, 204],
    [0, 102, 102],
    [0, 153, 153],
    [102, 204, 204],
    [128, 128, 128],
];

/// The label whose colour in [`PART_COLOURS`] is exactly `colour`.
pub fn label_of_colour(colour: [u8; 3]) -> Option<u8> {
    PART_COLOURS.iter().position(|&known| known == colour).map(|label| label as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_colour_names_its_own_label() {
        for (label, &colour) in PART_COLOURS.iter().enumerate() {
            assert_eq!(label_of_colour(colour), Some(label as u8), "{}", PART_NAMES[label]);
        }
        assert_eq!(label_of_colour([1, 2, 3]), None);
        assert_eq!(PART_NAMES[usize::from(OTHER_LABEL)], "Other");
    }
}
