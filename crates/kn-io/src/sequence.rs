//! The files that a folder, a glob or a printf pattern names, in their order, and whether one of a
//! numbered sequence is missing.

use super::{MeshError, MeshErrorKind, MeshFormat};
use std::cmp::Ordering;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

/// The kind of files that are searched.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// Files with the extension of a mesh format, all of one format.
    Meshes,
    /// Label files: in a folder those named `*.labels`, by a pattern whatever it matches.
    Labels,
}

/// The files that `spec` means: a file, a folder, a printf pattern (`f_%04d.obj`) or a glob, in
/// natural order. A name that exists is never taken for a pattern.
///
/// # Errors
/// Nothing matches, the matches are of several formats, or their names carry one common number
/// and a number between two others is missing.
pub(super) fn find_files(spec: &Path, kind: Kind) -> Result<Vec<PathBuf>, MeshError> {
    if spec.is_file() {
        return Ok(vec![spec.to_owned()]);
    }
    let mut files = if spec.is_dir() {
        list_folder(spec)?.into_iter().filter(|path| in_folder(path, kind)).collect()
    } else if let Some(pattern) = Printf::parse(spec) {
        list_folder(&pattern.folder)?.into_iter().filter(|path| pattern.matches(path)).collect()
    } else {
        let mut matches = matching_glob(spec)?;
        matches.retain(|path| kind == Kind::Labels || in_folder(path, kind));
        matches
    };
    if files.is_empty() {
        let kind = match kind {
            Kind::Meshes => MeshErrorKind::NoMatch,
            Kind::Labels => MeshErrorKind::NoLabelFile,
        };
        return Err(MeshError::new(spec, kind));
    }
    files.sort_by(|a, b| natural_order(&a.to_string_lossy(), &b.to_string_lossy()));
    if kind == Kind::Meshes {
        check_one_format(spec, &files)?;
    }
    check_numbering(&files)?;
    Ok(files)
}

/// Files listed one by one: in the order given, unless this is the alphabetical order that a
/// shell's glob comes in, which puts `f_10` before `f_9`; then in natural order.
///
/// # Errors
/// A file does not exist, or is a folder.
pub(super) fn listed_files(files: &[PathBuf]) -> Result<Vec<PathBuf>, MeshError> {
    for file in files {
        if fs::metadata(file).map_err(|error| MeshError::new(file, error))?.is_dir() {
            let what = "a folder cannot be listed beside files: give it alone, or its files";
            return Err(MeshError::new(file, MeshErrorKind::Ambiguous(what.into())));
        }
    }
    let mut files = files.to_vec();
    if files.is_sorted() {
        files.sort_by(|a, b| natural_order(&a.to_string_lossy(), &b.to_string_lossy()));
    }
    Ok(files)
}

fn in_folder(path: &Path, kind: Kind) -> bool {
    match kind {
        Kind::Meshes => MeshFormat::of_path(path).is_ok(),
        Kind::Labels => path.extension() == Some(OsStr::new("labels")),
    }
}

fn list_folder(folder: &Path) -> Result<Vec<PathBuf>, MeshError> {
    let list = || {
        let mut files = Vec::new();
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            // Hidden files are not meant, neither here nor by a glob: `._f.obj` is no scan.
            let hidden = entry.file_name().as_encoded_bytes().starts_with(b".");
            let path = entry.path();
            if !hidden && path.is_file() {
                files.push(path);
            }
        }
        Ok(files)
    };
    list().map_err(|error: std::io::Error| MeshError::new(folder, error))
}

fn matching_glob(spec: &Path) -> Result<Vec<PathBuf>, MeshError> {
    let pattern = spec.to_string_lossy();
    let is_pattern = pattern.contains(['*', '?', '[']);
    if !is_pattern {
        // A plain name: let the system say why it cannot be opened.
        let kind = match fs::metadata(spec) {
            Ok(_) => MeshErrorKind::NoMatch,
            Err(error) => MeshErrorKind::Io(error),
        };
        return Err(MeshError::new(spec, kind));
    }
    let like_a_shell =
        glob::MatchOptions { require_literal_leading_dot: true, ..Default::default() };
    let paths = glob::glob_with(&pattern, like_a_shell).map_err(|error| {
        MeshError::new(spec, MeshErrorKind::Malformed(format!("bad glob: {}", error.msg)))
    })?;
    let mut files = Vec::new();
    for path in paths {
        let path = path.map_err(|error| {
            MeshError::new(error.path().to_owned(), std::io::Error::from(error))
        })?;
        if path.is_file() {
            files.push(path);
        }
    }
    Ok(files)
}

fn check_one_format(spec: &Path, files: &[PathBuf]) -> Result<(), MeshError> {
    let first = MeshFormat::of_path(&files[0])?;
    for file in files {
        if MeshFormat::of_path(file)? != first {
            let what = format!(
                "several formats match, for instance {} and {}; choose one by a pattern",
                files[0].display(),
                file.display()
            );
            return Err(MeshError::new(spec, MeshErrorKind::Ambiguous(what)));
        }
    }
    Ok(())
}

