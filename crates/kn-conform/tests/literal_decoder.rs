//! The decoder and the literal reading of chapters 6 to 9 agree bit for bit on random GoFs.

use kn_bitstream::params::{
    Combination, FrameRate, InfluenceMode, LabelSet, Named, TranslationMode, UnitOfLength, UpAxis,
    WeightScheme,
};
use std::collections::BTreeSet;
use std::path::Path;

use kn_bitstream::Rule;
use kn_bitstream::unit::{self, FILE_SIGNATURE, write_unit};
use kn_bitstream::{
    AffineNodes, BitWriter, EntropyMode, FrameHeader, Index, IndexGroup, IntraFrame, KeyNodes,
    MAX_SMOOTHING, MotionContext, MotionFrame, NodeSites, SequenceHeader, ValueList,
};
use kn_codec::intra::encode_intra;
use kn_codec::{DecodeError, Limits, Progress, StreamDecoder, digest};
use kn_conform::{Spec, no_labels, node_labels};
use kn_mesh::{GridMesh, Mesh};
use proptest::prelude::*;

fn spec() -> &'static Spec {
    static SPEC: std::sync::OnceLock<Spec> = std::sync::OnceLock::new();
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../spec"));
    SPEC.get_or_init(|| Spec::load(folder).unwrap_or_else(|error| panic!("{error}")))
}

fn header() -> impl Strategy<Value = SequenceHeader> {
    // Custom regions, so that some labels share one.
    let shared = LabelSet::Custom((0..15).map(|label| label % 4).collect());
    let labels = prop::sample::select(vec![LabelSet::Body, shared, LabelSet::None]);
    // Few GoFs have a node in every region.
    let strict = prop::bool::weighted(0.2);
    let schemes = prop::sample::select(WeightScheme::all());
    let axes = prop::sample::select(UpAxis::all());
    (0..=8_u8, 1..=8_u8, schemes, axes, labels, strict).prop_map(
        |(fraction_bits, nodes_per_vertex, weight_scheme, up_axis, labels, strict)| {
            SequenceHeader {
                level: 0,
                frame_rate: FrameRate::new(1, 1),
                up_axis,
                unit_of_length: UnitOfLength::Unspecified,
                fraction_bits,
                max_group_length: 8,
                nodes_per_vertex,
                weight_scheme,
                influence_mode: if strict {
                    InfluenceMode::Strict
                } else {
                    InfluenceMode::Fallback
                },
                labels,
                grid_origin: [0.0; 3],
                grid_step: 1.0,
                names: None,
            }
        },
    )
}

fn point(limit: i32) -> impl Strategy<Value = [i32; 3]> {
    prop::array::uniform3(-limit..=limit)
}

/// Vertices close together, so that distances tie, as a strip, whose vertices are all on its border,
/// or as two tips over a ring, where all are inside.
fn mesh(labelled: bool) -> impl Strategy<Value = GridMesh> {
    let vertices = prop::collection::vec((point(6), 0..15_u8), 5..40);
    (vertices, any::<bool>()).prop_map(move |(vertices, closed)| {
        let count = vertices.len() as u32;
        let (positions, mut labels): (Vec<_>, Vec<_>) = vertices.into_iter().unzip();
        if !labelled {
            labels.clear();
        }
        let ring = |i: u32| 2 + i % (count - 2);
        let tips = |i: u32| [[0, ring(i), ring(i + 1)], [1, ring(i + 1), ring(i)]];
        let faces = match closed {
            true => (0..count - 2).flat_map(tips).collect(),
            false => (2..count).map(|v| [v - 2, v - 1, v]).collect(),
        };
        GridMesh::new(positions, faces).with_labels(labels)
    })
}

/// Nodes on vertices, rising, or anywhere.
fn sites(vertices: usize) -> impl Strategy<Value = NodeSites> {
    let on_vertices = prop::sample::subsequence((0..vertices as u32).collect::<Vec<_>>(), 1..5);
    prop_oneof![
        prop::collection::vec(point(8), 1..12).prop_map(NodeSites::Points),
        on_vertices.prop_map(NodeSites::Vertices),
    ]
}

