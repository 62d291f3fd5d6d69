//! Texts of streams, by hand and by editing.

use anyhow::Result;

use kn_bitstream::BitWriter;
use kn_codec::digest::positions_digest;
use kn_codec::intra::{IntraDecoder, IntraLimits, decode_intra, encode_intra};
use kn_mesh::GridMesh;

/// A text that edits can change line by line.
#[derive(Clone)]
pub(crate) struct Text(Vec<String>);

impl Text {
    pub(crate) fn new(text: &str) -> Self {
        Self(text.lines().map(str::to_owned).collect())
    }

    /// Replaces the value in the `nth` line of an element.
    pub(crate) fn set(mut self, name: &str, nth: usize, value: &str) -> Self {
        let at = self.find(name, nth);
        self.0[at] = format!("{name} = {value}");
        self
    }

    /// Puts lines before the `nth` line of an element.
    pub(crate) fn before(mut self, name: &str, nth: usize, lines: &[&str]) -> Self {
        let at = self.find(name, nth);
        self.0.splice(at..at, lines.iter().map(|line| (*line).to_owned()));
        self
    }

    /// Puts lines after the `nth` line of an element.
    pub(crate) fn after(mut self, name: &str, nth: usize, lines: &[&str]) -> Self {
        let at = self.find(name, nth) + 1;
        self.0.splice(at..at, lines.iter().map(|line| (*line).to_owned()));
        self
    }

    /// Takes the `nth` line of an element away.
    pub(crate) fn without(mut self, name: &str, nth: usize) -> Self {
        let at = self.find(name, nth);
        self.0.remove(at);
        self
    }

    /// Takes the `nth` unit away.
    pub(crate) fn without_unit(mut self, nth: usize) -> Self {
        let start = self.find("unit_type", nth);
        let is_next = |line: &String| line.starts_with("unit_type");
        let rest = self.0[start + 1..].iter().position(is_next);
        let end = rest.map_or(self.0.len(), |length| start + 1 + length);
        self.0.drain(start..end);
        self
    }

    /// Puts a copy of one unit before another.
    pub(crate) fn copy_unit(mut self, from: usize, before: usize) -> Self {
        let copy = self.0[self.find("unit_type", from)..self.find("unit_type", from + 1)].to_vec();
        let at = self.find("unit_type", before);
        self.0.splice(at..at, copy);
        self
    }

    /// Puts a copy of a unit behind it.
    pub(crate) fn repeat_unit(self, nth: usize) -> Self {
        self.copy_unit(nth, nth + 1)
    }

    /// Gives elements other names.
    pub(crate) fn map_names(mut self, names: &[(&str, &str)]) -> Self {
        for line in &mut self.0 {
            for (from, to) in names {
                if let Some(rest) = line.strip_prefix(from).filter(|rest| rest.starts_with(" =")) {
                    *line = format!("{to}{rest}");
                    break;
                }
            }
        }
        self
    }

    /// Takes the P-frame away: what is before it is broken already.
    pub(crate) fn without_motion(self) -> Self {
        self.without_unit(3)
    }

    /// Puts a line at the end.
    pub(crate) fn end(mut self, line: &str) -> Self {
        self.0.push(line.to_owned());
        self
    }

    pub(crate) fn build(self) -> String {
        self.0.join("\n") + "\n"
    }

    fn find(&self, name: &str, nth: usize) -> usize {
        let is_it = |line: &String| line.split(" =").next() == Some(name);
        let mut places = (0..self.0.len()).filter(|&place| is_it(&self.0[place]));
        places.nth(nth).unwrap_or_else(|| panic!("there is no line {name} number {nth}"))
    }
}

/// A strip of triangles on the grid: two rows of `columns` vertices, 16 steps apart, with labels
/// that change from `labels[0]` to `labels[1]` in the middle, or without.
pub(crate) fn strip(columns: u32, labels: Option<[u8; 2]>) -> GridMesh {
    let mut mesh = GridMesh::default();
    for column in 0..columns {
        for row in 0..2 {
            mesh.positions.push([16 * column as i32, 16 * row, (column * column % 7) as i32]);
            mesh.labels.extend(labels.map(|labels| labels[usize::from(column >= columns / 2)]));
        }
    }
    for column in 0..columns - 1 {
        let at = 2 * column;
        mesh.faces.extend([[at, at + 2, at + 1], [at + 1, at + 2, at + 3]]);
    }
    mesh
}

/// A strip with an edge of three faces, a face that repeats a vertex and a vertex of its own.
pub(crate) fn knotted() -> GridMesh {
    let mut mesh = strip(6, Some([0, 7]));
    mesh.faces.extend([[0, 1, 9], [2, 2, 5]]);
    mesh.positions.push([5, 5, 5]);
    mesh.labels.push(14);
    mesh
}

