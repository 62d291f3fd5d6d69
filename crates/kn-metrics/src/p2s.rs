//! Point-to-surface distance: exact closest points from samples of one surface to another.

use rayon::prelude::*;

use crate::surface::{IndexedMesh, Matches, MeshRef};
use crate::tree::{Closest, TreeError, TriangleTree, check};
use kn_mesh::vec3::{Vec3, cross, mul_add, norm, sub};

/// Samples that share hints, a thread and a partial sum.
const CHUNK: usize = 1024;

/// The reason why distances cannot be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum P2sError {
    /// The mesh has no faces, or indices or coordinates that cannot be used.
    #[error(transparent)]
    Mesh(#[from] TreeError),
    /// The mask does not have one entry for each vertex or face.
    #[error("the mask has {found} entries instead of {expected}")]
    MaskLength {
        /// The number of entries that it should have, `#V` or `#F`.
        expected: usize,
        /// The number of entries that it has.
        found: usize,
    },
    /// There are no samples: no vertex, no area, or a mask that excludes everything.
    #[error("there is nothing to sample")]
    NoSamples,
}

/// Distances from the samples of one surface to another surface, in world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distances {
    /// Number of samples.
    pub count: usize,
    /// Mean of the squared distances.
    pub mean_squared: f64,
    /// Mean of the distances.
    pub mean: f64,
    /// Largest distance: the one-sided Hausdorff distance over the samples.
    pub max: f64,
}

/// Distances in both directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct P2s {
    /// From samples of the reference to the other surface.
    pub from_reference: Distances,
    /// From samples of the other surface to the reference.
    pub from_other: Distances,
}

impl Distances {
    /// RMS distance.
    pub fn rms(&self) -> f64 {
        self.mean_squared.sqrt()
    }

    /// PSNR in decibels, `10·log10(3·peak² / mse)`; infinite where nothing differs.
    pub fn psnr(&self, peak: f64) -> f64 {
        psnr(self.mean_squared, peak)
    }
}

impl P2s {
    /// RMS distance in the worse direction.
    pub fn rms(&self) -> f64 {
        self.from_reference.rms().max(self.from_other.rms())
    }

    /// Mean distance in the worse direction.
    pub fn mean(&self) -> f64 {
        self.from_reference.mean.max(self.from_other.mean)
    }

    /// The Hausdorff distance over the samples, a lower bound of the exact one.
    pub fn hausdorff(&self) -> f64 {
        self.from_reference.max.max(self.from_other.max)
    }

    /// PSNR in the worse direction, in decibels. `peak` is usually the longest side of the
    /// sequence's box.
    pub fn psnr(&self, peak: f64) -> f64 {
        self.from_reference.psnr(peak).min(self.from_other.psnr(peak))
    }
}

/// `10·log10(3·peak² / mse)`.
pub(crate) fn psnr(mean_squared: f64, peak: f64) -> f64 {
    10.0 * libm::log10(3.0 * peak * peak / mean_squared)
}

/// Measures the distances from `points` (`#P × 3`) to a surface. With `keep` (`#P`) only marked
/// points are measured.
///
/// # Errors
/// The mask has another length, or there are no points.
pub fn distances_to_surface(
    points: &[[f64; 3]],
    keep: Option<&[bool]>,
    surface: &TriangleTree,
) -> Result<Distances, P2sError> {
    check_mask(keep, points.len())?;
    // Partial sums over fixed chunks, added in order: the same for any number of threads.
    let partial: Vec<Sums> = points
        .par_chunks(CHUNK)
        .enumerate()
        .map(|(chunk, points)| {
            let keep = keep.map(|keep| &keep[chunk * CHUNK..][..points.len()]);
            sum_distances(points, keep, surface)
        })
        .collect();
    let sums = partial.into_iter().fold(Sums::default(), Sums::and);
    if sums.count == 0 {
        return Err(P2sError::NoSamples);
    }
    let count = sums.count as f64;
    Ok(Distances {
        count: sums.count,
        mean_squared: sums.squares / count,
        mean: sums.distances / count,
        max: sums.largest_square.sqrt(),
    })
}

#[derive(Clone, Copy, Default)]
struct Sums {
    count: usize,
    squares: f64,
    distances: f64,
    largest_square: f64,
}

impl Sums {
    fn and(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            squares: self.squares + other.squares,
            distances: self.distances + other.distances,
            largest_square: self.largest_square.max(other.largest_square),
        }
    }
}

