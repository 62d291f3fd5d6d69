//! How far two meshes are apart, as `kn compare`, `kn rd` and `kn demo` report it.

use anyhow::{Context, Result};
use kn_mesh::{BoundingBox, Mesh};
use kn_metrics::{
    Closest, DEFAULT_LEVELS, Distances, Grid, Interpolation, Msdm2Surface, P2s, PointCloud,
    TriangleTree, distances_to_surface, msdm2, p2s, point_distortion, sample_surface,
};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;
use std::collections::BTreeMap;

/// Area-uniform samples on each surface for point-to-surface distances.
const SAMPLES: usize = 100_000;

/// Lines of the grid along the longest side, on which D1 and D2 sample the surfaces.
const GRID_SIZE: usize = 1024;

/// A number that says how far two meshes are apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Metric {
    /// Point-to-surface RMS of the worse direction, relative to the diagonal.
    P2sRms,
    /// The same in world units.
    P2sRmsWorld,
    /// 10·log10(3·side²/rms²); infinite where the surfaces are equal.
    P2sPsnr,
    /// Largest distance found, relative to the diagonal.
    Hausdorff,
    /// The same in world units.
    HausdorffWorld,
    /// The mean of both directions: 0 for equal, below 1.
    Msdm2,
    /// The first mesh is the reference.
    Msdm2Ab,
    /// The second mesh is the reference.
    Msdm2Ba,
    /// Symmetric, with the curvature at the closest points: independent of the order of faces.
    Msdm2Projected,
    /// Point to point on grid samples.
    D1Psnr,
    /// Point to plane on grid samples.
    D2Psnr,
}

impl Metric {
    pub(crate) const ALL: [Self; 11] = [
        Self::P2sRms,
        Self::P2sRmsWorld,
        Self::P2sPsnr,
        Self::Hausdorff,
        Self::HausdorffWorld,
        Self::Msdm2,
        Self::Msdm2Ab,
        Self::Msdm2Ba,
        Self::Msdm2Projected,
        Self::D1Psnr,
        Self::D2Psnr,
    ];

    /// Its name in JSON and CSV.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::P2sRms => "p2s_rms",
            Self::P2sRmsWorld => "p2s_rms_world",
            Self::P2sPsnr => "p2s_psnr",
            Self::Hausdorff => "hausdorff",
            Self::HausdorffWorld => "hausdorff_world",
            Self::Msdm2 => "msdm2",
            Self::Msdm2Ab => "msdm2_ab",
            Self::Msdm2Ba => "msdm2_ba",
            Self::Msdm2Projected => "msdm2_projected",
            Self::D1Psnr => "d1_psnr",
            Self::D2Psnr => "d2_psnr",
        }
    }
}

/// What was measured on one frame, or the mean of several.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Distortion([Option<f64>; Metric::ALL.len()]);

impl Distortion {
    /// A value, where it was measured.
    pub(crate) fn get(&self, metric: Metric) -> Option<f64> {
        self.0[metric as usize]
    }

    fn set(&mut self, metric: Metric, value: f64) {
        self.0[metric as usize] = Some(value);
    }

    fn set_distance(&mut self, distance: &P2s, scale: &Scale) {
        self.set(Metric::P2sRms, distance.rms() / scale.diagonal());
        self.set(Metric::P2sRmsWorld, distance.rms());
        self.set(Metric::P2sPsnr, distance.psnr(scale.side()));
        self.set(Metric::Hausdorff, distance.hausdorff() / scale.diagonal());
        self.set(Metric::HausdorffWorld, distance.hausdorff());
    }

    /// The mean of each number that all have; `None` where there is nothing to take it of.
    pub(crate) fn mean<'d>(all: impl IntoIterator<Item = &'d Self>) -> Option<Self> {
        let all: Vec<&Self> = all.into_iter().collect();
        let mean = |metric| {
            let sum: Option<f64> = all.iter().map(|one| one.get(metric)).sum();
            sum.map(|sum| sum / all.len() as f64)
        };
        (!all.is_empty()).then(|| Self(Metric::ALL.map(mean)))
    }
}

impl<'de> Deserialize<'de> for Distortion {
    /// JSON has no infinity: null is what decibels of equal meshes become.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let values = BTreeMap::<String, Value>::deserialize(deserializer)?;
        let number = |value: &Value| match value {
            Value::Null => Some(f64::INFINITY),
            value => value.as_f64(),
        };
        Ok(Self(Metric::ALL.map(|metric| number(values.get(metric.name())?))))
    }
}

impl Serialize for Distortion {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let measured = Metric::ALL.into_iter().filter_map(|m| Some((m.name(), self.get(m)?)));
        serializer.collect_map(measured)
    }
}

/// What relative distances and decibels refer to: the box of the whole reference sequence.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    bounds: BoundingBox,
}