#[derive(Clone, Debug)]
struct Motions {
    enabled: Combination,
    steps: [u8; 4],
    /// Spatio-temporal becomes spatial in the first frame.
    mode: TranslationMode,
    /// Of every label's part.
    changes: Vec<[i32; 3]>,
    /// Translation, rotation, scale, shear of every node.
    values: Vec<[[i32; 3]; 4]>,
}

fn motions(nodes: usize) -> impl Strategy<Value = Motions> {
    let values = (point(40), point(12), point(3), point(12));
    let values = prop::collection::vec(values.prop_map(|(t, r, s, h)| [t, r, s, h]), nodes);
    use TranslationMode::{Direct, Spatial, SpatioTemporal};
    let mode = prop::sample::select(vec![Direct, Spatial, SpatioTemporal]);
    let changes = prop::collection::vec(point(20), 15);
    let steps = [0..20_u8, 0..50, 0..50, 0..50];
    (any::<[bool; 3]>(), steps, mode, changes, values).prop_map(
        |([rotation, scale, shear], steps, mode, changes, values)| Motions {
            enabled: Combination { rotation, scale, shear },
            steps,
            mode,
            changes,
            values,
        },
    )
}

#[derive(Clone, Debug)]
struct Case {
    header: SequenceHeader,
    mesh: GridMesh,
    smoothing: u8,
    nodes: KeyNodes,
    affine: Vec<bool>,
    motions: Vec<Motions>,
}

fn case() -> impl Strategy<Value = Case> {
    let scene = header().prop_flat_map(|header| {
        let labelled = header.labels != LabelSet::None;
        (Just(header), mesh(labelled), 0..=MAX_SMOOTHING)
    });
    let with_nodes = scene.prop_flat_map(|(header, mesh, smoothing)| {
        let sites = sites(mesh.positions.len());
        let affine = prop::collection::vec(any::<bool>(), 12);
        (Just((header, mesh, smoothing)), sites, affine, 1..1000_u32)
    });
    with_nodes.prop_flat_map(|((header, mesh, smoothing), sites, mut affine, sigma)| {
        affine.truncate(match &sites {
            NodeSites::Points(points) => points.len(),
            NodeSites::Vertices(vertices) => vertices.len(),
        });
        let gaussian = header.weight_scheme == WeightScheme::Gaussian;
        let nodes = KeyNodes {
            sites,
            affine: AffineNodes::Nodes(affine.clone()),
            weight_sigma: gaussian.then_some(sigma),
        };
        let frames = prop::collection::vec(motions(affine.len()), 1..4);
        frames.prop_map(move |motions| Case {
            header: header.clone(),
            mesh: mesh.clone(),
            smoothing,
            nodes: nodes.clone(),
            affine: affine.clone(),
            motions,
        })
    })
}

/// Keeps what the nodes carry, and makes it the frame of the syntax.
fn frame(motions: &Motions, affine: &[bool], context: &MotionContext) -> MotionFrame {
    let mode = match (motions.mode, context.previous_table) {
        (TranslationMode::SpatioTemporal, None) => TranslationMode::Spatial,
        (mode, _) => mode,
    };
    let temporal = mode == TranslationMode::SpatioTemporal;
    let changes = if temporal { &motions.changes[..context.part_count as usize] } else { &[] };
    let any_affine = context.affine_count > 0;
    let enabled = if any_affine { motions.enabled } else { Combination::default() };
    let list = |component: usize, carries: &dyn Fn(bool) -> bool| -> Vec<[i32; 3]> {
        let carried = motions.values.iter().zip(affine).filter(|&(_, &affine)| carries(affine));
        carried.map(|(values, _)| values[component]).collect()
    };
    let [translation_step, rotation_step, scale_step, shear_step] = motions.steps;
    let counts = context.carriers(enabled);
    let step = |step, count| if count > 0 { step } else { 0 };
    let mut frame = MotionFrame {
        header: FrameHeader::default(),
        entropy_mode: EntropyMode::Huffman,
        translation_mode: mode,
        enabled,
        translation_step,
        translation_table: 0,
        rotation_step: step(rotation_step, counts[0]),
        scale_step: step(scale_step, counts[1]),
        shear_step: step(shear_step, counts[2]),
        parameter_table: 0,
        translation_change: changes.to_vec(),
        translation: list(0, &|_| true),
        rotation: list(1, &|affine| !affine || enabled.rotation),
        scale: list(2, &|affine| affine && enabled.scale),
        shear: list(3, &|affine| affine && enabled.shear),
    };
    let translations = [(ValueList::Translation, &frame.translation[..])];
    frame.translation_table = frame.entropy_mode.best_table(&translations).0;
    frame
}

