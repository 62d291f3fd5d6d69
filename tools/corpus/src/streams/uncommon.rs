//! Streams that the syntax allows and encoders seldom write.

use anyhow::Result;

use super::Draft;
use kn_mesh::GridMesh;

use super::texts::{
    HEADER, INDEX, MOTION, NODES, Text, by_hand, intra_unit, knotted, payload_of, strip,
};

pub(crate) fn drafts() -> Result<Vec<Draft>> {
    let base = by_hand()?;
    let lists = [
        nodes_and_labels(&base),
        motion(&base),
        predicted_translations(&base)?,
        frames_and_meshes(&base)?,
    ];
    Ok(lists.concat())
}

/// A sound stream.
fn sound(name: &str, danger: &str, covers: &'static [&'static str], text: Text) -> Draft {
    let (name, danger) = (name.into(), danger.into());
    Draft { name, text: text.build(), danger, rule: None, covers }
}

/// Units that are skipped, key nodes, labels, weights.
fn nodes_and_labels(base: &Text) -> Vec<Draft> {
    vec![
        sound(
            "skippable_units",
            "Private units may stand anywhere between the header and the index; one may be empty, and \
             one stands between key nodes and motion.",
            &["unit.skipped", "semantics.reserved"],
            base.clone()
                .before("unit_type", 1, &["unit_type = 128", "skipped = x"])
                .before("unit_type", 4, &["unit_type = 255", "skipped = x0405060708"])
                .before("unit_type", 6, &["unit_type = 200", "skipped = x00"]),
        ),
        sound(
            "nodes_as_points",
            "Nodes off the surface take the label of the closest vertex, of two the lower one.",
            &["nodes.points", "nodes.label.nearest"],
            base.clone()
                .set("node_coding", 0, "1")
                .set("node_vertex_rice", 0, "5")
                .set("node_vertex_gap", 0, "56 8 -40 44 0 0")
                .map_names(&[
                    ("node_vertex_rice", "node_delta_rice"),
                    ("node_vertex_gap", "node_delta"),
                ]),
        ),
        sound(
            "nodes_in_one_place",
            "Two nodes in one point: ranks by index, distance floored at one step.",
            &["deform.influence.nearest", "deform.weights.floor"],
            base.clone()
                .set("node_coding", 0, "1")
                .set("node_vertex_rice", 0, "5")
                .set("node_vertex_gap", 0, "64 0 2 0 0 0")
                .map_names(&[
                    ("node_vertex_rice", "node_delta_rice"),
                    ("node_vertex_gap", "node_delta"),
                ])
                .set("affine_mode", 0, "3")
                .without("affine_label", 0)
                .after("node_delta", 0, &["affine_node = 0 1"]),
        ),
        sound(
            "affine_node_by_node",
            "Affine nodes are marked one by one, whatever their labels.",
            &["nodes.affine", "motion.order"],
            base.clone().set("affine_mode", 0, "3").without("affine_label", 0).after(
                "node_vertex_gap",
                0,
                &["affine_node = 1 0"],
            ),
        ),
        sound(
            "custom_labels",
            "Labels of the stream's own; several in one region, and a region without vertices.",
            &["header.labels.meaning"],
            base.clone()
                .set("label_set", 0, "2")
                .after("grid_step", 0, &["label_count = 9", "label_region = 3 9 9 9 9 9 9 63 0"])
                .set("affine_label", 0, "0*7 1 0"),
        ),
        sound(
            "fallback",
            "A region without nodes is moved by the nearest nodes of any region.",
            &["deform.influence.mode", "deform.influence.replication"],
            base.clone()
                .set("node_count", 0, "1")
                .set("node_vertex_gap", 0, "1")
                .set("rotation_enabled", 0, "0")
                .set("scale_enabled", 0, "0")
                .without("scale_step", 0)
                .without("scale", 0)
                .set("translation", 0, "3 -1 0")
                .set("rotation", 0, "1 0 -2"),
        ),
        sound(
            "wide_gaussian",
            "The widest sigma is 2^20 − 1.",
            &["deform.weights.gaussian", "nodes.sigma.meaning"],
            base.clone().set("weight_scheme", 0, "2").after(
                "affine_mode",
                0,
                &["weight_sigma = 1048575"],
            ),
        ),
        sound(
            "narrow_gaussian",
            "The narrowest sigma is 1; all nodes of a region in one point weigh the same.",
            &["deform.exp"],
            base.clone().set("weight_scheme", 0, "2").after(
                "affine_mode",
                0,
                &["weight_sigma = 1"],
            ),
        ),
    ]
}

