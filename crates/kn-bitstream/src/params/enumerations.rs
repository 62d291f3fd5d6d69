//! Enumerations that a sequence header or a P-frame carries as a number.

use crate::params::{NameError, Named};
use strum::{AsRefStr, Display, EnumMessage, EnumString, VariantArray};

/// The unit of world coordinates (`unit_of_length`).
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    AsRefStr,
    Display,
    EnumMessage,
    EnumString,
    VariantArray,
)]
#[strum(parse_err_ty = NameError, parse_err_fn = NameError::of::<UnitOfLength>)]
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
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    AsRefStr,
    Display,
    EnumMessage,
    EnumString,
    VariantArray,
)]
#[strum(serialize_all = "lowercase")]
#[strum(parse_err_ty = NameError, parse_err_fn = NameError::of::<UpAxis>)]
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
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    AsRefStr,
    Display,
    EnumMessage,
    EnumString,
    VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
#[strum(parse_err_ty = NameError, parse_err_fn = NameError::of::<WeightScheme>)]
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
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    AsRefStr,
    Display,
    EnumMessage,
    EnumString,
    VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
#[strum(parse_err_ty = NameError, parse_err_fn = NameError::of::<InfluenceMode>)]
#[repr(u8)]
pub enum InfluenceMode {
    /// An error: the paper's manual mode.
    #[default]
    Strict,
    /// The nearest nodes of any region move it: the paper's auto mode.
    Fallback,
}

/// The prediction of the translations of a P-frame (`translation_mode`).
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    AsRefStr,
    Display,
    EnumMessage,
    EnumString,
    VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
#[strum(parse_err_ty = NameError, parse_err_fn = NameError::of::<TranslationMode>)]
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

impl Named for UnitOfLength {
    const KIND: &'static str = "unit of length";

    fn all() -> Vec<Self> {
        Self::VARIANTS.to_vec()
    }
}

impl Named for UpAxis {
    const KIND: &'static str = "up axis";

    fn all() -> Vec<Self> {
        Self::VARIANTS.to_vec()
    }
}

impl Named for WeightScheme {
    const KIND: &'static str = "weight scheme";

    fn all() -> Vec<Self> {
        Self::VARIANTS.to_vec()
    }
}

impl Named for InfluenceMode {
    const KIND: &'static str = "influence mode";

    fn all() -> Vec<Self> {
        Self::VARIANTS.to_vec()
    }
}

impl Named for TranslationMode {
    const KIND: &'static str = "translation mode";

    fn all() -> Vec<Self> {
        Self::VARIANTS.to_vec()
    }
}

impl UpAxis {
    /// 0, 1 or 2: the index of the coordinate.
    pub const fn index(self) -> usize {
        self as usize
    }
}
