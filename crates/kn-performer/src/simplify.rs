//! Quadric edge collapse (Garland and Heckbert 1997) to an exact number of vertices, like the last
//! step of scanning pipelines. The triangles are as uneven as those of a scan: large where cloth is
//! flat, small in folds and faces.
//!
//! Rounds instead of a heap: every round sorts all edges by cost and takes the cheapest that do
//! not touch each other, so that costs can be computed in parallel and ties never depend on it.

use super::net::Surface;
use glam::{DMat3, DVec3};
use kn_mesh::adjacency::{Rows, vertex_faces};
use rayon::prelude::*;

/// Share of the edges, from the cheapest, that a round may collapse.
const SHARE: f64 = 0.35;
/// Weight of keeping a new vertex at the middle of its edge, relative to the faces' area; it
/// decides where the surface is flat and the planes say nothing.
const CENTRING: f64 = 3e-4;

/// Edges shorter than this, in metres, are points.
const POINT: f64 = 2e-4;

/// Sum of squared distances to planes, weighted by area: xᵀ A x + 2 b·x + c.
#[derive(Clone, Copy, Debug)]
struct Quadric {
    a: DMat3,
    b: DVec3,
    c: f64,
    area: f64,
}

impl Quadric {
    const ZERO: Self = Self { a: DMat3::ZERO, b: DVec3::ZERO, c: 0.0, area: 0.0 };

    fn plane(corners: [DVec3; 3]) -> Self {
        let cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let area = cross.length() / 2.0;
        let normal = cross.normalize_or_zero();
        let offset = -normal.dot(corners[0]);
        let a = DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        Self { a: a * area, b: normal * (offset * area), c: offset * offset * area, area }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            a: self.a + other.a,
            b: self.b + other.b,
            c: self.c + other.c,
            area: self.area + other.area,
        }
    }

    /// The best point for the collapse of an edge around `middle`, and its cost.
    fn best(&self, middle: DVec3, length: f64) -> (f64, DVec3) {
        let weight = CENTRING * self.area;
        let a = self.a + DMat3::from_diagonal(DVec3::splat(weight));
        let way = a.inverse() * -(self.a * middle + self.b);
        let at = if way.is_finite() && way.length() < length { middle + way } else { middle };
        let planes = at.dot(self.a * at) + 2.0 * self.b.dot(at) + self.c;
        (
            planes.max(0.0)
                + weight * (at - middle).length_squared()
                + 1e-5 * self.area * length * length,
            at,
        )
    }
}

/// An edge that may go.
struct Collapse {
    cost: f64,
    /// Kept and removed vertex.
    ends: [u32; 2],
    at: DVec3,
    length: f64,
}

/// Collapses edges until `target` vertices are left, or none can go without tearing the surface.
pub(super) fn simplify(surface: &mut Surface, target: usize) {
    let mut quadrics = vertex_quadrics(surface);
    let mut count = surface.positions.len();
    while count > target {
        let around = vertex_faces(surface.positions.len(), &surface.faces);
        let collapses = cheapest(surface, &quadrics);
        let mut round =
            Round { around, touched: vec![false; surface.positions.len()], left: count - target };
        let before = round.left;
        round.run(surface, &mut quadrics, &collapses);
        surface.faces.retain(|f| f[0] != f[1] && f[1] != f[2] && f[2] != f[0]);
        count -= before - round.left;
        if before == round.left {
            break;
        }
    }
    surface.compact();
}

fn vertex_quadrics(surface: &Surface) -> Vec<Quadric> {
    let mut quadrics = vec![Quadric::ZERO; surface.positions.len()];
    for face in &surface.faces {
        let plane = Quadric::plane(face.map(|v| surface.positions[v as usize]));
        for &v in face {
            quadrics[v as usize] = quadrics[v as usize].plus(plane);
        }
    }
    quadrics
}

fn cheapest(surface: &Surface, quadrics: &[Quadric]) -> Vec<Collapse> {
    let edges = surface.faces.iter().flat_map(|f| [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]]);
    // Both directions of an edge occur: the surface is closed.
    let edges: Vec<[u32; 2]> = edges.filter(|e| e[0] < e[1]).collect();
    let mut collapses: Vec<Collapse> = edges
        .into_par_iter()
        .map(|ends| {
            let [a, b] = ends.map(|v| surface.positions[v as usize]);
            let quadric = quadrics[ends[0] as usize].plus(quadrics[ends[1] as usize]);
            let length = (a - b).length();
            let (cost, at) = quadric.best((a + b) / 2.0, length);
            Collapse { cost, ends, at, length }
        })
        .collect();
    let order = |a: &Collapse, b: &Collapse| a.cost.total_cmp(&b.cost).then(a.ends.cmp(&b.ends));
    let share = (SHARE * collapses.len() as f64) as usize;
    if share < collapses.len() {
        collapses.select_nth_unstable_by(share, order);
        collapses.truncate(share + 1);
    }
    collapses.par_sort_unstable_by(order);
    collapses
}

