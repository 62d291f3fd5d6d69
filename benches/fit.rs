//! Times of the fit on the performer: preparing a target, a first frame, a following frame, all
//! eight combinations, the node generator (which may take three first frames a GoF).

use criterion::{Criterion, criterion_group, criterion_main};
use kn_bitstream::params::{Combination, InfluenceMode, Weights};
use kn_deform::{BindOptions, Influence, bind};
use kn_fit::{
    FitError, FitOptions, FitSource, FitTarget, Fitter, GenerateOptions, NodeCount, NodeSource,
    RankBy, generate_nodes, place_farthest,
};
use kn_performer::{Performer, PerformerConfig};
use std::hint::black_box;

fn fit(criterion: &mut Criterion) {
    let performer = Performer::new(PerformerConfig::default()).expect("the defaults are in range");
    let (source, target) = (performer.frame(0), performer.frame(1));
    let (positions, to) = (source.positions, target.positions);
    let chosen = place_farthest(&positions, &source.faces, None, None, 150).expect("a figure");
    let grid: Vec<[i32; 3]> =
        positions.iter().map(|p| p.map(|c| (1000.0 * c).round() as i32)).collect();
    let bound = |chosen: &[u32]| -> Result<Influence, FitError> {
        let sites: Vec<[i32; 3]> = chosen.iter().map(|&v| grid[v as usize]).collect();
        let options = BindOptions {
            nodes_per_vertex: 4,
            weights: Weights::SUMNER,
            mode: InfluenceMode::Fallback,
        };
        let regions = (vec![0; grid.len()], vec![0; sites.len()]);
        let mut influence = Influence::default();
        bind(&grid, &regions.0, &sites, &regions.1, &options, &mut influence)?;
        Ok(influence)
    };
    let influence = bound(&chosen).expect("nodes");
    let nodes: Vec<[f64; 3]> = chosen.iter().map(|&v| positions[v as usize]).collect();
    let affine: Vec<bool> = (0..nodes.len()).map(|node| node % 3 == 0).collect();
    let source = FitSource {
        positions: &positions,
        faces: &source.faces,
        influence: &influence,
        nodes: &nodes,
        affine: &affine,
        labels: None,
    };
    let options = FitOptions::default();
    let prepared = FitTarget::new(&to, &target.faces).expect("a figure");
    let mut group = criterion.benchmark_group("fit");
    group.sample_size(10);
    group.bench_function("target", |b| {
        b.iter(|| FitTarget::new(black_box(&to), &target.faces));
    });
    group.bench_function("first_frame", |b| {
        b.iter(|| {
            let mut fitter = Fitter::new(&source).expect("consistent");
            fitter.fit_frame(&source, black_box(&prepared), &options)
        });
    });
    let mut fitter = Fitter::new(&source).expect("consistent");
    group.bench_function("next_frame", |b| {
        b.iter(|| fitter.fit_frame(&source, black_box(&prepared), &options));
    });
    let rigid = vec![false; positions.len()];
    let places = NodeSource {
        positions: &positions,
        faces: source.faces,
        regions: None,
        affine: &rigid,
        bind: &bound,
    };
    let generate = GenerateOptions {
        count: NodeCount::Exactly(150),
        rank_by: RankBy::Distance,
        fit: options,
        explains: &|_| true,
    };
    group.bench_function("generator", |b| {
        b.iter(|| generate_nodes(&places, black_box(&prepared), &generate));
    });
    group.bench_function("eight_combinations", |b| {
        b.iter(|| {
            fitter.fit_combinations(&source, black_box(&prepared), &options, &Combination::ALL)
        });
    });
    group.finish();
}

criterion_group!(benches, fit);
criterion_main!(benches);
