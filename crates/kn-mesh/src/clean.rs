//! What a scan needs before it can be coded: seams welded, empty and repeated faces dropped,
//! and a report of every change.
//!
//! Boundaries, non-manifold edges, loose components and isolated vertices are kept: they are the
//! content, and the coder handles them. Faces of zero area are kept too as long as their three
//! vertices differ, since where they lie they hold the surface together. Vertices that no face uses
//! can be dropped after that.

use crate::adjacency::{Components, EdgeTable, Rows};
use crate::{Mesh, MeshFault};
use std::fmt;
use std::ops::AddAssign;

/// A cleaned mesh, and how it came from its input.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cleaned {
    /// The mesh without coincident vertices, degenerate and duplicate faces. Vertices keep the
    /// order of their first appearance, faces their order.
    pub mesh: Mesh,
    /// `#V of the input`: the vertex of [`mesh`](Self::mesh) that each input vertex became, or
    /// [`DROPPED`].
    pub vertex_map: Vec<u32>,
    /// What was changed and what was found.
    pub report: CleanReport,
}

/// In a vertex map: the vertex was dropped.
pub const DROPPED: u32 = u32::MAX;

impl Cleaned {
    /// Drops the vertices that no face uses. They show nowhere, and a stray one would stretch the
    /// grid of a whole sequence.
    pub fn drop_isolated(mut self) -> Self {
        if self.report.isolated == 0 {
            return self;
        }
        let Mesh { positions, faces, labels } = &mut self.mesh;
        let mut used = vec![false; positions.len()];
        faces.iter().flatten().for_each(|&vertex| used[vertex as usize] = true);
        let mut new_of = Vec::with_capacity(used.len());
        let mut count = 0;
        for &used in &used {
            new_of.push(if used { count } else { DROPPED });
            count += u32::from(used);
        }
        retain_marked(positions, &used);
        retain_marked(labels, &used);
        faces.as_flattened_mut().iter_mut().for_each(|vertex| *vertex = new_of[*vertex as usize]);
        self.vertex_map.iter_mut().for_each(|vertex| *vertex = new_of[*vertex as usize]);
        self.report.unused += std::mem::take(&mut self.report.isolated);
        self
    }
}

/// Keeps what is marked; no labels stay none.
fn retain_marked<T>(values: &mut Vec<T>, marks: &[bool]) {
    let mut marks = marks.iter();
    values.retain(|_| marks.next().is_some_and(|&mark| mark));
}

/// Counts of what [`clean`] changed and of what it found and kept; sums over frames with `+=`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CleanReport {
    /// Meshes that this report is about.
    pub frames: u64,
    /// Vertices before.
    pub input_vertices: u64,
    /// Faces before.
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
    /// Whether the mesh came out with other vertices or faces than it went in.
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
    /// One line: what was changed, then what was kept.
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
    let (mut mesh, vertex_map) = weld(input, &mut report);
    mesh.faces = kept_faces(input, &vertex_map, mesh.positions.len(), &mut report);

    let edges = EdgeTable::new(mesh.positions.len(), &mesh.faces);
    let components = Components::new(mesh.positions.len(), &mesh.faces);
    report.boundary_edges = edges.boundary_count() as u64;
    report.non_manifold_edges = edges.non_manifold_count() as u64;
    report.components = components.count as u64;
    report.isolated = components.isolated_count() as u64;
    Ok(Cleaned { mesh, vertex_map, report })
}

/// The distinct positions with their labels in order of first appearance, and the map to them.
fn weld(input: &Mesh, report: &mut CleanReport) -> (Mesh, Vec<u32>) {
    let first_of = first_at_position(&input.positions);
    let mut mesh = Mesh::default();
    let mut vertex_map = Vec::with_capacity(input.positions.len());
    for (vertex, &first) in first_of.iter().enumerate() {
        if first as usize == vertex {
            vertex_map.push(mesh.positions.len() as u32);
            mesh.positions.push(input.positions[vertex]);
            mesh.labels.extend(input.labels.get(vertex));
        } else {
            vertex_map.push(vertex_map[first as usize]);
            report.welded += 1;
            let conflict = input.labels.get(vertex) != input.labels.get(first as usize);
            report.label_conflicts += u64::from(conflict);
        }
    }
    (mesh, vertex_map)
}

/// For every vertex the lowest vertex at the same position.
fn first_at_position(positions: &[[f32; 3]]) -> Vec<u32> {
    // Adding +0 turns −0 into +0 and leaves every other number: equal bits, equal position.
    let bits = |vertex: u32| positions[vertex as usize].map(|c| (c + 0.0).to_bits());
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(|&vertex| (bits(vertex), vertex));
    let mut first_of = vec![0; positions.len()];
    for run in order.chunk_by(|&a, &b| bits(a) == bits(b)) {
        for &vertex in run {
            first_of[vertex as usize] = run[0];
        }
    }
    first_of
}

/// The faces on welded vertices that are neither degenerate nor duplicates of an earlier one.
fn kept_faces(
    input: &Mesh,
    vertex_map: &[u32],
    vertex_count: usize,
    report: &mut CleanReport,
) -> Vec<[u32; 3]> {
    let mut faces: Vec<[u32; 3]> =
        input.faces.iter().map(|face| face.map(|vertex| vertex_map[vertex as usize])).collect();
    let welded = faces.len();
    faces.retain(|&[a, b, c]| a != b && b != c && c != a);
    report.degenerate += (welded - faces.len()) as u64;

    let duplicate = duplicates(vertex_count, &faces);
    let distinct = faces.len();
    let mut at = 0;
    faces.retain(|_| {
        at += 1;
        !duplicate[at - 1]
    });
    report.duplicate += (distinct - faces.len()) as u64;
    faces
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
    use proptest::prelude::*;

    #[test]
    fn welds_drops_and_counts() {
        let input = Mesh {
            positions: vec![
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [-0.0, 0.0, -0.0],
                [1.0, 0.0, 0.0],
                [5.0, 5.0, 5.0],
            ],
            faces: vec![[0, 1, 2], [1, 2, 3], [0, 2, 1], [3, 0, 2], [4, 2, 3], [2, 2, 1]],
            labels: vec![7, 8, 9, 1, 8, 2],
        };
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
        let mesh = Mesh { faces: vec![[0, 1, 2]], ..Mesh::default() };
        assert_eq!(clean(&mesh), Err(MeshFault::FaceIndex { face: 0, index: 0, vertices: 0 }));
    }

    proptest! {
        #[test]
        fn cleaning_keeps_the_surface_and_is_idempotent(
            corners in prop::collection::vec([0i8..3, 0..3, 0..3], 1..30),
            faces in prop::collection::vec([0usize..30, 0..30, 0..30], 0..60),
        ) {
            let count = corners.len();
            let input = Mesh {
                positions: corners.iter().map(|p| p.map(f32::from)).collect(),
                faces: faces.iter().map(|f| f.map(|v| (v % count) as u32)).collect(),
                labels: vec![],
            };
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
            let corners = |mesh: &Mesh| -> Vec<[f32; 3]> {
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
