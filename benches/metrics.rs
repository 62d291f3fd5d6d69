//! Speed of the metrics, and how it grows from 1 k to 100 k vertices.
//!
//! `cargo bench --bench metrics`; `-- growth` for the table in `docs/notes/metrics.md`.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use kn_metrics::{
    DEFAULT_LEVELS, Grid, Interpolation, Msdm2Surface, PointCloud, TriangleTree, msdm2,
    p2s_of_vertices, point_distortion,
};

type Mesh = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// A wavy tube, closed to a ring, of about `vertices` vertices: as thin beside its box as a person
/// is. `shift` moves the waves.
fn wavy_ring(vertices: usize, shift: f64) -> Mesh {
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

fn pair(vertices: usize) -> (Mesh, Mesh) {
    (wavy_ring(vertices, 0.0), wavy_ring(vertices * 97 / 100, 0.4))
}

fn symmetric(a: &Mesh, b: &Mesh) -> f64 {
    let (a, b) = rayon::join(
        || Msdm2Surface::new(&a.0, &a.1, DEFAULT_LEVELS),
        || Msdm2Surface::new(&b.0, &b.1, DEFAULT_LEVELS),
    );
    msdm2(&a.expect("a valid mesh"), &b.expect("a valid mesh"), Interpolation::AtVertex).symmetric
}

fn growth(c: &mut Criterion) {
    let mut group = c.benchmark_group("growth");
    group.sample_size(10);
    for vertices in [1_000, 3_000, 10_000, 30_000, 100_000] {
        let (a, b) = pair(vertices);
        group.throughput(Throughput::Elements(vertices as u64));
        group.bench_with_input(BenchmarkId::new("msdm2", vertices), &vertices, |bench, _| {
            bench.iter(|| black_box(symmetric(&a, &b)));
        });
        group.bench_with_input(BenchmarkId::new("tree", vertices), &vertices, |bench, _| {
            bench.iter(|| TriangleTree::new(black_box(&b.0), &b.1));
        });
        let trees = [&a, &b].map(|m| TriangleTree::new(&m.0, &m.1).expect("a valid mesh"));
        group.bench_with_input(BenchmarkId::new("p2s", vertices), &vertices, |bench, _| {
            bench.iter(|| p2s_of_vertices((&a.0, &trees[0]), (&b.0, &trees[1]), (None, None)));
        });
    }
    group.finish();
}

/// One thread, each query with its neighbour's face as the hint.
fn queries(c: &mut Criterion) {
    let (a, b) = pair(20_000);
    let tree = TriangleTree::new(&b.0, &b.1).expect("a valid mesh");
    let mut group = c.benchmark_group("closest");
    group.throughput(Throughput::Elements(a.0.len() as u64));
    group.bench_function("neighbour_hint", |bench| {
        bench.iter(|| {
            let mut hint = 0;
            for &point in &a.0 {
                hint = tree.closest_from(black_box(point), hint).face;
            }
            hint
        });
    });
    group.bench_function("no_hint", |bench| {
        bench.iter(|| a.0.iter().map(|&point| tree.closest(black_box(point)).face).max());
    });
    group.finish();
}

fn points(c: &mut Criterion) {
    let (a, b) = pair(20_000);
    let grid = Grid::new([-1.0; 3], [1.0; 3], 256).expect("a valid grid");
    let cloud = |m: &Mesh| PointCloud::from_grid(&m.0, &m.1, &grid).expect("a valid mesh");
    c.bench_function("d1d2_grid_256", |bench| {
        bench.iter(|| point_distortion(&cloud(black_box(&a)), &cloud(&b)));
    });
}

criterion_group!(benches, growth, queries, points);
criterion_main!(benches);
