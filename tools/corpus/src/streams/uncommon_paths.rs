//! Paths over nodes on a lattice: ties of height, distance, product and angle everywhere.

use anyhow::Result;

use kn_mesh::GridMesh;

use super::Draft;
use super::shapes::Noise;
use super::texts::{HEADER, INDEX, Text};
use super::uncommon_motion::{Motion, Scene};

/// A stream: its name, `up_axis`, `label_set` and the spacing of the lattice.
const STREAMS: [(&str, u8, u8, i32); 4] = [
    ("path_body", 1, 1, 4),
    ("path_plain", 0, 0, 3),
    ("path_custom", 2, 2, 3),
    ("path_wide", 2, 1, 1),
];

/// A label in whose region there is no node.
const WITHOUT_NODES: u8 = 14;

pub(crate) fn drafts() -> Result<Vec<Draft>> {
    STREAMS.map(stream).into_iter().collect()
}

fn stream((name, up_axis, label_set, spacing): (&str, u8, u8, i32)) -> Result<Draft> {
    let mut noise = Noise::new(31 + u64::from(up_axis) + 3 * u64::from(label_set));
    let mut header = Text::new(HEADER)
        .set("fraction_bits", 0, "4")
        .set("max_group_length", 0, "6")
        .set("nodes_per_vertex", 0, "2")
        .set("weight_scheme", 0, "1")
        .set("up_axis", 0, &up_axis.to_string())
        .set("label_set", 0, &label_set.to_string());
    if label_set == 2 {
        let regions = "label_region = 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14";
        header = header.after("grid_step", 0, &["label_count = 15", regions]);
    }
    let mut text = header.clone().build();
    for _ in 0..6 {
        text += &scene(&header, label_set, spacing, &mut noise).group()?;
    }
    Ok(Draft {
        name: name.into(),
        text: text + INDEX,
        danger: "Nodes on a lattice: ties of height, distance, product and angle on the path, slots of weight 0, \
                 components of several labels, modes in turn."
            .into(),
        rule: None,
        covers: COVERS,
    })
}

/// Clusters of nodes with a vertex on each and one beside it. Where labels do not tell nodes apart
/// two may be in one point.
fn scene(header: &Text, label_set: u8, spacing: i32, noise: &mut Noise) -> Scene {
    let (mut nodes, mut labels): (Vec<[i32; 3]>, Vec<u8>) = Default::default();
    let clusters: &[u8] = if label_set == 0 { &[0; 3] } else { &[7, 0, 10, 9, 3, 2, 12, 13] };
    for &label in clusters {
        let at = noise.point(6);
        for _ in 0..3 + noise.below(7) {
            let off = noise.point(2);
            let node = [0, 1, 2].map(|axis| spacing * (at[axis] + off[axis]));
            if label_set == 0 || !nodes.contains(&node) {
                nodes.push(node);
                labels.push(label);
            }
        }
    }
    let beside: Vec<[i32; 3]> =
        nodes.iter().map(|&[x, y, z]| [x + noise.around(1), y, z + 1]).collect();
    let mut mesh = GridMesh::new([nodes.clone(), beside].concat(), Vec::new());
    if label_set > 0 {
        mesh.labels = labels.repeat(2);
        // Without a node of their own they connect nodes of other parts.
        mesh.positions.extend((0..2).map(|_| noise.point(8 * spacing)));
        mesh.labels.extend([WITHOUT_NODES; 2]);
    }
    labels.sort_unstable();
    labels.dedup();
    let mut motion = |mode| Motion {
        translation: nodes.iter().map(|_| noise.point(40)).collect(),
        turn_or_scale: vec![[0; 3]; nodes.len()],
        steps: [[5, 7, 9, 13][noise.below(4)], 0],
        mode,
        changes: labels.iter().map(|_| noise.point(9)).collect(),
    };
    let motions = [1, 2, 1, 0, 2].map(&mut motion).into();
    Scene { header: header.clone(), mesh, nodes, affine: false, sigma: None, motions }
}

const COVERS: &[&str] = &[
    "motion.prediction.spatial",
    "motion.prediction.temporal",
    "motion.translation.previous",
    "path.mean",
    "path.graph",
    "path.order",
    "path.part",
    "path.references",
    "path.start.highest",
    "path.start.nearest",
    "path.angle",
    "path.ring",
];