/// Components, tables and steps of P-frames.
fn motion(base: &Text) -> Vec<Draft> {
    vec![
        sound(
            "translations_alone",
            "Affine nodes only and no component enabled: no steps, no table and no values but translations.",
            &["motion.counts", "motion.absent"],
            base.clone()
                .set("affine_mode", 0, "2")
                .without("affine_label", 0)
                .set("rotation_enabled", 0, "0")
                .set("scale_enabled", 0, "0")
                .without("rotation_step", 0)
                .without("scale_step", 0)
                .without("parameter_table", 0)
                .without("rotation", 0)
                .without("scale", 0),
        ),
        sound(
            "escapes",
            "Values beyond the table are escaped, up to the largest of the syntax.",
            &["descriptor.huffman.value", "descriptor.ue", "motion.translation"],
            base.clone().set("translation_step", 0, "0").set("translation_table", 0, "0").set(
                "translation",
                0,
                "16 -16 100 -5000 70000 -1048575",
            ),
        ),
        sound(
            "largest_table",
            "Table 47 has codes of 20 bits, the longest there are.",
            &[
                "descriptor.huffman.tables",
                "descriptor.huffman.lengths",
                "descriptor.huffman.codes",
                "descriptor.huffman.symbols",
            ],
            base.clone().set("translation_step", 0, "0").set("translation_table", 0, "47").set(
                "translation",
                0,
                "16383 -16383 16384 -1 0 700",
            ),
        ),
        sound(
            "largest_motion",
            "Steps at the top of their range, angles beyond a half turn.",
            &[
                "motion.exact",
                "motion.step.parameter",
                "motion.rotation",
                "motion.scale",
                "deform.sincos",
            ],
            base.clone()
                .set("rotation_step", 0, "63")
                .set("rotation", 0, "1 -1 0 0 1 1")
                .set("scale_step", 0, "56")
                .set("scale", 0, "7 0 1")
                .set("grid_step", 0, "5e-324"),
        ),
        sound(
            "shear",
            "Shears beyond a right angle's tangent.",
            &["motion.shear", "deform.matrix"],
            {
                let motion = Text::new(MOTION)
                    .set("scale_enabled", 0, "0")
                    .set("shear_enabled", 0, "1")
                    .set("scale_step", 0, "52")
                    .set("scale", 0, "16 -15 9")
                    .map_names(&[("scale_step", "shear_step"), ("scale", "shear")]);
                let before = base.clone().without_unit(3).without_unit(3).build();
                Text::new(&format!("{before}{}{INDEX}", motion.build()))
            },
        ),
    ]
}

/// Predictions of translations.
fn predicted_translations(base: &Text) -> Result<Vec<Draft>> {
    Ok(vec![
        sound(
            "translation_dictionaries",
            "A change is coded with step and table of the frame before, not of its own or of the first.",
            &["motion.translation.previous", "motion.prediction.temporal", "motion.parts"],
            base.clone()
                .repeat_unit(3)
                .repeat_unit(4)
                .set("translation_mode", 1, "2")
                .set("translation_step", 1, "13")
                .set("translation_table", 1, "2")
                .before("translation", 1, &["translation_change = 2 -1 0 0 900 1"])
                .set("translation_mode", 2, "2")
                .set("translation_step", 2, "5")
                .before("translation", 2, &["translation_change = 1 0 -3 16 0 0"]),
        ),
        sound(
            "translation_back_to_spatial",
            "After a spatio-temporal frame a spatial one is predicted from nothing before it.",
            &["motion.prediction.spatial", "motion.prediction.direct"],
            base.clone()
                .repeat_unit(3)
                .repeat_unit(4)
                .set("translation_mode", 0, "1")
                .set("translation_mode", 1, "2")
                .before("translation", 1, &["translation_change = 0 1 0 2 0 0"])
                .set("translation_mode", 2, "1"),
        ),
        sound(
            "translation_ring",
            "A node on the centre of its layer, two in one direction, four on the axes' quarters.",
            &["path.angle", "path.ring", "path.layers"],
            ring_of_nodes()?,
        ),
    ])
}

