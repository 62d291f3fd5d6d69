//! Lines and numbers of text formats, read from bytes.

use memchr::memchr2;
use std::borrow::Cow;

/// The lines of a text file with their numbers, counted from 1. A line ends in LF, in CR LF or in
/// CR.
pub(super) struct Lines<'a> {
    bytes: &'a [u8],
    /// Start of the line that was returned last, and of the one to come.
    line_start: usize,
    next_start: usize,
    next_number: usize,
}

impl<'a> Lines<'a> {
    /// Starts at the first line of `bytes`, behind a byte-order mark.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self::numbered_from(bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes), 1)
    }

    /// Starts inside a file, where the next line has this number.
    pub(super) fn numbered_from(bytes: &'a [u8], next_number: usize) -> Self {
        Self { bytes, line_start: 0, next_start: 0, next_number }
    }

    /// Finds the end of the next line and goes behind it.
    fn line_end(&mut self) -> Option<usize> {
        let rest = self.bytes.get(self.next_start..).filter(|rest| !rest.is_empty())?;
        self.next_number += 1;
        let length = memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        let terminator = if rest[length..].starts_with(b"\r\n") { 2 } else { 1 };
        let end = self.next_start + length;
        self.next_start = end + terminator;
        Some(end)
    }

    /// The line that was returned last with all that it goes on in: the next one, for as long as a
    /// line ends in a backslash.
    pub(super) fn continued(&mut self, line: &'a [u8]) -> &'a [u8] {
        let (mut last, mut whole) = (line, line);
        while goes_on(last) {
            let start = self.next_start;
            let Some(end) = self.line_end() else { break };
            (last, whole) = (&self.bytes[start..end], &self.bytes[self.line_start..end]);
        }
        whole
    }

    /// The bytes behind the line that was returned last.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.next_start..).unwrap_or(&[])
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let number = self.next_number;
        self.line_start = self.next_start;
        let end = self.line_end()?;
        Some((number, &self.bytes[self.line_start..end]))
    }
}

/// Whether a line ends in a backslash.
pub(super) fn goes_on(line: &[u8]) -> bool {
    line.trim_ascii_end().ends_with(b"\\")
}

/// Whether a byte parts words. The end-of-file mark of DOS stands at the end of some files.
fn is_blank(byte: u8) -> bool {
    matches!(byte, b'\t'..=b'\r' | b' ' | 0x1A)
}

/// The words of a line up to a comment; the backslash of a continued line counts as a space.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|&byte| is_blank(byte) || byte == b'\\')
        .map(trim_nul)
        .filter(|word| !word.is_empty())
        .take_while(|word| word[0] != b'#')
}

/// Takes the next word off a line; empty at its end.
pub(super) fn next_word<'a>(line: &mut &'a [u8]) -> &'a [u8] {
    let start = line.iter().position(|&byte| !is_blank(byte) && byte != 0).unwrap_or(line.len());
    let text = &line[start..];
    let end = text.iter().position(|&byte| is_blank(byte)).unwrap_or(text.len());
    let (word, rest) = text.split_at(end);
    *line = rest;
    trim_nul(word)
}

/// Whether a line has no word.
pub(super) fn is_blank_line(line: &[u8]) -> bool {
    line.iter().all(|&byte| is_blank(byte) || byte == 0)
}

/// A word without the NULs around it, which some programs write at the end of a text. NULs inside a
/// word are no blanks: the digits of a number must not become two numbers.
fn trim_nul(word: &[u8]) -> &[u8] {
    match word {
        [0, ..] | [.., 0] => {
            let start = word.iter().position(|byte| *byte != 0).unwrap_or(word.len());
            let end = word.iter().rposition(|byte| *byte != 0).map_or(start, |at| at + 1);
            &word[start..end]
        }
        _ => word,
    }
}

/// The bytes of a text in UTF-8, if it is in UTF-16 with a byte-order mark; else the bytes as they
/// are.
pub(super) fn in_utf8(bytes: &[u8]) -> Cow<'_, [u8]> {
    let (body, unit): (_, fn([u8; 2]) -> u16) = match bytes {
        [0xFF, 0xFE, body @ ..] => (body, u16::from_le_bytes),
        [0xFE, 0xFF, body @ ..] => (body, u16::from_be_bytes),
        _ => return Cow::Borrowed(bytes),
    };
    let units = body.as_chunks().0.iter().map(|pair| unit(*pair));
    let text = char::decode_utf16(units).map(|unit| unit.unwrap_or(char::REPLACEMENT_CHARACTER));
    Cow::Owned(text.collect::<String>().into_bytes())
}

