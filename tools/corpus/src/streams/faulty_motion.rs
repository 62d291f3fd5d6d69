//! Streams that break one rule each: of key nodes, of P-frames, of deformation.

use super::faulty::Fault;
use super::texts::Text;

/// Nodes as points, by their differences, both rigid.
fn points(text: Text, rice: &str, deltas: &str) -> Text {
    rigid(text)
        .set("node_coding", 0, "1")
        .set("node_vertex_rice", 0, rice)
        .set("node_vertex_gap", 0, deltas)
        .map_names(&[("node_vertex_rice", "node_delta_rice"), ("node_vertex_gap", "node_delta")])
}

/// Two rigid nodes that do not turn.
fn rigid(text: Text) -> Text {
    text.set("affine_node", 0, "0 0")
        .set("rotation_enabled", 0, "0")
        .set("scale_enabled", 0, "0")
        .without("scale_step", 0)
        .without("scale", 0)
        .set("rotation", 0, "0*6")
}

/// So many rigid nodes in one point, which do not move.
fn idle(text: Text, count: usize) -> Text {
    let none = format!("0*{}", 3 * count);
    points(text, "0", &none)
        .set("node_count", 0, &count.to_string())
        .set("affine_mode", 0, "0")
        .without("affine_node", 0)
        .set("translation", 0, &none)
        .set("rotation", 0, &none)
}

pub(super) const NODES: &[Fault] = &[
    ("node_count_zero", "nodes.count.range", "Key nodes of which there are none.", |t| {
        idle(t, 1)
            .set("node_count", 0, "0")
            .without("node_delta", 0)
            .without("rotation_step", 0)
            .without("parameter_table", 0)
            .without("translation", 0)
            .without("rotation", 0)
    }),
    ("node_count_level", "nodes.count.range", "More nodes than the level allows.", |t| {
        idle(t, 513)
    }),
    ("sigma_zero", "nodes.sigma.range", "A squared distance divided by zero.", |t| {
        t.set("weight_scheme", 0, "2").after("affine_mode", 0, &["weight_sigma = 0"])
    }),
    ("sigma_large", "nodes.sigma.range", "A sigma of 2^20, as wide as the grid.", |t| {
        t.set("weight_scheme", 0, "2").after("affine_mode", 0, &["weight_sigma = 1048576"])
    }),
    ("node_vertex", "nodes.vertex.range", "Vertex 16 of 16.", |t| {
        t.set("node_vertex_gap", 0, "1 14")
    }),
    ("node_position", "nodes.position.range", "A node a step before the grid.", |t| {
        points(t, "20", "-1048575 0 0 -1 0 0").set("translation", 0, "0 0 0 9 0 0")
    }),
    ("node_position_above", "nodes.position.range", "A node a step behind the grid.", |t| {
        points(t, "20", "0 1048575 0 0 1 0").set("translation", 0, "0 0 0 0 -9 0")
    }),
    ("delta_endless", "descriptor.rice.range", "33 ones for a small number.", |t| {
        let long = "-17 as 0b1111111111111111111111111111111110";
        points(t, "0", long).after("node_delta", 0, &["node_delta = 0 0 4 0 0"])
    }),
    ("gap_wraps", "descriptor.rice.range", "A gap of 2^32 and a little more.", |t| {
        t.set("node_vertex_rice", 0, "31")
            .set("node_vertex_gap", 0, "1 as 0b1100000000000000000000000000000001")
            .after("node_vertex_gap", 0, &["node_vertex_gap = 8"])
    }),
    ("gap_endless", "descriptor.rice.range", "A unary part of 33 ones.", |t| {
        t.set("node_vertex_rice", 0, "0")
            .set("node_vertex_gap", 0, "33 as xffffffffa0")
            .after("node_vertex_gap", 0, &["node_vertex_gap = 0"])
            .without_motion()
    }),
];