/// Names, the grid, meshes.
fn frames_and_meshes(base: &Text) -> Result<Vec<Draft>> {
    Ok(vec![
        sound(
            "frame_names",
            "Names in frame headers, not in ASCII, override the pattern.",
            &["frame.name.meaning"],
            base.clone()
                .set("names_present", 0, "1")
                .after(
                    "grid_step",
                    0,
                    &["name_prefix = x66", "name_digits = 9", "name_first = 4294967295"],
                )
                .set("name_present", 0, "1")
                .after("name_present", 0, &["name = xc3a974c3a9"])
                .set("name_present", 1, "1")
                .after("name_present", 1, &["name = x2e2e2e"]),
        ),
        sound(
            "grid_extremes",
            "World coordinates may be anything finite: frames are integers.",
            &["header.grid.meaning"],
            base.clone().set("grid_origin", 0, "-1.7976931348623157e308 0.0 -0.0").set(
                "grid_step",
                0,
                "2.2250738585072014e-308",
            ),
        ),
        sound(
            "intra_only_groups",
            "GoFs of one frame each, and no key nodes at all.",
            &["conformance.process"],
            {
                let intra = intra_unit(&payload_of(&strip(4, Some([0, 7])))?);
                Text::new(&format!("{HEADER}{intra}{intra}{intra}{INDEX}"))
            },
        ),
        sound(
            "knotted_mesh",
            "An edge of three faces, a face that repeats a vertex, a vertex without faces.",
            &[
                "intra.decoded.order",
                "intra.join",
                "intra.join.twins",
                "intra.geometry.twins",
                "intra.geometry.isolated",
                "intra.labels.isolated",
            ],
            Text::new(&format!("{HEADER}{}{INDEX}", intra_unit(&payload_of(&knotted())?))),
        ),
        sound(
            "empty_mesh",
            "A frame may have no vertices.",
            &["intra.payload"],
            Text::new(&format!(
                "{HEADER}{}{INDEX}",
                intra_unit(&payload_of(&GridMesh::default())?)
            ))
            .set("label_set", 0, "0"),
        ),
    ])
}

/// Nine nodes without labels, each a neighbour of the topmost: a layer about (56, 0).
fn ring_of_nodes() -> Result<Text> {
    // (x, z) from the centre; the top is the last, so that its index decides nothing.
    let layer = [[-48, 0], [32, 0], [16, 0], [0, 0], [-16, -16], [16, -16], [16, 16], [-16, 16]];
    let mut points: Vec<[i32; 3]> = layer.iter().map(|[x, z]| [56 + x, 8, *z]).collect();
    points.push([48, 15, 2]);
    let mut last = [0; 3];
    let mut deltas = String::new();
    for point in points {
        for axis in 0..3 {
            deltas.push_str(&format!("{} ", point[axis] - last[axis]));
        }
        last = point;
    }
    let intra = intra_unit(&payload_of(&strip(8, None))?);
    let values: String = (0..27).map(|value| format!("{} ", value * value % 7 - 3)).collect();
    Ok(Text::new(&format!("{HEADER}{intra}{NODES}{MOTION}{INDEX}"))
        .set("label_set", 0, "0")
        .set("nodes_per_vertex", 0, "8")
        .set("node_count", 0, "9")
        .set("node_coding", 0, "1")
        .set("affine_mode", 0, "0")
        .without("affine_label", 0)
        .set("node_vertex_rice", 0, "5")
        .set("node_vertex_gap", 0, &deltas)
        .map_names(&[("node_vertex_rice", "node_delta_rice"), ("node_vertex_gap", "node_delta")])
        .set("translation_mode", 0, "1")
        .set("rotation_enabled", 0, "0")
        .set("scale_enabled", 0, "0")
        .without("scale_step", 0)
        .without("scale", 0)
        .set("translation", 0, &values)
        .set("rotation", 0, "0*27"))
}
