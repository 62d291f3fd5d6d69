//! Streams whose I-frame is broken: damaged payloads, one for each rule that damage can break.

use std::collections::BTreeMap;
use std::error::Error;

use kn_codec::intra::{IntraDecoder, IntraError, IntraLimits, decode_intra};
use kn_conform::decode_mesh;
use kn_mesh::{GridMesh, Mesh};

use crate::Draft;
use crate::meshes::{ellipsoid, opened, torus, twins};
use crate::texts::{HEADER, INDEX, MOTION, intra_unit, knotted, payload_of, strip};
use crate::uncommon_meshes::lattice_payload;

pub(crate) fn drafts() -> Result<Vec<Draft>, Box<dyn Error>> {
    let unlabelled = payload_of(&strip(8, None))?;
    let strange = payload_of(&strip(8, Some([0, 15])))?;
    let mut drafts = vec![
        draft("labels_absent", "intra.labels.present", "Labels promised, none there.", &unlabelled),
        draft("label_range", "intra.labels.range", "Label 15 of 15.", &strange),
        draft(
            "lattice_least",
            "intra.geometry.lattice",
            "The least value of a lattice is −2^20: its magnitude is one too large.",
            &lattice_payload([&[-(1 << 20), 0], &[0], &[0]], &[[1, 0, 0]]),
        ),
        draft(
            "intra_sections_consumed",
            "intra.sections.consumed",
            "A geometry section with 16 bytes more than its decisions read.",
            &spare_bytes()?,
        ),
        draft(
            "intra_counts_density",
            "intra.counts.density",
            "40000 vertices, which the level allows, in 16 bytes, which cannot hold them: refuse before allocating.",
            &[0, 0, 0xc0, 0xb8, 0x02, 0xc0, 0xb8, 0x02, 0, 0, 0, 0, 0, 1, 0, 0],
        ),
        spare_label_section(&unlabelled),
        nodes_on_nothing()?,
    ];
    for (rule, payload) in damaged_payloads()? {
        if ["intra.sections.consumed", "intra.counts.density"].contains(&rule) {
            continue;
        }
        let name = rule.replace('.', "_");
        drafts.push(draft(&name, rule, "A damaged or hostile mesh.", &payload));
    }
    Ok(drafts)
}

fn draft(name: &str, rule: &'static str, danger: &str, payload: &[u8]) -> Draft {
    let text = format!("{HEADER}{}{INDEX}", intra_unit(payload));
    Draft { name: name.into(), text, danger: danger.into(), rule: Some(rule), covers: &[] }
}

/// Key nodes for a mesh without vertices.
fn nodes_on_nothing() -> Result<Draft, Box<dyn Error>> {
    let nodes = "unit_type = 3\nnode_count = 1\nnode_coding = 1\naffine_mode = 0\n\
                 node_delta_rice = 0\nnode_delta = 0 0 0\n";
    let motion = MOTION.lines().filter(|line| !line.starts_with("scale"));
    let motion: Vec<&str> = motion.filter(|line| !line.starts_with("rotation_enabled")).collect();
    let enabled = "rotation_enabled = 0\nscale_enabled = 0\nshear_enabled";
    let motion = motion.join("\n").replace("shear_enabled", enabled);
    let motion = motion.replace("3 -1 0 5 0 -2", "0 0 0").replace("1 0 -2 0 4 1", "0 0 0");
    let intra = intra_unit(&payload_of(&GridMesh::default())?);
    let header = HEADER.replace("label_set = 1", "label_set = 0");
    Ok(Draft {
        name: "nodes_on_nothing".into(),
        text: format!("{header}{intra}{nodes}{motion}{INDEX}"),
        danger: "A P-frame of a mesh without vertices.".into(),
        rule: Some("intra.vertices.nodes"),
        covers: &[],
    })
}

/// For every rule that some damage breaks, the first payload that breaks it.
fn damaged_payloads() -> Result<BTreeMap<&'static str, Vec<u8>>, Box<dyn Error>> {
    let mut found = BTreeMap::new();
    for mesh in meshes() {
        let sound = payload_of(&mesh)?;
        for payload in damages(&sound) {
            if let Some(rule) = broken_rule(&payload) {
                found.entry(rule).or_insert(payload);
            }
        }
    }
    Ok(found)
}

