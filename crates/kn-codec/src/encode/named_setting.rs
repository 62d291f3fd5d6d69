//! Settings by name: for command lines, configuration files and bindings.

mod list;

use crate::encode::config::EncoderConfig;
use crate::encode::settings::Setting;
use list::SETTINGS;
use std::fmt;

type Set = fn(&mut EncoderConfig, &str) -> Result<(), String>;
type Values = fn() -> Vec<(String, String)>;

/// A setting of [`EncoderConfig`] with a name and a text form of its values.
///
/// [`EncoderConfig::set`] sets it. Command lines make a flag of each, bindings an argument.
#[derive(Clone, Copy, Debug)]
pub struct NamedSetting {
    setting: Setting,
    name: &'static str,
    placeholder: &'static str,
    about: &'static str,
    values: Option<Values>,
    excludes: Option<&'static str>,
    expert: bool,
    set: Set,
}

impl NamedSetting {
    const fn new(
        setting: Setting,
        name: &'static str,
        placeholder: &'static str,
        set: Set,
    ) -> Self {
        let (values, excludes) = (None, None);
        Self { setting, name, placeholder, about: "", values, excludes, expert: false, set }
    }

    const fn about(mut self, about: &'static str) -> Self {
        self.about = about;
        self
    }

    const fn values(mut self, values: Values) -> Self {
        self.values = Some(values);
        self
    }

    const fn excludes(mut self, other: &'static str) -> Self {
        self.excludes = Some(other);
        self
    }

    const fn expert(mut self) -> Self {
        self.expert = true;
        self
    }

    /// All settings that have a name, in the order of a help text.
    pub fn all() -> &'static [Self] {
        SETTINGS
    }

    /// The setting with this name; `None` where there is none.
    pub fn by_name(name: &str) -> Option<&'static Self> {
        SETTINGS.iter().find(|setting| setting.name == name)
    }

    /// The setting that errors of [`EncoderConfig::validate`] name; `None` where it has no name.
    pub fn of(setting: Setting) -> Option<&'static Self> {
        SETTINGS.iter().find(|named| named.setting == setting)
    }

    /// The name, with `_` between words: `motion_step`.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// A word that stands for the value in a help text: `LENGTH`.
    pub fn placeholder(&self) -> &'static str {
        self.placeholder
    }

    /// A sentence that describes the setting, without full stop.
    pub fn description(&self) -> &'static str {
        self.about
    }

    /// The names of all values and their meanings (empty where the name says it); `None` where
    /// values are not a list of names.
    pub fn value_names(&self) -> Option<Vec<(String, String)>> {
        self.values.map(|values| values())
    }

    /// The name of another setting that this one takes the place of: only one of them can be given.
    pub fn excluded(&self) -> Option<&'static str> {
        self.excludes
    }

    /// Whether most users never need the setting.
    pub fn is_expert(&self) -> bool {
        self.expert
    }

    /// Checks that `text` is a form of a value. Ranges are checked by [`EncoderConfig::validate`].
    ///
    /// # Errors
    /// It is not; the text says what to give.
    pub fn read(&self, text: &str) -> Result<(), String> {
        (self.set)(&mut EncoderConfig::default(), text)
    }

    fn set(&self, config: &mut EncoderConfig, text: &str) -> Result<(), SetError> {
        let value = |reason| SetError::Value { name: self.name, text: text.into(), reason };
        (self.set)(config, text).map_err(value)
    }
}

impl EncoderConfig {
    /// Sets the setting with this name from the text form of its value. [`NamedSetting::all`] lists
    /// the names.
    ///
    /// ```
    /// use kn_codec::{EncoderConfig, Preset};
    ///
    /// let mut config = Preset::by_name("baseline").expect("a preset").config();
    /// config.set("nodes", "200")?;
    /// config.set("motion_step", "0.5")?;
    /// assert_eq!(config.motion.nodes, 200.into());
    /// assert!(config.set("nodes", "many").is_err());
    /// # Ok::<(), kn_codec::SetError>(())
    /// ```
    ///
    /// # Errors
    /// There is no such setting, or the text is not a form of its value. Ranges and contradictions
    /// are found by [`Self::validate`].
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), SetError> {
        let setting = NamedSetting::by_name(name).ok_or_else(|| SetError::Name(name.into()))?;
        setting.set(self, text)
    }

    /// Sets several settings, given as names and texts.
    ///
    /// # Errors
    /// The errors of [`Self::set`], or two of the settings exclude each other.
    pub fn set_all<'t>(
        &mut self,
        settings: impl IntoIterator<Item = (&'t str, &'t str)>,
    ) -> Result<(), SetError> {
        let settings: Vec<_> = settings.into_iter().collect();
        let given = |name: &str| settings.iter().any(|&(other, _)| other == name);
        for named in SETTINGS.iter().filter(|named| given(named.name)) {
            if let Some(second) = named.excludes.filter(|other| given(other)) {
                return Err(SetError::Exclusive { first: named.name, second });
            }
        }
        settings.iter().try_for_each(|(name, text)| self.set(name, text))
    }
}

