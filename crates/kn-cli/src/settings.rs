//! The codec's settings: flags of `kn encode` and, under the same names, keys of a `kn rd`
//! configuration. kn-codec lists them ([`NamedSetting`]).

use anyhow::{Result, anyhow};
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use kn_codec::{EncoderConfig, NamedSetting, Setting};

/// Heading of the flags that `--help` leaves to `--help-all`.
const EXPERT: &str = "Expert settings";

/// The settings that are given, each with the text of its value. A setting that is not given keeps
/// the value of the preset.
#[derive(Clone, Debug, Default)]
pub(crate) struct Settings(Vec<(&'static str, String)>);

impl Settings {
    /// Writes the settings that are given into `config`.
    pub(crate) fn apply(&self, config: &mut EncoderConfig) -> Result<()> {
        Ok(config.set_all(self.0.iter().map(|(name, text)| (*name, text.as_str())))?)
    }

    /// The flag that was given and has no effect without body parts.
    pub(crate) fn needs_labels(&self) -> Option<&'static str> {
        self.0.iter().find_map(|(name, text)| match (*name, text.as_str()) {
            ("affine", "labels") => Some("--affine labels"),
            ("part_start", "on" | "auto") => Some("--part-start"),
            _ => None,
        })
    }
}

impl FromArgMatches for Settings {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let given = |named: &NamedSetting| {
            let text = matches.get_one::<String>(named.name())?;
            Some((named.name(), text.clone()))
        };
        Ok(Self(NamedSetting::all().iter().filter_map(given).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for Settings {
    fn augment_args(command: Command) -> Command {
        command.args(NamedSetting::all().iter().map(flag))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

/// The flag that sets a setting.
fn flag(named: &'static NamedSetting) -> Arg {
    let flag = Arg::new(named.name())
        .long(named.name().replace('_', "-"))
        .value_name(named.placeholder())
        .help(named.description())
        .conflicts_with_all(named.excluded())
        .hide_short_help(named.is_expert());
    let flag = if named.is_expert() { flag.help_heading(EXPERT) } else { flag };
    match named.value_names() {
        Some(values) => {
            let values = values.into_iter().map(|(name, about)| {
                let value = PossibleValue::new(name);
                if about.is_empty() { value } else { value.help(about) }
            });
            flag.value_parser(PossibleValuesParser::new(values))
        }
        None => flag
            .allow_negative_numbers(true)
            .value_parser(move |text: &str| named.read(text).map(|()| text.to_owned())),
    }
}

/// Checks the settings of a command; the message names flags.
///
/// # Errors
/// A value out of its range, or flags that contradict each other.
pub(crate) fn check_settings(config: &EncoderConfig) -> Result<()> {
    config.validate().map_err(|error| anyhow!(error.describe(flag_of)))
}

/// The flag of a setting. Those that no flag sets are named as the library names them.
fn flag_of(setting: Setting) -> String {
    match setting {
        Setting::Bounds => "the box of all frames".into(),
        Setting::Lossless => "--lossless".into(),
        Setting::FrameRate => "--fps".into(),
        Setting::Names => "the name of the first file".into(),
        other => match NamedSetting::of(other) {
            Some(named) => format!("--{}", named.name().replace('_', "-")),
            None => other.to_string(),
        },
    }
}

/// The texts of the settings that a table of a configuration holds.
pub(crate) fn texts_of(table: &toml::Table) -> Vec<(&str, String)> {
    let text = |value: &toml::Value| match value {
        toml::Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    table.iter().map(|(key, value)| (key.as_str(), text(value))).collect()
}

/// Sets the settings that a table of a configuration holds.
///
/// # Errors
/// An unknown setting, a value that it does not take, or two settings that exclude each other.
pub(crate) fn apply_table(table: &toml::Table, config: &mut EncoderConfig) -> Result<()> {
    let texts = texts_of(table);
    Ok(config.set_all(texts.iter().map(|(name, text)| (*name, text.as_str())))?)
}

/// The flags that set what the table sets.
pub(crate) fn flags_of(table: &toml::Table) -> Vec<String> {
    let flag = |(key, text): (&str, String)| format!("--{}={text}", key.replace('_', "-"));
    texts_of(table).into_iter().map(flag).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_checked_and_named_by_their_flags() {
        let message = |toml: &str| {
            let mut config = EncoderConfig::default();
            let table = toml::from_str(toml).expect("TOML");
            apply_table(&table, &mut config).expect("known");
            check_settings(&config).expect_err("a mistake").to_string()
        };
        assert_eq!(message("gof = 0"), "--gof is 0; it must be from 1 to 255");
        let both = message("combination = 'RT'\nscale_step = 1.0");
        assert_eq!(both, "--scale-step is 1, but --combination is RT: no node carries scales");
    }

    #[test]
    fn flags_set_what_they_name() {
        let command = Settings::augment_args(Command::new("kn").no_binary_name(true));
        let read = |words: &[&str]| -> Result<EncoderConfig> {
            let matches = command.clone().try_get_matches_from(words)?;
            let mut config = EncoderConfig::default();
            Settings::from_arg_matches(&matches)?.apply(&mut config)?;
            Ok(config)
        };
        let config = read(&["--nodes", "40", "--motion-step=0.5"]).expect("known");
        assert_eq!(
            config,
            EncoderConfig::default()
                .with_nodes(40)
                .with_translation_step(kn_codec::StepChoice::Fixed(0.5))
        );
        let message = |words: &[&str]| read(words).expect_err("a mistake").to_string();
        let value = message(&["--gof", "300"]);
        assert!(value.contains("invalid value '300' for '--gof <N>': give a whole"), "{value}");
        let both = message(&["--bits", "9", "--step", "1"]);
        assert!(both.contains("'--bits <N>' cannot be used with '--step <LENGTH>'"), "{both}");
    }
}