/// The rule by which a payload is refused at level 0, by our decoder and read literally: what breaks
/// several rules is of use only where both meet the same one first.
fn broken_rule(payload: &[u8]) -> Option<&'static str> {
    let limits = IntraLimits { max_vertices: 1 << 16, max_faces: 1 << 17 };
    let mut mesh = GridMesh::default();
    match decode_intra(payload, &limits, &mut IntraDecoder::default(), &mut mesh) {
        Err(IntraError::Malformed { rule, .. }) if decode_mesh(payload) == Err(rule) => Some(rule),
        Err(IntraError::Limit { .. }) => Some("intra.size.level"),
        _ => None,
    }
}

/// A sound payload but for what its geometry section ends with. The counts of this mesh are below
/// 128, so that each number of the header is a byte.
fn spare_bytes() -> Result<Vec<u8>, Box<dyn Error>> {
    const GEOMETRY_SIZE: usize = 2 + 7;
    let mut payload = payload_of(&strip(8, Some([0, 7])))?;
    let sizes = &payload[GEOMETRY_SIZE - 1..];
    let end = payload.len() - usize::from(sizes[2]);
    payload.splice(end..end, [0; 16]);
    payload[GEOMETRY_SIZE] += 16;
    Ok(payload)
}

/// A label section where the flags promise none. The counts of this mesh are below 128 too.
fn spare_label_section(unlabelled: &[u8]) -> Draft {
    const LABEL_SIZE: usize = 2 + 8;
    let mut payload = unlabelled.to_vec();
    payload[LABEL_SIZE] = 1;
    payload.push(0);
    let danger = "A byte of labels in a payload without labels.";
    let draft = draft("label_section_spare", "intra.sections.size", danger, &payload);
    Draft { text: draft.text.replace("label_set = 1", "label_set = 0"), ..draft }
}

/// Every prefix, every flipped bit, and every byte replaced by a few others.
fn damages(sound: &[u8]) -> impl Iterator<Item = Vec<u8>> {
    let prefixes = (0..sound.len()).map(|length| sound[..length].to_vec());
    let flips = (0..8 * sound.len()).map(|bit| {
        let mut payload = sound.to_vec();
        payload[bit / 8] ^= 0x80 >> (bit % 8);
        payload
    });
    let others: [&[u8]; 5] = [&[], &[0], &[0xff], &[0x81, 0x80, 0x04], &[0xff, 0xff, 0x7f]];
    let replaced = (0..sound.len())
        .flat_map(move |at| others.map(|other| [&sound[..at], other, &sound[at + 1..]].concat()));
    prefixes.chain(flips).chain(replaced).chain(scrambled(sound))
}

/// A few bytes anywhere replaced by noise, always the same noise.
fn scrambled(sound: &[u8]) -> impl Iterator<Item = Vec<u8>> {
    const TRIES: usize = 50_000;
    let mut state = 1_u64;
    let mut random = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize
    };
    (0..TRIES).map(move |_| {
        let mut payload = sound.to_vec();
        let start = random() % payload.len();
        for byte in payload.iter_mut().skip(start).take(1 + random() % 12) {
            *byte = random() as u8;
        }
        payload
    })
}

/// Meshes that between them use every part of the coder: a boundary, several components, an
/// isolated vertex, a degenerate face, an edge of three faces, a hole through.
fn meshes() -> Vec<GridMesh> {
    let round = on_grid(&ellipsoid(4, 6));
    let open = on_grid(&opened(&twins(&ellipsoid(3, 5))));
    let mut ring = strip(9, None);
    ring.faces.extend([[16, 0, 17], [17, 0, 1]]);
    ring.positions.push([5, 5, 5]);
    vec![round, open, knotted(), ring, on_grid(&torus(6, 5))]
}

fn on_grid(mesh: &Mesh) -> GridMesh {
    let positions = mesh.positions.iter().map(|p| p.map(|x| (x * 100.0) as i32)).collect();
    GridMesh { positions, faces: mesh.faces.clone(), labels: vec![7; mesh.positions.len()] }
}