fn sum_distances(points: &[Vec3], keep: Option<&[bool]>, surface: &TriangleTree) -> Sums {
    let mut hint = u32::MAX;
    let mut sums = Sums::default();
    for (i, &point) in points.iter().enumerate() {
        if keep.is_some_and(|keep| !keep[i]) {
            continue;
        }
        let closest = surface.closest_from(point, hint);
        hint = closest.face;
        let squares = closest.distance_squared;
        let one = Sums { count: 1, squares, distances: squares.sqrt(), largest_square: squares };
        sums = sums.and(one);
    }
    sums
}

/// Measures the distances of all vertices, in both directions. The samples are the vertices alone:
/// this is the fastest way to see the effect of an encoder's choice.
///
/// # Errors
/// A mesh has no vertices.
pub fn p2s_of_vertices(
    reference: IndexedMesh<'_>,
    other: IndexedMesh<'_>,
) -> Result<P2s, P2sError> {
    Ok(P2s {
        from_reference: distances_to_surface(reference.mesh.positions, None, other.tree)?,
        from_other: distances_to_surface(other.mesh.positions, None, reference.tree)?,
    })
}

/// Spreads about `count` points evenly over a surface (`#P × 3`). The result is deterministic. With
/// `keep` (`#F`) the points lie on marked faces only.
///
/// The area is cut into `count` equal parts with one point each, along a low-discrepancy sequence
/// inside the faces.
///
/// # Errors
/// The errors of [`TriangleTree::new`]; the mask has another length; or there is no area.
pub fn sample_surface(
    positions: &[[f64; 3]],
    faces: &[[u32; 3]],
    keep: Option<&[bool]>,
    count: usize,
) -> Result<Vec<[f64; 3]>, P2sError> {
    let samples = samples_on_faces(positions, faces, keep, count)?;
    Ok(samples.into_iter().map(|(_, point)| point).collect())
}

/// The samples of [`sample_surface`], each with its face; the faces ascend.
pub(crate) fn samples_on_faces(
    positions: &[Vec3],
    faces: &[[u32; 3]],
    keep: Option<&[bool]>,
    count: usize,
) -> Result<Vec<(u32, Vec3)>, P2sError> {
    check(positions, faces)?;
    check_mask(keep, faces.len())?;
    let corners = |face: usize| faces[face].map(|vertex| positions[vertex as usize]);
    let kept = |face: usize| keep.is_none_or(|keep| keep[face]);
    let areas: Vec<f64> =
        (0..faces.len()).map(|face| if kept(face) { area(corners(face)) } else { 0.0 }).collect();
    let whole: f64 = areas.iter().sum();
    if !(whole > 0.0 && whole.is_finite()) || count == 0 {
        return Err(P2sError::NoSamples);
    }
    // Grows with the mesh's own samples only: `count` is the caller's.
    let mut samples = Vec::new();
    let mut covered = 0.0;
    for (face, area) in areas.iter().enumerate() {
        covered += area;
        let due = (covered / whole * count as f64 + 0.5).floor() as usize;
        while samples.len() < due.min(count) {
            samples.push((face as u32, sample_in_triangle(corners(face), samples.len())));
        }
    }
    Ok(samples)
}

fn area([a, b, c]: [Vec3; 3]) -> f64 {
    0.5 * norm(cross(sub(b, a), sub(c, a)))
}

/// The point that the two-dimensional golden-ratio sequence puts into a triangle.
fn sample_in_triangle([a, b, c]: [Vec3; 3], index: usize) -> Vec3 {
    let fraction = |step: f64| (0.5 + step * (index as f64 + 1.0)).fract();
    let (mut v, mut w) = (fraction(0.754_877_666_246_692_7), fraction(0.569_840_290_998_053_3));
    if v + w > 1.0 {
        (v, w) = (1.0 - v, 1.0 - w);
    }
    mul_add(mul_add(a, v, sub(b, a)), w, sub(c, a))
}

/// Measures the distances of `count` samples in each direction, uniform by area, to their exact
/// closest points. All vertices count for the maximum too.
///
/// # Errors
/// A mesh cannot be used or has no area.
pub fn p2s(
    reference: IndexedMesh<'_>,
    other: IndexedMesh<'_>,
    count: usize,
) -> Result<P2s, P2sError> {
    p2s_of_matches(reference, other, count, &Matches::new(reference, other))
}

