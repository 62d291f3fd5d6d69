//! Two meshes whose distance is measured, of any size.

/// Positions and faces.
pub type Shape = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// A wavy tube, closed to a ring, of about `vertices` vertices: as thin beside its box as a person
/// is. `shift` moves the waves.
fn wavy_ring(vertices: usize, shift: f64) -> Shape {
    let across = ((vertices as f64 / 8.0).sqrt() as u32).max(3);
    let around = vertices as u32 / across;
    let turn = |i: u32, n: u32| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
    let vertex = |index: u32| {
        let (u, v) = (turn(index / across, around), turn(index % across, across));
        let radius = 0.12 + 0.01 * (9.0 * u + 3.0 * v + shift).sin();
        let ring = 0.8 + radius * v.cos();
        [ring * u.cos(), ring * u.sin(), radius * v.sin()]
    };
    let quad = |index: u32| {
        let (i, j) = (index / across, index % across);
        let at = |i: u32, j: u32| (i % around) * across + j % across;
        let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        [[a, b, c], [a, c, d]]
    };
    let count = around * across;
    ((0..count).map(vertex).collect(), (0..count).flat_map(quad).collect())
}

/// Two rings of about so many vertices, with different waves and edges.
pub fn pair(vertices: usize) -> (Shape, Shape) {
    (wavy_ring(vertices, 0.0), wavy_ring(vertices * 97 / 100, 0.4))
}
