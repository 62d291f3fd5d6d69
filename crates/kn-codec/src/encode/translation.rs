//! Coding of the translations of a P-frame: their prediction and their quantised values.

use crate::decode::Translations;
use crate::encode::choices::TranslationChoice;
use crate::encode::quantise::quantised;
use kn_bitstream::params::TranslationMode;
use kn_bitstream::{EntropyMode, MotionFrame, ValueList, translation_step};
use kn_deform::NodeTransform;

/// Codes the translations of `transforms` (`#N`, in reference units) into `motion`: mode, step,
/// values, changes and table. `before` is the state of the GoF, `limit` what no decoded translation
/// may reach.
pub(crate) fn code_translations(
    transforms: &[NodeTransform],
    before: &Translations,
    choice: TranslationChoice,
    step: u8,
    limit: i32,
    motion: &mut MotionFrame,
) {
    // Rounding moves one by half a step at most.
    let reach = (f64::from(limit - 1) - translation_step(step) as f64 / 2.0).max(0.0);
    let wanted: Vec<[f64; 3]> =
        transforms.iter().map(|t| t.translation.map(|t| t.clamp(-reach, reach))).collect();
    let entropy = motion.entropy_mode;
    let trial = |&mode: &TranslationMode| Trial::new(mode, entropy, &wanted, before, step);
    let trials = modes(choice, before).iter().map(trial);
    // Of equals the first.
    let Some(best) = trials.min_by_key(|trial| trial.bits) else { return };
    motion.translation_step = step;
    motion.translation_mode = best.mode;
    motion.translation_table = best.table;
    motion.translation_change = best.changes;
    motion.translation = best.values;
}

/// The modes to try in this frame.
fn modes(choice: TranslationChoice, before: &Translations) -> &'static [TranslationMode] {
    use TranslationMode::{Direct, Spatial, SpatioTemporal};
    match (choice, before.dictionary()) {
        (TranslationChoice::Direct, _) => &[Direct],
        (TranslationChoice::Paper, None) => &[Spatial],
        (TranslationChoice::Paper, Some(_)) => &[SpatioTemporal],
        (TranslationChoice::Cost, None) => &[Direct, Spatial],
        (TranslationChoice::Cost, Some(_)) => &[Direct, Spatial, SpatioTemporal],
    }
}

/// A frame's translations in one mode.
struct Trial {
    mode: TranslationMode,
    /// Number of bits of the values and the changes.
    bits: u64,
    table: u8,
    changes: Vec<[i32; 3]>,
    values: Vec<[i32; 3]>,
}

impl Trial {
    fn new(
        mode: TranslationMode,
        entropy: EntropyMode,
        wanted: &[[f64; 3]],
        before: &Translations,
        step: u8,
    ) -> Self {
        let step = translation_step(step);
        let (changes, change_bits) = match mode {
            TranslationMode::SpatioTemporal => fit_changes(entropy, wanted, before),
            TranslationMode::Direct | TranslationMode::Spatial => (Vec::new(), 0),
        };
        let mut values = vec![[0; 3]; wanted.len()];
        let quantise = |node: usize, prediction: [i64; 3]| {
            let value = |axis: usize| {
                let difference = wanted[node][axis] - prediction[axis] as f64;
                quantised(difference, step as f64, f64::INFINITY)
            };
            values[node] = std::array::from_fn(value);
            let decoded = |axis: usize| prediction[axis] + i64::from(values[node][axis]) * step;
            Ok::<_, std::convert::Infallible>(std::array::from_fn(decoded))
        };
        let Ok(()) = before.clone().predict(mode, &changes, quantise);
        let (table, bits) = entropy.best_table(&[(ValueList::Translation, &values)]);
        Self { mode, bits: bits + change_bits, table, changes, values }
    }
}

/// The change of every part since the frame before, quantised by that frame's dictionary, and the
/// bits that the changes take.
fn fit_changes(
    entropy: EntropyMode,
    wanted: &[[f64; 3]],
    before: &Translations,
) -> (Vec<[i32; 3]>, u64) {
    let Some(dictionary) = before.dictionary() else { return (Vec::new(), 0) };
    let of_part = |part: u32| {
        let nodes = before.parts().iter().enumerate().filter(|(_, of)| u32::from(**of) == part);
        let change = |(node, _): (usize, &u8)| -> [f64; 3] {
            std::array::from_fn(|axis| wanted[node][axis] - before.decoded()[node][axis] as f64)
        };
        let changes: Vec<[f64; 3]> = nodes.map(change).collect();
        geometric_median(&changes).map(|d| quantised(d, dictionary.step as f64, f64::INFINITY))
    };
    let changes: Vec<[i32; 3]> = (0..before.part_count()).map(of_part).collect();
    let bits = entropy.bits(ValueList::TranslationChange, &changes, dictionary.table);
    (changes, bits)
}