/// Measures like [`p2s`], where the closest points of the vertices are known.
pub(crate) fn p2s_of_matches(
    reference: IndexedMesh<'_>,
    other: IndexedMesh<'_>,
    count: usize,
    matches: &Matches,
) -> Result<P2s, P2sError> {
    let from = |mesh: MeshRef<'_>, surface: &TriangleTree, corners: &[Closest]| {
        let samples = sample_surface(mesh.positions, mesh.faces, None, count)?;
        let inside = distances_to_surface(&samples, None, surface)?;
        let farthest = corners.iter().map(|corner| corner.distance_squared).fold(0.0, f64::max);
        Ok::<_, P2sError>(Distances { max: inside.max.max(farthest.sqrt()), ..inside })
    };
    Ok(P2s {
        from_reference: from(reference.mesh, other.tree, &matches.from_reference)?,
        from_other: from(other.mesh, reference.tree, &matches.from_other)?,
    })
}

fn check_mask(keep: Option<&[bool]>, expected: usize) -> Result<(), P2sError> {
    match keep {
        Some(keep) if keep.len() != expected => {
            Err(P2sError::MaskLength { expected, found: keep.len() })
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of side 1 at the height z.
    fn square(z: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let positions = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| [x, y, z]);
        (positions.to_vec(), vec![[0, 1, 2], [0, 2, 3]])
    }

    fn tree((positions, faces): &(Vec<Vec3>, Vec<[u32; 3]>)) -> TriangleTree {
        TriangleTree::new(positions, faces).unwrap()
    }

    fn indexed<'m>(
        (positions, faces): &'m (Vec<Vec3>, Vec<[u32; 3]>),
        tree: &'m TriangleTree,
    ) -> IndexedMesh<'m> {
        IndexedMesh::new(MeshRef::new(positions, faces), tree)
    }

    #[test]
    fn parallel_squares_are_their_distance_apart() {
        let (a, b) = (square(0.0), square(0.25));
        let (tree_a, tree_b) = (tree(&a), tree(&b));
        let (side_a, side_b) = (indexed(&a, &tree_a), indexed(&b, &tree_b));
        let found = p2s(side_a, side_b, 1000).unwrap();
        for value in [found.rms(), found.mean(), found.hausdorff()] {
            assert!((value - 0.25).abs() < 1e-15);
        }
        assert!((found.psnr(1.0) - 10.0 * 48f64.log10()).abs() < 1e-12);
        let vertices = p2s_of_vertices(side_a, side_b).unwrap();
        assert_eq!((vertices.rms(), vertices.from_other.count), (0.25, 4));
        assert_eq!(p2s(side_a, side_a, 9).unwrap().psnr(1.0), f64::INFINITY);
    }

    #[test]
    fn samples_are_even() {
        let (positions, faces) = square(0.0);
        let samples = sample_surface(&positions, &faces, None, 10_000).unwrap();
        assert_eq!(samples.len(), 10_000);
        for cell in 0..16 {
            let (x, y) = (f64::from(cell % 4) * 0.25, f64::from(cell / 4) * 0.25);
            let inside = |p: &&Vec3| (x..x + 0.25).contains(&p[0]) && (y..y + 0.25).contains(&p[1]);
            let count = samples.iter().filter(inside).count();
            assert!((615..=635).contains(&count), "{count} in a cell");
        }
    }

    #[test]
    fn a_mask_selects_what_is_measured() {
        let (a, b) =
            (square(0.0), (vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5]], vec![[0, 1, 2]]));
        let to_b = tree(&b);
        let half = sample_surface(&a.0, &a.1, Some(&[true, false]), 100).unwrap();
        assert!(half.iter().all(|p| p[0] >= p[1]));
        let one = distances_to_surface(&a.0, Some(&[true, false, false, false]), &to_b).unwrap();
        assert_eq!((one.count, one.max), (1, 0.0));
        let none = distances_to_surface(&a.0, Some(&[false; 4]), &to_b);
        assert_eq!(none, Err(P2sError::NoSamples));
        let short = distances_to_surface(&a.0, Some(&[true]), &to_b);
        assert_eq!(short, Err(P2sError::MaskLength { expected: 4, found: 1 }));
    }

    #[test]
    fn surfaces_without_area_are_refused() {
        let flat =
            sample_surface(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], &[[0, 1, 2]], None, 9);
        assert_eq!(flat, Err(P2sError::NoSamples));
        let empty = sample_surface(&[], &[], None, 9);
        assert_eq!(empty, Err(P2sError::Mesh(TreeError::NoFaces)));
    }

    #[test]
    fn threads_do_not_matter() {
        let (a, b) = (square(0.0), square(0.1));
        let samples = sample_surface(&a.0, &a.1, None, 5000).unwrap();
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| distances_to_surface(&samples, None, &tree(&b)).unwrap())
        };
        let one = run(1);
        assert!(one == run(2) && one == run(8));
    }
}
