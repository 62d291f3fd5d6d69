//! Translations of the key nodes, and their predictions (`spec/07-motion.md`, 7.3 and
//! 7.4). The encoder runs the same prediction with its own quantiser in the loop.

use crate::decode::path::Visit;
use kn_bitstream::params::TranslationMode;
use kn_bitstream::rule::{self, Rule};
use kn_bitstream::{MotionFrame, translation_step};

/// The translations of the last P-frame of a GoF, and the data that the next ones are predicted
/// from.
#[derive(Clone, Debug, Default)]
pub(crate) struct Translations {
    /// `#N × 3`, in reference units, each below 2^20 grid steps in magnitude; undefined before the
    /// first P-frame.
    decoded: Vec<[i64; 3]>,
    /// Quantiser and table of the last P-frame; `None` before the first of the GoF.
    dictionary: Option<Dictionary>,
    /// `#N`, place of the node's label among the labels that nodes have.
    parts: Vec<u8>,
    part_count: u32,
    path: Vec<Visit>,
}

/// Quantiser step and Huffman table of a frame's translations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dictionary {
    pub(crate) step: i64,
    pub(crate) table: u8,
}

impl Translations {
    /// Begins a GoF with nodes of these labels and this path over them.
    pub(crate) fn begin(&mut self, labels: &[u8], path: Vec<Visit>) {
        let mut place = [None; 256];
        labels.iter().for_each(|&label| place[usize::from(label)] = Some(0));
        self.part_count = 0;
        for place in place.iter_mut().flatten() {
            *place = self.part_count as u8;
            self.part_count += 1;
        }
        self.parts.clear();
        self.parts.extend(labels.iter().map(|&label| place[usize::from(label)].unwrap_or(0)));
        self.decoded.clear();
        self.decoded.resize(labels.len(), [0; 3]);
        self.dictionary = None;
        self.path = path;
    }

    /// Number of parts that have a node.
    pub(crate) fn part_count(&self) -> u32 {
        self.part_count
    }

    /// Quantiser and table of the GoF's last P-frame.
    pub(crate) fn dictionary(&self) -> Option<Dictionary> {
        self.dictionary
    }

    /// `#N × 3`, of the last P-frame, in reference units.
    pub(crate) fn decoded(&self) -> &[[i64; 3]] {
        &self.decoded
    }

    /// `#N`, the part of every node.
    #[cfg(feature = "encode")]
    pub(crate) fn parts(&self) -> &[u8] {
        &self.parts
    }

    /// Decodes a P-frame's translations, each below `limit` in magnitude.
    ///
    /// # Errors
    /// The rule that is broken; the state is then undefined until the next GoF.
    pub(crate) fn decode(&mut self, motion: &MotionFrame, limit: i64) -> Result<(), Rule> {
        let step = translation_step(motion.translation_step);
        // Values are below 2^20 and steps below 2^16, so that nothing here overflows.
        let add = |node: usize, prediction: [i64; 3]| {
            let values = motion.translation[node];
            let sum = |axis: usize| prediction[axis] + i64::from(values[axis]) * step;
            inside(std::array::from_fn(sum), limit)
        };
        self.predict(motion.translation_mode, &motion.translation_change, add)?;
        self.dictionary = Some(Dictionary { step, table: motion.translation_table });
        Ok(())
    }

    /// Calls `translate` with each node and its prediction, and keeps the translation that it
    /// returns. The order of the nodes lets later ones be predicted from earlier ones.
    ///
    /// # Errors
    /// The errors of `translate`.
    pub(crate) fn predict<E>(
        &mut self,
        mode: TranslationMode,
        changes: &[[i32; 3]],
        mut translate: impl FnMut(usize, [i64; 3]) -> Result<[i64; 3], E>,
    ) -> Result<(), E> {
        match mode {
            TranslationMode::Direct => {
                for (node, translation) in self.decoded.iter_mut().enumerate() {
                    *translation = translate(node, [0; 3])?;
                }
            }
            TranslationMode::Spatial => {
                for visit in &self.path {
                    let prediction =
                        visit.from.map_or([0; 3], |from| self.decoded[usize::from(from)]);
                    let node = usize::from(visit.node);
                    self.decoded[node] = translate(node, prediction)?;
                }
            }
            TranslationMode::SpatioTemporal => {
                let step = self.dictionary.map_or(0, |dictionary| dictionary.step);
                for (node, translation) in self.decoded.iter_mut().enumerate() {
                    let change = changes[usize::from(self.parts[node])];
                    let moved = |axis: usize| translation[axis] + i64::from(change[axis]) * step;
                    *translation = translate(node, std::array::from_fn(moved))?;
                }
            }
        }
        Ok(())
    }
}

/// Checks the range of a translation (`motion.translation.range`).
fn inside(translation: [i64; 3], limit: i64) -> Result<[i64; 3], Rule> {
    if translation.iter().all(|t| t.abs() < limit) {
        Ok(translation)
    } else {
        Err(rule::MOTION_TRANSLATION_RANGE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(mode: TranslationMode, step: u8, values: &[[i32; 3]]) -> MotionFrame {
        MotionFrame {
            translation_mode: mode,
            translation_step: step,
            translation: values.to_vec(),
            ..MotionFrame::default()
        }
    }

    /// That of eight fraction bits.
    const LIMIT: i64 = 1 << 28;

    fn three_nodes() -> Translations {
        let mut translations = Translations::default();
        let visit = |node, from| Visit { node, from };
        let path = vec![visit(2, None), visit(0, Some(2)), visit(1, Some(2))];
        translations.begin(&[9, 4, 9], path);
        translations
    }

    #[test]
    fn differences_along_the_path_add_up() {
        let mut translations = three_nodes();
        let values = [[1, 0, 0], [0, 0, -1], [0, 5, 0]];
        // Step 8 has four units.
        let frame = frame(TranslationMode::Spatial, 8, &values);
        assert_eq!(translations.decode(&frame, 21), Ok(()));
        assert_eq!(translations.decoded(), [[4, 20, 0], [0, 20, -4], [0, 20, 0]]);
        assert_eq!(translations.decode(&frame, 20), Err(rule::MOTION_TRANSLATION_RANGE));
    }

    #[test]
    fn changes_are_in_the_step_of_the_frame_before() {
        let mut translations = three_nodes();
        assert_eq!(translations.part_count(), 2);
        let first = frame(TranslationMode::Direct, 8, &[[1, 0, 0], [2, 0, 0], [3, 0, 0]]);
        assert_eq!(translations.decode(&first, LIMIT), Ok(()));
        let mut second = frame(TranslationMode::SpatioTemporal, 4, &[[0, 0, 1], [0; 3], [0; 3]]);
        // Part 0 is label 4, part 1 label 9.
        second.translation_change = vec![[0, 10, 0], [0, -1, 0]];
        assert_eq!(translations.decode(&second, LIMIT), Ok(()));
        assert_eq!(translations.decoded(), [[4, -4, 2], [8, 40, 0], [12, -4, 0]]);
    }

    #[test]
    fn a_sum_outside_the_range_is_refused() {
        let mut translations = three_nodes();
        // 4681 × 57344 is just inside 2^28.
        let values = [[0; 3], [0; 3], [4681, 0, 0]];
        let last = frame(TranslationMode::Spatial, 63, &values);
        assert_eq!(translations.decode(&last, LIMIT), Ok(()));
        let next = frame(TranslationMode::Spatial, 63, &[[1, 0, 0], [0; 3], [4681, 0, 0]]);
        assert_eq!(translations.decode(&next, LIMIT), Err(rule::MOTION_TRANSLATION_RANGE));
    }
}
