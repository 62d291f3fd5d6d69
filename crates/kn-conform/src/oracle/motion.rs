//! Chapter 7: from the values of a P-frame to those of its nodes.

use kn_bitstream::rule::{self, Rule};
use std::collections::BTreeSet;

use super::Oracle;
use super::deform::{Motion, Node};

impl Oracle {
    /// P(s), four times T(s), of 7.2.
    fn step(&self, name: &str) -> i64 {
        let s = self.number(name) as u32;
        i64::from(4 + s % 4) << (s / 4)
    }

    /// 7.3 and 7.4: the translations of the nodes, and T(s).
    pub(super) fn translations(&self) -> Result<(Vec<[i64; 3]>, i64), Rule> {
        let step = self.step("translation_step") / 4;
        let values = self.triples("translation");
        let (before, previous_step) = &self.previous;
        let add = |a: [i64; 3], b: [i64; 3], step: i64| [0, 1, 2].map(|k| a[k] + b[k] * step);
        let mut translations = vec![[0; 3]; values.len()];
        match self.number("translation_mode") {
            0 => {
                for node in 0..values.len() {
                    translations[node] = add([0; 3], values[node], step);
                }
            }
            1 => {
                for &(node, predecessor) in &self.path {
                    let prediction = predecessor.map_or([0; 3], |before| translations[before]);
                    translations[node] = add(prediction, values[node], step);
                }
            }
            _ => {
                let changes = self.triples("translation_change");
                let parts: BTreeSet<u8> = self.nodes.iter().map(|node| node.label).collect();
                for (node, value) in values.into_iter().enumerate() {
                    let label = self.nodes[node].label;
                    let part = parts.iter().take_while(|&&part| part < label).count();
                    let prediction = add(before[node], changes[part], *previous_step);
                    translations[node] = add(prediction, value, step);
                }
            }
        }
        // r[motion.translation.range]
        let limit = 1 << (20 + self.fraction_bits());
        let inside = translations.iter().flatten().all(|t| t.abs() < limit);
        if inside { Ok((translations, step)) } else { Err(rule::MOTION_TRANSLATION_RANGE) }
    }

    /// Chapter 7: the values of every node.
    pub(super) fn motions(&self, translations: &[[i64; 3]]) -> Vec<Motion> {
        let mut rotations = self.triples("rotation").into_iter();
        let mut scales = self.triples("scale").into_iter();
        let mut shears = self.triples("shear").into_iter();
        let flag = |name: &str, node: &Node| node.affine && self.number(name) == 1;
        let value = |q: i64, name: &str| (q * self.step(name)) as f64 / 65536.0;
        let of_node = |(node, &translation): (&Node, &[i64; 3])| {
            let rotates = !node.affine || flag("rotation_enabled", node);
            let next = |carries: bool, list: &mut std::vec::IntoIter<[i64; 3]>| {
                if carries { list.next().unwrap_or([0; 3]) } else { [0; 3] }
            };
            let angles = next(rotates, &mut rotations);
            let scale = next(flag("scale_enabled", node), &mut scales);
            let shear = next(flag("shear_enabled", node), &mut shears);
            Motion {
                translation,
                angles: angles.map(|q| value(q, "rotation_step")),
                scale: scale.map(|q| 1.0 + value(q, "scale_step")),
                shear: shear.map(|q| value(q, "shear_step")),
            }
        };
        self.nodes.iter().zip(translations).map(of_node).collect()
    }
}
