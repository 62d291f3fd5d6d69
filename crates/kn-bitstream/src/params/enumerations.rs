//! Enumerations that a sequence header or a P-frame carries as a number.

use crate::impl_named;
use strum::{AsRefStr, EnumMessage, VariantArray};

/// The unit of world coordinates (`unit_of_length`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, AsRefStr, EnumMessage, VariantArray)]
#[repr(u8)]
pub enum UnitOfLength {
    /// Unknown.
    #[default]
    #[strum(serialize = "unspecified")]
    Unspecified,
    /// Metre.
    #[strum(serialize = "m")]
    Metre,
    /// Centimetre.
    #[strum(serialize = "cm")]
    Centimetre,
    /// Millimetre.
    #[strum(serialize = "mm")]
    Millimetre,
    /// Inch, 25.4 mm.
    #[strum(serialize = "in")]
    Inch,
    /// Foot, 304.8 mm.
    #[strum(serialize = "ft")]
    Foot,
}

/// The axis that points up (`up_axis`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, AsRefStr, EnumMessage, VariantArray)]
#[strum(serialize_all = "lowercase")]
#[repr(u8)]
pub enum UpAxis {
    /// The first coordinate.
    X,
    /// The second coordinate.
    #[default]
    Y,
    /// The third coordinate.
    Z,
}

/// The weight of a node as a function of its distance d from the vertex (`weight_scheme`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, AsRefStr, EnumMessage, VariantArray)]
#[strum(serialize_all = "kebab-case")]
#[repr(u8)]
pub enum WeightScheme {
    /// w = 1/d²: the bi-modal paper's scheme.
    #[default]
    InverseSquare,
    /// w = (1 − d/d')², d' the distance of the first node that is not used (Sumner 2007). It stands
    /// in for the scheme of the earlier codec.
    Sumner,
    /// w = exp(−d²/2σ²), σ sent with the key nodes. It stands in for the isometric scheme.
    Gaussian,
}

/// The influence on a vertex whose region has no key node (`influence_mode`,
/// `deform.influence.mode`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, AsRefStr, EnumMessage, VariantArray)]
#[strum(serialize_all = "kebab-case")]
#[repr(u8)]
pub enum InfluenceMode {
    /// An error: the paper's manual mode.
    #[default]
    Strict,
    /// The nearest nodes of any region move it: the paper's auto mode.
    Fallback,
}

/// The prediction of the translations of a P-frame (`translation_mode`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, AsRefStr, EnumMessage, VariantArray)]
#[strum(serialize_all = "kebab-case")]
#[repr(u8)]
pub enum TranslationMode {
    /// Nothing.
    #[default]
    Direct,
    /// The node before on a path over the influence graph.
    Spatial,
    /// The node's own translation in the frame before and a change that its part has in common.
    SpatioTemporal,
}

impl_named! {
    UnitOfLength: "unit of length",
    UpAxis: "up axis",
    WeightScheme: "weight scheme",
    InfluenceMode: "influence mode",
    TranslationMode: "translation mode",
}

impl UpAxis {
    /// 0, 1 or 2: the index of the coordinate.
    pub const fn index(self) -> usize {
        self as usize
    }
}