/// A file name with one `%d` or `%0Nd` in it.
struct Printf {
    folder: PathBuf,
    prefix: String,
    suffix: String,
    /// The digits that zeros fill up to; 0 where numbers are not padded.
    width: usize,
}

impl Printf {
    fn parse(spec: &Path) -> Option<Self> {
        let name = spec.file_name()?.to_str()?;
        let (prefix, rest) = name.split_once('%')?;
        let (digits, suffix) = rest.split_at(rest.find(|c: char| !c.is_ascii_digit())?);
        let suffix = suffix.strip_prefix('d')?;
        let width = if digits.starts_with('0') { digits.parse().ok()? } else { 0 };
        let folder = match spec.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
            _ => PathBuf::from("."),
        };
        Some(Self { folder, prefix: prefix.into(), suffix: suffix.into(), width })
    }

    fn matches(&self, path: &Path) -> bool {
        let number = path
            .file_name()
            .and_then(OsStr::to_str)
            .and_then(|name| name.strip_prefix(&self.prefix[..]))
            .and_then(|rest| rest.strip_suffix(&self.suffix[..]));
        let Some(number) = number else { return false };
        let padded = number.len() > 1 && number.starts_with('0');
        !number.is_empty()
            && number.bytes().all(|byte| byte.is_ascii_digit())
            && number.len() >= self.width
            && (!padded || number.len() == self.width)
    }
}

/// Splits a name into runs of digits and runs of anything else.
fn runs(name: &str) -> Vec<&str> {
    let digit = |c: char| c.is_ascii_digit();
    let mut runs = Vec::new();
    let mut rest = name;
    while let Some(first) = rest.chars().next() {
        let end = rest.find(|c| digit(c) != digit(first)).unwrap_or(rest.len());
        let (run, tail) = rest.split_at(end);
        runs.push(run);
        rest = tail;
    }
    runs
}

fn is_number(run: &str) -> bool {
    run.starts_with(|c: char| c.is_ascii_digit())
}

/// Digits without leading zeros, in a form that orders by value: shorter is smaller.
fn magnitude(run: &str) -> (usize, &str) {
    let digits = run.trim_start_matches('0');
    (digits.len(), digits)
}

/// Orders names as people do: `f_9` before `f_10`.
fn natural_order(a: &str, b: &str) -> Ordering {
    for (run_a, run_b) in runs(a).into_iter().zip(runs(b)) {
        let order = if is_number(run_a) && is_number(run_b) {
            magnitude(run_a).cmp(&magnitude(run_b))
        } else {
            run_a.cmp(run_b)
        };
        if order != Ordering::Equal {
            return order;
        }
    }
    // Equal runs so far: the shorter name first, then f_01 before f_1.
    runs(a).len().cmp(&runs(b).len()).then_with(|| a.cmp(b))
}

/// The index of the run that is the common number of the names: they differ in this run of digits
/// and in nothing else. `None` where the names are not numbered like that.
fn common_number(names: &[Vec<&str>]) -> Option<usize> {
    let first = names.first()?;
    let mut varying = None;
    for name in names {
        if name.len() != first.len() {
            return None;
        }
        for (at, (run, model)) in name.iter().zip(first).enumerate() {
            let both_numbers = is_number(run) && is_number(model);
            if run == model {
                continue;
            }
            if !both_numbers || varying.is_some_and(|other| other != at) {
                return None;
            }
            varying = Some(at);
        }
    }
    varying
}

/// Checks that naturally sorted files with one common number have every number in between, once.
fn check_numbering(files: &[PathBuf]) -> Result<(), MeshError> {
    let names: Vec<_> = files.iter().map(|file| file.to_string_lossy()).collect();
    let names: Vec<_> = names.iter().map(|name| runs(name)).collect();
    let Some(at) = common_number(&names) else { return Ok(()) };
    for (pair, file) in names.windows(2).zip(&files[1..]) {
        let (Ok(before), Ok(after)) = (pair[0][at].parse::<u64>(), pair[1][at].parse::<u64>())
        else {
            continue; // Longer than any frame number: a date or a hash.
        };
        if after == before {
            let what = format!("has the frame number of {}", pair[0].concat());
            return Err(MeshError::new(file, MeshErrorKind::Ambiguous(what)));
        }
        if after - before > 1 {
            let mut missing: Vec<String> = pair[0].iter().map(|&run| run.into()).collect();
            missing[at] = format!("{:0width$}", before + 1, width = pair[0][at].len());
            return Err(MeshError::new(missing.concat(), missing_between(files)));
        }
    }
    Ok(())
}

