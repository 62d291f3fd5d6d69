//! The pattern that the names of a sequence's files follow.

use kn_codec::NamePattern;

/// The pattern of `names` (one per frame, without extension), where they are a common prefix and
/// then numbers that rise by one; `None` otherwise.
pub(crate) fn name_pattern(names: &[String]) -> Option<NamePattern> {
    let name = names.first()?;
    let digits = name.bytes().rev().take_while(u8::is_ascii_digit).count();
    let (prefix, number) = name.split_at(name.len() - digits);
    let first: u32 = number.parse().ok()?;
    // A number that starts with 0 is padded; of others the first has the fewest digits.
    let digits = u8::try_from(if number.starts_with('0') { digits } else { 1 }).ok()?;
    let pattern = NamePattern { prefix: prefix.to_owned(), digits, first };
    let follows = |(frame, name): (u64, &String)| {
        let number = u64::from(first) + frame;
        *name == format!("{prefix}{number:0width$}", width = usize::from(digits))
    };
    (0..).zip(names).all(follows).then_some(pattern)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(names: &[&str]) -> Option<(String, u8, u32)> {
        let names: Vec<String> = names.iter().map(|&name| name.into()).collect();
        name_pattern(&names).map(|pattern| (pattern.prefix, pattern.digits, pattern.first))
    }

    #[test]
    fn padded_and_plain_numbers_are_found() {
        assert_eq!(pattern(&["f_0099", "f_0100"]), Some(("f_".into(), 4, 99)));
        assert_eq!(pattern(&["9", "10"]), Some((String::new(), 1, 9)));
        assert_eq!(pattern(&["0000", "0001"]), Some((String::new(), 4, 0)));
    }

    #[test]
    fn other_names_have_no_pattern() {
        for names in [&[][..], &["a"], &["a1", "b2"], &["a1", "a3"], &["a01", "a2"]] {
            assert_eq!(pattern(names), None, "{names:?}");
        }
        assert_eq!(pattern(&["f99999999999"]), None);
    }
}
