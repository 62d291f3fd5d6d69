//! Names of files, cut into texts and numbers, and their natural order.

use std::cmp::Ordering;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// A number in a name, as it is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Number {
    pub(super) negative: bool,
    pub(super) digits: String,
}

impl Number {
    /// `None` where it does not fit 64 bits: a hash.
    pub(super) fn value(&self) -> Option<i64> {
        let magnitude: i64 = self.digits.parse().ok()?;
        Some(if self.negative { -magnitude } else { magnitude })
    }

    /// Orders by value, whatever the number of digits.
    fn order(&self, other: &Self) -> Ordering {
        let magnitude = |number: &Self| {
            let digits = number.digits.trim_start_matches('0').to_owned();
            // Fewer digits without leading zeros are a smaller number.
            (digits.len(), digits)
        };
        match (self.negative, other.negative) {
            (false, false) => magnitude(self).cmp(&magnitude(other)),
            (true, true) => magnitude(other).cmp(&magnitude(self)),
            (true, false) => Ordering::Less,
            (false, true) => Ordering::Greater,
        }
    }
}

/// The path of a file without its extension: a text, a number, a text, a number, ..., a text.
#[derive(Clone, Debug)]
pub(super) struct Name {
    pub(super) texts: Vec<String>,
    pub(super) numbers: Vec<Number>,
    pub(super) path: PathBuf,
}

impl Name {
    fn new(path: PathBuf) -> Self {
        let whole = path.with_extension("").to_string_lossy().into_owned();
        let (mut texts, mut numbers) = (Vec::new(), Vec::new());
        let mut rest = &whole[..];
        while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
            let (text, tail) = rest.split_at(start);
            let end = tail.find(|c: char| !c.is_ascii_digit()).unwrap_or(tail.len());
            let (digits, tail) = tail.split_at(end);
            let negative = is_sign(text, texts.is_empty());
            texts.push(text.strip_suffix('-').filter(|_| negative).unwrap_or(text).to_owned());
            numbers.push(Number { negative, digits: digits.to_owned() });
            rest = tail;
        }
        texts.push(rest.to_owned());
        Self { texts, numbers, path }
    }

    /// The texts without the minus at the end of text `at`, where there is one.
    fn unsigned(&self, at: usize) -> Option<Vec<String>> {
        let mut texts = self.texts.clone();
        texts[at] = texts[at].strip_suffix('-')?.to_owned();
        Some(texts)
    }

    /// The path of a file with other digits in place of number `at`.
    pub(super) fn with_number(&self, at: usize, value: i64) -> PathBuf {
        let mut numbers = self.numbers.clone();
        let own = &numbers[at].digits;
        let width = if own.starts_with('0') { own.len() } else { 0 };
        let digits = format!("{:0width$}", value.unsigned_abs());
        numbers[at] = Number { negative: value < 0, digits };
        let shown = |(text, number): (&String, &Number)| {
            format!("{text}{}{}", if number.negative { "-" } else { "" }, number.digits)
        };
        let mut path: String = self.texts.iter().zip(&numbers).map(shown).collect();
        path.extend(self.texts.last().cloned());
        if let Some(extension) = self.path.extension() {
            path = format!("{path}.{}", extension.to_string_lossy());
        }
        path.into()
    }
}

/// Whether the minus at the end of a text belongs to the number behind it, whatever other names
/// there are. After a letter or a digit it is a hyphen: a text that is not the first of its name
/// stands behind a digit.
fn is_sign(text: &str, is_first: bool) -> bool {
    let Some(before) = text.strip_suffix('-') else { return false };
    let last = before.chars().next_back();
    last.map_or(is_first, |last| matches!(last, '/' | '_' | '=' | '('))
}

/// The names of files. A minus before a number is its sign where another file has the same name
/// without it: `f-1`, `f0`.
pub(super) fn names_of(files: Vec<PathBuf>) -> Vec<Name> {
    let mut names: Vec<Name> = files.into_iter().map(Name::new).collect();
    let shapes: HashSet<Vec<String>> = names.iter().map(|name| name.texts.clone()).collect();
    for name in &mut names {
        for at in 0..name.numbers.len() {
            if let Some(texts) = name.unsigned(at).filter(|texts| shapes.contains(texts)) {
                name.texts = texts;
                name.numbers[at].negative = true;
            }
        }
    }
    names
}

