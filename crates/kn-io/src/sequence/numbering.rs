//! The order of the files of a sequence by the numbers in their names, and what is missing.

use super::super::{MeshError, MeshErrorKind};
use super::names::{Name, file_name, names_of, natural_order};
use super::{Found, FrameFile};
use kn_bitstream::impl_named;
use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};
use strum::{AsRefStr, EnumMessage, VariantArray};

/// What is done where a numbered sequence lacks a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, AsRefStr, EnumMessage, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum Missing {
    /// It is an error.
    #[default]
    Fail,
    /// The sequence goes on without it.
    Skip,
    /// The frame before is shown again in its place.
    Hold,
}

impl_named! { Missing: "treatment of missing frames" }

/// The largest number of missing frames that are held: more is no gap in a sequence.
const MAX_HELD: u64 = 10_000;

/// Puts files into the order of their numbers, and deals with missing frames.
///
/// Files without a number that changes come in the natural order of their names.
///
/// # Errors
/// The files are of several series, two of them have one number, or a number is missing and
/// `missing` is [`Missing::Fail`].
pub(super) fn in_order(
    spec: &Path,
    files: Vec<PathBuf>,
    missing: Missing,
) -> Result<Found, MeshError> {
    let mut names = names_of(files);
    names.sort_by(natural_order);
    let is_series = check_one_series(spec, &names)?;
    let varying = if is_series { varying_numbers(&names) } else { Vec::new() };
    if varying.is_empty() {
        return Ok(Found::plain(names.into_iter().map(|name| name.path)));
    }
    check_different(&names, &varying)?;
    let Some(columns) = columns(&names, &varying) else {
        // Numbers of more than 64 bits count nothing.
        return Ok(Found::plain(names.into_iter().map(|name| name.path)));
    };
    let timelines = rising(&varying, &columns);
    match timelines.into_iter().min_by_key(|timeline| timeline.gaps.len()) {
        Some(timeline) => timeline.sequence(names, missing),
        None => in_order_of_times(spec, names, &varying, &columns),
    }
}

/// Checks that the names differ in numbers alone, unless no two of them do: then the result is
/// `false`.
fn check_one_series(spec: &Path, names: &[Name]) -> Result<bool, MeshError> {
    let mut series: BTreeMap<&[String], Vec<&Name>> = BTreeMap::new();
    for name in names {
        series.entry(&name.texts).or_default().push(name);
    }
    let mut series: Vec<Vec<&Name>> = series.into_values().collect();
    series.sort_by_key(|names| std::cmp::Reverse(names.len()));
    let [largest, second, others @ ..] = &series[..] else { return Ok(true) };
    if largest.len() == 1 {
        return Ok(false);
    }
    let (count, like) = (largest.len(), file_name(&largest[0].path));
    let (other, more) =
        (file_name(&second[0].path), second.len() - 1 + others.iter().map(Vec::len).sum::<usize>());
    let what = match (second.len(), more) {
        (1, 0) => format!("{count} files are a series like {like}, but {other} is not one of them"),
        (1, _) => format!(
            "{count} files are a series like {like}, but {other} and {more} more are not of it"
        ),
        _ => format!(
            "there are several series, such as {count} files like {like} and {} like {other}",
            second.len()
        ),
    };
    let what = format!("{what}; name the frames by a pattern, such as '{}'", pattern_of(largest));
    Err(MeshError::new(spec, MeshErrorKind::Ambiguous(what)))
}

/// A printf pattern, or a glob where several numbers vary, that finds these files.
fn pattern_of(names: &[&Name]) -> String {
    let names: Vec<Name> = names.iter().map(|&name| name.clone()).collect();
    pattern(&names, &varying_numbers(&names))
}