/// The coded mesh.
pub(crate) fn payload_of(mesh: &GridMesh) -> Result<Vec<u8>> {
    let mut bits = BitWriter::new();
    encode_intra(mesh)?.payload().write(&mut bits);
    Ok(bits.into_bytes())
}

/// The lines of an I-frame unit without digests.
pub(crate) fn intra_unit(payload: &[u8]) -> String {
    let start = "\nunit_type = 2\ndigest_present = 0\nname_present = 0\nsmoothing_strength = 0\n";
    start.to_owned() + &payload_lines(payload)
}

/// The lines of a payload, whose counts may be wrong but whose sections fill it.
fn payload_lines(payload: &[u8]) -> String {
    let (flags, mut rest) = (payload[0], &payload[2..]);
    let mut numbers = [0; 9];
    for number in &mut numbers {
        let bytes = rest.iter().position(|byte| byte & 0x80 == 0).map_or(rest.len(), |at| at + 1);
        let (uleb, behind) = rest.split_at(bytes);
        *number = uleb.iter().rev().fold(0, |value, byte| value << 7 | usize::from(byte & 0x7f));
        rest = behind;
    }
    let mut lines = format!(
        "lattice_present = {}\nlabels_present = {}\nattribute_count = {}\n",
        flags >> 1 & 1,
        flags & 1,
        payload[1]
    );
    const COUNTS: [&str; 6] = [
        "vertex_count",
        "isolated_count",
        "face_count",
        "raw_face_count",
        "component_count",
        "join_count",
    ];
    for (name, count) in COUNTS.iter().zip(numbers) {
        lines += &format!("{name} = {count}\n");
    }
    for (name, &size) in ["connectivity", "geometry", "label"].iter().zip(&numbers[6..]) {
        let (section, behind) = rest.split_at(size);
        let digits: String = section.iter().map(|byte| format!("{byte:02x}")).collect();
        lines += &format!("{name}_section = x{digits}\n");
        rest = behind;
    }
    assert!(rest.is_empty(), "bytes behind the sections");
    lines
}

/// The digest of a mesh's positions as they are decoded, in decoded order, with 8 fraction bits.
pub(crate) fn positions_digest_of(mesh: &GridMesh) -> Result<u64> {
    let limits = IntraLimits { max_vertices: 1 << 10, max_faces: 1 << 10 };
    let mut decoded = GridMesh::default();
    let encoding = encode_intra(mesh)?;
    decode_intra(&encoding.payload(), &limits, &mut IntraDecoder::default(), &mut decoded)?;
    let in_units: Vec<_> = decoded.positions.iter().map(|p| p.map(|c| c << 8)).collect();
    Ok(positions_digest(&in_units))
}

/// The lines of a sequence header unit: level 0, a metre grid, Q = 4, body labels, fallback.
pub(crate) const HEADER: &str = "\
unit_type = 1
version = 0
profile = 0
level = 0
frame_rate_numerator = 30
frame_rate_denominator = 1
up_axis = 1
unit_of_length = 1
fraction_bits = 8
max_group_length = 4
nodes_per_vertex = 4
weight_scheme = 0
influence_mode = 1
label_set = 1
names_present = 0
grid_origin = 0.0 0.0 0.0
grid_step = 0.001
";

/// Two nodes on vertices 1 and 10, affine by label 7.
pub(crate) const NODES: &str = "
unit_type = 3
node_count = 2
node_coding = 0
affine_mode = 1
affine_label = 0*7 1 0*7
node_vertex_rice = 2
node_vertex_gap = 1 8
";

/// A P-frame for one rigid and one affine node, RTS.
pub(crate) const MOTION: &str = "
unit_type = 4
digest_present = 0
name_present = 0
reference_mode = 0
entropy_mode = 0
residual_present = 0
translation_mode = 0
rotation_enabled = 1
scale_enabled = 1
shear_enabled = 0
translation_step = 24
translation_table = 10
rotation_step = 24
scale_step = 24
parameter_table = 10
translation = 3 -1 0 5 0 -2
rotation = 1 0 -2 0 4 1
scale = 2 -1 1
";

pub(crate) const INDEX: &str = "\nunit_type = 5\n";

/// A whole sound stream of two frames by hand: a strip of 16 vertices, head and torso.
pub(crate) fn by_hand() -> Result<Text> {
    let intra = intra_unit(&payload_of(&strip(8, Some([0, 7])))?);
    Ok(Text::new(&format!("{HEADER}{intra}{NODES}{MOTION}{INDEX}")))
}