/// Orders names as people do: `f_9` before `f_10`.
pub(super) fn natural_order(a: &Name, b: &Name) -> Ordering {
    for at in 0..a.texts.len().min(b.texts.len()) {
        let order = a.texts[at].cmp(&b.texts[at]).then_with(|| {
            let numbers = a.numbers.get(at).zip(b.numbers.get(at));
            numbers.map_or(Ordering::Equal, |(a, b)| a.order(b))
        });
        if order != Ordering::Equal {
            return order;
        }
    }
    // Equal so far: the shorter name first, then f_01 before f_1.
    a.texts.len().cmp(&b.texts.len()).then_with(|| a.path.cmp(&b.path))
}

/// The last part of a path, for messages.
pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The names of frames: those of their files without extension, or of their folders where several
/// files have one name, such as `frame_0/model.obj` and `frame_1/model.obj`.
pub(super) fn frame_names(files: &[PathBuf]) -> Vec<String> {
    let text =
        |part: Option<&std::ffi::OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
    let stems: Vec<String> = files.iter().map(|file| text(file.file_stem())).collect();
    let are_different =
        |names: &[String]| names.iter().collect::<HashSet<_>>().len() == names.len();
    if are_different(&stems) {
        return stems;
    }
    let folder = |file: &PathBuf| text(file.parent().and_then(Path::file_name));
    let folders: Vec<String> = files.iter().map(folder).collect();
    if are_different(&folders) { folders } else { stems }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(names: &[&str]) -> Vec<String> {
        let mut names = names_of(names.iter().map(PathBuf::from).collect());
        names.sort_by(natural_order);
        names.iter().map(|name| name.path.display().to_string()).collect()
    }

    #[test]
    fn natural_order_is_total() {
        let names = ["f10", "f9", "f009", "f", "f9a", "g1", "f1000000000000000000000"];
        let order = ["f", "f009", "f9", "f9a", "f10", "f1000000000000000000000", "g1"];
        assert_eq!(sorted(&names), order);
    }

    #[test]
    fn a_minus_is_a_sign_where_the_names_show_it() {
        for (names, order) in [
            (
                &["f-1.obj", "f-10.obj", "f0.obj", "f1.obj"][..],
                &["f-10.obj", "f-1.obj", "f0.obj", "f1.obj"][..],
            ),
            (&["-1.obj", "-2.obj", "0.obj"], &["-2.obj", "-1.obj", "0.obj"]),
            (&["s/f_-1.obj", "s/f_-2.obj"], &["s/f_-2.obj", "s/f_-1.obj"]),
            // A hyphen.
            (&["f-2.obj", "f-1.obj"], &["f-1.obj", "f-2.obj"]),
            (&["5-2.obj", "5-1.obj"], &["5-1.obj", "5-2.obj"]),
        ] {
            assert_eq!(sorted(names), order);
        }
    }

    #[test]
    fn numbers_keep_their_width() {
        let name = |path: &str| names_of(vec![path.into()]).remove(0);
        let missing =
            |path: &str, at, value| name(path).with_number(at, value).display().to_string();
        assert_eq!(missing("a1/f_009.obj", 1, 10), "a1/f_010.obj");
        assert_eq!(missing("9.ply", 0, 10), "10.ply");
        assert_eq!(missing("f_-02_x.ply", 0, -1), "f_-01_x.ply");
        assert_eq!(missing("f_-10.ply", 0, -9), "f_-9.ply");
    }

    #[test]
    fn a_frame_has_the_name_of_its_folder_where_files_have_one_name() {
        let names =
            |files: &[&str]| frame_names(&files.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert_eq!(names(&["s/f 0 ä.obj", "s/f 1 ä.obj"]), ["f 0 ä", "f 1 ä"]);
        assert_eq!(names(&["s/f0/m.obj", "s/f1/m.obj"]), ["f0", "f1"]);
        assert_eq!(names(&["m.obj", "m.obj"]), ["m", "m"]);
    }
}