fn bytes(write: impl FnOnce(&mut BitWriter)) -> Vec<u8> {
    let mut bits = BitWriter::new();
    write(&mut bits);
    bits.into_bytes()
}

fn stream(case: &Case) -> Vec<u8> {
    let Case { header, mesh, smoothing, nodes, affine, motions } = case;
    let encoding = encode_intra(mesh).expect("a mesh");
    let intra =
        IntraFrame { payload: encoding.payload(), smoothing: *smoothing, ..IntraFrame::default() };
    let mut out = FILE_SIGNATURE.to_vec();
    write_unit(&mut out, unit::SEQUENCE_HEADER, &bytes(|bits| header.write(bits)));
    let start = out.len();
    write_unit(&mut out, unit::INTRA_FRAME, &bytes(|bits| intra.write(bits)));
    write_unit(&mut out, unit::KEY_NODES, &bytes(|bits| nodes.write(bits)));
    let trace = spec().parse(&out, no_labels()).expect("sound");
    let labels: BTreeSet<u8> = node_labels(&trace).expect("sound").into_iter().collect();
    let mut context = MotionContext {
        node_count: affine.len() as u32,
        affine_count: affine.iter().filter(|&&affine| affine).count() as u32,
        part_count: labels.len() as u32,
        previous_table: None,
    };
    for motions in motions {
        let frame = frame(motions, affine, &context);
        write_unit(&mut out, unit::MOTION_FRAME, &bytes(|bits| frame.write(bits, &context)));
        context.previous_table = Some(frame.translation_table);
    }
    let group = IndexGroup { bytes: (out.len() - start) as u32, frames: 1 + motions.len() as u8 };
    let index = Index { groups: vec![group] };
    write_unit(&mut out, unit::INDEX, &bytes(|bits| index.write(bits)));
    out
}

/// The decoder's frames, or the rule by which it refuses the stream.
fn decoded(stream: &[u8]) -> Result<Vec<String>, Rule> {
    let mut decoder = StreamDecoder::new(Limits::default());
    decoder.push(stream);
    let mut mesh = Mesh::default();
    let mut frames = Vec::new();
    let rule = |error: DecodeError| error.rule().expect("the bytes are there");
    while let Progress::Frame(frame) = decoder.poll(&mut mesh).map_err(rule)? {
        let kind = if frame.index == 0 { 'I' } else { 'P' };
        let digest = digest::frame_sha256(decoder.grid_positions(), decoder.faces());
        frames.push(format!("{} {kind} {} {} {digest}", frame.index, frame.vertices, frame.faces));
    }
    Ok(frames)
}

proptest! {
    #[test]
    fn random_groups_decode_alike(case in case()) {
        let stream = stream(&case);
        let literal = spec().reconstruct(&stream).map(|literal| literal.frames);
        prop_assert_eq!(decoded(&stream).map_err(Some), literal.map_err(|failure| failure.rule));
    }

    #[test]
    fn most_random_groups_decode(mut case in case()) {
        // Small steps: the range rules hold, so the test above compares something.
        case.motions.iter_mut().for_each(|motions| motions.steps = [8, 20, 20, 20]);
        case.header.influence_mode = InfluenceMode::Fallback;
        prop_assert!(decoded(&stream(&case)).is_ok());
    }
}
