//! The nearest points of one cloud for each point of another.

use rayon::prelude::*;

use super::PointCloud;
use crate::bvh::{Lanes, Patience, Query, Search, descend};
use kn_mesh::adjacency::Rows;
use kn_mesh::vec3::{Vec3, distance_squared, dot, sub};

/// Points that share hints and a thread.
const CHUNK: usize = 1024;

/// Largest factor by which a squared distance may exceed the smallest one and still count as equal.
const EQUAL: f64 = 1.0 + 1e-9;

/// More equally near points are left out. MPEG's tool has the same bound.
const MOST_EQUAL: usize = 30;

/// Squared distances of boxes in binary32 are at most this factor too large.
const ROUNDING: f64 = 1.0 + 1e-6;

/// The nearest points of one cloud for each point of another.
pub(super) struct Neighbours {
    /// Squared.
    distances: Vec<f64>,
    /// Per point all that are equally near, in ascending order.
    nearest: Rows,
}

impl Neighbours {
    pub(super) fn new(from: &PointCloud, to: &PointCloud) -> Self {
        let chunks: Vec<Self> =
            from.points().par_chunks(CHUNK).map(|points| Self::of_chunk(points, to)).collect();
        let mut all = Self { distances: Vec::with_capacity(from.len()), nearest: Rows::default() };
        all.nearest.restart();
        for chunk in chunks {
            all.distances.extend(chunk.distances);
            for row in chunk.nearest.iter() {
                all.nearest.values.extend_from_slice(row);
                all.nearest.end_row();
            }
        }
        all
    }

    /// Each point takes the answer for the last one as its hint.
    fn of_chunk(points: &[[f32; 3]], to: &PointCloud) -> Self {
        let mut found = Self { distances: Vec::new(), nearest: Rows::default() };
        found.nearest.restart();
        let mut hint = 0;
        for &point in points {
            let nearest = Nearest::find(to, point, hint);
            hint = nearest.index;
            let start = found.nearest.values.len();
            found.nearest.values.push(nearest.index);
            if nearest.rival <= nearest.distance * EQUAL {
                Equal::collect(to, point, nearest.distance, &mut found.nearest.values);
            }
            found.nearest.values[start..].sort_unstable();
            found.nearest.end_row();
            found.distances.push(nearest.distance);
        }
        found
    }

    pub(super) fn nearest(&self, point: usize) -> &[u32] {
        self.nearest.row(point)
    }

    /// For each of `count` points of the other cloud the points that it is nearest to, ascending.
    pub(super) fn transposed(&self, count: usize) -> Rows {
        let mut offsets = vec![0u32; count + 1];
        self.nearest.values.iter().for_each(|&index| offsets[index as usize + 1] += 1);
        for i in 0..count {
            offsets[i + 1] += offsets[i];
        }
        let mut place = offsets.clone();
        let mut values = vec![0; self.nearest.values.len()];
        for (point, nearest) in self.nearest.iter().enumerate() {
            for &index in nearest {
                let place = &mut place[index as usize];
                values[*place as usize] = point as u32;
                *place += 1;
            }
        }
        Rows { offsets, values }
    }

    pub(super) fn mean_square(&self) -> f64 {
        self.distances.iter().sum::<f64>() / self.distances.len() as f64
    }

    pub(super) fn mean_square_to_planes(
        &self,
        from: &PointCloud,
        to: &PointCloud,
        normals: &[Vec3],
    ) -> f64 {
        let mut sum = 0.0;
        for (&point, nearest) in from.points().iter().zip(self.nearest.iter()) {
            let to_plane = |&index: &u32| {
                let along = sub(wide(to.points()[index as usize]), wide(point));
                dot(along, normals[index as usize]).powi(2)
            };
            sum += nearest.iter().map(to_plane).sum::<f64>() / nearest.len() as f64;
        }
        sum / from.len() as f64
    }
}

fn wide(point: [f32; 3]) -> Vec3 {
    point.map(f64::from)
}

/// A search for the nearest point.
struct Nearest<'c> {
    cloud: &'c PointCloud,
    point: Vec3,
    index: u32,
    /// Squared.
    distance: f64,
    /// The next smallest squared distance that was met. All points that are equally near are met.
    rival: f64,
    patience: Patience,
    limit: f32,
}

impl<'c> Nearest<'c> {
    fn find(cloud: &'c PointCloud, point: [f32; 3], hint: u32) -> Self {
        let from = wide(point);
        let mut search = Self {
            cloud,
            point: from,
            index: hint,
            distance: distance_squared(from, wide(cloud.points()[hint as usize])),
            rival: f64::INFINITY,
            patience: Patience::FULL,
            limit: 0.0,
        };
        search.set_limit();
        descend(cloud.nodes(), &query(point), &mut search);
        search
    }

    #[inline]
    fn set_limit(&mut self) {
        let part = self.patience.part();
        self.limit = (self.distance * part * part * ROUNDING) as f32;
    }
}

impl Search for Nearest<'_> {
    #[inline]
    fn limit(&self) -> f32 {
        self.limit
    }

    #[inline]
    fn visit(&mut self, leaf: usize) {
        for (index, point) in self.cloud.leaf(leaf) {
            let distance = distance_squared(self.point, wide(point));
            if distance < self.distance {
                (self.rival, self.distance, self.index) = (self.distance, distance, index);
                self.set_limit();
            } else if distance < self.rival && index != self.index {
                self.rival = distance;
            }
        }
    }

    fn hurry(&mut self) {
        self.patience = self.patience.less();
        self.set_limit();
    }
}

/// A search for the points that are as near as the nearest one, which `found` ends with.
struct Equal<'f> {
    cloud: &'f PointCloud,
    point: Vec3,
    nearest: u32,
    /// Squared.
    reach: f64,
    found: &'f mut Vec<u32>,
    room: usize,
    limit: f32,
}

impl<'f> Equal<'f> {
    fn collect(cloud: &'f PointCloud, point: [f32; 3], distance: f64, found: &'f mut Vec<u32>) {
        let reach = distance * EQUAL;
        let mut search = Self {
            cloud,
            point: wide(point),
            nearest: *found.last().unwrap_or(&0),
            reach,
            found,
            room: MOST_EQUAL - 1,
            limit: (reach * ROUNDING) as f32,
        };
        descend(cloud.nodes(), &query(point), &mut search);
    }
}

impl Search for Equal<'_> {
    #[inline]
    fn limit(&self) -> f32 {
        self.limit
    }

    fn visit(&mut self, leaf: usize) {
        for (index, point) in self.cloud.leaf(leaf) {
            let near = distance_squared(self.point, wide(point)) <= self.reach;
            if near && index != self.nearest && self.room > 0 {
                self.found.push(index);
                self.room -= 1;
            }
        }
        if self.room == 0 {
            self.limit = 0.0;
        }
    }

    fn hurry(&mut self) {
        self.limit = 0.0;
    }
}

fn query(point: [f32; 3]) -> Query {
    point.map(Lanes::splat)
}
