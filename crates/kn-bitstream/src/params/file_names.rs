//! Names of the input files of a sequence.

use std::fmt;
use std::str::FromStr;

/// Largest number of digits of a name (`header.names.digits`).
pub const MAX_DIGITS: u8 = 9;

/// The pattern of the names of a sequence's files, without folder and extension: the file of frame
/// f is called `prefix`, then `first` + f in at least `digits` digits.
///
/// Its text form is the name of the first frame: `scan_0017` stands for `scan_0017`, `scan_0018` …
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileNames {
    /// Text before the number, up to 255 bytes; see rule `name.characters`.
    pub prefix: String,
    /// Least number of digits, at most 9; shorter numbers are padded with zeros.
    pub digits: u8,
    /// Number of the first frame.
    pub first: u32,
}

impl FileNames {
    /// Name of frame `frame`, without folder and extension.
    pub fn of_frame(&self, frame: u32) -> String {
        let number = u64::from(self.first) + u64::from(frame);
        format!("{}{number:0width$}", self.prefix, width = usize::from(self.digits))
    }

    /// Finds the pattern that `names` follow (one per frame, without extension): a common prefix
    /// and numbers that rise by one. Returns `None` where there is no pattern, or none that a stream
    /// can carry.
    pub fn of_all(names: &[String]) -> Option<Self> {
        let first = names.first()?;
        // A name that ends in no number, or in one that is too large, has no pattern.
        let pattern: Self = first.parse().ok()?;
        let follows = |(frame, name): (u32, &String)| *name == pattern.of_frame(frame);
        let is_carried = is_frame_name(first) && pattern.digits <= MAX_DIGITS;
        (is_carried && (0..).zip(names).all(follows)).then_some(pattern)
    }
}

impl fmt::Display for FileNames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.of_frame(0))
    }
}

impl FromStr for FileNames {
    type Err = FileNamesError;

    fn from_str(name: &str) -> Result<Self, FileNamesError> {
        let digits = name.bytes().rev().take_while(u8::is_ascii_digit).count();
        let (prefix, number) = name.split_at(name.len() - digits);
        let first = number.parse().map_err(|_| FileNamesError)?;
        // A number that starts with 0 is padded; of others the first has the fewest digits.
        let digits = if number.starts_with('0') { digits } else { 1 };
        let digits = u8::try_from(digits).map_err(|_| FileNamesError)?;
        Ok(Self { prefix: prefix.to_owned(), digits, first })
    }
}

/// The error for a name that does not end in a number below 2^32.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileNamesError;

impl fmt::Display for FileNamesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name of a sequence's first frame ends in a number, such as scan_0017")
    }
}

impl std::error::Error for FileNamesError {}

/// Whether a frame can carry this name (`name.characters`, `name.whole`): 1 to 255 bytes that may be
/// a file name on every system.
pub fn is_frame_name(name: &str) -> bool {
    let fits = (1..=255).contains(&name.len()) && !matches!(name, "." | "..");
    fits && name_text(name.as_bytes()).is_some()
}

/// The bytes as text, where it may be part of a file name on every system, else `None`.
pub fn name_text(bytes: &[u8]) -> Option<&str> {
    let text = std::str::from_utf8(bytes).ok()?;
    let refused = |c: char| c.is_control() || matches!(c, '/' | '\\' | ':');
    (!text.contains(refused)).then_some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(names: &[&str]) -> Option<(String, u8, u32)> {
        let names: Vec<String> = names.iter().map(|&name| name.into()).collect();
        FileNames::of_all(&names).map(|pattern| (pattern.prefix, pattern.digits, pattern.first))
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
        assert_eq!(pattern(&["f0000000001", "f0000000002"]), None);
        assert_eq!(pattern(&["a:1", "a:2"]), None);
    }

    #[test]
    fn a_name_is_one_on_every_system() {
        for name in ["tänzer 1 é", "a", "..."] {
            assert!(is_frame_name(name), "{name}");
        }
        for name in ["", ".", "..", "a/b", "a:b", "a\nb", &"x".repeat(256)] {
            assert!(!is_frame_name(name), "{name}");
        }
    }

    #[test]
    fn a_pattern_is_read_back_from_the_first_name() {
        for name in ["scan_0017", "9", "a1b02"] {
            let names: FileNames = name.parse().expect("it ends in a number");
            assert_eq!(names.to_string(), name);
        }
        assert_eq!("scan".parse::<FileNames>(), Err(FileNamesError));
    }
}
