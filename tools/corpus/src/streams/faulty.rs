//! Streams that break one rule each, made from a sound one.

use anyhow::Result;

use super::Draft;
use super::faulty_motion::{DEFORMATION, MOTION, NODES};
use super::texts::{Text, by_hand, payload_of, positions_digest_of, strip};

/// A name, the rule that it breaks, the mistake that it catches, and the edits.
pub(super) type Fault = (&'static str, &'static str, &'static str, fn(Text) -> Text);

pub(crate) fn drafts() -> Result<Vec<Draft>> {
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
            "truncated_in_unit" => &[
                "conformance.truncated",
                "conformance.verdict",
                "conventions.refusal",
                "descriptor.end",
            ],
            "vertex_flies_off" => &["conformance.coordinates"],
            _ => &[],
        },
    };
    let lists = [FRAMING, HEADER, NODES, MOTION, DEFORMATION, INDEX_FAULTS];
    let mut drafts: Vec<Draft> = lists.into_iter().flatten().map(draft).collect();
    let beyond = format!("intra_size = {}", payload_of(&strip(8, Some([0, 7])))?.len() + 1);
    let digest = positions_digest_of(&strip(8, Some([0, 7])))?;
    let digests = [&format!("positions_digest = 0x{digest:x}"), "faces_digest = 0x1"];
    drafts.push(Draft {
        name: "payload_beyond".into(),
        text: base.clone().before("lattice_present", 0, &[&beyond]).build(),
        danger: "A mesh of a byte more than its unit has.".into(),
        rule: Some("intra.sections.size"),
        covers: &[],
    });
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
    ("no_nodes", "file.order", "A P-frame that needs the key nodes of the GoF before.", |t| {
        t.copy_unit(1, 4).copy_unit(3, 5)
    }),
    ("two_nodes", "file.order", "Key nodes twice in a GoF.", |t| t.repeat_unit(2)),
    ("no_motion", "file.order", "Key nodes without a P-frame.", |t| t.without_unit(3)),
    ("no_frames", "file.order", "A file without frames, and an index that says so.", |t| {
        t.without_unit(3).without_unit(2).without_unit(1).end("group_count = 0")
    }),
    ("skipped_before_header", "file.order", "Private data before the sequence header.", |t| {
        t.before("unit_type", 0, PRIVATE)
    }),
    ("skipped_behind_index", "file.order", "Private data behind the index.", |t| {
        PRIVATE.iter().fold(t, |t, line| t.end(line))
    }),
    ("group_too_long", "file.group.length", "A fifth frame in groups of four.", |t| {
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
    ("size_not_shortest", "descriptor.uleb.shortest", "A size with a byte too many.", |t| {
        t.after("unit_type", 0, &["unit_size = 41 as xa900"])
    }),
    ("size_too_long", "descriptor.uleb.range", "A size of six bytes.", |t| {
        t.after("unit_type", 0, &["unit_size = 41 as xa98080808001"])
    }),
    ("size_wraps", "descriptor.uleb.range", "A size that is right but for 2^32.", |t| {
        t.after("unit_type", 0, &["unit_size = 41 as xa980808010"])
    }),
    (
        "header_short",
        "unit.size.exact",
        "The last byte of a unit is missing; it would be 0.",
        |t| t.set("grid_step", 0, "1.0 as x3ff00000000000"),
    ),
];

const PRIVATE: &[&str] = &["unit_type = 128", "unit_size = 1", "skipped = x00"];

const HEADER: &[Fault] = &[
    ("version", "header.version.value", "Another version.", |t| t.set("version", 0, "1")),
    ("profile", "header.profile.known", "Another profile.", |t| t.set("profile", 0, "1")),
    ("level", "header.level.known", "A level that is not listed.", |t| t.set("level", 0, "3")),
    ("frame_rate", "header.rate.range", "Frames at a time divided by zero.", |t| {
        t.set("frame_rate_denominator", 0, "0")
    }),
    ("frame_rate_zero", "header.rate.range", "No frames in a second.", |t| {
        t.set("frame_rate_numerator", 0, "0")
    }),
    ("up_axis", "header.axis.range", "A fourth axis.", |t| t.set("up_axis", 0, "3")),
    ("unit_of_length", "header.length.known", "A reserved unit of length.", |t| {
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
    (
        "group_length_level",
        "header.group.range",
        "Groups of more frames than the level allows.",
        |t| t.set("max_group_length", 0, "33"),
    ),
    ("nodes_per_vertex", "header.nodes.range", "Vertices without a slot for a node.", |t| {
        t.set("nodes_per_vertex", 0, "0")
    }),
    ("nodes_per_vertex_9", "header.nodes.range", "Nine slots where a decoder has eight.", |t| {
        t.set("nodes_per_vertex", 0, "9")
    }),
    ("weight_scheme", "header.weight.known", "A reserved weighting scheme.", |t| {
        t.set("weight_scheme", 0, "3")
    }),
    ("label_set", "header.labels.known", "A reserved set of labels.", |t| {
        t.set("label_set", 0, "3")
    }),
    ("header_reserved", "header.reserved.zero", "A reserved bit of the sequence header.", |t| {
        t.after("names_present", 0, &["reserved_zero = 1"])
    }),
    ("grid_origin", "header.origin.finite", "Not a number.", |t| {
        t.set("grid_origin", 0, "0.0 0x7ff8000000000000 0.0")
    }),
    ("grid_step", "header.step.positive", "A step below zero.", |t| t.set("grid_step", 0, "-1.0")),
    ("grid_step_infinite", "header.step.positive", "A step without end.", |t| {
        t.set("grid_step", 0, "0x7ff0000000000000")
    }),
    ("label_count", "header.labels.count", "65 labels.", |t| {
        t.set("label_set", 0, "2").after(
            "grid_step",
            0,
            &["label_count = 65", "label_region = 0*65"],
        )
    }),
    ("label_region", "header.labels.region", "Region 64.", |t| {
        let regions = &["label_count = 8", "label_region = 0*7 64"];
        t.set("label_set", 0, "2").after("grid_step", 0, regions)
    }),
    ("name_digits", "header.names.digits", "Names of hundreds of digits.", |t| {
        t.set("names_present", 0, "1").after(
            "grid_step",
            0,
            &["name_prefix = x66", "name_digits = 10", "name_first = 0"],
        )
    }),
    ("prefix_slash", "name.characters", "A prefix of names that leads out of the folder.", |t| {
        let names = &["name_prefix = x2e2e2f", "name_digits = 3", "name_first = 0"];
        t.set("names_present", 0, "1").after("grid_step", 0, names)
    }),
    ("name_backslash", "name.characters", "A name that leads elsewhere on some systems.", |t| {
        named(t, "x2e2e5c61")
    }),
    ("name_colon", "name.characters", "A name that begins with a drive or names a stream.", |t| {
        named(t, "x633a61")
    }),
    ("name_control", "name.characters", "A name with an escape sequence for terminals.", |t| {
        named(t, "x1b5b326a")
    }),
    ("name_zero", "name.characters", "A name that ends early for the system.", |t| {
        named(t, "x610062")
    }),
    ("name_delete", "name.characters", "U+007F, a control character above the letters.", |t| {
        named(t, "x617f")
    }),
    ("name_control_high", "name.characters", "U+009F, the last of the control characters.", |t| {
        named(t, "x61c29f")
    }),
    ("name_latin", "name.characters", "A name in Latin-1, which is not UTF-8.", |t| {
        named(t, "x6de47263")
    }),
    ("name_overlong", "name.characters", "A slash hidden in an overlong form.", |t| {
        named(t, "x2e2ec0af61")
    }),
    (
        "name_surrogate",
        "name.characters",
        "Half of a surrogate pair, as some encoders write it.",
        |t| named(t, "xeda080"),
    ),
    ("name_slash", "name.characters", "A name that leads into another folder.", |t| {
        t.set("name_present", 0, "1").after("name_present", 0, &["name = x2e2e2f61"])
    }),
    ("name_empty", "name.whole", "A name of no characters.", |t| named(t, "x")),
    ("name_dot", "name.whole", "A name that is the folder itself.", |t| named(t, "x2e")),
    ("name_dots", "name.whole", "A name that is the folder above.", |t| {
        t.set("name_present", 1, "1").after("name_present", 1, &["name = x2e2e"])
    }),
    ("frame_reserved", "frame.reserved.zero", "A reserved bit of a frame header.", |t| {
        t.after("name_present", 0, &["reserved_zero = 32"])
    }),
    ("positions_digest", "frame.digest.positions", "Decoded positions differ.", |t| {
        t.set("digest_present", 1, "1").after("name_present", 1, &["positions_digest = 0x1"])
    }),
];

/// The I-frame with a name.
fn named(text: Text, name: &str) -> Text {
    text.set("name_present", 0, "1").after("name_present", 0, &[&format!("name = {name}")])
}

const INDEX_FAULTS: &[Fault] = &[
    ("index_empty", "index.count.range", "An index of no GoFs.", |t| t.end("group_count = 0")),
    ("index_frames_zero", "index.frames.range", "A GoF of no frames.", |t| {
        t.end("group_frames = 0")
    }),
    ("index_frames_many", "index.frames.range", "Five frames where four are the most.", |t| {
        t.end("group_frames = 5")
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
