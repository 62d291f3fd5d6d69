//! Globs and printf patterns of paths.

use super::super::{MeshError, MeshErrorKind};
use glob::Pattern;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// The files that a glob or a printf pattern matches. A folder or file that exists is meant as it
/// is written, even where its name has brackets.
///
/// # Errors
/// The pattern is broken, a folder cannot be read, or `spec` is no pattern and does not exist.
pub(super) fn matching_files(spec: &Path) -> Result<Vec<PathBuf>, MeshError> {
    let text = spec.to_string_lossy();
    if let Some(pattern) = Printf::parse(&text) {
        let found = matching_glob(spec, &pattern.glob())?;
        return Ok(found.into_iter().filter(|path| pattern.matches(path)).collect());
    }
    let components: Vec<Component<'_>> = spec.components().collect();
    let mut found = Vec::new();
    expand(spec, PathBuf::new(), &components, &mut found)?;
    if found.is_empty() && !has_wildcard(&text) {
        // A plain name: let the system say why it cannot be opened.
        let kind = match fs::metadata(spec) {
            Ok(_) => MeshErrorKind::NoMatch,
            Err(error) => MeshErrorKind::Io(error),
        };
        return Err(MeshError::new(spec, kind));
    }
    Ok(found)
}

/// Adds the files below `folder` that the remaining components match.
fn expand(
    spec: &Path,
    folder: PathBuf,
    components: &[Component<'_>],
    found: &mut Vec<PathBuf>,
) -> Result<(), MeshError> {
    let [first, rest @ ..] = components else {
        if folder.is_file() {
            found.push(folder);
        }
        return Ok(());
    };
    let name = first.as_os_str().to_string_lossy();
    let as_written = folder.join(first);
    if !has_wildcard(&name) || as_written.exists() {
        return expand(spec, as_written, rest, found);
    }
    let below = |pattern: &str| {
        let folder = Pattern::escape(&folder.to_string_lossy());
        if folder.is_empty() { pattern.to_owned() } else { format!("{folder}/{pattern}") }
    };
    if name == "**" {
        // What stands behind it may be at any depth.
        let rest: PathBuf = components.iter().collect();
        found.extend(matching_glob(spec, &below(&rest.to_string_lossy()))?);
        return Ok(());
    }
    for path in glob_paths(spec, &below(&name))? {
        if rest.is_empty() || path.is_dir() {
            expand(spec, path, rest, found)?;
        }
    }
    Ok(())
}

fn has_wildcard(text: &str) -> bool {
    text.contains(['*', '?', '['])
}

fn matching_glob(spec: &Path, pattern: &str) -> Result<Vec<PathBuf>, MeshError> {
    let mut files = glob_paths(spec, pattern)?;
    files.retain(|path| path.is_file());
    Ok(files)
}

/// What a glob matches, as a shell does: hidden files are not meant, `._f.obj` is no scan.
fn glob_paths(spec: &Path, pattern: &str) -> Result<Vec<PathBuf>, MeshError> {
    let like_a_shell =
        glob::MatchOptions { require_literal_leading_dot: true, ..Default::default() };
    let paths = glob::glob_with(pattern, like_a_shell).map_err(|error| {
        MeshError::new(spec, MeshErrorKind::Malformed(format!("bad glob: {}", error.msg)))
    })?;
    let found = paths.map(|path| {
        path.map_err(|error| MeshError::new(error.path().to_owned(), std::io::Error::from(error)))
    });
    found.collect()
}

/// A path with one `%d` or `%0Nd` in it.
struct Printf {
    prefix: String,
    suffix: String,
    /// The digits that zeros fill up to; 0 where numbers are not padded.
    width: usize,
}

impl Printf {
    fn parse(spec: &str) -> Option<Self> {
        spec.match_indices('%').find_map(|(at, _)| Self::parse_at(spec, at))
    }

    fn parse_at(spec: &str, at: usize) -> Option<Self> {
        let (prefix, rest) = (&spec[..at], &spec[at + 1..]);
        let (digits, suffix) = rest.split_at(rest.find(|c: char| !c.is_ascii_digit())?);
        let suffix = suffix.strip_prefix('d')?;
        // A folder `100%done` is no pattern.
        let end = spec[at..].find('/').map_or(spec.len(), |slash| at + slash);
        if Path::new(&spec[..end]).exists() {
            return None;
        }
        let width = if digits.starts_with('0') { digits.parse().ok()? } else { 0 };
        Some(Self { prefix: prefix.into(), suffix: suffix.into(), width })
    }

    /// A glob that matches more.
    fn glob(&self) -> String {
        format!("{}*{}", Pattern::escape(&self.prefix), Pattern::escape(&self.suffix))
    }

    /// Whether a path is what printf writes for a number.
    fn matches(&self, path: &Path) -> bool {
        let path = path.to_string_lossy();
        let prefix = self.prefix.strip_prefix("./").unwrap_or(&self.prefix);
        let rest = path.strip_prefix("./").unwrap_or(&path).strip_prefix(prefix);
        let Some(number) = rest.and_then(|rest| rest.strip_suffix(&self.suffix[..])) else {
            return false;
        };
        let digits = number.strip_prefix('-').unwrap_or(number);
        let padded = digits.len() > 1 && digits.starts_with('0');
        !digits.is_empty()
            && digits.bytes().all(|byte| byte.is_ascii_digit())
            && number.len() >= self.width
            && (!padded || number.len() == self.width)
    }
}