/// The path of the first name with a place holder for the numbers `open`.
fn pattern(names: &[Name], open: &[usize]) -> String {
    let place = |at: usize| {
        let digits = || names.iter().map(|name| &name.numbers[at].digits);
        let padded = digits().any(|digits| digits.len() > 1 && digits.starts_with('0'));
        match (open.contains(&at), open.len()) {
            (false, _) => names[0].numbers[at].digits.clone(),
            (true, 1) if padded => format!("%0{}d", digits().map(String::len).min().unwrap_or(0)),
            (true, 1) => "%d".into(),
            (true, _) => "*".into(),
        }
    };
    let Name { texts, numbers, path } = &names[0];
    let mut pattern: String = (0..numbers.len()).map(|at| texts[at].clone() + &place(at)).collect();
    pattern.extend(texts.last().cloned());
    match path.extension() {
        Some(extension) => format!("{pattern}.{}", extension.to_string_lossy()),
        None => pattern,
    }
}

/// The numbers that are not the same in all names.
fn varying_numbers(names: &[Name]) -> Vec<usize> {
    let Some(first) = names.first() else { return Vec::new() };
    let varies =
        |&at: &usize| names.iter().any(|name| name.numbers.get(at) != first.numbers.get(at));
    (0..first.numbers.len()).filter(varies).collect()
}

/// Checks that no two names have the same numbers, such as `f_1` and `f_01`.
fn check_different(names: &[Name], varying: &[usize]) -> Result<(), MeshError> {
    let values = |name: &Name| -> Vec<Option<i64>> {
        varying.iter().map(|&at| name.numbers[at].value()).collect()
    };
    for pair in names.windows(2) {
        let own = values(&pair[0]);
        if own.iter().all(Option::is_some) && own == values(&pair[1]) {
            let what = format!("has the frame number of {}", pair[0].path.display());
            return Err(MeshError::new(&pair[1].path, MeshErrorKind::Ambiguous(what)));
        }
    }
    Ok(())
}

/// The numbers of a sequence's frames, which rise.
struct Timeline {
    /// The number in the names; `None` where it is made of several.
    number: Option<usize>,
    values: Vec<i64>,
    /// The distance between frames.
    step: i64,
    /// The frames before a gap, with the number of frames that are missing.
    gaps: Vec<(usize, u64)>,
}

/// The values of the numbers that vary, a list for each; `None` where one does not fit 64 bits.
fn columns(names: &[Name], varying: &[usize]) -> Option<Vec<Vec<i64>>> {
    let column = |&at: &usize| -> Option<Vec<i64>> {
        names.iter().map(|name| name.numbers[at].value()).collect()
    };
    varying.iter().map(column).collect()
}

fn rises(values: &[i64]) -> bool {
    values.is_sorted_by(|a, b| a < b)
}

/// The numbers that count the names, in natural order; none where they do not rise together.
fn rising(varying: &[usize], columns: &[Vec<i64>]) -> Vec<Timeline> {
    if !columns.iter().all(|column| rises(column)) {
        return Vec::new();
    }
    let is_alone = columns.len() == 1;
    let timeline =
        |(&at, values): (&usize, &Vec<i64>)| Timeline::new(Some(at), values.clone(), is_alone);
    varying.iter().zip(columns).map(timeline).collect()
}

/// The names in the order of the times that their numbers give together.
///
/// # Errors
/// They give none, or not one without gaps: they are of several series.
fn in_order_of_times(
    spec: &Path,
    names: Vec<Name>,
    varying: &[usize],
    columns: &[Vec<i64>],
) -> Result<Found, MeshError> {
    let times = seconds_with_fraction(&names, varying).or_else(|| clock(&names, varying, columns));
    let Some(times) = times else { return Err(several_numbers(spec, &names, varying)) };
    let mut timed: Vec<(i64, &Name)> = times.into_iter().zip(&names).collect();
    timed.sort_by_key(|(time, _)| *time);
    let (times, ordered): (Vec<i64>, Vec<Name>) =
        timed.into_iter().map(|(time, name)| (time, name.clone())).unzip();
    if !rises(&times) {
        return Err(several_numbers(spec, &names, varying));
    }
    let timeline = Timeline::new(None, times, true);
    if timeline.gaps.is_empty() {
        Ok(timeline.without_gaps(ordered))
    } else {
        Err(several_numbers(spec, &names, varying))
    }
}

