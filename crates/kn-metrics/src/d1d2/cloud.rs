//! Points with normals, and the BVH over them.

use super::{Grid, PointError};
use crate::bvh::{self, Bounds, Item, Node};
use crate::p2s::samples_on_faces;
use crate::tree::check;
use kn_mesh::vec3::{Vec3, cross, mul_add, norm, scale, sub};

/// Points of a leaf.
const CAPACITY: usize = 8;

/// Beyond this the square of a coordinate leaves binary32.
const LARGEST: f32 = 1e18;

/// Points with normals. No two points are at the same place.
pub struct PointCloud {
    /// In the order of the leaves: neighbours in the list are neighbours in space.
    points: Vec<[f32; 3]>,
    /// Unit, or zero where undefined.
    normals: Vec<Vec3>,
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
}

/// A range of the points.
#[derive(Clone, Copy, Debug)]
struct Leaf {
    start: u32,
    count: u32,
}

/// A point and its place in a list of normals.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub(super) position: [f32; 3],
    pub(super) normal: u32,
}

impl Sample {
    /// Coordinates are rounded to binary32, in which MPEG's tools hold them: it decides what is at
    /// the same place and which neighbours are equally near.
    pub(super) fn new(position: Vec3, normal: usize) -> Self {
        // The sum makes a negative zero positive.
        Self { position: position.map(|x| x as f32 + 0.0), normal: normal as u32 }
    }
}

impl PointCloud {
    /// Makes points of the vertices, with normals weighted by the area of the faces around (`#V ×
    /// 3`, `#F × 3`).
    ///
    /// # Errors
    /// The errors of [`TriangleTree::new`](crate::TriangleTree::new), or a coordinate beyond ±1e18.
    pub fn from_vertices(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<Self, PointError> {
        check(positions, faces)?;
        Self::merged(vertices(positions), &vertex_normals(positions, faces))
    }

    /// Makes points of the vertices, and of about `samples` points that are spread evenly over the
    /// surface, with their faces' normals.
    ///
    /// # Errors
    /// The errors of [`from_vertices`](Self::from_vertices), or the surface has no area.
    pub fn from_surface(
        positions: &[[f64; 3]],
        faces: &[[u32; 3]],
        samples: usize,
    ) -> Result<Self, PointError> {
        let on_faces = samples_on_faces(positions, faces, None, samples)?;
        let mut normals = vertex_normals(positions, faces);
        normals.extend(faces.iter().map(|face| face_normal(positions, face)));
        let mut points = vertices(positions);
        let on_faces = on_faces.into_iter();
        points.extend(
            on_faces.map(|(face, point)| Sample::new(point, positions.len() + face as usize)),
        );
        Self::merged(points, &normals)
    }

    /// Makes points where the lines of a grid meet the faces, with the faces' normals.
    ///
    /// # Errors
    /// The errors of [`from_vertices`](Self::from_vertices), no hit, or too many hits.
    pub fn from_grid(
        positions: &[[f64; 3]],
        faces: &[[u32; 3]],
        grid: &Grid,
    ) -> Result<Self, PointError> {
        check(positions, faces)?;
        let hits = grid.hits(positions, faces)?;
        if hits.is_empty() {
            return Err(PointError::NoPoints);
        }
        let normals: Vec<Vec3> = faces.iter().map(|face| face_normal(positions, face)).collect();
        Self::merged(hits, &normals)
    }

    /// Points at the same place become one with the mean of their normals. There is at least one
    /// point.
    pub(super) fn merged(mut points: Vec<Sample>, normals: &[Vec3]) -> Result<Self, PointError> {
        let small = |point: &Sample| point.position.iter().all(|x| x.abs() <= LARGEST);
        if !points.iter().all(small) {
            return Err(PointError::TooLarge);
        }
        points.sort_unstable_by(|a, b| {
            let axis = |axis: usize| a.position[axis].total_cmp(&b.position[axis]);
            axis(0).then_with(|| axis(1)).then_with(|| axis(2)).then(a.normal.cmp(&b.normal))
        });
        let (mut unique, mut means) = (Vec::new(), Vec::new());
        for same in points.chunk_by(|a, b| a.position == b.position) {
            let normal = |sample: &Sample| normals[sample.normal as usize];
            let sum = same.iter().fold([0.0; 3], |sum, one| mul_add(sum, 1.0, normal(one)));
            unique.push(same[0].position);
            means.push(unit(sum));
        }
        Ok(Self::indexed(&unique, &means))
    }

    /// Builds the BVH and brings the points into its order.
    fn indexed(points: &[[f32; 3]], normals: &[Vec3]) -> Self {
        let item = |(index, &point): (usize, &[f32; 3])| {
            let mut bounds = Bounds::EMPTY;
            bounds.include(point);
            Item { bounds, index: index as u32 }
        };
        let mut items: Vec<Item> = points.iter().enumerate().map(item).collect();
        let mut leaves = Vec::new();
        let nodes = bvh::build(&mut items, CAPACITY, |start, items| {
            leaves.push(Leaf { start: start as u32, count: items.len() as u32 });
        });
        Self {
            points: items.iter().map(|item| points[item.index as usize]).collect(),
            normals: items.iter().map(|item| normals[item.index as usize]).collect(),
            nodes,
            leaves,
        }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there are no points. A cloud always has points, so this is false.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    pub(super) fn points(&self) -> &[[f32; 3]] {
        &self.points
    }

    pub(super) fn normals(&self) -> &[Vec3] {
        &self.normals
    }

    pub(super) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The indices of a leaf's points, and the points.
    #[inline]
    pub(super) fn leaf(&self, leaf: usize) -> impl Iterator<Item = (u32, [f32; 3])> {
        let Leaf { start, count } = self.leaves[leaf];
        let points = &self.points[start as usize..][..count as usize];
        (start..).zip(points.iter().copied())
    }
}

fn vertices(positions: &[Vec3]) -> Vec<Sample> {
    positions.iter().enumerate().map(|(vertex, &position)| Sample::new(position, vertex)).collect()
}

/// `#V` sums of the normals of the faces around, each as long as twice its face's area.
fn vertex_normals(positions: &[Vec3], faces: &[[u32; 3]]) -> Vec<Vec3> {
    let mut normals = vec![[0.0; 3]; positions.len()];
    for face in faces {
        let [a, b, c] = face.map(|vertex| positions[vertex as usize]);
        let normal = cross(sub(b, a), sub(c, a));
        for &vertex in face {
            let sum = &mut normals[vertex as usize];
            *sum = mul_add(*sum, 1.0, normal);
        }
    }
    normals.into_iter().map(unit).collect()
}

/// Zero for a face without area.
fn face_normal(positions: &[Vec3], face: &[u32; 3]) -> Vec3 {
    let [a, b, c] = face.map(|vertex| positions[vertex as usize]);
    unit(cross(sub(b, a), sub(c, a)))
}

fn unit(vector: Vec3) -> Vec3 {
    let length = norm(vector);
    if length > 0.0 { scale(vector, 1.0 / length) } else { [0.0; 3] }
}
