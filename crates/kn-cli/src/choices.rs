//! Values of flags: those of the codec's vocabulary, and those that only the command has.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use kn_bitstream::params::Named;
use kn_codec::{LabelChoice, Preset};
use kn_io::LabelSource;
use std::convert::Infallible;
use std::num::NonZeroU16;
use std::path::PathBuf;
use std::str::FromStr;

/// The values of a named type; the help lists each with what it means.
pub(crate) fn named<T>() -> impl TypedValueParser<Value = T>
where
    T: Named + FromStr<Err: std::error::Error + Send + Sync + 'static> + Send + Sync + 'static,
{
    let value = |value: T| PossibleValue::new(value.name().to_owned()).help(value.about());
    PossibleValuesParser::new(T::all().into_iter().map(value)).try_map(|name| name.parse())
}

/// A preset by its name; help and errors list all of them.
pub(crate) fn preset() -> impl TypedValueParser<Value = &'static Preset> {
    let value = |preset: &Preset| PossibleValue::new(preset.name()).help(preset.about());
    PossibleValuesParser::new(Preset::all().iter().map(value))
        .try_map(|name| Preset::by_name(&name).ok_or("no such preset"))
}

/// The value of `--labels`: the source of the labels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum LabelArgument {
    None,
    Auto,
    Colours,
    Files(PathBuf),
}

impl FromStr for LabelArgument {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text {
            "none" => Self::None,
            "auto" => Self::Auto,
            "colours" | "colors" => Self::Colours,
            pattern => Self::Files(pattern.into()),
        })
    }
}

impl LabelArgument {
    /// The source of labels for the reader of a single file. Files beside the meshes are added to
    /// the sequence.
    pub(crate) fn source(choice: Option<&Self>) -> LabelSource {
        match choice {
            None => LabelSource::Property,
            Some(Self::Colours) => LabelSource::Colours,
            Some(Self::None | Self::Auto | Self::Files(_)) => LabelSource::None,
        }
    }

    /// The encoder's setting for frames without labels.
    pub(crate) fn choice(choice: Option<&Self>, preset: LabelChoice) -> LabelChoice {
        match choice {
            None => preset,
            Some(Self::Auto) => LabelChoice::Auto,
            Some(_) => LabelChoice::Given,
        }
    }
}

/// Reads a number of threads or jobs.
pub(crate) fn count(text: &str) -> Result<NonZeroU16, String> {
    text.parse().map_err(|_| format!("give a number from 1 to {}", u16::MAX))
}

/// Reads a positive length.
pub(crate) fn length(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(length) if length > 0.0 && length.is_finite() => Ok(length),
        _ => Err("a length is a positive number".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_positive() {
        assert_eq!(length("0.5"), Ok(0.5));
        for bad in ["0", "-1", "nan", "inf", "1e999", "x"] {
            assert!(length(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn counts_are_from_1_on() {
        assert_eq!(count("7"), Ok(NonZeroU16::MIN.saturating_add(6)));
        for bad in ["0", "70000", "-1", "x"] {
            assert!(count(bad).is_err_and(|said| said.contains("1 to 65535")), "{bad}");
        }
    }

    #[test]
    fn labels_are_a_word_or_files() {
        let parse = |text: &str| text.parse::<LabelArgument>();
        assert_eq!(parse("none"), Ok(LabelArgument::None));
        assert_eq!(parse("colors"), Ok(LabelArgument::Colours));
        assert_eq!(parse("l_*.txt"), Ok(LabelArgument::Files("l_*.txt".into())));
    }
}
