//! Cleaning of a scan before it is coded: seams are welded, and degenerate and repeated faces are
//! dropped. A report counts every change.
//!
//! Boundaries, non-manifold edges, loose components and isolated vertices are kept: they are the
//! content, and the coder handles them. Faces of zero area are kept too as long as their three
//! vertices differ, since where they lie they hold the surface together. Vertices that no face uses
//! can be dropped after that.

use crate::adjacency::{Components, EdgeTable, Rows};
use crate::{Mesh, MeshFault, VertexMap, compose};
use std::fmt;
use std::ops::AddAssign;

/// A cleaned mesh, its vertex map, and a report.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cleaned {
    /// The mesh without coincident vertices, degenerate and duplicate faces. Vertices keep the
    /// order of their first appearance, faces their order.
    pub mesh: Mesh,
    /// `#V of the input`: the vertex of [`mesh`](Self::mesh) that each input vertex became, or
    /// [`DROPPED`](crate::DROPPED).
    pub vertex_map: Vec<u32>,
    /// Counts of the changes and of what was found.
    pub report: CleanReport,
}

impl Cleaned {
    /// Drops the vertices that no face uses. They are not visible, and one far away would stretch
    /// the grid of the whole sequence.
    pub fn drop_isolated(mut self) -> Self {
        if self.report.isolated == 0 {
            return self;
        }
        let used = VertexMap::of_used(self.mesh.positions.len(), &self.mesh.faces);
        self.mesh = self.mesh.map_vertices(&used);
        self.vertex_map = compose(&self.vertex_map, used.targets());
        self.report.unused += std::mem::take(&mut self.report.isolated);
        self
    }
}

/// Counts of what [`clean`] changed, and of what it found and kept. `+=` adds the counts of another
/// frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CleanReport {
    /// Number of meshes in this report.
    pub frames: u64,
    /// Number of vertices before cleaning.
    pub input_vertices: u64,
    /// Number of faces before cleaning.
    pub input_faces: u64,
    /// Vertices merged into an earlier one at exactly the same position.
    pub welded: u64,
    /// Merged vertices whose label differed from the one that was kept.
    pub label_conflicts: u64,
    /// Faces dropped because a vertex repeats in them after welding.
    pub degenerate: u64,
    /// Faces dropped because an earlier face has the same three vertices in the same turn.
    pub duplicate: u64,
    /// Vertices dropped because no face uses them, see [`Cleaned::drop_isolated`].
    pub unused: u64,
    /// Kept: edges with one face.
    pub boundary_edges: u64,
    /// Kept: edges with three faces or more.
    pub non_manifold_edges: u64,
    /// Kept: connected components (isolated vertices not counted).
    pub components: u64,
    /// Kept: vertices that no face uses.
    pub isolated: u64,
}

impl CleanReport {
    /// Whether cleaning changed the vertices or the faces.
    pub fn changed(&self) -> bool {
        self.welded + self.degenerate + self.duplicate + self.unused > 0
    }
}

impl AddAssign for CleanReport {
    fn add_assign(&mut self, other: Self) {
        self.frames += other.frames;
        self.input_vertices += other.input_vertices;
        self.input_faces += other.input_faces;
        self.welded += other.welded;
        self.label_conflicts += other.label_conflicts;
        self.degenerate += other.degenerate;
        self.duplicate += other.duplicate;
        self.unused += other.unused;
        self.boundary_edges += other.boundary_edges;
        self.non_manifold_edges += other.non_manifold_edges;
        self.components += other.components;
        self.isolated += other.isolated;
    }
}

impl fmt::Display for CleanReport {
    /// Writes one line: first the changes, then what was kept.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} of {} vertices welded, {} in no face dropped, {} degenerate and {} duplicate of {} faces dropped; \
             kept {} components, {} boundary edges, {} non-manifold edges, {} isolated vertices",
            self.welded,
            self.input_vertices,
            self.unused,
            self.degenerate,
            self.duplicate,
            self.input_faces,
            self.components,
            self.boundary_edges,
            self.non_manifold_edges,
            self.isolated,
        )?;
        if self.label_conflicts > 0 {
            write!(f, "; {} welded vertices had another label", self.label_conflicts)?;
        }
        Ok(())
    }
}

