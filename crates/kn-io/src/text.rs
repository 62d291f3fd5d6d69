//! Lines and numbers of text formats, read from bytes.

/// The lines of a text file with their numbers, counted from 1. A line that ends in a backslash
/// goes on in the next one.
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    next_number: usize,
}

impl<'a> Lines<'a> {
    /// Starts at the first line of `bytes`, behind a byte-order mark.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self::numbered_from(bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes), 1)
    }

    /// Starts inside a file, where the next line has this number.
    pub(super) fn numbered_from(bytes: &'a [u8], next_number: usize) -> Self {
        Self { rest: bytes, next_number }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let number = self.next_number;
        let mut end = 0;
        loop {
            let newline = self.rest[end..].iter().position(|&byte| byte == b'\n');
            end = newline.map_or(self.rest.len(), |at| end + at);
            self.next_number += 1;
            let line = &self.rest[..end];
            let continued = line.strip_suffix(b"\r").unwrap_or(line).ends_with(b"\\");
            if newline.is_none() || !continued {
                self.rest = self.rest.get(end + 1..).unwrap_or(&[]);
                return Some((number, line));
            }
            end += 1;
        }
    }
}

/// The words of a line up to a comment; the backslash of a continued line counts as a space.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|byte| byte.is_ascii_whitespace() || *byte == b'\\')
        .filter(|word| !word.is_empty())
        .take_while(|word| word[0] != b'#')
}

/// A number of any type that Rust can parse from ASCII.
pub(super) fn parse<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A word as it may be shown in a message: readable and short.
pub(super) fn shown(word: &[u8]) -> String {
    let head = String::from_utf8_lossy(&word[..word.len().min(24)]);
    let dots = if word.len() > 24 { "…" } else { "" };
    format!("\"{}{dots}\"", head.escape_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_keep_their_numbers_across_continuations() {
        let text = b"\xEF\xBB\xBFf 1 2 \\\r\n 3 # tail\n\nlast";
        let lines: Vec<_> = Lines::new(text).collect();
        assert_eq!(lines.iter().map(|line| line.0).collect::<Vec<_>>(), [1, 3, 4]);
        assert_eq!(words(lines[0].1).collect::<Vec<_>>(), [&b"f"[..], b"1", b"2", b"3"]);
        assert_eq!(words(lines[1].1).count(), 0);
        assert_eq!(lines[2].1, b"last");
    }

    #[test]
    fn a_backslash_at_the_very_end_ends_the_file() {
        assert_eq!(Lines::new(b"f 1 \\").count(), 1);
        assert_eq!(Lines::new(b"f 1 \\\n").count(), 1);
    }

    #[test]
    fn shown_words_are_short_and_printable() {
        assert_eq!(shown(b"a\x00b"), "\"a\\u{0}b\"");
        assert!(shown(&[b'x'; 1000]).len() < 40);
    }
}
