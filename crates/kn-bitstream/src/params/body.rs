//! The parts of a human body and the regions that they form.

use crate::impl_named;
use strum::{AsRefStr, EnumMessage, VariantArray};

/// A body part: the 14 parts of the bi-modal paper, in its order, and [`Self::Other`] for whatever
/// belongs to no part. The discriminant is the label of [`super::LabelSet::Body`]
/// (`header.labels.meaning`).
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, AsRefStr, EnumMessage, VariantArray,
)]
#[repr(u8)]
pub enum BodyPart {
    /// Head and neck.
    Head,
    /// Left upper arm.
    #[strum(serialize = "Left upper arm")]
    LeftUpperArm,
    /// Left lower arm.
    #[strum(serialize = "Left lower arm")]
    LeftLowerArm,
    /// Left hand.
    #[strum(serialize = "Left hand")]
    LeftHand,
    /// Right upper arm.
    #[strum(serialize = "Right upper arm")]
    RightUpperArm,
    /// Right lower arm.
    #[strum(serialize = "Right lower arm")]
    RightLowerArm,
    /// Right hand.
    #[strum(serialize = "Right hand")]
    RightHand,
    /// Torso, with the cloth that hangs from it.
    Torso,
    /// Left thigh.
    #[strum(serialize = "Left thigh")]
    LeftThigh,
    /// Left lower leg.
    #[strum(serialize = "Left leg")]
    LeftLeg,
    /// Left foot.
    #[strum(serialize = "Left foot")]
    LeftFoot,
    /// Right thigh.
    #[strum(serialize = "Right thigh")]
    RightThigh,
    /// Right lower leg.
    #[strum(serialize = "Right leg")]
    RightLeg,
    /// Right foot.
    #[strum(serialize = "Right foot")]
    RightFoot,
    /// No part of a body: a held ball, a chair.
    Other,
}

/// A region of influence: key nodes move the vertices of their own region. The discriminant is the
/// number of the region (`header.labels.meaning`).
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, AsRefStr, EnumMessage, VariantArray,
)]
#[repr(u8)]
pub enum Region {
    /// The head.
    Head,
    /// The torso.
    Torso,
    /// Left upper arm, lower arm and hand.
    #[strum(serialize = "Left arm")]
    LeftArm,
    /// Right upper arm, lower arm and hand.
    #[strum(serialize = "Right arm")]
    RightArm,
    /// Left thigh, leg and foot.
    #[strum(serialize = "Left leg")]
    LeftLeg,
    /// Right thigh, leg and foot.
    #[strum(serialize = "Right leg")]
    RightLeg,
    /// Vertices that belong to no part of a body.
    Other,
}

impl_named! {
    BodyPart: "body part",
    Region: "region",
}

impl BodyPart {
    /// Number of parts, [`Self::Other`] included: labels are below it.
    pub const COUNT: usize = Self::VARIANTS.len();

    /// The label that vertices of the part carry.
    pub const fn label(self) -> u8 {
        self as u8
    }

    /// The label as an index of a list with an entry for each part.
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The part with this label; `None` for a label that no part has.
    pub const fn from_label(label: u8) -> Option<Self> {
        if (label as usize) < Self::COUNT { Some(Self::VARIANTS[label as usize]) } else { None }
    }

    /// The region that the part belongs to.
    pub const fn region(self) -> Region {
        match self {
            Self::Head => Region::Head,
            Self::LeftUpperArm | Self::LeftLowerArm | Self::LeftHand => Region::LeftArm,
            Self::RightUpperArm | Self::RightLowerArm | Self::RightHand => Region::RightArm,
            Self::Torso => Region::Torso,
            Self::LeftThigh | Self::LeftLeg | Self::LeftFoot => Region::LeftLeg,
            Self::RightThigh | Self::RightLeg | Self::RightFoot => Region::RightLeg,
            Self::Other => Region::Other,
        }
    }