/// Welds vertices at exactly the same position (−0 equals +0), then drops faces that repeat a
/// vertex and faces that repeat an earlier face in the same turn. The same three vertices turned
/// the other way are the back of a thin sheet and stay.
///
/// Among welded vertices the label of the lowest input index wins.
///
/// # Errors
/// The first fault of the input, see [`Mesh::check`].
pub fn clean(input: &Mesh) -> Result<Cleaned, MeshFault> {
    input.check()?;
    let mut report = CleanReport {
        frames: 1,
        input_vertices: input.positions.len() as u64,
        input_faces: input.faces.len() as u64,
        ..CleanReport::default()
    };
    let welded = VertexMap::of_welded(&input.positions);
    report.welded = (input.positions.len() - welded.sources().len()) as u64;
    report.label_conflicts = label_conflicts(&input.labels, &welded);
    let mut mesh = input.map_vertices(&welded);
    drop_faces(&mut mesh, &mut report);

    let edges = EdgeTable::new(mesh.positions.len(), &mesh.faces);
    let components = Components::new(mesh.positions.len(), &mesh.faces);
    report.boundary_edges = edges.boundary_count() as u64;
    report.non_manifold_edges = edges.non_manifold_count() as u64;
    report.components = components.count as u64;
    report.isolated = components.isolated_count() as u64;
    Ok(Cleaned { mesh, vertex_map: welded.into_targets(), report })
}

/// Counts the vertices whose label differs from that of the vertex that they are merged into.
fn label_conflicts(labels: &[u8], welded: &VertexMap) -> u64 {
    let kept = |&target: &u32| labels[welded.sources()[target as usize] as usize];
    let pairs = labels.iter().zip(welded.targets());
    pairs.filter(|(label, target)| **label != kept(target)).count() as u64
}

/// Drops the faces that are degenerate or duplicates of an earlier one.
fn drop_faces(mesh: &mut Mesh, report: &mut CleanReport) {
    let before = mesh.faces.len();
    mesh.retain_faces(|&[a, b, c]| a != b && b != c && c != a);
    report.degenerate = (before - mesh.faces.len()) as u64;

    let duplicate = duplicates(mesh.positions.len(), &mesh.faces);
    let mut marks = duplicate.iter();
    mesh.retain_faces(|_| marks.next() != Some(&true));
    report.duplicate = (duplicate.len() - mesh.faces.len()) as u64;
}

/// Marks every face that has an earlier face's vertices in the same cyclic order.
fn duplicates(vertex_count: usize, faces: &[[u32; 3]]) -> Vec<bool> {
    // Turned so that the lowest vertex leads, equal faces are equal arrays. They are compared
    // within the faces that share this lowest vertex, which are few.
    let turned: Vec<[u32; 3]> = faces.iter().map(|&face| lowest_first(face)).collect();
    let leaders = turned.iter().zip(0u32..).map(|(face, index)| (face[0], index));
    let by_leader = Rows::collect(vertex_count, leaders);
    let mut duplicate = vec![false; faces.len()];
    let mut sharing = Vec::new();
    for leader in by_leader.iter() {
        sharing.clear();
        sharing.extend_from_slice(leader);
        sharing.sort_unstable_by_key(|&face| (turned[face as usize], face));
        for pair in sharing.windows(2) {
            duplicate[pair[1] as usize] = turned[pair[0] as usize] == turned[pair[1] as usize];
        }
    }
    duplicate
}

