//! Streams whose I-frame is broken. What they are made of is sound but for the rule that they break,
//! so that a decoder which does not check it decodes them.

use anyhow::Result;

use kn_mesh::GridMesh;

use super::Draft;
use super::decisions::{Decisions, payload, section};
use super::texts::{HEADER, INDEX, MOTION, Text, intra_unit, payload_of, strip};
use super::uncommon_meshes::lattice_payload;

pub(crate) fn drafts() -> Result<Vec<Draft>> {
    let plain = payload_of(&strip(8, None))?;
    let lists = [headers(&plain), sections(&plain)?, lattices(), levels(), labels(&plain)?];
    Ok([lists.concat(), super::faulty_conquests::drafts(), vec![nodes_on_nothing()?]].concat())
}

/// Places of the numbers in the header of a small mesh: each below 128, a byte.
const VERTEX_COUNT: usize = 2;
const FACE_COUNT: usize = 4;
const CONNECTIVITY_SIZE: usize = 8;
const GEOMETRY_SIZE: usize = 9;
const LABEL_SIZE: usize = 10;

/// The payload with a byte, or several, in the place of another.
fn with(payload: &[u8], at: usize, bytes: &[u8]) -> Vec<u8> {
    [&payload[..at], bytes, &payload[at + 1..]].concat()
}

fn headers(plain: &[u8]) -> Vec<Draft> {
    let count = plain[VERTEX_COUNT];
    let long = format!("{count} as x{:02x}00", count | 0x80);
    let edited = |name: &str, rule, danger: &str, edit: &dyn Fn(Text) -> Text| {
        let sound = draft(name, rule, danger, plain);
        Draft { text: edit(Text::new(&sound.text)).build(), ..sound }
    };
    let sized = |label_size: &str| {
        let size = |name: &str, at: usize| format!("{name}_size = {}", plain[at]);
        let sizes = [size("connectivity", CONNECTIVITY_SIZE), size("geometry", GEOMETRY_SIZE)];
        let label_size = format!("label_size = {label_size}");
        move |text: Text| {
            let lines = [sizes[0].as_str(), sizes[1].as_str(), label_size.as_str()];
            text.before("connectivity_section", 0, &lines)
        }
    };
    vec![
        edited("intra_header", "intra.reserved.zero", "A flag of a later version.", &|text| {
            text.before("lattice_present", 0, &["reserved_zero = 1"])
        }),
        edited(
            "intra_header_long",
            "descriptor.uleb.shortest",
            "A count with a byte too many.",
            &|text| text.set("vertex_count", 0, &long),
        ),
        edited(
            "intra_header_wraps",
            "descriptor.uleb.range",
            "A size of 2^32, which is 0 in 32 bits.",
            &sized("0 as x8080808010"),
        ),
        short_header(),
        draft(
            "intra_header_attributes",
            "intra.header.attributes",
            "An attribute of a later version.",
            &with(plain, 1, &[1]),
        ),
        draft(
            "intra_vertices_count",
            "intra.vertices.count",
            "A vertex more is promised than the conquest brings.",
            &with(plain, VERTEX_COUNT, &[plain[VERTEX_COUNT] + 1]),
        ),
        draft(
            "intra_faces_count",
            "intra.faces.count",
            "A face more is promised than the conquest brings.",
            &with(plain, FACE_COUNT, &[plain[FACE_COUNT] + 1]),
        ),
        draft(
            "intra_counts_density",
            "intra.counts.density",
            "40000 vertices, which the level allows, in 16 bytes, which cannot hold them: refuse before allocating.",
            &[0, 0, 0xc0, 0xb8, 0x02, 0xc0, 0xb8, 0x02, 0, 0, 0, 0, 0, 1, 0, 0],
        ),
    ]
}