/// The point whose distances to `points` have the least sum, by Weiszfeld's iteration; 0 without
/// points.
fn geometric_median(points: &[[f64; 3]]) -> [f64; 3] {
    const ROUNDS: usize = 64;
    let mean = |weight: &dyn Fn(&[f64; 3]) -> f64| {
        let mut sum = [0.0; 3];
        let mut total = 0.0;
        for point in points {
            let weight = weight(point);
            total += weight;
            (0..3).for_each(|axis| sum[axis] += weight * point[axis]);
        }
        if total > 0.0 { sum.map(|sum| sum / total) } else { [0.0; 3] }
    };
    let mut median = mean(&|_| 1.0);
    for _ in 0..ROUNDS {
        let squared =
            |p: &[f64; 3]| (0..3).map(|k| (p[k] - median[k]) * (p[k] - median[k])).sum::<f64>();
        // A reference unit more than the distance: no weight is infinite.
        median = mean(&|point| 1.0 / (1.0 + squared(point).sqrt()));
    }
    median
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decode::Visit;
    use proptest::prelude::*;

    const NODES: u16 = 6;

    fn group() -> Translations {
        let mut translations = Translations::default();
        let from = |node: u16| (node > 0).then_some(node / 2);
        let path = (0..NODES).map(|node| Visit { node, from: from(node) }).collect();
        translations.begin(&[1, 1, 7, 7, 7, 9], path);
        translations
    }

    fn frames() -> impl Strategy<Value = Vec<Vec<NodeTransform>>> {
        let translation = prop::array::uniform3(-5e4..5e4_f64);
        let node = translation
            .prop_map(|translation| NodeTransform { translation, ..NodeTransform::IDENTITY });
        let frame = prop::collection::vec(node, usize::from(NODES));
        prop::collection::vec(frame, 1..5)
    }

    /// Codes a frame and decodes it; the bits of its translations.
    fn code(
        frame: &[NodeTransform],
        group: &mut Translations,
        choice: TranslationChoice,
        step: u8,
    ) -> u64 {
        let mut motion = MotionFrame::default();
        code_translations(frame, group, choice, step, 1 << 28, &mut motion);
        let mode = motion.entropy_mode;
        let before = group.dictionary().map_or(0, |dictionary| dictionary.table);
        group.decode(&motion, 1 << 28).expect("in range");
        mode.bits(ValueList::TranslationChange, &motion.translation_change, before)
            + mode.bits(ValueList::Translation, &motion.translation, motion.translation_table)
    }

    proptest! {
        #[test]
        fn prediction_saves_bits_and_changes_nothing(frames in frames(), step in 0..40_u8) {
            let [mut direct, mut paper, mut cost] = [group(), group(), group()];
            for frame in &frames {
                let bits = code(frame, &mut direct, TranslationChoice::Direct, step);
                code(frame, &mut paper, TranslationChoice::Paper, step);
                prop_assert!(code(frame, &mut cost, TranslationChoice::Cost, step) <= bits);
                prop_assert_eq!(direct.decoded(), paper.decoded());
                prop_assert_eq!(direct.decoded(), cost.decoded());
            }
        }

        #[test]
        fn any_translation_is_coded_within_half_a_step(frames in frames(), steps in [0..40_u8, 0..40_u8]) {
            // Steps that change from frame to frame.
            let mut group = group();
            for (frame, step) in frames.iter().zip(steps.into_iter().cycle()) {
                code(frame, &mut group, TranslationChoice::Paper, step);
                let half = translation_step(step) as f64 / 2.0;
                for (node, decoded) in frame.iter().zip(group.decoded()) {
                    for axis in 0..3 {
                        prop_assert!((node.translation[axis] - decoded[axis] as f64).abs() <= half);
                    }
                }
            }
        }
    }

    #[test]
    fn the_geometric_median_ignores_an_outlier() {
        let mut points = vec![[10.0, -20.0, 5.0]; 7];
        points.extend([[1e6, 1e6, 0.0], [-3e5, 0.0, 1e7], [0.0; 3]]);
        let median = geometric_median(&points);
        for (found, wanted) in median.iter().zip([10.0, -20.0, 5.0]) {
            assert!((found - wanted).abs() < 1.0, "{median:?}");
        }
        assert_eq!(geometric_median(&[]), [0.0; 3]);
    }
}
