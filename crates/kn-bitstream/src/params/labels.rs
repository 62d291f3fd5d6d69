//! Labels of vertices and their regions.

use crate::params::BodyPart;

/// Which labels vertices have, and the region of influence of each.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum LabelSet {
    /// One label, one region.
    #[default]
    None,
    /// The labels and regions of [`BodyPart`].
    Body,
    /// The region (below 64) of each of 1 to 64 labels.
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