fn sections(plain: &[u8]) -> Result<Vec<Draft>> {
    let consumed = "range.end";
    let size = "intra.sections.size";
    let in_origin = "is_zero=1 ".repeat(3);
    let faces = |corner: u32| section(&format!("16:0 16:0 16:0 16:0 16:0 16:{corner}"));
    let one_vertex =
        |connectivity| payload(0, [1, 1, 1, 1, 0, 0], [connectivity, section(&in_origin), vec![]]);
    let far = |sign: u8| {
        let longer: String = (0..20).map(|place| format!("longer.{place}=1 ")).collect();
        let value =
            format!("is_negative={sign} {longer}longer.20=0 second.20=0 third.20=0 2:0 16:0");
        let script = format!("is_zero=0 {value} is_zero=1 is_zero=1");
        payload(0, [1, 1, 0, 0, 0, 0], [vec![], section(&script), vec![]])
    };
    let range = "intra.geometry.range";
    Ok(vec![
        draft(
            "intra_sections_consumed",
            consumed,
            "A geometry section with 16 bytes more than its decisions read.",
            &spare_bytes()?,
        ),
        draft(
            "intra_sections_short",
            consumed,
            "A section that ends 4 bytes too early; zeros would do behind its end.",
            &one_vertex(vec![]),
        ),
        byte_behind(plain),
        draft(
            "label_section_spare",
            size,
            "A byte of labels in a payload without labels.",
            &[&with(plain, LABEL_SIZE, &[1]), &[0][..]].concat(),
        ),
        draft(
            "intra_faces_raw",
            "intra.faces.raw",
            "A raw face of vertex 1 of 1.",
            &one_vertex(faces(1)),
        ),
        draft("intra_geometry_range", range, "A coordinate of 2^20.", &far(0)),
        draft("intra_geometry_least", range, "A coordinate of −2^20.", &far(1)),
    ])
}

/// Ten zeros, where the shortest header has eleven bytes.
fn short_header() -> Draft {
    let danger = "A payload that ends before its last size.";
    let sound = draft("intra_header_short", "unit.size.exact", danger, &[0; 11]);
    let sizes = ["connectivity_size = 0", "geometry_size = 0", "label_size = 0 as 0b"];
    let text = Text::new(&sound.text).before("connectivity_section", 0, &sizes);
    Draft { text: text.build(), ..sound }
}

fn byte_behind(plain: &[u8]) -> Draft {
    let size = format!("intra_size = {}", plain.len() + 1);
    let sound = draft(
        "intra_sections_size",
        "intra.sections.size",
        "A byte behind the last section.",
        plain,
    );
    let text = Text::new(&sound.text).before("lattice_present", 0, &[&size]);
    Draft { text: text.after("label_section", 0, &["pad = 0 as x00"]).build(), ..sound }
}

fn lattices() -> Vec<Draft> {
    let lattice = |name: &str, danger: &str, values: &[i32], ranks: &[[i32; 3]]| {
        draft(name, "intra.geometry.lattice", danger, &lattice_payload([values, &[0], &[0]], ranks))
    };
    let two = [[0, 0, 0], [1, 0, 0]];
    vec![
        lattice(
            "lattice_least",
            "The least value of a lattice is −2^20: its magnitude is one too large.",
            &[-(1 << 20), 0],
            &two,
        ),
        lattice("lattice_largest", "The last value of a lattice is 2^20.", &[0, 1 << 20], &two),
        lattice("lattice_empty", "A lattice without values on an axis.", &[], &[[0, 0, 0]]),
        lattice(
            "lattice_long",
            "More values on an axis than there are vertices.",
            &[0, 1],
            &[[0, 0, 0]],
        ),
        lattice(
            "intra_geometry_lattice",
            "A rank behind the end of the list.",
            &[0, 5],
            &[[0, 0, 0], [2, 0, 0]],
        ),
        lattice("lattice_rank_below", "A rank of −1.", &[0, 5], &[[0, 0, 0], [-1, 0, 0]]),
    ]
}

