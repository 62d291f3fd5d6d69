//! Speed of the metrics, and how it grows from 1 k to 100 k vertices.
//!
//! `cargo bench --bench metrics`; the table and the picture in `docs/` are from
//! `cargo run --release -p kn-lab -- metrics-growth`.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use kn_metrics::{
    DEFAULT_LEVELS, Grid, IndexedMesh, Interpolation, MeshRef, Msdm2Surface, PointCloud,
    TriangleTree, msdm2, p2s_of_vertices, point_distortion,
};

use kn_lab::ring::{Shape, pair};

fn symmetric(a: &Shape, b: &Shape) -> f64 {
    let (a, b) = rayon::join(
        || Msdm2Surface::new(&a.0, &a.1, DEFAULT_LEVELS),
        || Msdm2Surface::new(&b.0, &b.1, DEFAULT_LEVELS),
    );
    msdm2(&a.expect("a valid mesh"), &b.expect("a valid mesh"), Interpolation::AtVertex).symmetric
}

fn growth(c: &mut Criterion) {
    let mut group = c.benchmark_group("growth");
    group.sample_size(10);
    for vertices in [1_000, 3_000, 10_000, 20_000, 40_000, 100_000] {
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
            let first = IndexedMesh::new(MeshRef::new(&a.0, &a.1), &trees[0]);
            let second = IndexedMesh::new(MeshRef::new(&b.0, &b.1), &trees[1]);
            bench.iter(|| p2s_of_vertices(first, second));
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
    let sampled = |m: &Shape| PointCloud::from_surface(&m.0, &m.1, 100_000).expect("a valid mesh");
    c.bench_function("d1d2_samples", |bench| {
        bench.iter(|| point_distortion(&sampled(black_box(&a)), &sampled(&b)));
    });
    let grid = Grid::new([-1.0; 3], [1.0; 3], 256).expect("a valid grid");
    let cloud = |m: &Shape| PointCloud::from_grid(&m.0, &m.1, &grid).expect("a valid mesh");
    c.bench_function("d1d2_grid_256", |bench| {
        bench.iter(|| point_distortion(&cloud(black_box(&a)), &cloud(&b)));
    });
}

criterion_group!(benches, growth, queries, points);
criterion_main!(benches);
