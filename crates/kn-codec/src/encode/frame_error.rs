//! The distance between a decoded frame and its scan, and the bound that every P-frame keeps.
//!
//! The measures of the fit see the deformed reference before its motion is quantised, and they allow
//! more on coarse meshes. The bound holds for every mesh: it is about what a decoder shows.

use crate::encode::failure::FitFailure;
use crate::encode::tuning::ErrorTuning;
use kn_mesh::adjacency::Components;
use kn_mesh::vec3::{Vec3, add, cross, norm, scale, sub};
use kn_metrics::{IndexedMesh, MeshRef, TreeError, TriangleTree, sample_surface};
use std::collections::BTreeMap;

/// The distance between a decoded frame and its scan, or a bound for it. Both are shares of the
/// scan's size: the diagonal of the box that holds its surface but for 2 % on each axis, or all but
/// 2 % of its faces where that is smaller.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameError {
    /// RMS distance, the largest of four: in both directions, of points that are spread by area and
    /// of the corners and centres of faces. Specks are left out: components of less than 1 % of the
    /// area in meshes of 2,000 faces and more.
    pub rms: f64,
    /// The worst region of far points: its RMS distance times the square root of its share of its
    /// mesh's area, which is its part of the RMS distance of the whole. Far points are beyond the
    /// bound for `rms`. Specks count here.
    pub region: f64,
}

/// The measured error of a P-frame within its bound.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured {
    pub(crate) error: FrameError,
    pub(crate) bound: FrameError,
}

/// Judges P-frames by their distance from the scan, relative to their GoF's I-frame. Lengths are
/// grid steps.
pub(crate) struct ErrorBound {
    /// The setting: by how much a P-frame may be farther from its scan than its I-frame, as a share
    /// of the scan's size.
    excess: f64,
    tuning: ErrorTuning,
    /// RMS distance of the GoF's I-frame from its scan, at least a grid step.
    intra: f64,
}

impl ErrorBound {
    pub(crate) fn new(excess: f64, tuning: ErrorTuning) -> Self {
        Self { excess, tuning, intra: 1.0 }
    }

    /// Begins a GoF: measures its I-frame, which is what its P-frames are compared with.
    ///
    /// # Errors
    /// A mesh that cannot be searched.
    pub(crate) fn begin(
        &mut self,
        scan: MeshRef<'_>,
        decoded: MeshRef<'_>,
    ) -> Result<(), TreeError> {
        let tree = TriangleTree::new(scan.positions, scan.faces)?;
        let distances = Distances::new(IndexedMesh::new(scan, &tree), decoded, &self.tuning)?;
        self.intra = distances.rms().max(1.0);
        Ok(())
    }

    /// The error of a decoded P-frame, or a failure where it is beyond the bound.
    ///
    /// # Errors
    /// A mesh that cannot be searched.
    pub(crate) fn judge(
        &self,
        scan: IndexedMesh<'_>,
        decoded: MeshRef<'_>,
    ) -> Result<Result<Measured, FitFailure>, TreeError> {
        let distances = Distances::new(scan, decoded, &self.tuning)?;
        let size = distances.size;
        let limit = self.intra + self.excess * size;
        let (rms, region) = (distances.rms(), distances.worst_region(limit, &self.tuning));
        let share = |length: f64| length / size.max(1.0);
        let error = FrameError { rms: share(rms), region: share(region.part()) };
        let bound =
            FrameError { rms: share(limit), region: share(self.tuning.region_bound * limit) };
        Ok(if error.rms > bound.rms {
            Err(FitFailure::Distant { rms: error.rms, bound: bound.rms })
        } else if error.region > bound.region {
            let distance = share(region.rms());
            Err(FitFailure::DistantRegion { share: region.share, distance, bound: bound.region })
        } else {
            Ok(Measured { error, bound })
        })
    }
}

/// Distances between two surfaces.
struct Distances {
    from_scan: Directed,
    from_decoded: Directed,
    /// The scan's size.
    size: f64,
}

