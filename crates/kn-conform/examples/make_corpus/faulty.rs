//! Streams that break one rule each, made from a sound one.

use std::error::Error;

use crate::Draft;
use crate::texts::{Text, by_hand, positions_digest_of, strip};

/// A name, the rule that it breaks, the mistake that it catches, and the edits.
type Fault = (&'static str, &'static str, &'static str, fn(Text) -> Text);

pub(crate) fn drafts() -> Result<Vec<Draft>, Box<dyn Error>> {
    // Affine nodes marked one by one: labels would need a sound header.
    let base = by_hand()?.set("affine_mode", 0, "3").without("affine_label", 0).after(
        "node_vertex_gap",
        0,
        &["affine_node = 0 1"],
    );
    let draft = |&(name, rule, danger, edit): &Fault| Draft {
        name: name.into(),
        text: edit(base.clone()).build(),
        danger: danger.into(),
        rule: Some(rule),
        covers: match name {
            "truncated_in_unit" => &["conformance.truncated"],
            "vertex_flies_off" => &["conformance.coordinates"],
            _ => &[],
        },
    };
    let lists = [FRAMING, HEADER, NODES, MOTION, DEFORMATION, INDEX_FAULTS];
    let mut drafts: Vec<Draft> = lists.into_iter().flatten().map(draft).collect();
    let digest = positions_digest_of(&strip(8, Some([0, 7])))?;
    let digests = [&format!("positions_digest = 0x{digest:x}"), "faces_digest = 0x1"];
    drafts.push(Draft {
        name: "faces_digest".into(),
        text: base.set("digest_present", 0, "1").after("name_present", 0, &digests).build(),
        danger: "Decoded faces differ.".into(),
        rule: Some("intra.digest.faces"),
        covers: &[],
    });
    Ok(drafts)
}

const FRAMING: &[Fault] = &[
    ("signature", "file.signature.value", "A transfer as text changed the line ends.", |t| {
        t.before("unit_type", 0, &["file_signature = 0x8b4b4e4d0a1a0a00"])
    }),
    ("truncated_in_unit", "file.order", "The file ends inside the index.", |t| t.end("@cut 5")),
    ("truncated_at_unit", "file.order", "The index is missing altogether.", |t| t.without_unit(4)),
    ("trailing_byte", "file.order", "A byte behind the index.", |t| t.end("@append x00")),
    ("no_header", "file.order", "The file begins with an I-frame.", |t| {
        t.copy_unit(1, 0).without_unit(2)
    }),
    ("two_headers", "file.order", "A second sequence header.", |t| t.repeat_unit(0)),
    ("no_nodes", "file.order", "A P-frame that needs the key nodes of the group before.", |t| {
        t.copy_unit(1, 4).copy_unit(3, 5)
    }),
    ("two_nodes", "file.order", "Key nodes twice in a group.", |t| t.repeat_unit(2)),
    ("no_motion", "file.order", "Key nodes without a P-frame.", |t| t.without_unit(3)),
    ("group_too_long", "file.group.length", "Five frames where four are the most.", |t| {
        t.repeat_unit(3).repeat_unit(3).repeat_unit(3)
    }),
    ("flipped_bit", "unit.crc.match", "One bit of the I-frame's payload.", |t| t.end("@flip 700")),
    ("crc_zero", "unit.crc.match", "A writer that leaves the CRC out.", |t| {
        t.before("unit_type", 3, &["unit_crc = 0x0"])
    }),
    ("unit_type", "unit.type.known", "A reserved unit is not stepped over.", |t| {
        t.before("unit_type", 2, &["unit_type = 127", "unit_size = 0"])
    }),
    ("unit_size_huge", "unit.size.limit", "4 GiB promised: refuse before waiting.", |t| {
        t.after("unit_type", 1, &["unit_size = 4294967295"])
    }),
    ("unit_size_level", "unit.size.limit", "One byte above the level.", |t| {
        t.after("unit_type", 1, &["unit_size = 2097153"])
    }),
    ("spare_byte", "unit.size.exact", "A byte too many inside a unit.", |t| {
        t.before("unit_type", 3, &["pad = 0 as 0b000000000"])
    }),
    ("alignment", "unit.align.zero", "A bit in the alignment.", |t| {
        t.before("unit_type", 3, &["pad = 0 as 0b1"])
    }),
    ("size_not_shortest", "descriptor.uleb.shortest", "A size with a group too many.", |t| {
        t.after("unit_type", 0, &["unit_size = 46 as xae00"])
    }),
    ("size_too_long", "descriptor.uleb.range", "A size of six groups.", |t| {
        t.after("unit_type", 0, &["unit_size = 46 as xae8080808001"])
    }),
];

const HEADER: &[Fault] = &[
    ("version", "header.version.value", "Another version.", |t| t.set("version", 0, "1")),
    ("profile", "header.profile.known", "Another profile.", |t| t.set("profile", 0, "1")),
    ("level", "header.level.known", "A level that is not listed.", |t| t.set("level", 0, "3")),
    ("frame_rate", "header.rate.range", "Division by zero.", |t| {
        t.set("frame_rate_denominator", 0, "0")
    }),
    ("up_axis", "header.axis.range", "A fourth axis.", |t| t.set("up_axis", 0, "3")),
    ("unit_of_length", "header.length.known", "A reserved unit.", |t| {
        t.set("unit_of_length", 0, "6")
    }),
    ("fraction_bits", "header.fraction.range", "Coordinates of 29 bits and more.", |t| {
        t.set("fraction_bits", 0, "9")
    }),
    ("smoothing", "intra.smoothing.range", "A strength that no table has.", |t| {
        t.set("smoothing_strength", 0, "6")
    }),
    ("group_length", "header.group.range", "Groups without frames.", |t| {
        t.set("max_group_length", 0, "0")
    }),
    ("nodes_per_vertex", "header.nodes.range", "Nobody moves a vertex.", |t| {
        t.set("nodes_per_vertex", 0, "0")
    }),
    ("weight_scheme", "header.weight.known", "A reserved scheme.", |t| {
        t.set("weight_scheme", 0, "3")
    }),
    ("label_set", "header.labels.known", "A reserved set.", |t| t.set("label_set", 0, "3")),
    ("header_reserved", "header.reserved.zero", "A reserved bit.", |t| {
        t.after("names_present", 0, &["reserved_zero = 1"])
    }),
    ("grid_origin", "header.origin.finite", "Not a number.", |t| {
        t.set("grid_origin", 0, "0.0 0x7ff8000000000000 0.0")
    }),
    ("grid_step", "header.step.positive", "A step below zero.", |t| t.set("grid_step", 0, "-1.0")),
    ("label_count", "header.labels.count", "65 labels.", |t| {
        t.set("label_set", 0, "2").after(
            "grid_step",
            0,
            &["label_count = 65", "label_region = 0*65"],
        )
    }),
    ("label_region", "header.labels.region", "Region 64.", |t| {
        t.set("label_set", 0, "2").after("grid_step", 0, &["label_count = 1", "label_region = 64"])
    }),
    ("name_digits", "header.names.digits", "Names of hundreds of digits.", |t| {
        t.set("names_present", 0, "1").after(
            "grid_step",
            0,
            &["name_prefix = x66", "name_digits = 10", "name_first = 0"],
        )
    }),
    ("name_slash", "name.characters", "A name that leads into another folder.", |t| {
        t.set("name_present", 0, "1").after("name_present", 0, &["name = x2e2e2f61"])
    }),
    ("name_dots", "name.whole", "A name that is a folder.", |t| {
        t.set("name_present", 1, "1").after("name_present", 1, &["name = x2e2e"])
    }),
    ("frame_reserved", "frame.reserved.zero", "A reserved bit.", |t| {
        t.after("name_present", 0, &["reserved_zero = 32"])
    }),
    ("positions_digest", "frame.digest.positions", "Decoded positions differ.", |t| {
        t.set("digest_present", 1, "1").after("name_present", 1, &["positions_digest = 0x1"])
    }),
];

const NODES: &[Fault] = &[
    ("node_count_zero", "nodes.count.range", "Nobody moves a vertex.", |t| {
        t.set("node_count", 0, "0")
            .without("node_vertex_gap", 0)
            .without("affine_node", 0)
            .without_motion()
    }),
    ("node_count_level", "nodes.count.range", "More nodes than the level allows.", |t| {
        t.set("node_count", 0, "513")
            .set("node_vertex_gap", 0, "0*513")
            .set("affine_node", 0, "0*513")
            .without_motion()
    }),
    ("sigma_zero", "nodes.sigma.range", "Division by zero.", |t| {
        t.set("weight_scheme", 0, "2").after("affine_mode", 0, &["weight_sigma = 0"])
    }),
    ("node_vertex", "nodes.vertex.range", "Vertex 16 of 16.", |t| {
        t.set("node_vertex_gap", 0, "1 14").without_motion()
    }),
    ("node_position", "nodes.position.range", "A node outside the grid.", |t| {
        t.set("node_coding", 0, "1")
            .set("node_vertex_rice", 0, "20")
            .set("node_vertex_gap", 0, "-1048575 0 0 -1 0 0")
            .map_names(&[
                ("node_vertex_rice", "node_delta_rice"),
                ("node_vertex_gap", "node_delta"),
            ])
            .without_motion()
    }),
    ("gap_endless", "descriptor.rice.range", "A unary part of 33 ones.", |t| {
        t.set("node_vertex_rice", 0, "0")
            .set("node_vertex_gap", 0, "33 as xffffffffa0")
            .after("node_vertex_gap", 0, &["node_vertex_gap = 0"])
            .without_motion()
    }),
];

const MOTION: &[Fault] = &[
    ("reference_mode", "motion.reference.known", "A reserved mode.", |t| {
        t.set("reference_mode", 0, "1")
    }),
    ("entropy_mode", "motion.entropy.known", "A reserved mode.", |t| t.set("entropy_mode", 0, "1")),
    ("residual", "motion.residual.known", "A residual that nobody reads.", |t| {
        t.set("residual_present", 0, "1")
    }),
    ("translation_mode", "motion.translation.known", "A reserved mode.", |t| {
        t.set("translation_mode", 0, "3")
    }),
    ("enabled_rigid", "motion.enabled.affine", "Components that no node carries.", |t| {
        t.set("affine_node", 0, "0 0").without("scale_step", 0).without("scale", 0)
    }),
    ("table_48", "motion.table.range", "Beyond the last table.", |t| {
        t.set("parameter_table", 0, "10 as 0b110000")
    }),
    ("translation_mode_first", "motion.translation.first", "There is no frame before.", |t| {
        t.set("translation_mode", 0, "2").before("translation", 0, &["translation_change = 0*6"])
    }),
    ("translation_path_sum", "motion.translation.range", "Sums along the path grow.", |t| {
        t.set("translation_mode", 0, "1").set("translation_step", 0, "63").set(
            "translation",
            0,
            "4000 0 0 4000 0 0",
        )
    }),
    ("translation_change_sum", "motion.translation.range", "A change of 2^28 units.", |t| {
        t.repeat_unit(3).set("translation_step", 0, "32").set("translation_mode", 1, "2").before(
            "translation",
            1,
            &["translation_change = 1048575 0*5"],
        )
    }),
    ("translation_huge", "motion.translation.range", "A product that leaves 29 bits.", |t| {
        t.set("translation_step", 0, "63").set("translation", 0, "4682 0*5")
    }),
    (
        "translation_grid",
        "motion.translation.range",
        "2^20 grid steps, whatever the fraction.",
        |t| {
            t.set("fraction_bits", 0, "0").set("translation_step", 0, "4").set(
                "translation",
                0,
                "524288 0*5",
            )
        },
    ),
    ("value_huge", "descriptor.huffman.range", "An escaped value of 2^20.", |t| {
        t.set("translation", 0, "1048576 0*5")
    }),
    ("angle", "motion.rotation.range", "Beyond the range of the polynomials.", |t| {
        t.set("rotation_step", 0, "63").set("rotation", 0, "2 0*5")
    }),
    ("scale_zero", "motion.scale.range", "A node that collapses.", |t| {
        t.set("scale_step", 0, "56").set("scale", 0, "-1 0 0")
    }),
    ("scale_large", "motion.scale.range", "A scale of 9.", |t| {
        t.set("scale_step", 0, "56").set("scale", 0, "8 0 0")
    }),
];

const DEFORMATION: &[Fault] = &[
    ("region_without_node", "deform.influence.strict", "Strict, and the head has no node.", |t| {
        t.set("influence_mode", 0, "0").set("node_vertex_gap", 0, "11 2")
    }),
    ("vertex_flies_off", "deform.position.range", "A position outside the grid.", |t| {
        t.set("translation_step", 0, "48").set("translation", 0, "65535 0 0 65535 0 0")
    }),
    ("node_flies_off", "deform.nodes.move", "A node outside the grid, no vertex near it.", |t| {
        t.set("node_coding", 0, "1")
            .set("node_vertex_rice", 0, "20")
            .set("node_vertex_gap", 0, "0 0 0 1048575 0 0")
            .map_names(&[
                ("node_vertex_rice", "node_delta_rice"),
                ("node_vertex_gap", "node_delta"),
            ])
            .set("affine_node", 0, "0 0")
            .set("rotation_enabled", 0, "0")
            .set("scale_enabled", 0, "0")
            .without("scale_step", 0)
            .without("scale", 0)
            .set("nodes_per_vertex", 0, "1")
            .set("translation_step", 0, "24")
            .set("translation", 0, "0 0 0 4 0 0")
    }),
];

const INDEX_FAULTS: &[Fault] = &[
    ("index_empty", "index.count.range", "An index of no groups.", |t| t.end("group_count = 0")),
    ("index_frames_zero", "index.frames.range", "A group of no frames.", |t| {
        t.end("group_frames = 0")
    }),
    ("index_frames", "index.groups.match", "Three frames where there are two.", |t| {
        t.end("group_frames = 3")
    }),
    ("index_bytes", "index.groups.match", "An offset that leads elsewhere.", |t| {
        t.end("group_bytes = 7")
    }),
    ("index_size", "index.size.value", "A reader from the end would start elsewhere.", |t| {
        t.end("index_size = 0x10")
    }),
];