    /// The corresponding part on the other side. Head, torso and `Other` have no side.
    pub const fn mirrored(self) -> Self {
        match self {
            Self::LeftUpperArm => Self::RightUpperArm,
            Self::LeftLowerArm => Self::RightLowerArm,
            Self::LeftHand => Self::RightHand,
            Self::RightUpperArm => Self::LeftUpperArm,
            Self::RightLowerArm => Self::LeftLowerArm,
            Self::RightHand => Self::LeftHand,
            Self::LeftThigh => Self::RightThigh,
            Self::LeftLeg => Self::RightLeg,
            Self::LeftFoot => Self::RightFoot,
            Self::RightThigh => Self::LeftThigh,
            Self::RightLeg => Self::LeftLeg,
            Self::RightFoot => Self::LeftFoot,
            Self::Head | Self::Torso | Self::Other => self,
        }
    }

    /// The part's 8-bit sRGB colour, in pictures and in labels that are given as vertex colours.
    ///
    /// A limb has a family of hues (left arm reds, right arm blues, left leg pinks, right leg
    /// teals), lighter towards its end.
    pub const fn colour(self) -> [u8; 3] {
        match self {
            Self::Head => [255, 204, 0],
            Self::LeftUpperArm => [204, 0, 0],
            Self::LeftLowerArm => [255, 102, 0],
            Self::LeftHand => [255, 153, 102],
            Self::RightUpperArm => [0, 0, 204],
            Self::RightLowerArm => [0, 102, 255],
            Self::RightHand => [102, 178, 255],
            Self::Torso => [0, 153, 51],
            Self::LeftThigh => [153, 0, 102],
            Self::LeftLeg => [204, 51, 153],
            Self::LeftFoot => [255, 153, 204],
            Self::RightThigh => [0, 102, 102],
            Self::RightLeg => [0, 153, 153],
            Self::RightFoot => [102, 204, 204],
            Self::Other => [128, 128, 128],
        }
    }

    /// The part whose [`Self::colour`] this is exactly.
    pub fn of_colour(colour: [u8; 3]) -> Option<Self> {
        Self::VARIANTS.iter().copied().find(|part| part.colour() == colour)
    }
}

impl Region {
    /// Number of regions, [`Self::Other`] included.
    pub const COUNT: usize = Self::VARIANTS.len();

    /// The parts that form the region, by rising label.
    pub fn parts(self) -> impl Iterator<Item = BodyPart> {
        BodyPart::VARIANTS.iter().copied().filter(move |part| part.region() == self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_and_colours_name_their_part() {
        for (label, &part) in (0_u8..).zip(BodyPart::VARIANTS) {
            assert_eq!((part.label(), BodyPart::from_label(label)), (label, Some(part)));
            assert_eq!(BodyPart::of_colour(part.colour()), Some(part));
        }
        assert_eq!((BodyPart::COUNT, BodyPart::from_label(15)), (15, None));
        assert_eq!(BodyPart::of_colour([1, 2, 3]), None);
        assert_eq!("left FOOT".parse(), Ok(BodyPart::LeftFoot));
    }

    #[test]
    fn the_other_side_is_another_part_of_the_same_kind() {
        for &part in BodyPart::VARIANTS {
            assert_eq!(part.mirrored().mirrored(), part);
            let name = part.to_string().replace("Left", "side").replace("Right", "side");
            let other =
                part.mirrored().to_string().replace("Left", "side").replace("Right", "side");
            assert_eq!(name, other);
        }
    }

    #[test]
    fn every_part_is_in_one_region() {
        let parts: usize = Region::VARIANTS.iter().map(|region| region.parts().count()).sum();
        assert_eq!((parts, Region::COUNT), (BodyPart::COUNT, 7));
        let legs: Vec<_> = Region::LeftLeg.parts().map(BodyPart::label).collect();
        assert_eq!(legs, [8, 9, 10]);
    }
}
