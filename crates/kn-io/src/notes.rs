//! Notes of content that a file has beside the mesh and that is not carried.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::AddAssign;

/// A file may invent any number of kinds, but nobody reads a thousand.
const MAX_KINDS: usize = 64;

/// Notes of a reader: content that is not carried, and polygons that were cut. `+=` adds the notes
/// of another frame. There are at most 64 kinds of content; all others count as `other content`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadNotes {
    /// Number of faces with more than three corners. They are cut into triangles.
    pub polygons: u64,
    /// Number of these triangles.
    pub polygon_triangles: u64,
    /// Kinds of content that are not carried, each with its count.
    pub ignored: BTreeMap<String, u64>,
}

impl ReadNotes {
    /// Whether there are no notes.
    pub fn is_empty(&self) -> bool {
        self.polygons == 0 && self.ignored.is_empty()
    }

    /// Notes that `what` occurs `count` times and is not carried; 0 times is no note.
    pub(super) fn ignore(&mut self, what: impl AsRef<str>, count: u64) {
        if count == 0 {
            return;
        }
        let known = self.ignored.len() < MAX_KINDS || self.ignored.contains_key(what.as_ref());
        let what = if known { what.as_ref() } else { "other content" };
        match self.ignored.get_mut(what) {
            Some(sum) => *sum += count,
            None => drop(self.ignored.insert(what.to_owned(), count)),
        }
    }

    /// Notes that a face with more than three corners is cut into so many triangles.
    pub(super) fn polygon(&mut self, triangles: usize) {
        self.polygons += 1;
        self.polygon_triangles += triangles as u64;
    }
}

impl AddAssign<&ReadNotes> for ReadNotes {
    fn add_assign(&mut self, other: &ReadNotes) {
        self.polygons += other.polygons;
        self.polygon_triangles += other.polygon_triangles;
        for (what, count) in &other.ignored {
            self.ignore(what, *count);
        }
    }
}

impl fmt::Display for ReadNotes {
    /// Writes the notes as one line, which is empty without notes.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        if self.polygons > 0 {
            let plural = if self.polygons == 1 { "" } else { "s" };
            let (count, triangles) = (self.polygons, self.polygon_triangles);
            write!(f, "{count} polygon{plural} cut into {triangles} triangles")?;
            separator = "; ";
        }
        if !self.ignored.is_empty() {
            write!(f, "{separator}not carried:")?;
            separator = " ";
        }
        for (what, count) in &self.ignored {
            write!(f, "{separator}{what} ({count})")?;
            separator = ", ";
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_are_one_line_and_add_up() {
        let mut notes = ReadNotes::default();
        assert_eq!(notes.to_string(), "");
        notes.polygon(3);
        notes.ignore("normals", 8);
        notes.ignore("lines", 0);
        assert_eq!(notes.to_string(), "1 polygon cut into 3 triangles; not carried: normals (8)");
        let more = notes.clone();
        notes += &more;
        assert_eq!((notes.polygons, notes.ignored["normals"]), (2, 16));
        (0..1000).for_each(|kind| notes.ignore(format!("statements {kind}"), 1));
        assert_eq!((notes.ignored.len(), notes.ignored["other content"]), (65, 937));
    }
}