fn lowest_first([a, b, c]: [u32; 3]) -> [u32; 3] {
    match a.min(b).min(c) {
        low if low == a => [a, b, c],
        low if low == b => [b, c, a],
        _ => [c, a, b],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DROPPED;
    use proptest::prelude::*;

    #[test]
    fn welds_drops_and_counts() {
        let positions = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-0.0, 0.0, -0.0],
            [1.0, 0.0, 0.0],
            [5.0, 5.0, 5.0],
        ];
        let faces = vec![[0, 1, 2], [1, 2, 3], [0, 2, 1], [3, 0, 2], [4, 2, 3], [2, 2, 1]];
        let input = Mesh::new(positions, faces).with_labels(vec![7, 8, 9, 1, 8, 2]);
        let cleaned = clean(&input).expect("valid");
        assert_eq!(cleaned.vertex_map, [0, 1, 2, 0, 1, 3]);
        assert_eq!(cleaned.mesh.faces, [[0, 1, 2], [0, 2, 1]]);
        assert_eq!(cleaned.mesh.labels, [7, 8, 9, 2]);
        let expected = CleanReport {
            frames: 1,
            input_vertices: 6,
            input_faces: 6,
            welded: 2,
            label_conflicts: 1,
            degenerate: 2,
            duplicate: 2,
            unused: 0,
            boundary_edges: 0,
            non_manifold_edges: 0,
            components: 1,
            isolated: 1,
        };
        assert_eq!(cleaned.report, expected);
        let dropped = cleaned.drop_isolated();
        assert_eq!(dropped.vertex_map, [0, 1, 2, 0, 1, DROPPED]);
        assert_eq!((dropped.mesh.positions.len(), &dropped.mesh.labels[..]), (3, &[7, 8, 9][..]));
        assert_eq!((dropped.report.unused, dropped.report.isolated), (1, 0));
        let mut sum = expected;
        sum += expected;
        assert_eq!((sum.frames, sum.welded, sum.isolated), (2, 4, 2));
    }

    #[test]
    fn an_invalid_mesh_is_refused() {
        let mesh = Mesh::new(Vec::new(), vec![[0, 1, 2]]);
        assert_eq!(clean(&mesh), Err(MeshFault::FaceIndex { face: 0, index: 0, vertices: 0 }));
    }

    proptest! {
        #[test]
        fn cleaning_keeps_the_surface_and_is_idempotent(
            corners in prop::collection::vec([0i8..3, 0..3, 0..3], 1..30),
            faces in prop::collection::vec([0usize..30, 0..30, 0..30], 0..60),
        ) {
            let count = corners.len();
            let input = Mesh::new(
                corners.iter().map(|p| p.map(f64::from)).collect(),
                faces.iter().map(|f| f.map(|v| (v % count) as u32)).collect(),
            );
            let cleaned = clean(&input).expect("valid");
            let mut distinct = corners.clone();
            distinct.sort_unstable();
            distinct.dedup();
            prop_assert_eq!(cleaned.mesh.positions.len(), distinct.len());
            for (vertex, &new) in cleaned.vertex_map.iter().enumerate() {
                prop_assert_eq!(cleaned.mesh.positions[new as usize], input.positions[vertex]);
            }
            // The oracle: the set of turned, non-degenerate corner triples.
            let mut surface: Vec<_> = input
                .faces
                .iter()
                .map(|f| lowest_first(f.map(|v| cleaned.vertex_map[v as usize])))
                .filter(|[a, b, c]| a != b && b != c && a != c)
                .collect();
            surface.sort_unstable();
            surface.dedup();
            let mut kept: Vec<_> = cleaned.mesh.faces.iter().map(|&f| lowest_first(f)).collect();
            kept.sort_unstable();
            prop_assert_eq!(kept, surface);

            // Without isolated vertices it is the same surface.
            let corners = |mesh: &Mesh| -> Vec<[f64; 3]> {
                mesh.faces.iter().flatten().map(|&v| mesh.positions[v as usize]).collect()
            };
            let dropped = cleaned.clone().drop_isolated();
            prop_assert_eq!(corners(&dropped.mesh), corners(&cleaned.mesh));
            prop_assert_eq!(dropped.mesh.bounding_box(), input.surface_box());
            for (vertex, &new) in dropped.vertex_map.iter().enumerate().filter(|v| *v.1 != DROPPED) {
                prop_assert_eq!(dropped.mesh.positions[new as usize], input.positions[vertex]);
            }

            let again = clean(&cleaned.mesh).expect("valid");
            prop_assert!(!again.report.changed());
            prop_assert_eq!(again.mesh, cleaned.mesh);
        }
    }
}
