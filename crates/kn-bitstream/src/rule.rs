//! The rules that streams must obey, as in `spec/`: the one list of them in the code.

use std::fmt;

/// A rule of the specification: its id and its sentence. The type is one pointer wide.
///
/// `Display` gives both: `node_count must be from 1 to the level's limit (nodes.count.range)`.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Rule(&'static Text);

#[derive(PartialEq, Eq)]
struct Text {
    id: &'static str,
    sentence: &'static str,
}

impl Rule {
    /// The id of the clause in `spec/`, such as `nodes.count.range`.
    pub const fn id(self) -> &'static str {
        self.0.id
    }

    /// The requirement of the rule, as one sentence without a full stop.
    pub const fn sentence(self) -> &'static str {
        self.0.sentence
    }

    /// The rule with an id, `None` for an id that is not in [`ALL`].
    pub fn with_id(id: &str) -> Option<Self> {
        ALL.iter().copied().find(|rule| rule.id() == id)
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.sentence(), self.id())
    }
}

impl fmt::Debug for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

macro_rules! rules {
    ($($name:ident = $id:literal, $sentence:literal;)*) => {
        $(
            #[doc = $sentence]
            pub const $name: Rule = Rule(&Text { id: $id, sentence: $sentence });
        )*

        /// Every rule, in the order of the chapters.
        pub const ALL: &[Rule] = &[$($name),*];
    };
}