impl Distances {
    fn new(
        scan: IndexedMesh<'_>,
        decoded: MeshRef<'_>,
        tuning: &ErrorTuning,
    ) -> Result<Self, TreeError> {
        let tree = TriangleTree::new(decoded.positions, decoded.faces)?;
        let (from_scan, from_decoded) = rayon::join(
            || Directed::new(scan.mesh, &tree, tuning),
            || Directed::new(decoded, scan.tree, tuning),
        );
        Ok(Self { size: from_scan.size(tuning.trimmed), from_scan, from_decoded })
    }

    fn rms(&self) -> f64 {
        self.from_scan.rms().max(self.from_decoded.rms())
    }

    fn worst_region(&self, far: f64, tuning: &ErrorTuning) -> Region {
        let reach = far.max(tuning.reach * self.size);
        let [one, other] =
            [&self.from_scan, &self.from_decoded].map(|side| side.worst_region(far, reach));
        if one.squared >= other.squared { one } else { other }
    }
}

/// Distances from the points of one surface to another.
struct Directed {
    /// Points spread evenly by area over all but specks; the corners and centres where there is no
    /// area.
    main: Points,
    /// Points spread as densely over the specks.
    specks: Points,
    /// Corners and centres of faces, of every so many where there are many; none of specks.
    corners: Points,
}

impl Directed {
    fn new(mesh: MeshRef<'_>, to: &TriangleTree, tuning: &ErrorTuning) -> Self {
        let (kept, share) = without_specks(mesh, tuning);
        let main = (share * tuning.samples as f64).ceil() as usize;
        let spread = |keep: &[bool], count: usize| {
            sample_surface(mesh.positions, mesh.faces, Some(keep), count).ok()
        };
        let specks: Vec<bool> = kept.iter().map(|kept| !kept).collect();
        let specks = spread(&specks, tuning.samples.saturating_sub(main)).unwrap_or_default();
        let corners = Points::new(corners_and_centres(mesh, &kept, tuning.samples), to);
        let main = spread(&kept, main).map(|points| Points::new(points, to));
        let main = main.unwrap_or_else(|| corners.clone());
        Self { main, specks: Points::new(specks, to), corners }
    }

    fn rms(&self) -> f64 {
        self.main.rms().max(self.corners.rms())
    }

    /// The diagonal of the box without the outermost points on each axis, so that what is far away
    /// does not make the surface large; the smaller of both kinds of points.
    fn size(&self, trimmed: f64) -> f64 {
        self.main.size(trimmed).min(self.corners.size(trimmed))
    }

    fn worst_region(&self, far: f64, reach: f64) -> Region {
        let all = [&self.main, &self.specks];
        let count = all.iter().map(|points| points.places.len()).sum();
        let each = all.into_iter().flat_map(|points| points.places.iter().zip(&points.squared));
        worst_region(each.map(|(&place, &squared)| (place, squared)), count, far, reach)
    }
}

/// Points, and their squared distances from a surface.
#[derive(Clone)]
struct Points {
    places: Vec<Vec3>,
    squared: Vec<f64>,
}

impl Points {
    fn new(places: Vec<Vec3>, to: &TriangleTree) -> Self {
        let closest = to.closest_all(&places);
        Self { squared: closest.iter().map(|closest| closest.distance_squared).collect(), places }
    }

    fn rms(&self) -> f64 {
        (self.squared.iter().sum::<f64>() / self.squared.len().max(1) as f64).sqrt()
    }

    fn size(&self, trimmed: f64) -> f64 {
        let cut = (trimmed * self.places.len() as f64) as usize;
        norm([0, 1, 2].map(|axis| {
            let mut along: Vec<f64> = self.places.iter().map(|place| place[axis]).collect();
            along.sort_unstable_by(f64::total_cmp);
            let ends = along.get(cut).zip(along.iter().nth_back(cut));
            ends.map_or(0.0, |(low, high)| high - low)
        }))
    }
}