/// A value of any type that Rust can parse from ASCII.
pub(super) fn parse<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A number in binary64. `nan`, `-nan(ind)` and `1.#QNAN` are NaN, however they are written.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    parse(word).or_else(|| is_nan(word).then_some(f64::NAN))
}

/// Whether a word is one of the C libraries' names for what is no finite number.
fn is_nan(word: &[u8]) -> bool {
    let unsigned = word.strip_prefix(b"-").or(word.strip_prefix(b"+")).unwrap_or(word);
    let c99 = unsigned.get(..3).is_some_and(|head| head.eq_ignore_ascii_case(b"nan"));
    c99 || unsigned.starts_with(b"1.#") || unsigned.starts_with(b"1#")
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
        let mut lines = Lines::new(text);
        let (number, line) = lines.next().expect("a line");
        let line = lines.continued(line);
        assert_eq!(number, 1);
        assert_eq!(words(line).collect::<Vec<_>>(), [&b"f"[..], b"1", b"2", b"3"]);
        let (number, line) = lines.next().expect("a line");
        assert_eq!((number, words(line).count()), (3, 0));
        assert_eq!(lines.next(), Some((4, &b"last"[..])));
        assert_eq!((lines.next(), lines.rest()), (None, &b""[..]));
    }

    #[test]
    fn lines_end_in_every_way() {
        for text in ["a\nb\n\nc", "a\rb\r\rc\r", "a\r\nb\r\n\r\nc\r\n", "a\rb\r\n\nc\n"] {
            let lines: Vec<_> = Lines::new(text.as_bytes()).collect();
            assert_eq!(lines, [(1, &b"a"[..]), (2, b"b"), (3, b""), (4, b"c")], "{text:?}");
        }
    }

    #[test]
    fn a_blank_line_ends_what_goes_on() {
        let mut lines = Lines::new(b"f 1 \\ \r\n\r\nf 2");
        let (_, line) = lines.next().expect("a line");
        assert_eq!(words(lines.continued(line)).count(), 2);
        assert_eq!(lines.next(), Some((3, &b"f 2"[..])));
    }

    #[test]
    fn a_backslash_at_the_very_end_ends_the_file() {
        for text in [&b"f 1 \\"[..], b"f 1 \\\n", b"f 1 \\\r"] {
            let mut lines = Lines::new(text);
            let (_, line) = lines.next().expect("a line");
            assert_eq!(words(lines.continued(line)).count(), 2);
            assert_eq!(lines.next(), None);
        }
    }

    #[test]
    fn numbers_are_binary64_and_nan_has_many_names() {
        assert_eq!(number(b"5334567.891"), Some(5334567.891));
        assert_eq!(number(b"1e39"), Some(1e39));
        for word in ["nan", "-NaN", "-nan(ind)", "nan(0x7fe)", "1.#QNAN", "-1.#IND00", "1.#INF"] {
            assert!(number(word.as_bytes()).is_some_and(f64::is_nan), "{word}");
        }
        for word in ["", "-", "abc", "0,5", "1.2.3", "na", "#"] {
            assert_eq!(number(word.as_bytes()), None, "{word}");
        }
    }

    #[test]
    fn nul_is_around_words_and_never_between_digits() {
        assert_eq!(
            words(b"\0v\0 1\0\x002 \0\0 3\0").collect::<Vec<_>>(),
            [&b"v"[..], b"1\0\x002", b"3"]
        );
        let mut line = &b"\0 3\0 4\0"[..];
        assert_eq!(
            [next_word(&mut line), next_word(&mut line), next_word(&mut line)],
            [&b"3"[..], b"4", b""]
        );
        assert!(is_blank_line(b" \0\x1a") && !is_blank_line(b"\x001"));
    }

    #[test]
    fn utf_16_becomes_utf_8() {
        let utf_16 = |mark: [u8; 2], bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
            mark.into_iter().chain("v é\n".encode_utf16().flat_map(bytes)).collect()
        };
        assert_eq!(&in_utf8(&utf_16([0xFF, 0xFE], u16::to_le_bytes))[..], "v é\n".as_bytes());
        assert_eq!(&in_utf8(&utf_16([0xFE, 0xFF], u16::to_be_bytes))[..], "v é\n".as_bytes());
        assert_eq!(&in_utf8(b"v 1")[..], b"v 1");
    }

    #[test]
    fn shown_words_are_short_and_printable() {
        assert_eq!(shown(b"a\x00b"), "\"a\\u{0}b\"");
        assert!(shown(&[b'x'; 1000]).len() < 40);
    }
}
