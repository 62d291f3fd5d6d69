//! kn-bitstream and the interpreter of the syntax tables agree on random structures, both ways.

use std::path::Path;

use kn_bitstream::unit::{self, FILE_SIGNATURE, write_unit};
use kn_bitstream::{
    AffineNodes, BitReader, BitWriter, Components, FrameHeader, KeyNodes, KeyNodesContext,
    MotionContext, MotionFrame, NodeSites, WeightScheme,
};
use kn_conform::{GroupPayloads, Spec, TraceLine};
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
        frame_rate: [25, 1],
        up_axis: 2,
        unit_of_length: kn_bitstream::UnitOfLength::Foot,
        fraction_bits: 3,
        max_group_length: 9,
        nodes_per_vertex: 2,
        weight_scheme: WeightScheme::Gaussian,
        influence_mode: kn_bitstream::InfluenceMode::Strict,
        labels: kn_bitstream::LabelSet::Body,
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

/// Key nodes and a P-frame for them; where labels decide, every second node is affine.
fn group() -> impl Strategy<Value = (KeyNodes, MotionContext, MotionFrame)> {
    let enabled = any::<[bool; 3]>();
    (key_nodes(), enabled, 0..48_u8, 0..48_u8, 0..12_u8).prop_flat_map(
        |(nodes, [rotation, scale, shear], translation_table, parameter_table, step)| {
            let affine_count = match &nodes.affine {
                AffineNodes::None => 0,
                AffineNodes::Labels(_) => nodes.count() / 2,
                AffineNodes::All => nodes.count(),
                AffineNodes::Nodes(flags) => flags.iter().filter(|&&flag| flag).count() as u32,
            };
            let context = MotionContext { node_count: nodes.count(), affine_count };
            let enabled = Components { rotation, scale, shear };
            let enabled = if affine_count == 0 { Components::default() } else { enabled };
            let counts = enabled.counts(&context);
            let lists = (
                triples(200_000, nodes.count()),
                triples(4000, counts[0]),
                triples(2000, counts[1]),
                triples(4000, counts[2]),
            );
            lists.prop_map(move |(translation, rotation, scale, shear)| {
                let step_for = |count| if count > 0 { step } else { 0 };
                let motion = MotionFrame {
                    header: FrameHeader { name: "né".into(), positions_digest: Some(3) },
                    enabled,
                    translation_step: step,
                    translation_table,
                    rotation_step: step_for(counts[0]),
                    scale_step: step_for(counts[1]),
                    shear_step: step_for(counts[2]),
                    parameter_table: if counts == [0; 3] { 0 } else { parameter_table },
                    translation,
                    rotation,
                    scale,
                    shear,
                };
                (nodes.clone(), context, motion)
            })
        },
    )
}

/// The elements that kn-bitstream reads from the structures, which start at these bits.
fn product_trace(
    payloads: &[Vec<u8>; 2],
    starts: [u64; 2],
    context: &MotionContext,
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
    let mut sink = |element: &kn_bitstream::Element<'_>| lines.push(element.into());
    let mut bits = BitReader::new(&payloads[1]).at(starts[1]).traced(&mut sink);
    MotionFrame::default().read(&mut bits, context)?;
    bits.finish()?;
    Ok(lines)
}

proptest! {
    #[test]
    fn random_groups_read_alike((nodes, context, motion) in group()) {
        let mut out = BitWriter::new();
        nodes.write(&mut out);
        let nodes_payload = out.into_bytes();
        let mut out = BitWriter::new();
        motion.write(&mut out);
        let payloads = [nodes_payload, out.into_bytes()];

        let mut stream = FILE_SIGNATURE.to_vec();
        write_unit(&mut stream, unit::SEQUENCE_HEADER, &header().into_bytes());
        write_unit(&mut stream, unit::KEY_NODES, &payloads[0]);
        write_unit(&mut stream, unit::MOTION_FRAME, &payloads[1]);

        let by_labels = |_: &GroupPayloads| Some(context.affine_count);
        let by_tables = spec().parse(&stream, &by_labels).expect("a stream");
        let first = |name| by_tables.iter().position(|line| line.name == name).expect("it is there");
        let starts = ["node_count", "digest_present"].map(|name| by_tables[first(name)].bit);
        let framing = ["unit_type", "unit_size", "unit_crc"];
        let by_tables = by_tables[first("node_count")..].iter();
        let by_tables = by_tables.filter(|line| !framing.contains(&line.name.as_str()));
        let by_product = product_trace(&payloads, starts, &context).expect("sound structures");
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
