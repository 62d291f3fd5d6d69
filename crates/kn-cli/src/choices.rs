//! Values of flags: those of the codec's vocabulary, and those that only the command has.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use kn_bitstream::params::Named;
use kn_codec::Preset;
use std::num::NonZeroU16;
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

/// Reads a number of threads or jobs.
pub(crate) fn count(text: &str) -> Result<NonZeroU16, String> {
    text.parse().map_err(|_| format!("give a number from 1 to {}", u16::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_from_1_on() {
        assert_eq!(count("7"), Ok(NonZeroU16::MIN.saturating_add(6)));
        for bad in ["0", "70000", "-1", "x"] {
            assert!(count(bad).is_err_and(|said| said.contains("1 to 65535")), "{bad}");
        }
    }
}