impl From<BoundingBox> for Scale {
    fn from(bounds: BoundingBox) -> Self {
        Self { bounds }
    }
}

impl Scale {
    /// Longest side, world units: the peak of decibels.
    pub(crate) fn side(&self) -> f64 {
        self.bounds.longest_side()
    }

    /// Diagonal, world units: the unit of relative distances.
    pub(crate) fn diagonal(&self) -> f64 {
        self.bounds.diagonal()
    }
}

/// What to measure beside point-to-surface distances.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Measures {
    /// MSDM2 in both directions.
    pub(crate) msdm2: bool,
    /// MSDM2 with the curvature at the closest points, where MSDM2 is measured.
    pub(crate) projected: bool,
    /// D1 and D2.
    pub(crate) points: bool,
}

impl Measures {
    pub(crate) const DISTANCE: Self = Self { msdm2: false, projected: false, points: false };
    pub(crate) const PERCEPTUAL: Self = Self { msdm2: true, ..Self::DISTANCE };
    pub(crate) const ALL: Self = Self { msdm2: true, projected: true, points: true };
}

/// A mesh prepared for measuring: it costs a tree, and for MSDM2 the curvature.
pub(crate) struct Surface {
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    prepared: Prepared,
}

/// What measuring needs of a mesh; MSDM2 brings its tree.
enum Prepared {
    Distance(TriangleTree),
    Perceptual(Box<Msdm2Surface>),
}

impl Surface {
    /// Prepares a mesh.
    pub(crate) fn new(mesh: &Mesh, measures: Measures) -> Result<Self> {
        let (positions, faces) = (mesh.positions_f64(), mesh.faces.clone());
        let prepared = if measures.msdm2 {
            let surface = Msdm2Surface::new(&positions, &faces, DEFAULT_LEVELS)?;
            Prepared::Perceptual(Box::new(surface))
        } else {
            Prepared::Distance(TriangleTree::new(&positions, &faces)?)
        };
        Ok(Self { positions, faces, prepared })
    }

    fn tree(&self) -> &TriangleTree {
        match &self.prepared {
            Prepared::Distance(tree) => tree,
            Prepared::Perceptual(surface) => surface.tree(),
        }
    }

    fn perceptual(&self) -> Option<&Msdm2Surface> {
        match &self.prepared {
            Prepared::Distance(_) => None,
            Prepared::Perceptual(surface) => Some(surface),
        }
    }

    /// Values of MSDM2 on the vertices of both, `other` against this one: `#V` of this one, `#V` of
    /// `other`. `None` where either is not prepared for MSDM2.
    pub(crate) fn local_msdm2(&self, other: &Self) -> Option<[Vec<f64>; 2]> {
        let (reference, other) = (self.perceptual()?, other.perceptual()?);
        let found = msdm2(reference, other, Interpolation::AtVertex);
        Some([found.backward.local, found.forward.local])
    }

    /// `#V of other` distances from the vertices of `other` to this surface, world units.
    pub(crate) fn distances_of(&self, other: &Self) -> Vec<f64> {
        let distance = |closest: Closest| closest.distance_squared.sqrt();
        self.tree().closest_all(&other.positions).into_iter().map(distance).collect()
    }
}

/// Measures `other` against `reference`; both are prepared for these measures.
pub(crate) fn measure(
    reference: &Surface,
    other: &Surface,
    scale: &Scale,
    measures: Measures,
) -> Result<Distortion> {
    let mut distortion = Distortion::default();
    measure_distance(reference, other, scale, &mut distortion)?;
    if measures.msdm2 {
        measure_msdm2(reference, other, measures, &mut distortion);
    }
    if measures.points {
        measure_points(reference, other, scale, &mut distortion)?;
    }
    Ok(distortion)
}

/// Measures one body part: points of its faces on each side against the whole other surface.
/// `parts` holds a mark per face (`#F`) of either side.
pub(crate) fn measure_part(
    reference: &Surface,
    other: &Surface,
    parts: [&[bool]; 2],
    scale: &Scale,
) -> Result<Distortion> {
    let distances = |from: &Surface, part: &[bool], to: &Surface| -> Result<Distances> {
        let points = sample_surface(&from.positions, &from.faces, Some(part), SAMPLES)?;
        Ok(distances_to_surface(&points, None, to.tree())?)
    };
    let distance = P2s {
        from_reference: distances(reference, parts[0], other)?,
        from_other: distances(other, parts[1], reference)?,
    };
    let mut distortion = Distortion::default();
    distortion.set_distance(&distance, scale);
    Ok(distortion)
}

fn measure_distance(
    reference: &Surface,
    other: &Surface,
    scale: &Scale,
    distortion: &mut Distortion,
) -> Result<()> {
    let distance = p2s(
        (&reference.positions, &reference.faces, reference.tree()),
        (&other.positions, &other.faces, other.tree()),
        SAMPLES,
    )?;
    distortion.set_distance(&distance, scale);
    Ok(())
}