/// Times such as `12.033`: two numbers with a point between.
fn seconds_with_fraction(names: &[Name], varying: &[usize]) -> Option<Vec<i64>> {
    let &[whole, fraction] = varying else { return None };
    if fraction != whole + 1 || names[0].texts[fraction] != "." {
        return None;
    }
    let width = names.iter().map(|name| name.numbers[fraction].digits.len()).max()?;
    let value = |name: &Name| -> Option<i64> {
        let fraction = format!("{:0<width$}", name.numbers[fraction].digits);
        let magnitude = format!("{}{fraction}", name.numbers[whole].digits).parse::<i64>().ok()?;
        Some(if name.numbers[whole].negative { -magnitude } else { magnitude })
    };
    names.iter().map(value).collect()
}

/// Times such as `10-59-30`: hours, minutes and seconds side by side.
fn clock(names: &[Name], varying: &[usize], columns: &[Vec<i64>]) -> Option<Vec<i64>> {
    let side_by_side = varying.windows(2).all(|pair| {
        pair[1] == pair[0] + 1 && matches!(&names[0].texts[pair[1]][..], "-" | "." | ":" | "_")
    });
    let two_digits = |&at: &usize| names.iter().all(|name| name.numbers[at].digits.len() == 2);
    let below_60 = columns[1..].iter().flatten().all(|&value| value < 60);
    if varying.len() > 3 || !side_by_side || !varying[1..].iter().all(two_digits) || !below_60 {
        return None;
    }
    let value = |frame: usize| {
        columns
            .iter()
            .try_fold(0_i64, |sum, column| sum.checked_mul(60)?.checked_add(column[frame]))
    };
    (0..names.len()).map(value).collect()
}

/// The error for numbers that change independently of each other.
fn several_numbers(spec: &Path, names: &[Name], varying: &[usize]) -> MeshError {
    // The number with the fewest values is that of the series: the level of detail, the person.
    let count =
        |at: usize| names.iter().map(|name| &name.numbers[at].digits).collect::<HashSet<_>>().len();
    let of_series = varying.iter().copied().rev().min_by_key(|&at| count(at));
    let open: Vec<usize> = varying.iter().copied().filter(|&at| Some(at) != of_series).collect();
    let example = pattern(names, &open);
    let (a, b) = (file_name(&names[0].path), file_name(&names[1].path));
    let what = format!(
        "several numbers change from name to name, as in {a} and {b}: this looks like several series \
         or levels of detail; name one of them by a pattern, such as '{example}', or list the files \
         in their order"
    );
    MeshError::new(spec, MeshErrorKind::Ambiguous(what))
}

impl Timeline {
    fn new(number: Option<usize>, values: Vec<i64>, is_alone: bool) -> Self {
        let steps: Vec<i64> =
            values.windows(2).map(|pair| pair[1].saturating_sub(pair[0])).collect();
        let step = usual_step(&steps, is_alone);
        let missing = |&distance: &i64| {
            // Times are not exact: half a step more is the next frame still.
            let frames = (i128::from(distance) * 2 + i128::from(step)) / (2 * i128::from(step));
            (frames - 1).max(0) as u64
        };
        let gaps = steps.iter().map(missing).enumerate().filter(|(_, missing)| *missing > 0);
        Self { number, step, gaps: gaps.collect(), values }
    }

