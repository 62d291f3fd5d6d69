//! What a caller can choose. Every number is free of units: the same values serve metres,
//! millimetres and grid steps, five nodes and five hundred.

use kn_deform::Combination;

/// When each labelled part is first aligned rigidly, before the nodes move (the paper's
/// segmentation-enhanced correspondence estimation).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PartStart {
    /// Never.
    Off,
    /// Wherever both meshes carry labels.
    On,
    /// Wherever both meshes carry labels and the aligned start leaves a clearly lower residual.
    #[default]
    Auto,
}

/// How a frame is fitted.
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
        }
    }
}
