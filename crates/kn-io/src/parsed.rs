//! The result of a format's reader, and what is done to it whatever the format: polygons are cut,
//! labels are taken, and the mesh is checked.

use super::polygons::Polygons;
use super::{MeshError, MeshErrorKind, Place, ReadNotes, ReadOptions, Scan, labels};
use kn_mesh::{MAX_COORDINATE, Mesh, MeshFault};
use std::path::Path;

/// A mesh without labels, and the sources of labels.
#[derive(Default)]
pub(super) struct Parsed {
    /// The vertices and the triangles; `polygons` has the other faces.
    pub(super) mesh: Mesh,
    pub(super) polygons: Polygons,
    /// Vertices with a coordinate that is none ([`MAX_COORDINATE`]), and where they are in the file.
    pub(super) not_finite: Vec<(u32, Place)>,
    /// `#V` values of a vertex property `label`, or empty.
    pub(super) labels: Vec<i64>,
    /// `#V × 3` vertex colours, 0 to 255, or empty.
    pub(super) colours: Vec<[f32; 3]>,
    pub(super) notes: ReadNotes,
}

impl Parsed {
    /// Adds a vertex. It may be NaN, if no face uses it.
    pub(super) fn push_vertex(&mut self, position: [f64; 3], place: Place) {
        if !position.iter().all(|coordinate| coordinate.abs() <= MAX_COORDINATE) {
            self.not_finite.push((self.mesh.positions.len() as u32, place));
        }
        self.mesh.positions.push(position);
    }

    /// Adds a face. One of fewer than three corners is dropped, which is noted.
    pub(super) fn push_polygon(&mut self, corners: &[u32]) {
        match *corners {
            [] | [_] | [_, _] => self.notes.ignore(SHORT_FACES, 1),
            [a, b, c] => self.mesh.faces.push([a, b, c]),
            _ => self.polygons.push(corners, self.mesh.faces.len()),
        }
    }

    /// Makes the mesh of the file.
    ///
    /// # Errors
    /// The mesh has no vertices, no faces where it must have some, a face with a vertex that is NaN
    /// or infinite, or labels that are not as `options` say.
    pub(super) fn finish(mut self, path: &Path, options: &ReadOptions) -> Result<Scan, MeshError> {
        if self.mesh.positions.is_empty() && !options.allow_empty {
            return Err(MeshError::new(path, MeshErrorKind::Empty("the mesh has no vertices")));
        }
        let replaced = self.replace_not_finite(path)?;
        std::mem::take(&mut self.polygons).cut(&mut self.mesh, &mut self.notes);
        if self.mesh.faces.is_empty() && !options.allow_empty {
            return Err(MeshError::new(path, MeshErrorKind::NoFaces));
        }
        self.mesh.labels = labels::take_labels(&mut self, path, options)?;
        for (vertex, like) in replaced {
            if let Some(&label) = self.mesh.labels.get(like as usize) {
                self.mesh.labels[vertex as usize] = label;
            }
        }
        self.notes.ignore("colours", self.colours.len() as u64);
        self.notes.ignore("labels", self.labels.len() as u64);
        match self.mesh.check() {
            Ok(()) => Ok(Scan { mesh: self.mesh, notes: self.notes }),
            Err(MeshFault::NotFinite { vertex }) => {
                Err(Place::Vertex(vertex).fault(MeshErrorKind::NotFinite).at(path))
            }
            Err(fault) => Err(MeshError::new(path, MeshErrorKind::Malformed(fault.to_string()))),
        }
    }

    /// Moves the vertices that are NaN or infinite onto one that is used. Returns both, for each.
    ///
    /// # Errors
    /// A face uses such a vertex, or there are no faces.
    fn replace_not_finite(&mut self, path: &Path) -> Result<Vec<(u32, u32)>, MeshError> {
        let Some(&(_, first_place)) = self.not_finite.first() else { return Ok(Vec::new()) };
        let mut used = vec![false; self.mesh.positions.len()];
        let triangles = self.mesh.faces.as_flattened().iter();
        for &vertex in triangles.chain(self.polygons.corners()) {
            used[vertex as usize] = true;
        }
        let fault = |place: Place| place.fault(MeshErrorKind::NotFinite).at(path);
        if let Some(&(_, place)) = self.not_finite.iter().find(|(v, _)| used[*v as usize]) {
            return Err(fault(place));
        }
        let Some(like) = used.iter().position(|used| *used) else {
            return Err(fault(first_place));
        };
        let position = self.mesh.positions[like];
        let mut replaced = Vec::with_capacity(self.not_finite.len());
        for &(vertex, _) in &self.not_finite {
            self.mesh.positions[vertex as usize] = position;
            replaced.push((vertex, like as u32));
        }
        self.notes.ignore("vertices that are NaN and in no face", replaced.len() as u64);
        Ok(replaced)
    }
}

/// The note of faces that are dropped because they have too few corners.
pub(super) const SHORT_FACES: &str = "faces with fewer than 3 corners";
