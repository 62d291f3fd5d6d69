//! Labels of vertices and their regions.

use crate::params::BodyPart;

/// The labels that vertices may have, and the region of each label.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum LabelSet {
    /// One label, one region.
    #[default]
    None,
    /// The labels and regions of [`BodyPart`].
    Body,
    /// Labels of the sequence's own, 1 to 64: the region of each, below 64.
    Custom(Vec<u8>),
}

impl LabelSet {
    /// Number of labels.
    pub fn label_count(&self) -> u32 {
        match self {
            Self::None => 1,
            Self::Body => BodyPart::COUNT as u32,
            Self::Custom(regions) => regions.len() as u32,
        }
    }

    /// Region of a label, `None` for a label that is not in the set.
    pub fn region(&self, label: u8) -> Option<u8> {
        match self {
            Self::None => (label == 0).then_some(0),
            Self::Body => BodyPart::from_label(label).map(|part| part.region() as u8),
            Self::Custom(regions) => regions.get(usize::from(label)).copied(),
        }
    }
}