/// The corners and centres of the kept faces: of all, or of every so many, such that they are about
/// `count`.
fn corners_and_centres(mesh: MeshRef<'_>, kept: &[bool], count: usize) -> Vec<Vec3> {
    let faces = || mesh.faces.iter().zip(kept).filter(|(_, kept)| **kept);
    let stride = (4 * faces().count()).div_ceil(count.max(1)).max(1);
    let points = faces().step_by(stride).flat_map(|(face, _)| {
        let [a, b, c] = face.map(|vertex| mesh.positions[vertex as usize]);
        [a, b, c, scale(add(add(a, b), c), 1.0 / 3.0)]
    });
    points.collect()
}

/// `#F`, whether a face is kept, and the share of the area that these faces have. Specks are not
/// kept: small components of a mesh that is fine and has larger ones.
fn without_specks(mesh: MeshRef<'_>, tuning: &ErrorTuning) -> (Vec<bool>, f64) {
    let everything = (vec![true; mesh.faces.len()], 1.0);
    if mesh.faces.len() < tuning.fine {
        return everything;
    }
    let components = Components::new(mesh.positions.len(), mesh.faces);
    let component = |face: &[u32; 3]| components.of_vertex[face[0] as usize] as usize;
    let mut areas = vec![0.0; components.count];
    for face in mesh.faces {
        let [a, b, c] = face.map(|vertex| mesh.positions[vertex as usize]);
        areas[component(face)] += norm(cross(sub(b, a), sub(c, a)));
    }
    let total: f64 = areas.iter().sum();
    let large = |area: &f64| *area >= tuning.speck * total;
    let share = areas.iter().filter(|area| large(area)).sum::<f64>() / total;
    if share.is_nan() || share <= 0.0 {
        return everything;
    }
    (mesh.faces.iter().map(|face| large(&areas[component(face)])).collect(), share)
}

/// A region of far points.
#[derive(Clone, Copy, Default)]
struct Region {
    /// Its share of the points.
    share: f64,
    /// The sum of its squared distances over the number of all points.
    squared: f64,
}

impl Region {
    /// Its part of the RMS distance of all points.
    fn part(self) -> f64 {
        self.squared.sqrt()
    }

    /// Its own RMS distance.
    fn rms(self) -> f64 {
        if self.share > 0.0 { (self.squared / self.share).sqrt() } else { 0.0 }
    }
}

/// The cells of a lattice that have far points, with the number of these and the sum of their
/// squared distances.
type Cells = BTreeMap<[i64; 3], (usize, f64)>;

/// The region with the largest sum of squared distances, of points with their squared distances; all
/// points are `count`. Far points in one cell of side `reach`, or in cells that touch, are one
/// region. The work grows with the number of points alone.
fn worst_region(
    points: impl Iterator<Item = (Vec3, f64)>,
    count: usize,
    far: f64,
    reach: f64,
) -> Region {
    let mut cells = Cells::new();
    for (place, squared) in points.filter(|(_, squared)| *squared > far * far) {
        let cell = cells.entry(place.map(|c| (c / reach).floor() as i64)).or_default();
        cell.0 += 1;
        cell.1 += squared;
    }
    let all = count.max(1) as f64;
    let mut worst = Region::default();
    while let Some((seed, first)) = cells.pop_first() {
        let (count, sum) = flood(&mut cells, seed, first);
        if sum / all > worst.squared {
            worst = Region { share: count as f64 / all, squared: sum / all };
        }
    }
    worst
}