/// Writes the neighbours of a vertex to `ring`. Each is found once: around a vertex of a
/// closed surface every neighbour follows it in exactly one face.
fn neighbours(surface: &Surface, around: &Rows, vertex: u32, ring: &mut Vec<u32>) {
    ring.clear();
    for &face in around.row(vertex as usize) {
        let [a, b, c] = surface.faces[face as usize];
        ring.push(if a == vertex {
            b
        } else if b == vertex {
            c
        } else {
            a
        });
    }
}

struct Round {
    /// Faces around every vertex, as they were when the round began.
    around: Rows,
    /// Vertices whose faces have changed in this round.
    touched: Vec<bool>,
    left: usize,
}

impl Round {
    fn run(&mut self, surface: &mut Surface, quadrics: &mut [Quadric], collapses: &[Collapse]) {
        let (mut a, mut b) = (Vec::new(), Vec::new());
        for collapse in collapses {
            if self.left == 0 {
                return;
            }
            let [keep, gone] = collapse.ends;
            if self.touched[keep as usize] || self.touched[gone as usize] {
                continue;
            }
            neighbours(surface, &self.around, keep, &mut a);
            neighbours(surface, &self.around, gone, &mut b);
            let fresh = a.iter().chain(&b).all(|&v| !self.touched[v as usize]);
            if fresh && links_meet_twice(&a, &b) && self.keeps_sides(surface, collapse) {
                for &v in a.iter().chain(&b) {
                    self.touched[v as usize] = true;
                }
                self.apply(surface, quadrics, collapse);
            }
        }
    }

    fn apply(&mut self, surface: &mut Surface, quadrics: &mut [Quadric], collapse: &Collapse) {
        let [keep, gone] = collapse.ends;
        for &face in self.around.row(gone as usize) {
            for corner in &mut surface.faces[face as usize] {
                if *corner == gone {
                    *corner = keep;
                }
            }
        }
        surface.positions[keep as usize] = collapse.at;
        quadrics[keep as usize] = quadrics[keep as usize].plus(quadrics[gone as usize]);
        self.left -= 1;
    }

    /// No face around the edge turns over or becomes a sliver.
    fn keeps_sides(&self, surface: &Surface, collapse: &Collapse) -> bool {
        // Ends so close that the faces between them have no side to keep.
        if collapse.length < POINT {
            return true;
        }
        let [keep, gone] = collapse.ends;
        let stays = |&face: &u32| {
            let corners = surface.faces[face as usize];
            if corners.contains(&keep) && corners.contains(&gone) {
                return true;
            }
            let old = corners.map(|v| surface.positions[v as usize]);
            let moved = corners.map(|v| v == keep || v == gone);
            let new: [DVec3; 3] =
                std::array::from_fn(|i| if moved[i] { collapse.at } else { old[i] });
            let normal = |p: [DVec3; 3]| (p[1] - p[0]).cross(p[2] - p[0]);
            let (before, after) = (normal(old), normal(new));
            // A sliver may stay one, or no way out of it would be open.
            let grows = shape(new) > f64::min(0.05, shape(old));
            before.dot(after) > 0.3 * before.length() * after.length() && grows
        };
        let (a, b) = (self.around.row(keep as usize), self.around.row(gone as usize));
        a.iter().chain(b).all(stays)
    }
}

/// Twice the area over the sum of squared sides: 0.29 for an equilateral triangle, 0 for a line.
fn shape(corners: [DVec3; 3]) -> f64 {
    let double_area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
    let sides = |i: usize| (corners[i] - corners[(i + 1) % 3]).length_squared();
    double_area / (sides(0) + sides(1) + sides(2)).max(f64::MIN_POSITIVE)
}

/// The link condition of a closed manifold: the ends of an edge share the two vertices opposite
/// to it and no other.
fn links_meet_twice(a: &[u32], b: &[u32]) -> bool {
    a.iter().filter(|v| b.contains(v)).count() == 2 && a.len() + b.len() > 7
}
