//! Notes of content that a file has beside the mesh and that is not carried.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::AddAssign;

/// Notes of a reader: content that is not carried, and polygons that were cut. `+=` adds the notes
/// of another frame.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadNotes {
    /// Number of faces with more than three corners. They are cut into fans of triangles.
    pub polygons: u64,
    /// Number of triangles of these fans.
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
    pub(super) fn ignore(&mut self, what: impl Into<String>, count: u64) {
        if count > 0 {
            *self.ignored.entry(what.into()).or_default() += count;
        }
    }

    /// Notes that a face with so many corners is cut into triangles.
    pub(super) fn polygon(&mut self, corners: usize) {
        if corners > 3 {
            self.polygons += 1;
            self.polygon_triangles += corners as u64 - 2;
        }
    }
}

impl AddAssign<&ReadNotes> for ReadNotes {
    fn add_assign(&mut self, other: &ReadNotes) {
        self.polygons += other.polygons;
        self.polygon_triangles += other.polygon_triangles;
        for (what, count) in &other.ignored {
            self.ignore(what.clone(), *count);
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
        notes.polygon(5);
        notes.ignore("normals", 8);
        notes.ignore("lines", 0);
        assert_eq!(notes.to_string(), "1 polygon cut into 3 triangles; not carried: normals (8)");
        let more = notes.clone();
        notes += &more;
        assert_eq!((notes.polygons, notes.ignored["normals"]), (2, 16));
    }
}
