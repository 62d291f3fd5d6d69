//! Options of a fit. Every number is free of units: the same values serve metres, millimetres and
//! grid steps, five nodes and five hundred.

use crate::measures::MeasureOptions;
use kn_bitstream::impl_named;
use kn_bitstream::params::Combination;
use strum::{AsRefStr, EnumMessage, VariantArray};

/// The frames in which each labelled part is first aligned rigidly, before the nodes move (the
/// paper's segmentation-enhanced correspondence estimation).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, AsRefStr, EnumMessage, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum PartStart {
    /// Never.
    Off,
    /// In every frame, as in the paper.
    On,
    /// In frames where it leaves the mesh clearly nearer to the scan.
    #[default]
    Auto,
}

impl_named! { PartStart: "part start" }

/// Options of the fit of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    /// The components that affine nodes may use; rigid nodes always have rotation and translation.
    pub combination: Combination,
    /// α_reg of the last pass, relative to the data term; earlier passes are stiffer.
    pub regularisation: f64,
    /// α_orth, relative to the data term.
    pub orthogonality: f64,
    /// Weight of a residual's tangential part; the part along the normal has weight 1.
    pub tangential: f64,
    /// Bound on the correspondence steps.
    pub max_steps: usize,
    /// Whether labelled parts are aligned first.
    pub part_start: PartStart,
    /// Options of the measures of what the motion does not explain; `None` leaves them out.
    pub measures: Option<MeasureOptions>,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            combination: Combination::RTSH,
            regularisation: 0.004,
            orthogonality: 0.001,
            tangential: 0.05,
            max_steps: 40,
            part_start: PartStart::Auto,
            measures: None,
        }
    }
}
