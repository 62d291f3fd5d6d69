//! Streams for readings of the text that were open, one a reading.

use anyhow::{Context, Result};

use kn_codec::intra::{IntraDecoder, IntraLimits, decode_intra, encode_intra};
use kn_mesh::GridMesh;

use super::Draft;
use super::decisions::{payload, section};
use super::shapes::{
    Faces, Noise, bipyramid, crowd, curled, mesh, sphere, together, turned_edges, without_vertex,
};
use super::texts::{HEADER, INDEX, Text, intra_unit, payload_of};
use super::uncommon_meshes::{groups, noise_labels};
use super::uncommon_motion::{Motion, Scene};

pub(crate) fn drafts() -> Result<Vec<Draft>> {
    Ok(vec![
        groups(
            "lone_triangle",
            "A mesh of one face: four triangles in all, as many as may be for a face.",
            &["intra.faces.count", "intra.connectivity.new"],
            &[mesh(vec![[0, 1, 2]], |v| curled(v, 90.0, 3), None)],
        )?,
        raw_faces(),
        groups(
            "long_splits",
            "Splits that walk more than 1024 steps in all: the triangles so far add to what they may.",
            &["intra.connectivity.split"],
            &[crowded(22)],
        )?,
        groups(
            "label_dummies",
            "Vertices of more than 32 triangles beside a hole: the dummy counts among the 32.",
            &["intra.labels.border"],
            &beside_holes(),
        )?,
        groups(
            "wide_means",
            "Means whose numerators are beyond 2^53, where binary64 rounds.",
            &["intra.geometry.frame", "conventions.integers"],
            &far_apart(),
        )?,
        node_in_one_place()?,
        nodes_between_vertices()?,
        coincident_nodes()?,
    ])
}

/// Two raw faces, one of them of three different vertices.
fn raw_faces() -> Draft {
    let corner = |v: u32| format!("16:0 16:{v} ");
    let corners: String = [0, 1, 2, 2, 2, 1].map(corner).concat();
    let one = "is_zero=0 is_negative=0 longer.0=0 ";
    let zero = "is_zero=1 ";
    let places = [zero, zero, zero, one, zero, zero, zero, one, zero].concat();
    let sections = [section(&corners), section(&places), vec![]];
    let unit = intra_unit(&payload(0, [3, 3, 2, 2, 0, 0], sections));
    let header = HEADER.replace("label_set = 1", "label_set = 0");
    Draft {
        name: "raw_faces".into(),
        text: format!("{header}{unit}{INDEX}"),
        danger: "A raw face of three different vertices, which the conquest could have brought."
            .into(),
        rule: None,
        covers: &["intra.faces.raw", "intra.counts.meaning"],
    }
}

fn crowded(size: u32) -> GridMesh {
    mesh(crowd(size), |v| curled(v, 500.0, 9), None)
}

/// Bipyramids that lack the faces around vertices of their rings, so that both tips are on a hole.
fn beside_holes() -> Vec<GridMesh> {
    let open = |sides: u32, gap: u32| without_vertex(&bipyramid(sides), gap);
    let opened: Vec<Faces> = [(36, 3), (40, 11), (44, 20), (38, 30), (50, 27)]
        .map(|(sides, gap)| open(sides, gap))
        .into();
    let faces = together(&opened);
    let turned = turned_edges(faces.clone(), 60, &mut Noise::new(3));
    vec![
        mesh(faces.clone(), |v| curled(v, 700.0, 90), Some(&mut noise_labels(2))),
        mesh(faces, |v| curled(v, 300.0, 20), Some(&mut noise_labels(3))),
        mesh(turned, |v| curled(v, 700.0, 90), Some(&mut noise_labels(2))),
    ]
}

/// Vertices at the ends of the grid beside vertices of many triangles.
fn far_apart() -> Vec<GridMesh> {
    let mut noise = Noise::new(41);
    let mut far = |_| {
        [(); 3].map(|()| {
            let end = if noise.below(2) == 0 { 1 } else { -1 };
            end * ((1 << 20) - 1 - noise.below(1 << 16) as i32)
        })
    };
    let surfaces = together(&[sphere(24, 9), bipyramid(30)]);
    vec![mesh(surfaces, &mut far, None)]
}

/// The mesh as it is decoded.
fn decoded(mesh: &GridMesh) -> Result<GridMesh> {
    let limits = IntraLimits { max_vertices: 1 << 12, max_faces: 1 << 12 };
    let mut decoded = GridMesh::default();
    let encoding = encode_intra(mesh)?;
    decode_intra(&encoding.payload(), &limits, &mut IntraDecoder::default(), &mut decoded)?;
    Ok(decoded)
}

