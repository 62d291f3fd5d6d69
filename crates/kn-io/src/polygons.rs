//! Cutting of polygons into triangles.
//!
//! Frames of a sequence that have the same faces should be cut in the same way, though the
//! vertices move. So the cut follows the order of the corners wherever that does no harm: a polygon
//! is a fan around its first corner, unless a triangle of the fan folds back over another one or is
//! much thinner than it has to be. Only then do the positions decide. The rule looks at one polygon
//! alone: the same file is cut in the same way in every sequence.

use super::ReadNotes;
use super::parsed::SHORT_FACES;
use super::triangulation::triangulate;
use kn_mesh::Mesh;
use kn_mesh::vec3::{cross, dot, sub};

/// The faces of a mesh that have more than three corners.
#[derive(Default)]
pub(super) struct Polygons {
    /// The corners of all polygons.
    corners: Vec<u32>,
    list: Vec<Polygon>,
}

struct Polygon {
    /// Number of triangles of the mesh that come before this polygon.
    triangles_before: usize,
    /// End of its corners.
    end: usize,
}

impl Polygons {
    /// Adds a polygon behind `triangles_before` triangles.
    pub(super) fn push(&mut self, corners: &[u32], triangles_before: usize) {
        self.corners.extend_from_slice(corners);
        self.list.push(Polygon { triangles_before, end: self.corners.len() });
    }

    /// The vertices of all corners.
    pub(super) fn corners(&self) -> &[u32] {
        &self.corners
    }

    /// Cuts the polygons into triangles and puts these between the triangles of `mesh`, in the
    /// order of the file. All corners have to be finite.
    pub(super) fn cut(self, mesh: &mut Mesh, notes: &mut ReadNotes) {
        if self.list.is_empty() {
            return;
        }
        let triangles = std::mem::take(&mut mesh.faces);
        let mut faces = Vec::with_capacity(triangles.len() + self.corners.len());
        let mut cutter = Cutter::default();
        let (mut taken, mut start) = (0, 0);
        for &Polygon { triangles_before, end } in &self.list {
            faces.extend_from_slice(&triangles[taken..triangles_before]);
            let before = faces.len();
            cutter.cut(&self.corners[start..end], &mesh.positions, &mut faces);
            match faces.len() - before {
                0 => notes.ignore(SHORT_FACES, 1),
                count => notes.polygon(count),
            }
            (taken, start) = (triangles_before, end);
        }
        faces.extend_from_slice(&triangles[taken..]);
        mesh.faces = faces;
    }
}

/// A polygon while it is cut.
#[derive(Default)]
struct Cutter {
    /// `n` vertices of the mesh, none twice in a row.
    ring: Vec<u32>,
    /// `n × 3` positions relative to the first corner, the farthest at the distance 1 on one axis.
    points: Vec<[f64; 3]>,
}

/// How a polygon is cut.
enum Way {
    /// Into a fan around this corner.
    Fan(usize),
    /// Into the triangles of these corners.
    Triangles(Vec<[usize; 3]>),
}

/// A fan with a triangle thinner than this (an angle of some 0.1 degrees) is not a good cut.
const THIN: f64 = 0.002;
/// A quad is cut along its second diagonal if the thinner triangle is this many times better then.
/// No parallelogram gains as much, however it is sheared.
const CLEARLY_BETTER: f64 = 4.0;

impl Cutter {
    /// Appends the triangles of a polygon.
    fn cut(&mut self, corners: &[u32], positions: &[[f64; 3]], faces: &mut Vec<[u32; 3]>) {
        self.ring.clear();
        self.ring.extend_from_slice(corners);
        self.ring.dedup();
        while self.ring.len() > 1 && self.ring.first() == self.ring.last() {
            self.ring.pop();
        }
        if self.ring.len() < 3 {
            return;
        }
        let way = self.way(positions);
        let count = self.ring.len();
        let vertices = |corners: [usize; 3]| corners.map(|corner| self.ring[corner]);
        match way {
            Way::Fan(first) => faces.extend(fan(first, count).map(vertices)),
            Way::Triangles(triangles) => faces.extend(triangles.into_iter().map(vertices)),
        }
    }

    fn way(&mut self, positions: &[[f64; 3]]) -> Way {
        let Some(normal) = self.normal(positions) else { return Way::Fan(0) };
        if self.ring.len() == 4 {
            return Way::Fan(self.first_of_quad(normal));
        }
        let good = self.worst(0, normal) >= THIN;
        let triangles = if good { None } else { triangulate(&self.points, normal) };
        triangles.map_or(Way::Fan(0), Way::Triangles)
    }

    /// Sets `points`. Returns the unit normal of the plane that fits the ring best (M. E. Newell):
    /// the sum of the cross products of neighbouring corners. `None` where the ring has no area.
    fn normal(&mut self, positions: &[[f64; 3]]) -> Option<[f64; 3]> {
        let at = |vertex: &u32| positions[*vertex as usize];
        let first = at(&self.ring[0]);
        self.points.clear();
        self.points.extend(self.ring.iter().map(|vertex| sub(at(vertex), first)));
        let size = self.points.as_flattened().iter().fold(0f64, |size, x| size.max(x.abs()));
        if !(size.is_normal() && (1.0 / size).is_normal()) {
            return None;
        }
        self.points.as_flattened_mut().iter_mut().for_each(|x| *x /= size);
        let mut normal = [0.0; 3];
        for pair in self.points.windows(2) {
            let product = cross(pair[0], pair[1]);
            (0..3).for_each(|axis| normal[axis] += product[axis]);
        }
        let length = dot(normal, normal).sqrt();
        (length > 1e-14).then(|| normal.map(|x| x / length))
    }

    /// The corner that the better diagonal of a quad starts at: 0 or 1.
    fn first_of_quad(&self, normal: [f64; 3]) -> usize {
        let (first, second) = (self.worst(0, normal), self.worst(1, normal));
        usize::from(second > first.max(0.0) * CLEARLY_BETTER)
    }

    /// The least [`shape`] of the triangles of the fan around a corner.
    fn worst(&self, first: usize, normal: [f64; 3]) -> f64 {
        let shape = |corners: [usize; 3]| shape(corners.map(|at| self.points[at]), normal);
        fan(first, self.points.len()).map(shape).fold(f64::INFINITY, f64::min)
    }
}

/// The corners of the triangles of a fan around corner `first` of `count`.
fn fan(first: usize, count: usize) -> impl Iterator<Item = [usize; 3]> {
    let corner = move |at: usize| (first + at) % count;
    (1..count - 1).map(move |at| [first, corner(at), corner(at + 1)])
}

/// How good a triangle is: twice its area over the square of its longest edge, the height in
/// parts of the base. At most 0.87; negative where it faces away from `normal`, so that it folds.
fn shape([a, b, c]: [[f64; 3]; 3], normal: [f64; 3]) -> f64 {
    let (ab, ac, bc) = (sub(b, a), sub(c, a), sub(c, b));
    let longest = dot(ab, ab).max(dot(ac, ac)).max(dot(bc, bc));
    if longest > 0.0 { dot(cross(ab, ac), normal) / longest } else { 0.0 }
}