/// Takes the cells that belong together with `seed` out of `cells` and sums them up.
fn flood(cells: &mut Cells, seed: [i64; 3], first: (usize, f64)) -> (usize, f64) {
    let (mut count, mut sum) = first;
    let mut open = vec![seed];
    while let Some(cell) = open.pop() {
        for number in 0..27_i64 {
            let way = [number % 3 - 1, number / 3 % 3 - 1, number / 9 - 1];
            let beside: [i64; 3] = std::array::from_fn(|axis| cell[axis].saturating_add(way[axis]));
            if let Some(found) = cells.remove(&beside) {
                count += found.0;
                sum += found.1;
                open.push(beside);
            }
        }
    }
    (count, sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    type Soup = (Vec<Vec3>, Vec<[u32; 3]>);

    /// A square grid of side 100 with `cells` cells a side, at a height.
    fn plate(cells: u32, height: f64) -> Soup {
        let side = cells + 1;
        let at = |i: u32| 100.0 * f64::from(i) / f64::from(cells);
        let positions = (0..side * side).map(|v| [at(v % side), at(v / side), height]).collect();
        let face = |cell: u32| {
            let a = cell / cells * side + cell % cells;
            [[a, a + 1, a + side], [a + 1, a + side + 1, a + side]]
        };
        (positions, (0..cells * cells).flat_map(face).collect())
    }

    fn judge(scan: &Soup, shown: &Soup) -> Result<Measured, FitFailure> {
        let tree = TriangleTree::new(&scan.0, &scan.1).expect("a surface");
        let [mesh, shown] = [scan, shown].map(|(positions, faces)| MeshRef::new(positions, faces));
        let bound = ErrorBound::new(0.01, ErrorTuning::default());
        bound.judge(IndexedMesh::new(mesh, &tree), shown).expect("a surface")
    }

    #[test]
    fn the_whole_has_a_bound() {
        for cells in [1, 2, 60] {
            let scan = plate(cells, 0.0);
            // The size is about 140, so the bound is 1 grid step and 1.4.
            let near = judge(&scan, &plate(cells, 2.2)).expect("within the bound");
            assert!((near.error.rms - 2.2 / 140.0).abs() < 1e-3, "{near:?}");
            assert!(matches!(judge(&scan, &plate(cells, 2.8)), Err(FitFailure::Distant { .. })));
        }
    }

    #[test]
    fn a_region_weighs_its_area_and_its_distance() {
        let scan = plate(60, 0.0);
        let lifted = |corner: f64, height: f64| {
            let lift = |p: &Vec3| [p[0], p[1], if p[0].max(p[1]) < corner { height } else { p[2] }];
            judge(&scan, &(scan.0.iter().map(lift).collect(), scan.1.clone()))
        };
        assert!(lifted(4.0, 12.0).is_ok(), "0.2 % of the area");
        assert!(lifted(12.0, 3.0).is_ok(), "near");
        let limb = lifted(12.0, 12.0).expect_err("a limb");
        assert!(matches!(limb, FitFailure::DistantRegion { share, .. } if share > 0.01), "{limb}");
    }

    #[test]
    fn specks_count_by_their_area() {
        let clean = plate(60, 0.0);
        let mut specked = clean.clone();
        let first = specked.0.len() as u32;
        for speck in 0..150_u32 {
            let [x, y] = [f64::from(speck % 10) * 10.0, f64::from(speck / 10) * 6.0];
            specked.0.extend([[x, y, 30.0], [x + 0.3, y, 30.0], [x, y + 0.3, 30.0]]);
            specked.1.push([0, 1, 2].map(|corner| first + 3 * speck + corner));
        }
        for (scan, shown) in [(&specked, &clean), (&clean, &specked)] {
            let measured = judge(scan, shown).expect("within the bound");
            assert!(measured.error.rms < 1e-9, "{measured:?}");
        }
        // A coarse mesh has no specks: every face is seen.
        let coarse = plate(2, 0.0);
        let first = coarse.0.len() as u32;
        let mut stray = coarse.clone();
        stray.0.extend([[50.0, 50.0, 90.0], [51.0, 50.0, 90.0], [50.0, 51.0, 90.0]]);
        stray.1.push([first, first + 1, first + 2]);
        assert!(judge(&coarse, &stray).is_err() && judge(&stray, &coarse).is_err());
    }
}