fn labelled_header(labels: usize) -> Text {
    let regions: Vec<String> = (0..labels).map(|label| label.to_string()).collect();
    let lines =
        [format!("label_count = {labels}"), format!("label_region = {}", regions.join(" "))];
    Text::new(HEADER).set("label_set", 0, "2").after(
        "grid_step",
        0,
        &lines.each_ref().map(String::as_str),
    )
}

/// A node on the higher of two vertices that are at one place and have different labels.
fn node_in_one_place() -> Result<Draft> {
    let places = vec![[0; 3], [0; 3], [40, 0, 0], [80, 0, 0]];
    let mesh = GridMesh::new(places, Vec::new()).with_labels(vec![0, 1, 0, 1]);
    let found = decoded(&mesh)?;
    let here: Vec<usize> = (0..4).filter(|&v| found.positions[v] == [0; 3]).collect();
    let [low, high]: [usize; 2] =
        here.as_slice().try_into().context("two vertices at one place")?;
    anyhow::ensure!(found.labels[low] != found.labels[high], "labels differ");
    let other = (0..4).rev().find(|v| !here.contains(v)).context("another vertex")?;
    let [first, second] = [high.min(other), high.max(other)];
    let nodes = format!(
        "\nunit_type = 3\nnode_count = 2\nnode_coding = 0\naffine_mode = 0\nnode_vertex_rice = 2\n\
         node_vertex_gap = {first} {}\n",
        second - first - 1
    );
    let motion = "
unit_type = 4
digest_present = 0
name_present = 0
reference_mode = 0
entropy_mode = 0
residual_present = 0
translation_mode = 0
rotation_enabled = 0
scale_enabled = 0
shear_enabled = 0
translation_step = 40
translation_table = 10
rotation_step = 24
parameter_table = 10
translation = 3 -1 0 -5 0 -2
rotation = 0*6
";
    let header = labelled_header(2).build();
    let unit = intra_unit(&payload_of(&mesh)?);
    Ok(Draft {
        name: "node_in_one_place".into(),
        text: format!("{header}{unit}{nodes}{motion}{INDEX}"),
        danger: "A node on a vertex has the label of the lowest vertex at that place, not its own."
            .into(),
        rule: None,
        covers: &["nodes.label.nearest"],
    })
}

/// Nodes half-way between vertices that smoothing moves.
fn nodes_between_vertices() -> Result<Draft> {
    let even = |v| curled(v, 60.0, 4).map(|x| 2 * x);
    let mesh = mesh(sphere(9, 6), even, Some(&mut noise_labels(3)));
    let edges = mesh.faces.iter().map(|face| [face[0] as usize, face[1] as usize]);
    let half_way = |[a, b]: [usize; 2]| {
        [0, 1, 2].map(|axis| (mesh.positions[a][axis] + mesh.positions[b][axis]) / 2)
    };
    let nodes: Vec<[i32; 3]> = edges.step_by(3).map(half_way).collect();
    let mut noise = Noise::new(8);
    let motion = Motion {
        translation: nodes.iter().map(|_| noise.point(9)).collect(),
        turn_or_scale: vec![[0; 3]; nodes.len()],
        steps: [24, 20],
        ..Motion::default()
    };
    let scene = Scene {
        header: labelled_header(3),
        mesh,
        nodes,
        affine: false,
        sigma: None,
        motions: vec![motion],
    };
    let danger =
        "Nodes as far from two vertices, which smoothing moves: their labels follow from the grid.";
    let mut draft =
        scene.draft("nodes_between_vertices", danger, None, &["nodes.label.nearest"])?;
    draft.text = draft.text.replace("smoothing_strength = 0", "smoothing_strength = 5");
    Ok(draft)
}

/// More nodes in one place than move a vertex that is there too.
fn coincident_nodes() -> Result<Draft> {
    let places = vec![[0; 3], [1, 0, 0], [0, 3, 0], [90, 2, 1], [100, 0, 0]];
    let nodes = vec![[0; 3], [0; 3], [0; 3], [100, 0, 0]];
    let header = Text::new(HEADER)
        .set("nodes_per_vertex", 0, "2")
        .set("weight_scheme", 0, "1")
        .set("label_set", 0, "0");
    let scene = Scene {
        header,
        mesh: GridMesh::new(places, Vec::new()),
        affine: false,
        sigma: None,
        motions: vec![Motion {
            translation: vec![[900, 7, -40], [-300, 90, 5], [40, 40, 40], [1, 2, 3]],
            turn_or_scale: vec![[0; 3]; nodes.len()],
            ..Motion::default()
        }],
        nodes,
    };
    let danger = "The first node that is not used is at the vertex too: its distance counts as 1.";
    scene.draft(
        "coincident_nodes",
        danger,
        None,
        &["deform.weights.sumner", "deform.weights.floor", "deform.weights.normalise"],
    )
}
