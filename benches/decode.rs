//! Times that a player waits: for an I-frame, the first P-frame of a GoF (which binds influence), a
//! P-frame, and the deformation kernel alone. On one core.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use kn_bitstream::params::{InfluenceMode, Weights};
use kn_codec::{Encoder, EncoderConfig, Limits, Progress, StreamDecoder};
use kn_deform::{BindOptions, Deformer, Influence, NodeTransform};
use kn_mesh::{Grid, Mesh};
use kn_performer::{Performer, PerformerConfig};
use std::hint::black_box;

const VERTICES: usize = 20_000;
const NODES: usize = 150;

fn performer() -> Performer {
    let config = PerformerConfig { vertices: VERTICES, ..PerformerConfig::default() };
    Performer::new(config).expect("the settings are in range")
}

/// A GoF of three frames.
fn stream() -> Vec<u8> {
    let performer = performer();
    let config = EncoderConfig::default().with_group_length(3).with_nodes(NODES);
    let mut encoder = Encoder::new(Vec::new(), config).expect("sound settings");
    (0..3).for_each(|index| encoder.push(&performer.frame(index)).expect("a sound frame"));
    encoder.finish().expect("a vector takes everything").writer
}

fn poll_frame(decoder: &mut StreamDecoder, mesh: &mut Mesh) {
    let progress = decoder.poll(mesh).expect("a sound stream");
    assert!(matches!(progress, Progress::Frame(_)));
}

/// A decoder that has shown so many frames.
fn after(frames: usize, stream: &[u8], mesh: &mut Mesh) -> StreamDecoder {
    let mut decoder = StreamDecoder::new(Limits::default());
    decoder.push(stream);
    (0..frames).for_each(|_| poll_frame(&mut decoder, mesh));
    decoder
}

fn decode_frames(criterion: &mut Criterion) {
    let stream = stream();
    let mut group = criterion.benchmark_group("decode");
    group.throughput(Throughput::Elements(VERTICES as u64));
    for (name, frames) in [("I-frame", 0), ("first P-frame", 1), ("P-frame", 2)] {
        let mut mesh = Mesh::default();
        group.bench_function(name, |bencher| {
            bencher.iter_batched_ref(
                || after(frames, &stream, &mut Mesh::default()),
                |decoder| poll_frame(decoder, &mut mesh),
                BatchSize::PerIteration,
            );
        });
    }
    group.finish();
}

/// The kernels on a frame of the performer.
fn deform_vertices(criterion: &mut Criterion) {
    let frame = performer().frame(0);
    let grid = Grid { origin: [0.0; 3], step: 0.001 };
    let positions = grid.quantise(&frame.positions).expect("inside the grid");
    let nodes: Vec<[i32; 3]> = positions.iter().step_by(VERTICES / NODES).copied().collect();
    let options = BindOptions {
        nodes_per_vertex: 4,
        weights: Weights::INVERSE_SQUARE,
        mode: InfluenceMode::Strict,
    };
    let (vertex_regions, node_regions) = (vec![0; positions.len()], vec![0; nodes.len()]);
    let mut influence = Influence::default();
    let bind = |influence: &mut Influence| {
        kn_deform::bind(&positions, &vertex_regions, &nodes, &node_regions, &options, influence)
            .expect("there are nodes");
    };
    let mut group = criterion.benchmark_group("deform");
    group.throughput(Throughput::Elements(VERTICES as u64));
    group.bench_function("bind", |bencher| bencher.iter(|| bind(black_box(&mut influence))));
    let turned = NodeTransform { rotation: [0.1, 0.2, 0.3], ..NodeTransform::IDENTITY };
    let transforms = vec![turned; nodes.len()];
    let mut deformer = Deformer::default();
    let mut deformed = Vec::new();
    group.bench_function("deform", |bencher| {
        bencher.iter(|| {
            let reference = black_box(&positions);
            deformer
                .deform(reference, &influence, &nodes, &transforms, 1 << 28, &mut deformed)
                .expect("inside the range");
        });
    });
    group.finish();
}

fn on_one_core(criterion: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    pool.build_global().expect("the pool is built once");
    decode_frames(criterion);
    deform_vertices(criterion);
}

criterion_group!(benches, on_one_core);
criterion_main!(benches);
