//! Triangulation of one polygon in its plane: constrained Delaunay, by spade.

use kn_mesh::vec3::{cross, dot};
use spade::handles::FixedUndirectedEdgeHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use std::collections::HashMap;

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Cuts a polygon (`n × 3` points of magnitude 1) into triangles that fill it in the plane with this
/// unit normal, and face along it. Corners on a straight edge are corners of triangles too. What a
/// doubled edge joins to the rim is a hole.
///
/// `None` where the edges cross each other or enclose nothing.
pub(super) fn triangulate(points: &[[f64; 3]], normal: [f64; 3]) -> Option<Vec<[usize; 3]>> {
    let mut delaunay = Delaunay::new();
    let mut corners = Vec::with_capacity(points.len());
    // The polygon's corner of each vertex of the triangulation: the first at its place.
    let mut sources = Vec::with_capacity(points.len());
    let mut known = HashMap::new();
    for (corner, point) in plane_of(points, normal).enumerate() {
        let vertex = match known.get(&point.map(f64::to_bits)) {
            Some(&vertex) => vertex,
            None => {
                let vertex = delaunay.insert(Point2::new(point[0], point[1])).ok()?;
                sources.push(corner);
                known.insert(point.map(f64::to_bits), vertex);
                vertex
            }
        };
        corners.push(vertex);
    }
    let mut walls = Vec::with_capacity(points.len());
    for (at, &from) in corners.iter().enumerate() {
        let to = corners[(at + 1) % corners.len()];
        if from != to {
            let edges = delaunay.try_add_constraint(from, to);
            if edges.is_empty() {
                return None;
            }
            walls.extend(edges.into_iter().map(|edge| edge.as_undirected()));
        }
    }
    let inside = faces_inside(&delaunay, &walls);
    (!inside.is_empty()).then(|| {
        let corners = |face: &[usize; 3]| face.map(|vertex| sources[vertex]);
        inside.iter().map(corners).collect()
    })
}

/// The coordinates of points in the plane with this normal, counter-clockwise seen against it.
fn plane_of(points: &[[f64; 3]], normal: [f64; 3]) -> impl Iterator<Item = [f64; 2]> {
    let least = (0..3).min_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let across = cross(axis, normal);
    let length = dot(across, across).sqrt();
    let u = across.map(|x| x / length);
    let v = cross(normal, u);
    // spade refuses numbers near the smallest; adding 0 turns −0 into 0.
    let snap = |x: f64| if x.abs() < 1e-30 { 0.0 } else { x };
    points.iter().map(move |point| [snap(dot(*point, u)), snap(dot(*point, v))])
}

/// The vertices of the triangles that an odd number of walls parts from the outside.
fn faces_inside(delaunay: &Delaunay, walls: &[FixedUndirectedEdgeHandle]) -> Vec<[usize; 3]> {
    let mut is_wall = vec![false; delaunay.num_undirected_edges()];
    // A doubled edge is not a wall.
    walls.iter().for_each(|edge| is_wall[edge.index()] ^= true);
    // Over each face: whether it is inside, once that is known.
    let mut sides = vec![None; delaunay.num_all_faces()];
    sides[delaunay.outer_face().index()] = Some(false);
    let mut inside = Vec::new();
    let mut open: Vec<_> = delaunay.convex_hull().collect();
    open.iter_mut().filter(|edge| !edge.is_outer_edge()).for_each(|edge| *edge = edge.rev());
    while let Some(edge) = open.pop() {
        // `edge` borders on a known face. Its other side is the next one.
        let (known, next) = (edge.face(), edge.rev().face());
        if sides[next.index()].is_some() {
            continue;
        }
        let crosses = is_wall[edge.as_undirected().fix().index()];
        let side = sides[known.index()].map(|side: bool| side ^ crosses);
        sides[next.index()] = side;
        let Some(face) = next.as_inner() else { continue };
        if side == Some(true) {
            inside.push(face.vertices().map(|vertex| vertex.fix().index()));
        }
        open.extend(face.adjacent_edges());
    }
    inside
}