/// Meshes larger than level 0 allows, in a few hundred bytes.
fn levels() -> Vec<Draft> {
    let level = "intra.size.level";
    let vertices = (1 << 16) + 1;
    let mut geometry = Decisions::default();
    (0..3 * vertices).for_each(|_| geometry.bit("is_zero", true));
    let cloud = payload(0, [vertices, vertices, 0, 0, 0, 0], [vec![], geometry.finish(), vec![]]);
    vec![
        draft(
            "intra_size_level",
            level,
            "A vertex more than the level allows, in 100 bytes.",
            &cloud,
        ),
        draft(
            "intra_size_faces",
            level,
            "Faces of one point, two more than the level allows, in 1 KiB.",
            &many_faces((1 << 16) + 1),
        ),
    ]
}

/// Pairs of triangles back to back, all of their corners in one point.
fn many_faces(pairs: u32) -> Vec<u8> {
    let mut connectivity = Decisions::default();
    // Valence 2 thrice, the rest is forced.
    let valence =
        "is_six.4=0 is_less.4=1 less_than.4.5=1 less_than.4.4=1 less_than.4.3=1 less_than.4.2=0 ";
    let seed = valence.repeat(3);
    (0..pairs).for_each(|_| connectivity.script(&seed));
    for vertex in 1..3 * pairs {
        connectivity.gamma("gaps", u32::from(vertex == 1));
        connectivity.gamma("depths", 0);
    }
    let geometry = section(&"is_zero=1 ".repeat(3));
    payload(
        0,
        [1, 0, 2 * pairs, 0, pairs, 3 * pairs - 1],
        [connectivity.finish(), geometry, vec![]],
    )
}

fn labels(plain: &[u8]) -> Result<Vec<Draft>> {
    let labelled = payload_of(&strip(8, Some([0, 0])))?;
    let strange = payload_of(&strip(8, Some([0, 15])))?;
    let (present, range) = ("intra.labels.present", "intra.labels.range");
    let none = "label_set = 2\nnames_present = 0\ngrid_origin = 0.0 0.0 0.0\ngrid_step = 0.001\nlabel_count = 0\n";
    let start = HEADER.split("label_set").next().unwrap_or_default();
    let empty = payload(1, [0; 6], [vec![], vec![], vec![]]);
    Ok(vec![
        with_labels("labels_absent", present, "Labels promised, none there.", plain),
        with_labels(
            "labels_absent_empty",
            present,
            "Labels promised, and an empty frame that says it has none.",
            &payload_of(&GridMesh::default())?,
        ),
        draft(
            "labels_unasked",
            present,
            "Labels that the sequence header does not know of.",
            &labelled,
        ),
        with_labels("label_range", range, "Label 15 of 15.", &strange),
        Draft {
            name: "label_count_zero".into(),
            text: format!("{start}{none}{}{INDEX}", intra_unit(&empty)),
            danger: "A set of no labels, for a mesh without vertices.".into(),
            rule: Some("header.labels.count"),
            covers: &[],
        },
    ])
}

/// A file of one I-frame whose header says that vertices have the labels of a body.
fn with_labels(name: &str, rule: &'static str, danger: &str, payload: &[u8]) -> Draft {
    let text = format!("{HEADER}{}{INDEX}", intra_unit(payload));
    Draft { name: name.into(), text, danger: danger.into(), rule: Some(rule), covers: &[] }
}

/// A file of one I-frame without labels.
pub(crate) fn draft(name: &str, rule: &'static str, danger: &str, payload: &[u8]) -> Draft {
    let draft = with_labels(name, rule, danger, payload);
    Draft { text: draft.text.replace("label_set = 1", "label_set = 0"), ..draft }
}

/// Key nodes for a mesh without vertices.
fn nodes_on_nothing() -> Result<Draft> {
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

/// A sound payload but for what its geometry section ends with.
fn spare_bytes() -> Result<Vec<u8>> {
    let mut payload = payload_of(&strip(8, None))?;
    payload.extend([0; 16]);
    payload[GEOMETRY_SIZE] += 16;
    Ok(payload)
}