pub(super) const MOTION: &[Fault] = &[
    ("reference_mode", "motion.reference.known", "A reserved reference mode.", |t| {
        t.set("reference_mode", 0, "1")
    }),
    ("entropy_mode", "motion.entropy.known", "A reserved entropy mode.", |t| {
        t.set("entropy_mode", 0, "1")
    }),
    ("residual", "motion.residual.known", "A residual that nobody reads.", |t| {
        t.set("residual_present", 0, "1")
    }),
    (
        "translation_mode",
        "motion.translation.known",
        "A reserved prediction of translations.",
        |t| t.set("translation_mode", 0, "3"),
    ),
    ("enabled_rigid", "motion.enabled.affine", "Components that no node carries.", |t| {
        t.set("affine_node", 0, "0 0").without("scale_step", 0).without("scale", 0)
    }),
    ("table_48", "motion.table.range", "Beyond the last table.", |t| {
        t.set("parameter_table", 0, "47 as 0b110000")
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
    ("value_huge", "descriptor.huffman.range", "An escaped value of 2^20.", |t| {
        t.set("translation", 0, "1048576 0*5")
    }),
    ("value_low", "descriptor.huffman.range", "An escaped value of −2^20.", |t| {
        t.set("translation", 0, "-1048576 0*5")
    }),
    ("escape_endless", "descriptor.ue.range", "An escaped value with 21 ones.", |t| {
        let long = "0 as 0b11011111111111111111111111011111111111111111111111110";
        t.set("translation_table", 0, "8").set("translation", 0, long).after(
            "translation",
            0,
            &["translation = 0*5"],
        )
    }),
    ("angle", "motion.rotation.range", "Beyond the range of the polynomials.", |t| {
        t.set("rotation_step", 0, "63").set("rotation", 0, "2 0*5")
    }),
    ("angle_back", "motion.rotation.range", "An angle as far below zero.", |t| {
        t.set("rotation_step", 0, "63").set("rotation", 0, "-2 0*5")
    }),
    ("scale_zero", "motion.scale.range", "A node that collapses.", |t| {
        t.set("scale_step", 0, "56").set("scale", 0, "-1 0 0")
    }),
    ("scale_large", "motion.scale.range", "A scale of 9.", |t| {
        t.set("scale_step", 0, "56").set("scale", 0, "8 0 0")
    }),
    ("shear_large", "motion.shear.range", "A shear of 9.", |t| sheared(t, "9 0 0")),
    ("shear_low", "motion.shear.range", "A shear of −9.", |t| sheared(t, "0 0 -9")),
];

/// Shears of the affine node, in ones.
fn sheared(text: Text, values: &str) -> Text {
    text.set("shear_enabled", 0, "1").after("scale_step", 0, &["shear_step = 56"]).after(
        "scale",
        0,
        &[&format!("shear = {values}")],
    )
}

pub(super) const DEFORMATION: &[Fault] = &[
    ("region_without_node", "deform.influence.strict", "Strict, and the head has no node.", |t| {
        t.set("influence_mode", 0, "0").set("node_vertex_gap", 0, "11 2")
    }),
    ("vertex_flies_off", "deform.position.range", "A position outside the grid.", |t| {
        t.set("translation_step", 0, "48").set("translation", 0, "65535 0 0 65535 0 0")
    }),
    ("node_flies_off", "deform.nodes.move", "A node outside the grid, no vertex near it.", |t| {
        leaving(t, "0 0 0 1048575 0 0", "0 0 0 4 0 0")
    }),
    ("node_flies_back", "deform.nodes.move", "A node outside the grid on its lower side.", |t| {
        leaving(t, "0 0 0 0 0 -1048575", "0 0 0 0 0 -4")
    }),
];

/// Two nodes as points, each vertex with the nearest.
fn leaving(text: Text, deltas: &str, translation: &str) -> Text {
    points(text, "20", deltas).set("nodes_per_vertex", 0, "1").set("translation", 0, translation)
}