    /// The frames, with those that are missing as `missing` says.
    fn sequence(self, names: Vec<Name>, missing: Missing) -> Result<Found, MeshError> {
        let absent: u64 = self.gaps.iter().map(|(_, missing)| missing).sum();
        let Some(&(before, _)) = self.gaps.first() else { return Ok(self.without_gaps(names)) };
        if missing == Missing::Fail {
            return Err(self.missing_frame(&names, before));
        }
        let frames = if absent == 1 {
            "1 frame is missing".into()
        } else {
            format!("{absent} frames are missing")
        };
        let between = format!(
            "the first between {} and {}",
            file_name(&names[before].path),
            file_name(&names[before + 1].path)
        );
        if missing == Missing::Skip {
            let notes = vec![format!("{frames}, {between}: left out")];
            return Ok(Found { notes, ..Found::plain(names.into_iter().map(|name| name.path)) });
        }
        if absent > MAX_HELD {
            let what = format!(
                "{frames}, more than {MAX_HELD}: the numbers do not count frames; --missing skip takes the files as they are"
            );
            return Err(MeshError::new(&names[before].path, MeshErrorKind::Ambiguous(what)));
        }
        let notes = vec![format!("{frames}, {between}: the frame before is held")];
        Ok(Found { frames: self.held(&names), notes })
    }

    fn without_gaps(self, names: Vec<Name>) -> Found {
        let (first, last) = (file_name(&names[0].path), file_name(&names[names.len() - 1].path));
        let uniform = self.values.windows(2).all(|pair| pair[1] - pair[0] == self.step);
        let notes = match (self.step, uniform) {
            (1, _) => Vec::new(),
            (step, true) => {
                vec![format!("numbers rise by {step} from {first} to {last}; none is missing")]
            }
            (step, false) => vec![format!(
                "numbers rise by about {step} from {first} to {last}, as times do; none is missing"
            )],
        };
        Found { notes, ..Found::plain(names.into_iter().map(|name| name.path)) }
    }

    /// The frames, each gap filled with the frame before it. These have the missing names.
    fn held(&self, names: &[Name]) -> Vec<FrameFile> {
        let mut frames = Vec::new();
        let mut gaps = self.gaps.iter().peekable();
        for (frame, name) in names.iter().enumerate() {
            frames.push(FrameFile { path: name.path.clone(), named: name.path.clone() });
            let Some((_, missing)) = gaps.next_if(|(before, _)| *before == frame) else { continue };
            for held in 1..=*missing as i64 {
                let named = match self.number {
                    Some(at) => name.with_number(at, self.values[frame] + held * self.step),
                    None => name.path.clone(),
                };
                frames.push(FrameFile { path: name.path.clone(), named });
            }
        }
        frames
    }

    fn missing_frame(&self, names: &[Name], before: usize) -> MeshError {
        let counts = self.values.windows(2).all(|pair| (pair[1] - pair[0]) % self.step == 0);
        match self.number.filter(|_| counts) {
            Some(at) => {
                let path = names[before].with_number(at, self.values[before] + self.step);
                let first = file_name(&names[0].path);
                let last = file_name(&names[names.len() - 1].path);
                MeshError::new(path, MeshErrorKind::MissingFrame { first, last })
            }
            None => {
                let after = file_name(&names[before].path);
                let kind = MeshErrorKind::MissingBefore { after, step: self.step };
                MeshError::new(&names[before + 1].path, kind)
            }
        }
    }
}

/// The distance between two frames that most of a sequence has. Frame numbers are multiples of
/// the least distance; times are not. Two files do not show it: then every number counts, where
/// `is_alone` says that there is no other.
fn usual_step(steps: &[i64], is_alone: bool) -> i64 {
    let mut sorted = steps.to_vec();
    sorted.sort_unstable();
    let (Some(&least), Some(&median)) =
        (sorted.first(), sorted.get(sorted.len().saturating_sub(1) / 2))
    else {
        return 1;
    };
    if sorted.len() == 1 {
        return if is_alone { 1 } else { least.max(1) };
    }
    if sorted.iter().all(|step| step % least.max(1) == 0) { least.max(1) } else { median.max(1) }
}