/// The reason why a setting cannot be set by its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SetError {
    /// There is no setting with this name.
    Name(String),
    /// The text is not a form of the setting's value.
    Value {
        /// Name of the setting.
        name: &'static str,
        /// The text.
        text: String,
        /// The forms that the value has.
        reason: String,
    },
    /// Two settings were given of which one takes the place of the other.
    Exclusive {
        /// Name of one setting.
        first: &'static str,
        /// Name of the other.
        second: &'static str,
    },
}

impl fmt::Display for SetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name(name) => {
                let names: Vec<_> = SETTINGS.iter().map(NamedSetting::name).collect();
                write!(f, "there is no setting '{name}'; the names are {}", names.join(", "))
            }
            Self::Value { name, text, reason } => {
                write!(f, "invalid value '{text}' for '{name}': {reason}")
            }
            Self::Exclusive { first, second } => {
                write!(f, "'{first}' and '{second}' exclude each other: give one of them")
            }
        }
    }
}

impl std::error::Error for SetError {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encode::choices::{AffineChoice, StepChoice};
    use crate::encode::config::GridChoice;
    use kn_bitstream::params::Combination;
    use std::collections::HashSet;

    #[test]
    fn names_differ_and_every_listed_value_is_one() {
        let mut names = HashSet::new();
        for named in NamedSetting::all() {
            assert!(names.insert(named.name()), "{} is there twice", named.name());
            assert!(!named.description().is_empty(), "{}", named.name());
            assert!(std::ptr::eq(NamedSetting::of(named.setting).expect("listed"), named));
            for (value, _) in named.value_names().unwrap_or_default() {
                named.read(&value).expect("a listed value");
            }
            if let Some(other) = named.excluded() {
                assert!(NamedSetting::by_name(other).is_some(), "{other}");
            }
        }
    }

    #[test]
    fn settings_are_set_from_their_texts() {
        let mut config = EncoderConfig::default();
        let texts = [
            ("nodes", "40"),
            ("combination", "RTS"),
            ("motion_step", "0.5"),
            ("affine", "all"),
            ("bits", "9"),
        ];
        config.set_all(texts).expect("known");
        assert_eq!(config.motion.nodes, 40.into());
        assert_eq!(config.motion.translation_step, StepChoice::Fixed(0.5));
        assert_eq!(config.motion.combination, Combination::new(true, true, false).into());
        assert_eq!(config.motion.affine, AffineChoice::All);
        assert_eq!(config.sequence.grid, GridChoice::Bits { bits: 9, bounds: None });
        assert_eq!(config.sequence.group_length, EncoderConfig::default().sequence.group_length);
    }

    #[test]
    fn errors_say_what_to_give() {
        let message = |settings: &[(&str, &str)]| {
            let set = EncoderConfig::default().set_all(settings.iter().copied());
            set.expect_err("a mistake").to_string()
        };
        let unknown = message(&[("motion_stpe", "1")]);
        assert!(unknown.starts_with("there is no setting 'motion_stpe'; the names are bits, step"));
        let value = message(&[("gof", "300")]);
        assert_eq!(value, "invalid value '300' for 'gof': give a whole number from 0 to 255");
        for bad in ["0", "-1", "nan", "inf", "1e999", "x"] {
            let value = message(&[("step", bad)]);
            assert!(value.ends_with("give a positive number"), "{value}");
        }
        for bad in ["1", "0%", "-1%", "nan%", "%"] {
            let value = message(&[("pframe_error", bad)]);
            assert!(value.ends_with("such as 1%"), "{value}");
        }
        let both = message(&[("choice", "per-frame"), ("combination", "RT")]);
        assert_eq!(both, "'combination' and 'choice' exclude each other: give one of them");
        assert!(message(&[("bits", "9"), ("step", "1")]).contains("exclude"));
    }
}
