//! Damage that does not look at the format: lost, changed and added bytes and lines.

use super::random::Random;

/// Damages a file in one to three ways.
pub(super) fn apply(bytes: &mut Vec<u8>, random: &mut Random) {
    for _ in 0..1 + random.below(3) {
        let at = random.below(bytes.len());
        match random.below(8) {
            0 => bytes.truncate(at),
            1 => bytes.extend(vec![0; 1 + random.below(9)]),
            2 if !bytes.is_empty() => bytes[at] = random.below(256) as u8,
            3 if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
            4 => drop(bytes.drain(at..(at + random.below(40)).min(bytes.len()))),
            5 => {
                let piece = bytes[at..(at + random.below(40)).min(bytes.len())].to_vec();
                let to = random.below(bytes.len());
                bytes.splice(to..to, piece);
            }
            6 => {
                let word = random.pick(WORDS);
                bytes.splice(at..at, word.bytes());
            }
            _ => swap_lines(bytes, random),
        }
    }
}

const WORDS: &[&str] = &[
    "nan",
    "-1",
    "1e999",
    "4294967296",
    "\n",
    "\r",
    "\\\n",
    "\0",
    "#",
    "/",
    "99999999999999999999",
    " ",
    "-0",
    "\u{feff}",
];

fn swap_lines(bytes: &mut Vec<u8>, random: &mut Random) {
    let mut lines: Vec<&[u8]> = bytes.split_inclusive(|&byte| byte == b'\n').collect();
    let (a, b) = (random.below(lines.len()), random.below(lines.len()));
    if !lines.is_empty() {
        lines.swap(a, b);
    }
    *bytes = lines.concat();
}

/// A decimal number, written in one of the ways that are found.
pub(super) fn decimal(value: f64, random: &mut Random) -> String {
    if value.is_nan() {
        return random.pick(&["nan", "NaN", "-nan(ind)", "1.#QNAN", "-1.#IND00"]).into();
    }
    match random.below(4) {
        0 => format!("{value:e}"),
        1 => format!("{value:+.12}"),
        _ => format!("{value}"),
    }
}

/// The ends of lines.
pub(super) fn with_line_ends(text: &str, random: &mut Random) -> Vec<u8> {
    let end = random.pick(&["\n", "\n", "\n", "\r\n", "\r", "\n\n", " \n"]);
    let mut bytes = text.replace('\n', end).into_bytes();
    if random.chance(8) {
        bytes.splice(0..0, *b"\xEF\xBB\xBF");
    }
    bytes
}
