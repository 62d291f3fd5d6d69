//! Turns quantised motion into node transforms (`spec/07-motion.md`).

use kn_bitstream::{MotionFrame, parameter_step};
use kn_deform::NodeTransform;

/// Unit of the steps of rotation, scale and shear: 2^−16.
const PARAMETER_UNIT: f64 = 1.0 / 65536.0;

/// Dequantises the transforms of a frame; `affine` has one entry per node, `translations` are
/// decoded already, in reference units. Components that a node does not carry are the identity.
///
/// The reader has checked every range, and a product of integers below 2^53 with a power of two is
/// exact, so there is nothing to round here.
pub(crate) fn decode_transforms(
    motion: &MotionFrame,
    affine: &[bool],
    translations: &[[i64; 3]],
    transforms: &mut Vec<NodeTransform>,
) {
    transforms.clear();
    transforms.extend(translations.iter().map(|translation| NodeTransform {
        translation: translation.map(|t| t as f64),
        ..NodeTransform::IDENTITY
    }));
    let enabled = motion.enabled;
    let carriers = |rigid: bool, affine_too: bool| {
        (0..affine.len()).filter(move |&node| if affine[node] { affine_too } else { rigid })
    };
    let step = parameter_step(motion.rotation_step);
    for (node, &quantised) in carriers(true, enabled.rotation).zip(&motion.rotation) {
        transforms[node].rotation = parameter(quantised, step);
    }
    let step = parameter_step(motion.scale_step);
    for (node, &quantised) in carriers(false, enabled.scale).zip(&motion.scale) {
        transforms[node].scale = parameter(quantised, step).map(|change| 1.0 + change);
    }
    let step = parameter_step(motion.shear_step);
    for (node, &quantised) in carriers(false, enabled.shear).zip(&motion.shear) {
        transforms[node].shear = parameter(quantised, step);
    }
}

fn parameter(quantised: [i32; 3], step: i64) -> [f64; 3] {
    quantised.map(|q| (i64::from(q) * step) as f64 * PARAMETER_UNIT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kn_bitstream::params::Combination;

    #[test]
    fn lists_go_to_the_nodes_that_carry_them() {
        let motion = MotionFrame {
            enabled: Combination { rotation: false, scale: true, shear: true },
            rotation_step: 56,
            scale_step: 56,
            shear_step: 60,
            rotation: vec![[1, 0, 0], [0, 0, -1]],
            scale: vec![[-1, 0, 2]],
            shear: vec![[0, 1, 0]],
            ..MotionFrame::default()
        };
        let mut transforms = Vec::new();
        let translations = [[4, 0, -4], [8, 0, 0], [0; 3]];
        decode_transforms(&motion, &[false, true, false], &translations, &mut transforms);
        assert_eq!(transforms[0].translation, [4.0, 0.0, -4.0]);
        assert_eq!(transforms[0].rotation, [1.0, 0.0, 0.0]);
        assert_eq!(transforms[1].rotation, [0.0; 3]);
        assert_eq!(transforms[1].scale, [0.0, 1.0, 3.0]);
        assert_eq!(transforms[1].shear, [0.0, 2.0, 0.0]);
        assert_eq!(transforms[2].rotation, [0.0, 0.0, -1.0]);
        assert_eq!(transforms[2].scale, [1.0; 3]);
    }
}