fn measure_msdm2(
    reference: &Surface,
    other: &Surface,
    measures: Measures,
    distortion: &mut Distortion,
) {
    let (Some(reference), Some(other)) = (reference.perceptual(), other.perceptual()) else {
        return;
    };
    let plain = msdm2(reference, other, Interpolation::AtVertex);
    distortion.set(Metric::Msdm2, plain.symmetric);
    distortion.set(Metric::Msdm2Ab, plain.forward.score);
    distortion.set(Metric::Msdm2Ba, plain.backward.score);
    if measures.projected {
        let projected = msdm2(reference, other, Interpolation::Projected);
        distortion.set(Metric::Msdm2Projected, projected.symmetric);
    }
}

fn measure_points(
    reference: &Surface,
    other: &Surface,
    scale: &Scale,
    distortion: &mut Distortion,
) -> Result<()> {
    let grid = Grid::new(scale.bounds.min, scale.bounds.max, GRID_SIZE).context("D1 and D2")?;
    let cloud = |surface: &Surface| {
        PointCloud::from_grid(&surface.positions, &surface.faces, &grid).context("D1 and D2")
    };
    let points = point_distortion(&cloud(reference)?, &cloud(other)?);
    distortion.set(Metric::D1Psnr, points.d1_psnr(scale.side()));
    distortion.set(Metric::D2Psnr, points.d2_psnr(scale.side()));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bent sheet of `n × n` squares of side 1 / n, moved by `z`.
    fn sheet(n: u32, z: f32) -> Mesh {
        let at = |i: u32| (i % (n + 1), i / (n + 1));
        let position = |i| {
            let (x, y) = at(i);
            let (x, y) = (x as f32 / n as f32, y as f32 / n as f32);
            [x, y, z + 0.1 * (5.0 * x).sin()]
        };
        let corner = |i: u32| i % n + i / n * (n + 1);
        let faces =
            (0..n * n).map(corner).flat_map(|c| [[c, c + 1, c + n + 2], [c, c + n + 2, c + n + 1]]);
        Mesh::new((0..(n + 1) * (n + 1)).map(position).collect(), faces.collect())
    }

    fn distortion(a: &Mesh, b: &Mesh) -> Distortion {
        let scale = Scale::from(a.bounding_box().expect("a box"));
        let measures = Measures::PERCEPTUAL;
        let surfaces = [a, b].map(|mesh| Surface::new(mesh, measures).expect("a surface"));
        measure(&surfaces[0], &surfaces[1], &scale, measures).expect("measured")
    }

    #[test]
    fn a_moved_sheet_is_as_far_as_it_was_moved() {
        let (a, b) = (sheet(20, 0.0), sheet(20, 0.01));
        let found = distortion(&a, &b);
        let rms = found.get(Metric::P2sRmsWorld).expect("measured");
        assert!((0.008..=0.010).contains(&rms), "{rms}");
        let relative = found.get(Metric::P2sRms).expect("measured");
        let diagonal = a.bounding_box().expect("a box").diagonal();
        assert!((relative * diagonal - rms).abs() < 1e-12);
        assert!(found.get(Metric::Msdm2).is_some() && found.get(Metric::D1Psnr).is_none());
    }

    #[test]
    fn equal_meshes_are_at_no_distance() {
        let found = distortion(&sheet(8, 0.0), &sheet(8, 0.0));
        // A sample inside a face is on it up to the last bits.
        assert!(found.get(Metric::P2sRms).is_some_and(|rms| rms < 1e-15));
        assert!(found.get(Metric::P2sPsnr).is_some_and(|psnr| psnr > 250.0));
        assert!(found.get(Metric::Msdm2).is_some_and(|msdm2| msdm2 < 1e-6));
    }

    #[test]
    fn means_are_of_what_all_have() {
        let mut one = Distortion::default();
        one.set(Metric::P2sRms, 1.0);
        one.set(Metric::Msdm2, 0.5);
        let mut two = Distortion::default();
        two.set(Metric::P2sRms, 3.0);
        let mean = Distortion::mean([&one, &two]).expect("two");
        assert_eq!((mean.get(Metric::P2sRms), mean.get(Metric::Msdm2)), (Some(2.0), None));
        assert_eq!(Distortion::mean([]), None);
        assert_eq!(serde_json::to_string(&mean).expect("JSON"), r#"{"p2s_rms":2.0}"#);
        let read = |text: &str| serde_json::from_str::<Distortion>(text).expect("a distortion");
        assert_eq!(read(r#"{"p2s_rms":2.0,"x":"y"}"#), mean);
        assert_eq!(read(r#"{"d1_psnr":null}"#).get(Metric::D1Psnr), Some(f64::INFINITY));
    }
}
