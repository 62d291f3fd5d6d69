//! Settings of the encoder that no stream carries. Each type has a text form.

mod by_name;
mod by_number;

pub use by_name::{
    AffineChoice, CombinationChoice, DistortionMeasure, LabelChoice, NodePlacement,
    TranslationChoice,
};
pub use by_number::{Decimation, FormError, NodeChoice, SmoothingChoice, StepChoice};

#[cfg(test)]
mod tests {
    use super::*;
    use kn_bitstream::params::{Combination, Named};
    use std::fmt;
    use std::str::FromStr;

    fn reads_what_it_prints<T>(values: impl IntoIterator<Item = T>)
    where
        T: FromStr<Err: fmt::Debug> + fmt::Display + fmt::Debug + PartialEq,
    {
        for value in values {
            assert_eq!(value.to_string().parse::<T>().expect("a form"), value);
        }
    }

    #[test]
    fn choices_are_read_back_from_their_text() {
        reads_what_it_prints(LabelChoice::all());
        reads_what_it_prints(AffineChoice::all());
        reads_what_it_prints(CombinationChoice::all());
        reads_what_it_prints(Combination::ALL.map(CombinationChoice::Fixed));
        reads_what_it_prints(DistortionMeasure::all());
        reads_what_it_prints(NodePlacement::all());
        reads_what_it_prints(TranslationChoice::all());
        reads_what_it_prints([StepChoice::Cost, StepChoice::Fixed(0.5)]);
        reads_what_it_prints([NodeChoice::default(), NodeChoice::Fixed(150)]);
        reads_what_it_prints([SmoothingChoice::Auto, SmoothingChoice::Strength(3)]);
        reads_what_it_prints([Decimation::Faces(5000), Decimation::Share(0.125)]);
    }

    #[test]
    fn auto_is_read_in_any_case() {
        assert_eq!("AUTO".parse(), Ok(NodeChoice::default()));
        assert_eq!("Auto".parse(), Ok(SmoothingChoice::Auto));
        assert_eq!("auto".parse(), Ok(StepChoice::Cost));
    }

    #[test]
    fn other_texts_are_refused_with_the_forms() {
        let message = "sometimes".parse::<CombinationChoice>().expect_err("no form").to_string();
        assert!(message.contains("first-p") && message.contains("RTSH"), "{message}");
        for bad in ["", "-1", "many", "1.5"] {
            assert!(bad.parse::<NodeChoice>().is_err(), "{bad}");
        }
        for bad in ["", "%", "-1", "x"] {
            assert!(bad.parse::<Decimation>().is_err(), "{bad}");
        }
    }
}
