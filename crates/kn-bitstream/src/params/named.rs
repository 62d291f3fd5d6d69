//! Enumerations whose values have names.

use std::fmt;
use strum::EnumMessage;

/// An enumeration whose values have names: it is parsed from them, prints them, and knows what each
/// value means. Command lines and bindings generate their lists of values from it.
///
/// The derives of [`strum`] give the names (`AsRefStr`), the descriptions (`EnumMessage`) and the
/// list of values (`VariantArray`); [`impl_named`](crate::impl_named) does the rest for an
/// enumeration whose values have no fields.
pub trait Named: Clone + AsRef<str> + EnumMessage {
    /// Name of the enumeration in messages, in the singular: `weight scheme`.
    const KIND: &'static str;

    /// All values that have a name of their own, in the order of their declaration.
    fn all() -> Vec<Self>;

    /// The name that is parsed and printed.
    fn name(&self) -> &str {
        self.as_ref()
    }

    /// The meaning of the value: the first paragraph of its documentation, in one line, without a
    /// full stop.
    fn about(&self) -> String {
        let documentation = self.get_documentation().unwrap_or_default();
        let paragraph = documentation.split("\n\n").next().unwrap_or_default();
        let words: Vec<&str> = paragraph.split_whitespace().collect();
        words.join(" ").trim_end_matches('.').to_owned()
    }

    /// The value with this name, in upper or lower case.
    ///
    /// # Errors
    /// There is none; the error has all names.
    fn of_name(text: &str) -> Result<Self, NameError> {
        let found = Self::all().into_iter().find(|value| value.name().eq_ignore_ascii_case(text));
        found.ok_or_else(|| NameError::of::<Self>(text))
    }
}

/// Implements [`Named`](crate::params::Named), `FromStr` and `Display` for enumerations whose
/// values have no fields. They derive `AsRefStr`, `EnumMessage` and `VariantArray` of strum.
///
/// ```
/// use kn_bitstream::params::Named;
/// use strum::{AsRefStr, EnumMessage, VariantArray};
///
/// #[derive(Clone, Copy, Debug, PartialEq, AsRefStr, EnumMessage, VariantArray)]
/// #[strum(serialize_all = "kebab-case")]
/// enum Speed {
///     /// As fast as it goes.
///     Fast,
///     /// With care.
///     VerySlow,
/// }
///
/// kn_bitstream::impl_named! { Speed: "speed" }
///
/// assert_eq!("very-slow".parse(), Ok(Speed::VerySlow));
/// assert_eq!(Speed::Fast.to_string(), "fast");
/// assert_eq!(Speed::Fast.about(), "As fast as it goes");
/// ```
#[macro_export]
macro_rules! impl_named {
    ($($name:ident: $kind:literal),* $(,)?) => {$(
        impl $crate::params::Named for $name {
            const KIND: &'static str = $kind;

            fn all() -> Vec<Self> {
                <Self as strum::VariantArray>::VARIANTS.to_vec()
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.as_ref())
            }
        }

        impl std::str::FromStr for $name {
            type Err = $crate::params::NameError;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                <Self as $crate::params::Named>::of_name(text)
            }
        }
    )*};
}

/// The error for a text that is not the name of a value of an enumeration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NameError {
    kind: &'static str,
    text: String,
    names: Vec<String>,
}

impl NameError {
    /// The error for a `text` that is not the name of a `T`.
    pub fn of<T: Named>(text: &str) -> Self {
        Self::new(T::KIND, text, T::all().iter().map(T::name))
    }

    /// The error for a `text` that is not one of `names`, which are all names of a `kind`.
    pub fn new<'n>(
        kind: &'static str,
        text: &str,
        names: impl IntoIterator<Item = &'n str>,
    ) -> Self {
        let names = names.into_iter().map(str::to_owned).collect();
        Self { kind, text: text.to_owned(), names }
    }
}

impl fmt::Display for NameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, text, names } = self;
        write!(f, "there is no {kind} '{text}'; the names are {}", names.join(", "))
    }
}

impl std::error::Error for NameError {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::{BodyPart, InfluenceMode, Region, UnitOfLength, UpAxis, WeightScheme};
    use std::collections::HashSet;
    use std::str::FromStr;

    /// Names are read back, differ, and every value is documented.
    fn check<T>()
    where
        T: Named + FromStr<Err = NameError> + fmt::Display + fmt::Debug + PartialEq,
    {
        let mut names = HashSet::new();
        for value in T::all() {
            assert_eq!(value.name().parse().as_ref(), Ok(&value));
            assert_eq!(value.to_string(), value.name());
            assert!(names.insert(value.to_string()), "{value} is there twice");
            assert!(!value.about().is_empty(), "{value} is not documented");
        }
        let error = T::from_str("no such value").expect_err("no name");
        assert!(error.to_string().contains(T::all()[0].name()), "{error}");
    }

    #[test]
    fn every_value_is_read_back_from_its_name() {
        check::<WeightScheme>();
        check::<InfluenceMode>();
        check::<crate::params::TranslationMode>();
        check::<UnitOfLength>();
        check::<UpAxis>();
        check::<BodyPart>();
        check::<Region>();
    }

    #[test]
    fn an_unknown_name_is_told_with_the_known_ones() {
        let error = "loose".parse::<InfluenceMode>().expect_err("no name");
        let told = "there is no influence mode 'loose'; the names are strict, fallback";
        assert_eq!(error.to_string(), told);
    }
}
