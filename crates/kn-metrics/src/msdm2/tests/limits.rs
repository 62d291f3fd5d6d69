//! Bad input, and meshes whose neighbourhoods hold nearly all of them.

use super::super::direction::stride;
use super::*;

#[test]
fn some_vertices_stand_for_all_where_neighbourhoods_are_large() {
    let (a, b) = (surface(&torus(80, 41, |_| 0.0)), surface(&hard()));
    let matches = closest_faces(&a, &b);
    let both = [Interpolation::AtVertex, Interpolation::Projected];
    let direction = Direction::new(&b, &a, &matches, DEFAULT_LEVELS, &both);
    let connected: Vec<u32> = (0..b.positions.len() as u32).collect();
    // A scan, a small mesh and one whose neighbourhoods hold all of it.
    assert_eq!(
        [(95, 20_000), (900, 1000), (50_000, 50_000)].map(|(a, b)| stride(a, b)),
        [1, 1, 299]
    );
    let (all, some) = (direction.evaluate(), direction.evaluate_each(7, &connected));
    for (all, some) in all.iter().zip(&some) {
        assert_eq!((all.measured, some.measured), (connected.len(), connected.len().div_ceil(7)));
        assert!((all.score - some.score).abs() < 0.05 * all.score, "{} {}", all.score, some.score);
        assert_eq!((some.local[14], some.local[20]), (all.local[14], all.local[14]));
    }
}

/// Two meshes one of which is tiny beside the other, as where one is in millimetres.
#[test]
fn a_mesh_in_another_unit_is_measured() {
    let large = torus(80, 40, |i| 0.01 * noise(i));
    let scaled = large.0.iter().map(|p| p.map(|x| 1e-3 * x)).collect();
    let found = msdm2(&surface(&large), &surface(&(scaled, large.1)), Interpolation::AtVertex);
    assert!(found.symmetric > 0.0 && found.symmetric < 1.0, "{}", found.symmetric);
}

#[test]
fn bad_input_is_named() {
    let (positions, faces) = torus(5, 4, |_| 0.0);
    let error = |positions: &[Vec3], faces: &[[u32; 3]], levels| {
        Msdm2Surface::new(positions, faces, levels).map(|_| ()).unwrap_err()
    };
    assert_eq!(error(&positions, &faces, 0), Msdm2Error::Levels { levels: 0 });
    assert_eq!(error(&positions, &faces, 17), Msdm2Error::Levels { levels: 17 });
    assert_eq!(error(&positions, &[], 3), Msdm2Error::Mesh(TreeError::NoFaces));
    assert_eq!(error(&[[1.0; 3]; 3], &[[0, 1, 2]], 3), Msdm2Error::NoExtent);
    let tiny: Vec<Vec3> = positions.iter().map(|p| p.map(|x| 1e-70 * x)).collect();
    assert_eq!(error(&tiny, &faces, 3), Msdm2Error::NoExtent);
}