fn missing_between(files: &[PathBuf]) -> MeshErrorKind {
    let name = |file: Option<&PathBuf>| {
        let name = file.and_then(|file| file.file_name()).unwrap_or_default();
        name.to_string_lossy().into_owned()
    };
    MeshErrorKind::MissingFrame { first: name(files.first()), last: name(files.last()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder_with(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for name in names {
            fs::write(folder.path().join(name), "x").expect("written");
        }
        folder
    }

    /// The names that `spec` finds in a folder with these files, or the message.
    fn find(names: &[&str], spec: &str, kind: Kind) -> Result<Vec<String>, String> {
        let folder = folder_with(names);
        let found = find_files(&folder.path().join(spec), kind).map_err(|e| e.to_string())?;
        let name = |path: &PathBuf| path.file_name().map(|n| n.to_string_lossy().into_owned());
        Ok(found.iter().filter_map(name).collect())
    }

    #[test]
    fn a_folder_is_its_meshes_in_natural_order() {
        let names = ["f10.obj", "f9.obj", "f8.obj", "f8.labels", "notes.txt", "f.mtl", "._f8.obj"];
        assert_eq!(find(&names, "", Kind::Meshes).expect("found"), ["f8.obj", "f9.obj", "f10.obj"]);
        assert_eq!(find(&names, "", Kind::Labels).expect("found"), ["f8.labels"]);
        assert_eq!(find(&names, "f?.obj", Kind::Meshes).expect("found"), ["f8.obj", "f9.obj"]);
        assert_eq!(find(&names, "f8.*", Kind::Meshes).expect("found"), ["f8.obj"]);
        assert_eq!(find(&names, "*8.obj", Kind::Meshes).expect("found"), ["f8.obj"]);
    }

    #[test]
    fn printf_patterns_find_start_and_end() {
        let names = ["f_0099.obj", "f_0100.obj", "f_12.obj", "g_0098.obj", "f_0101.ply"];
        let found = find(&names, "f_%04d.obj", Kind::Meshes).expect("found");
        assert_eq!(found, ["f_0099.obj", "f_0100.obj"]);
        assert_eq!(find(&names, "f_%d.obj", Kind::Meshes).expect("found"), ["f_12.obj"]);
    }

    #[test]
    fn a_missing_frame_is_named_however_the_frames_are_given() {
        let names = ["f_0008.obj", "f_0009.obj", "f_0011.obj"];
        for spec in ["", "*.obj", "f_%04d.obj", "f_00*"] {
            let message = find(&names, spec, Kind::Meshes).expect_err("a gap");
            assert!(
                message.ends_with(
                    "f_0010.obj: this frame is missing: \
                     the sequence runs from f_0008.obj to f_0011.obj"
                ),
                "{spec}: {message}"
            );
        }
        let message = find(&["7.ply", "10.ply"], "", Kind::Meshes).expect_err("a gap");
        assert!(message.contains("/8.ply: this frame is missing"), "{message}");
    }

    #[test]
    fn names_without_one_common_number_have_no_gaps() {
        for names in [&["a.obj", "c.obj"][..], &["s1_f1.obj", "s3_f4.obj"], &["x1.obj", "y4.obj"]] {
            assert_eq!(find(names, "", Kind::Meshes).expect("found"), names);
        }
    }

    #[test]
    fn what_is_unclear_is_an_error() {
        let message = |names, spec| find(names, spec, Kind::Meshes).expect_err("must fail");
        assert!(message(&["a.obj"], "*.ply").ends_with("(.obj, .ply, .off, .stl, .glb, .gltf)"));
        assert!(message(&["a.txt"], "").contains("no mesh file matches"));
        assert!(message(&["a.obj"], "b.obj").contains("b.obj: No such file"));
        assert!(message(&["a.obj", "a.ply"], "").contains("several formats match"));
        assert!(message(&["f1.obj", "f01.obj"], "").contains("has the frame number of"));
        assert!(message(&["a.obj"], "***/a").contains("bad glob"));
        let labels = find(&["a.obj"], "*.labels", Kind::Labels).expect_err("must fail");
        assert!(labels.ends_with("no label file matches"), "{labels}");
    }

    #[test]
    fn an_existing_name_is_no_pattern() {
        let names = ["a[1].obj", "a1.obj", "b%d.obj", "b1.obj"];
        assert_eq!(find(&names, "a[1].obj", Kind::Meshes).expect("found"), ["a[1].obj"]);
        assert_eq!(find(&names, "b%d.obj", Kind::Meshes).expect("found"), ["b%d.obj"]);
    }

    #[test]
    fn a_list_keeps_its_order_unless_a_shell_sorted_it() {
        let folder = folder_with(&["f9.obj", "f10.obj", "f12.obj"]);
        let list = |names: [&str; 3]| {
            let files = names.map(|name| folder.path().join(name));
            let listed = listed_files(&files).expect("all exist");
            listed == files
        };
        assert!(list(["f12.obj", "f9.obj", "f10.obj"]));
        assert!(!list(["f10.obj", "f12.obj", "f9.obj"]));
        let absent = listed_files(&[folder.path().join("f11.obj")]);
        assert!(absent.expect_err("absent").to_string().contains("f11.obj: No such file"));
    }

    #[test]
    fn natural_order_is_total() {
        let mut names = vec!["f10", "f9", "f009", "f", "f9a", "g1", "f1000000000000000000000"];
        names.sort_by(|a, b| natural_order(a, b));
        assert_eq!(names, ["f", "f009", "f9", "f9a", "f10", "f1000000000000000000000", "g1"]);
    }
}