rules! {
    DESCRIPTOR_ULEB_RANGE = "descriptor.uleb.range", "a uleb must have at most 5 bytes and a value below 2^32";
    DESCRIPTOR_ULEB_SHORTEST = "descriptor.uleb.shortest", "a uleb must take no more bytes than its value needs";
    DESCRIPTOR_RICE_RANGE = "descriptor.rice.range", "a Rice code must have a unary part of at most 32 and a value below 2^32";
    DESCRIPTOR_UE_RANGE = "descriptor.ue.range", "an Exp-Golomb code must have a unary part of at most 20";
    DESCRIPTOR_HUFFMAN_RANGE = "descriptor.huffman.range", "a Huffman-coded value must be below 2^20 in magnitude";

    FILE_SIGNATURE_VALUE = "file.signature.value", "a file must begin with the signature of .knm files";
    FILE_ORDER = "file.order", "a file must hold its units in the order header, GoFs, index, and end with the index";
    FILE_GROUP_LENGTH = "file.group.length", "a GoF must have at most max_group_length frames";
    UNIT_TYPE_KNOWN = "unit.type.known", "unit_type must be from 1 to 5, or at least 128";
    UNIT_SIZE_LIMIT = "unit.size.limit", "unit_size must not be above the level's limit";
    UNIT_SIZE_EXACT = "unit.size.exact", "a structure must fill its unit exactly";
    UNIT_ALIGN_ZERO = "unit.align.zero", "alignment bits must be zero";
    UNIT_CRC_MATCH = "unit.crc.match", "unit_crc must be the CRC-32 of the unit's bytes before it";

    HEADER_VERSION_VALUE = "header.version.value", "version must be 0";
    HEADER_PROFILE_KNOWN = "header.profile.known", "profile must be 0";
    HEADER_LEVEL_KNOWN = "header.level.known", "level must be 0, 1 or 2";
    HEADER_RATE_RANGE = "header.rate.range", "numerator and denominator of the frame rate must be at least 1";
    HEADER_AXIS_RANGE = "header.axis.range", "up_axis must be 0, 1 or 2";
    HEADER_LENGTH_KNOWN = "header.length.known", "unit_of_length must be from 0 to 5";
    HEADER_FRACTION_RANGE = "header.fraction.range", "fraction_bits must be from 0 to 8";
    HEADER_GROUP_RANGE = "header.group.range", "max_group_length must be from 1 to the level's limit";
    HEADER_NODES_RANGE = "header.nodes.range", "nodes_per_vertex must be from 1 to 8";
    HEADER_WEIGHT_KNOWN = "header.weight.known", "weight_scheme must be 0, 1 or 2";
    HEADER_LABELS_KNOWN = "header.labels.known", "label_set must be 0, 1 or 2";
    HEADER_RESERVED_ZERO = "header.reserved.zero", "the reserved bits of the sequence header must be zero";
    HEADER_ORIGIN_FINITE = "header.origin.finite", "grid_origin must be finite";
    HEADER_STEP_POSITIVE = "header.step.positive", "grid_step must be finite and greater than 0";
    HEADER_LABELS_COUNT = "header.labels.count", "label_count must be from 1 to 64";
    HEADER_LABELS_REGION = "header.labels.region", "label_region must be below 64";
    HEADER_NAMES_DIGITS = "header.names.digits", "name_digits must be at most 9";
    NAME_CHARACTERS = "name.characters", "a name must be UTF-8 without control characters, '/', '\\' and ':'";

    NAME_WHOLE = "name.whole", "the name of a frame must not be empty, '.' or '..'";
    FRAME_RESERVED_ZERO = "frame.reserved.zero", "the reserved bits of a frame header must be zero";
    FRAME_DIGEST_POSITIONS = "frame.digest.positions", "positions_digest must be the digest of the decoded positions";

    INTRA_DIGEST_FACES = "intra.digest.faces", "faces_digest must be the digest of the decoded faces";
    INTRA_SMOOTHING_RANGE = "intra.smoothing.range", "smoothing_strength must be from 0 to 5";
    INTRA_SIZE_LEVEL = "intra.size.level", "an I-frame must have no more vertices and faces than the level allows";
    INTRA_LABELS_PRESENT = "intra.labels.present", "an I-frame must have labels where the sequence has a label set, and none where it has not";
    INTRA_LABELS_RANGE = "intra.labels.range", "every label of an I-frame must be a label of the sequence";
    INTRA_VERTICES_NODES = "intra.vertices.nodes", "an I-frame with key nodes must have at least one vertex";
    RANGE_END = "range.end", "the decisions of a section must consume it exactly";
    INTRA_RESERVED_ZERO = "intra.reserved.zero", "the reserved bits of an I-frame's mesh must be zero";
    INTRA_HEADER_ATTRIBUTES = "intra.header.attributes", "attribute_count must be 0";
    INTRA_COUNTS_DENSITY = "intra.counts.density", "vertex_count + face_count must be at most 2048 times the bytes of the payload";
    INTRA_VERTICES_COUNT = "intra.vertices.count", "vertex_count must be the number of isolated and coded vertices";
    INTRA_FACES_COUNT = "intra.faces.count", "the connectivity must decode to as many faces as the header announces";
    INTRA_SECTIONS_SIZE = "intra.sections.size", "the sections of an I-frame's payload must fill it exactly";
    INTRA_CONNECTIVITY_CLOSE = "intra.connectivity.close", "Close must occur only on a loop of three half-edges";
    INTRA_CONNECTIVITY_TIP = "intra.connectivity.tip", "the tip of a triangle must differ from the ends of its gate";
    INTRA_CONNECTIVITY_VALENCE = "intra.connectivity.valence", "every vertex must get exactly as many triangles as its valence says";
    INTRA_CONNECTIVITY_SPLIT = "intra.connectivity.split", "splits must not walk further than the triangles so far allow";
    INTRA_CONNECTIVITY_MERGE = "intra.connectivity.merge", "a jump must name an open half-edge";
    INTRA_JOIN_ORDER = "intra.join.order", "a join must name two decoded vertices, the earlier one first, neither a dummy";
    INTRA_FACES_RAW = "intra.faces.raw", "the corners of a raw face must be vertices of the mesh";
    INTRA_GEOMETRY_LATTICE = "intra.geometry.lattice", "lattice values and ranks must be in their range";
    INTRA_GEOMETRY_RANGE = "intra.geometry.range", "coordinates of an I-frame must be below 2^20 in magnitude";

    NODES_COUNT_RANGE = "nodes.count.range", "node_count must be from 1 to the level's limit";
    NODES_SIGMA_RANGE = "nodes.sigma.range", "weight_sigma must be from 1 to 2^20 - 1";
    NODES_VERTEX_RANGE = "nodes.vertex.range", "the vertex of a key node must be a vertex of the I-frame";
    NODES_POSITION_RANGE = "nodes.position.range", "the coordinates of a key node must be below 2^20 in magnitude";

    MOTION_REFERENCE_KNOWN = "motion.reference.known", "reference_mode must be 0";
    MOTION_ENTROPY_KNOWN = "motion.entropy.known", "entropy_mode must be 0";
    MOTION_RESIDUAL_KNOWN = "motion.residual.known", "residual_present must be 0";
    MOTION_TRANSLATION_KNOWN = "motion.translation.known", "translation_mode must be 0, 1 or 2";
    MOTION_TRANSLATION_FIRST = "motion.translation.first", "translation_mode must not be 2 in the first P-frame of a GoF";
    MOTION_ENABLED_AFFINE = "motion.enabled.affine", "no component must be enabled where no node is affine";
    MOTION_TABLE_RANGE = "motion.table.range", "a Huffman table index must be from 0 to 47";
    MOTION_TRANSLATION_RANGE = "motion.translation.range", "a translation must be below 2^20 grid steps in magnitude";
    MOTION_ROTATION_RANGE = "motion.rotation.range", "an angle must be at most 4 in magnitude";
    MOTION_SCALE_RANGE = "motion.scale.range", "a scale must be greater than 0 and at most 8";
    MOTION_SHEAR_RANGE = "motion.shear.range", "a shear must be at most 8 in magnitude";

    DEFORM_INFLUENCE_STRICT = "deform.influence.strict", "in strict mode every region that has a vertex must have a key node";
    DEFORM_POSITION_RANGE = "deform.position.range", "deformed positions must stay inside the coordinate range";
    DEFORM_NODES_MOVE = "deform.nodes.move", "moved key nodes must stay inside the coordinate range";

    INDEX_COUNT_RANGE = "index.count.range", "group_count must be at least 1";
    INDEX_FRAMES_RANGE = "index.frames.range", "group_frames must be from 1 to max_group_length";
    INDEX_SIZE_VALUE = "index.size.value", "index_size must be the size of the index unit in bytes";
    INDEX_GROUPS_MATCH = "index.groups.match", "the index must list the GoFs of the file as they are";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_unique() {
        for rule in ALL {
            assert_eq!(Rule::with_id(rule.id()), Some(*rule), "{rule}");
        }
        let mut ids: Vec<_> = ALL.iter().map(|rule| rule.id()).collect();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), ALL.len());
    }
}
