//! Presets: named settings, for the paper's codec and for the codec that it is compared with. A
//! study that changes one setting names it in its own configuration (`docs/rd/ablation.toml`).

use crate::encode::choices::{
    AffineChoice, LabelChoice, NodeChoice, StepChoice, TranslationChoice,
};
use crate::encode::config::EncoderConfig;
use kn_bitstream::params::{Combination, InfluenceMode, Weights};
use kn_fit::PartStart;

/// A named set of settings. Any decoder reads the streams of any preset.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    name: &'static str,
    about: &'static str,
    change: fn(&mut EncoderConfig),
}

/// The list of presets. A new preset is a new entry here.
const PRESETS: &[Preset] = &[
    Preset {
        name: "default",
        about: "bimodal with as many key nodes as pay for their bytes",
        change: |config| config.motion.nodes = NodeChoice::default(),
    },
    Preset {
        name: "bimodal",
        about: "150 nodes, rigid in the limbs, affine in the torso; components, steps and prediction \
                of translations at the least cost",
        change: |_| {},
    },
    Preset {
        name: "baseline",
        about: "the earlier key-node codec: rigid everywhere, twice the nodes, no \
                prediction of translations, its weights (Sumner's stand in for them)",
        change: |config| {
            config.intra.labels = LabelChoice::Given;
            config.motion.part_start = PartStart::Off;
            config.motion.affine = AffineChoice::None;
            config.motion.combination = Combination::RT.into();
            config.motion.translation_step = StepChoice::Fixed(2.0);
            config.motion.nodes = NodeChoice::Fixed(2 * NODES);
            config.motion.weights = Weights::SUMNER;
            config.motion.translation = TranslationChoice::Direct;
        },
    },
    Preset {
        name: "manual",
        about: "bimodal for labels that can be trusted: a region without a node is an error",
        change: |config| config.motion.influence = InfluenceMode::Strict,
    },
];

/// Key nodes of the paper's codec; the earlier one has twice as many.
const NODES: usize = 150;

impl Preset {
    /// All presets; the first is the default.
    pub fn all() -> &'static [Self] {
        PRESETS
    }

    /// The preset with this name; `None` where there is none.
    pub fn by_name(name: &str) -> Option<&'static Self> {
        PRESETS.iter().find(|preset| preset.name == name)
    }

    /// The name of the preset.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// A sentence that describes the preset.
    pub fn about(&self) -> &'static str {
        self.about
    }

    /// The settings of the preset.
    pub fn config(&self) -> EncoderConfig {
        let mut config = EncoderConfig::default().with_nodes(NodeChoice::Fixed(NODES));
        (self.change)(&mut config);
        config
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_and_settings_differ() {
        assert_eq!(Preset::all()[0].config(), EncoderConfig::default());
        for (index, preset) in Preset::all().iter().enumerate() {
            let found = Preset::by_name(preset.name()).expect("in the list");
            assert!(std::ptr::eq(found, preset), "{} is there twice", preset.name());
            for other in &Preset::all()[..index] {
                assert_ne!(preset.config(), other.config(), "{}, {}", preset.name, other.name);
            }
        }
        assert!(Preset::by_name("bimodal ").is_none());
    }

    #[test]
    fn the_baseline_is_rigid_with_twice_the_nodes() {
        let baseline = Preset::by_name("baseline").expect("in the list").config();
        assert_eq!(
            (baseline.motion.nodes, baseline.motion.affine),
            (300.into(), AffineChoice::None)
        );
    }
}
