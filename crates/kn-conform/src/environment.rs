//! Values that the tables refer to: elements as they were read last, and derived values (chapter 6).

use std::collections::HashMap;

/// Names and numbers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Environment {
    values: HashMap<String, i128>,
    /// Sum of the `affine_node` flags of the last key nodes.
    affine_flags: i128,
}

impl Environment {
    pub(crate) fn get(&self, name: &str) -> Option<i128> {
        self.values.get(name).copied()
    }

    pub(crate) fn set(&mut self, name: &str, value: i128) {
        self.values.insert(name.to_owned(), value);
    }

    /// Takes note of an element and derives what follows from it.
    pub(crate) fn read(&mut self, name: &str, value: i128, count_affine: &dyn Fn() -> Option<u32>) {
        self.set(name, value);
        match name {
            "label_set" if value == 0 => self.set("LabelCount", 1),
            "label_set" if value == 1 => self.set("LabelCount", 15),
            "label_count" => self.set("LabelCount", value),
            "node_count" => {
                self.set("NodeCount", value);
                self.values.remove("AffineCount");
            }
            "affine_mode" => self.affine_flags = 0,
            "affine_node" => self.affine_flags += value,
            "shear_enabled" => self.derive_counts(count_affine),
            _ => {}
        }
    }

    fn derive_counts(&mut self, count_affine: &dyn Fn() -> Option<u32>) {
        let known = |name| self.get(name).unwrap_or(0);
        let nodes = known("NodeCount");
        let affine = self.get("AffineCount").unwrap_or_else(|| match known("affine_mode") {
            0 => 0,
            1 => count_affine().map_or(0, i128::from),
            2 => nodes,
            _ => self.affine_flags,
        });
        let rigid = nodes - affine;
        let of_affine = |flag| if self.get(flag) == Some(1) { affine } else { 0 };
        let rotations = rigid + of_affine("rotation_enabled");
        let (scales, shears) = (of_affine("scale_enabled"), of_affine("shear_enabled"));
        self.set("AffineCount", affine);
        self.set("RotationCount", rotations);
        self.set("ScaleCount", scales);
        self.set("ShearCount", shears);
    }
}
