//! kn-bitstream and the interpreter of the syntax tables agree on random structures, both ways.

use kn_bitstream::params::{
    Combination, FrameRate, InfluenceMode, LabelSet, TranslationMode, UnitOfLength, UpAxis,
    WeightScheme,
};
use std::path::Path;

use kn_bitstream::unit::{self, FILE_SIGNATURE, write_unit};
use kn_bitstream::{
    AffineNodes, BitReader, BitWriter, EntropyMode, FrameHeader, KeyNodes, KeyNodesContext,
    MotionContext, MotionFrame, NodeSites,
};
use kn_conform::{Spec, TraceLine};
use proptest::prelude::*;

fn spec() -> &'static Spec {
    static SPEC: std::sync::OnceLock<Spec> = std::sync::OnceLock::new();
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../spec"));
    SPEC.get_or_init(|| Spec::load(folder).unwrap_or_else(|error| panic!("{error}")))
}

/// The smallest header that the structures need: Gaussian weights, body labels.
fn header() -> BitWriter {
    let header = kn_bitstream::SequenceHeader {
        level: 2,
        frame_rate: FrameRate::new(25, 1),
        up_axis: UpAxis::Z,
        unit_of_length: UnitOfLength::Foot,
        fraction_bits: 3,
        max_group_length: 9,
        nodes_per_vertex: 2,
        weight_scheme: WeightScheme::Gaussian,
        influence_mode: InfluenceMode::Strict,
        labels: LabelSet::Body,
        grid_origin: [0.1, -2.0, 1e300],
        grid_step: 1e-9,
        names: None,
    };
    let mut bits = BitWriter::new();
    header.write(&mut bits);
    bits
}

fn triples(limit: i32, count: u32) -> impl Strategy<Value = Vec<[i32; 3]>> {
    prop::collection::vec(prop::array::uniform3(-limit..=limit), count as usize)
}

fn sites() -> impl Strategy<Value = NodeSites> {
    prop_oneof![
        prop::collection::btree_set(0..20_000_u32, 1..20)
            .prop_map(|set| NodeSites::Vertices(set.into_iter().collect())),
        prop::collection::vec(prop::array::uniform3(-5000..5000), 1..20)
            .prop_map(NodeSites::Points),
    ]
}

fn key_nodes() -> impl Strategy<Value = KeyNodes> {
    (sites(), 1..1_u32 << 20, prop::collection::vec(any::<bool>(), 20), 0..4).prop_map(
        |(sites, sigma, flags, mode)| {
            let mut nodes =
                KeyNodes { sites, affine: AffineNodes::None, weight_sigma: Some(sigma) };
            nodes.affine = match mode {
                0 => AffineNodes::None,
                1 => AffineNodes::Labels(flags[..15].to_vec()),
                2 => AffineNodes::All,
                _ => AffineNodes::Nodes(flags[..nodes.count() as usize].to_vec()),
            };
            nodes
        },
    )
}

/// Key nodes, the labels that the I-frame is said to give them, and two P-frames for them.
#[derive(Clone, Debug)]
struct Group {
    nodes: KeyNodes,
    labels: Vec<u8>,
    motions: [(MotionContext, MotionFrame); 2],
}

fn group() -> impl Strategy<Value = Group> {
    (key_nodes(), prop::collection::vec(0..15_u8, 20)).prop_flat_map(|(nodes, mut labels)| {
        labels.truncate(nodes.count() as usize);
        let marked =
            |flags: &[bool]| labels.iter().filter(|&&label| flags[usize::from(label)]).count();
        let context = MotionContext {
            node_count: nodes.count(),
            affine_count: match &nodes.affine {
                AffineNodes::None => 0,
                AffineNodes::Labels(flags) => marked(flags) as u32,
                AffineNodes::All => nodes.count(),
                AffineNodes::Nodes(flags) => flags.iter().filter(|&&flag| flag).count() as u32,
            },
            part_count: labels.iter().collect::<std::collections::BTreeSet<_>>().len() as u32,
            previous_table: None,
        };
        motion(context).prop_flat_map(move |first| {
            let previous_table = Some(first.translation_table);
            let next = MotionContext { previous_table, ..context };
            let (nodes, labels) = (nodes.clone(), labels.clone());
            motion(next).prop_map(move |second| Group {
                nodes: nodes.clone(),
                labels: labels.clone(),
                motions: [(context, first.clone()), (next, second)],
            })
        })
    })
}

