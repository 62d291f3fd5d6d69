//! Values that the tables refer to: elements as they were read last, and derived values (chapter
//! 6).

use std::collections::{BTreeSet, HashMap};

/// Names and numbers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Environment {
    values: HashMap<String, i128>,
    /// The `affine_label` flags of the last key nodes.
    affine_labels: Vec<i128>,
    /// Sum of their `affine_node` flags.
    affine_flags: i128,
}

impl Environment {
    pub(crate) fn get(&self, name: &str) -> Option<i128> {
        self.values.get(name).copied()
    }

    pub(crate) fn set(&mut self, name: &str, value: i128) {
        self.values.insert(name.to_owned(), value);
    }

    /// Takes note of an element and derives what follows from it; `labels` gives those of the key
    /// nodes.
    pub(crate) fn read(&mut self, name: &str, value: i128, labels: &dyn Fn() -> Option<Vec<u8>>) {
        self.set(name, value);
        match name {
            "label_set" if value == 0 => self.set("LabelCount", 1),
            "label_set" if value == 1 => self.set("LabelCount", 15),
            "label_count" => self.set("LabelCount", value),
            "node_count" => {
                self.set("NodeCount", value);
                for of_group in ["AffineCount", "PartCount", "translation_table"] {
                    self.values.remove(of_group);
                }
                // A text may say spatio-temporal where nothing goes before: a decoder refuses it.
                self.set("PreviousTable", 0);
            }
            "affine_mode" => {
                self.affine_flags = 0;
                self.affine_labels.clear();
            }
            "affine_label" => self.affine_labels.push(value),
            "affine_node" => self.affine_flags += value,
            "reference_mode" => self.derive_first(),
            "translation_mode" => {
                self.derive_parts(value == 2, labels);
                self.derive_affine(labels);
            }
            "shear_enabled" => self.derive_counts(),
            _ => {}
        }
    }

    /// The values that a change of a part depends on: 6.6.
    fn derive_parts(&mut self, needed: bool, labels: &dyn Fn() -> Option<Vec<u8>>) {
        if let Some(table) = self.get("translation_table") {
            self.set("PreviousTable", table);
        }
        if needed && self.get("PartCount").is_none() {
            let parts: BTreeSet<u8> = labels().unwrap_or_default().into_iter().collect();
            self.set("PartCount", parts.len() as i128);
        }
    }

    /// Whether a P-frame is the first of its group; an example says so by what it gives.
    fn derive_first(&mut self) {
        let known = |name| self.get(name).is_some();
        let first = !known("translation_table") && (known("node_count") || !known("PreviousTable"));
        self.set("IsFirst", i128::from(first));
    }

    fn derive_affine(&mut self, labels: &dyn Fn() -> Option<Vec<u8>>) {
        if self.get("AffineCount").is_some() {
            return;
        }
        let known = |name| self.get(name).unwrap_or(0);
        let marked = |label: &&u8| self.affine_labels.get(usize::from(**label)) == Some(&1);
        let affine = match known("affine_mode") {
            0 => 0,
            1 => labels().unwrap_or_default().iter().filter(marked).count() as i128,
            2 => known("NodeCount"),
            _ => self.affine_flags,
        };
        self.set("AffineCount", affine);
    }

    fn derive_counts(&mut self) {
        let known = |name| self.get(name).unwrap_or(0);
        let (nodes, affine) = (known("NodeCount"), known("AffineCount"));
        let rigid = nodes - affine;
        let of_affine = |flag| if self.get(flag) == Some(1) { affine } else { 0 };
        let rotations = rigid + of_affine("rotation_enabled");
        let (scales, shears) = (of_affine("scale_enabled"), of_affine("shear_enabled"));
        self.set("RotationCount", rotations);
        self.set("ScaleCount", scales);
        self.set("ShearCount", shears);
    }
}