fn motion(context: MotionContext) -> impl Strategy<Value = MotionFrame> {
    let mut modes = vec![TranslationMode::Direct, TranslationMode::Spatial];
    modes.extend(context.previous_table.map(|_| TranslationMode::SpatioTemporal));
    let choices = (any::<[bool; 3]>(), prop::sample::select(modes));
    (choices, 0..48_u8, 0..48_u8, 0..12_u8).prop_flat_map(
        move |(([rotation, scale, shear], mode), translation_table, parameter_table, step)| {
            let affine_count = context.affine_count;
            let enabled = Combination { rotation, scale, shear };
            let enabled = if affine_count == 0 { Combination::default() } else { enabled };
            let counts = context.carriers(enabled);
            let temporal = mode == TranslationMode::SpatioTemporal;
            let lists = (
                triples(3000, if temporal { context.part_count } else { 0 }),
                triples(200_000, context.node_count),
                triples(4000, counts[0]),
                triples(2000, counts[1]),
                triples(4000, counts[2]),
            );
            lists.prop_map(move |(translation_change, translation, rotation, scale, shear)| {
                let step_for = |count| if count > 0 { step } else { 0 };
                MotionFrame {
                    header: FrameHeader { name: "né".into(), positions_digest: Some(3) },
                    entropy_mode: EntropyMode::Huffman,
                    translation_mode: mode,
                    enabled,
                    translation_step: step,
                    translation_table,
                    rotation_step: step_for(counts[0]),
                    scale_step: step_for(counts[1]),
                    shear_step: step_for(counts[2]),
                    parameter_table: if counts == [0; 3] { 0 } else { parameter_table },
                    translation_change,
                    translation,
                    rotation,
                    scale,
                    shear,
                }
            })
        },
    )
}

/// The elements that kn-bitstream reads from the structures, which start at these bits.
fn product_trace(
    payloads: &[Vec<u8>; 3],
    starts: &[u64],
    contexts: [&MotionContext; 2],
) -> Result<Vec<TraceLine>, kn_bitstream::Error> {
    let mut lines: Vec<TraceLine> = Vec::new();
    let nodes_context = KeyNodesContext {
        label_count: 15,
        weight_scheme: WeightScheme::Gaussian,
        vertex_count: 20_000,
        max_nodes: 4096,
    };
    let mut sink = |element: &kn_bitstream::Element<'_>| lines.push(element.into());
    let mut bits = BitReader::new(&payloads[0]).at(starts[0]).traced(&mut sink);
    KeyNodes::read(&mut bits, &nodes_context)?;
    bits.finish()?;
    for (place, context) in (1..).zip(contexts) {
        let mut sink = |element: &kn_bitstream::Element<'_>| lines.push(element.into());
        let mut bits = BitReader::new(&payloads[place]).at(starts[place]).traced(&mut sink);
        MotionFrame::default().read(&mut bits, context)?;
        bits.finish()?;
    }
    Ok(lines)
}

proptest! {
    #[test]
    fn random_groups_read_alike(group in group()) {
        let mut out = BitWriter::new();
        group.nodes.write(&mut out);
        let nodes_payload = out.into_bytes();
        let [first, second] = group.motions.each_ref().map(|(context, motion)| {
            let mut out = BitWriter::new();
            motion.write(&mut out, context);
            out.into_bytes()
        });
        let payloads = [nodes_payload, first, second];

        let mut stream = FILE_SIGNATURE.to_vec();
        write_unit(&mut stream, unit::SEQUENCE_HEADER, &header().into_bytes());
        write_unit(&mut stream, unit::KEY_NODES, &payloads[0]);
        write_unit(&mut stream, unit::MOTION_FRAME, &payloads[1]);
        write_unit(&mut stream, unit::MOTION_FRAME, &payloads[2]);

        let by_labels = |_: &[TraceLine]| Some(group.labels.clone());
        let by_tables = spec().parse(&stream, &by_labels).expect("a stream");
        let begins = |line: &&TraceLine| ["node_count", "digest_present"].contains(&line.name.as_str());
        let starts: Vec<u64> = by_tables.iter().filter(begins).map(|line| line.bit).collect();
        let nodes_at = by_tables.iter().position(|line| line.name == "node_count");
        let framing = ["unit_type", "unit_size", "unit_crc"];
        let by_tables = by_tables[nodes_at.expect("it is there")..].iter();
        let by_tables = by_tables.filter(|line| !framing.contains(&line.name.as_str()));
        let contexts = group.motions.each_ref().map(|(context, _)| context);
        let by_product = product_trace(&payloads, &starts, contexts).expect("sound structures");
        prop_assert!(by_tables.eq(&by_product));

        let text = spec().disassemble(&stream, &by_labels).expect("a stream");
        prop_assert_eq!(spec().assemble(&text, &by_labels).expect("a text"), stream);
    }

    #[test]
    fn any_bytes_are_parsed_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        // No panic, no hang; units that look sound get past the signature.
        let mut stream = FILE_SIGNATURE.to_vec();
        write_unit(&mut stream, unit::SEQUENCE_HEADER, &header().into_bytes());
        for unit_type in [unit::KEY_NODES, unit::INTRA_FRAME, unit::INDEX, unit::MOTION_FRAME] {
            write_unit(&mut stream, unit_type, &bytes);
            let _ = spec().parse(&stream, kn_conform::no_labels());
        }
        let _ = spec().parse(&bytes, kn_conform::no_labels());
    }
}
