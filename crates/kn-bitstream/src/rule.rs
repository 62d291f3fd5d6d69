//! Ids of the rules that streams must obey, as in `spec/`, with the sentence for error messages.

macro_rules! rules {
    ($($name:ident = $id:literal, $sentence:literal;)*) => {
        $(#[doc = $sentence] pub const $name: &str = $id;)*

        /// Every rule: its id and what it says.
        pub const ALL: &[(&str, &str)] = &[$(($id, $sentence)),*];
    };
}

rules! {
    DESCRIPTOR_ULEB_RANGE = "descriptor.uleb.range", "a uleb has at most 5 groups and its value is below 2^32";
    DESCRIPTOR_ULEB_SHORTEST = "descriptor.uleb.shortest", "the last of several uleb groups is not zero";
    DESCRIPTOR_RICE_RANGE = "descriptor.rice.range", "the unary part of a Rice code is at most 32 and its value is below 2^32";
    DESCRIPTOR_UE_RANGE = "descriptor.ue.range", "the unary part of an Exp-Golomb code is at most 20";
    DESCRIPTOR_HUFFMAN_RANGE = "descriptor.huffman.range", "a Huffman-coded value is below 2^20 in magnitude";

    FILE_SIGNATURE_VALUE = "file.signature.value", "a file begins with the signature";
    FILE_ORDER = "file.order", "the units of a file come in the written order and the index ends it";
    FILE_GROUP_LENGTH = "file.group.length", "a group of frames has at most max_group_length frames";
    UNIT_TYPE_KNOWN = "unit.type.known", "unit_type is 1 to 5 or at least 128";
    UNIT_SIZE_LIMIT = "unit.size.limit", "unit_size is within the limit of the level";
    UNIT_SIZE_EXACT = "unit.size.exact", "a structure fills its unit exactly";
    UNIT_ALIGN_ZERO = "unit.align.zero", "alignment bits are zero";
    UNIT_CRC_MATCH = "unit.crc.match", "unit_crc is the CRC-32 of the unit's bytes before it";

    HEADER_VERSION_VALUE = "header.version.value", "version is 0";
    HEADER_PROFILE_KNOWN = "header.profile.known", "profile is 0";
    HEADER_LEVEL_KNOWN = "header.level.known", "level is listed in tables/levels.csv";
    HEADER_RATE_RANGE = "header.rate.range", "both parts of the frame rate are at least 1";
    HEADER_AXIS_RANGE = "header.axis.range", "up_axis is 0, 1 or 2";
    HEADER_LENGTH_KNOWN = "header.length.known", "unit_of_length is 0 to 5";
    HEADER_FRACTION_RANGE = "header.fraction.range", "fraction_bits is 0 to 8";
    HEADER_GROUP_RANGE = "header.group.range", "max_group_length is from 1 to the level's limit";
    HEADER_NODES_RANGE = "header.nodes.range", "nodes_per_vertex is 1 to 8";
    HEADER_WEIGHT_KNOWN = "header.weight.known", "weight_scheme is 0, 1 or 2";
    HEADER_LABELS_KNOWN = "header.labels.known", "label_set is 0, 1 or 2";
    HEADER_RESERVED_ZERO = "header.reserved.zero", "reserved bits of the sequence header are zero";
    HEADER_ORIGIN_FINITE = "header.origin.finite", "grid_origin is finite";
    HEADER_STEP_POSITIVE = "header.step.positive", "grid_step is finite and greater than zero";
    HEADER_LABELS_COUNT = "header.labels.count", "label_count is 1 to 64";
    HEADER_LABELS_REGION = "header.labels.region", "label_region is below 64";
    HEADER_NAMES_DIGITS = "header.names.digits", "name_digits is at most 9";
    NAME_CHARACTERS = "name.characters", "a name is UTF-8 without control characters, '/', '\\' and ':'";
    NAME_WHOLE = "name.whole", "a frame's name is not empty and neither '.' nor '..'";
    INTRA_LABELS_PRESENT = "intra.labels.present", "an I-frame has labels exactly where the sequence has a label set";
    INTRA_LABELS_RANGE = "intra.labels.range", "labels of an I-frame are labels of the sequence";
    INTRA_VERTICES_NODES = "intra.vertices.nodes", "an I-frame with P-frames has at least one vertex";
    INTRA_SIZE_LEVEL = "intra.size.level", "an I-frame has no more vertices and faces than the level allows";
    FRAME_RESERVED_ZERO = "frame.reserved.zero", "reserved bits of a frame header are zero";
    FRAME_DIGEST_POSITIONS = "frame.digest.positions", "positions_digest is that of the decoded positions";
    INTRA_SMOOTHING_RANGE = "intra.smoothing.range", "smoothing_strength is 0 to 5";
    INTRA_DIGEST_FACES = "intra.digest.faces", "faces_digest is that of the decoded faces";

    NODES_COUNT_RANGE = "nodes.count.range", "node_count is from 1 to the level's limit";
    NODES_SIGMA_RANGE = "nodes.sigma.range", "weight_sigma is from 1 to 2^20 - 1";
    NODES_VERTEX_RANGE = "nodes.vertex.range", "a node's vertex is a vertex of the I-frame";
    NODES_POSITION_RANGE = "nodes.position.range", "coordinates of a node are below 2^20 in magnitude";

    MOTION_REFERENCE_KNOWN = "motion.reference.known", "reference_mode is 0";
    MOTION_ENTROPY_KNOWN = "motion.entropy.known", "entropy_mode is 0";
    MOTION_RESIDUAL_KNOWN = "motion.residual.known", "residual_present is 0";
    MOTION_TRANSLATION_KNOWN = "motion.translation.known", "translation_mode is 0, 1 or 2";
    MOTION_TRANSLATION_FIRST = "motion.translation.first", "the first P-frame of a group is not predicted from the frame before";
    MOTION_ENABLED_AFFINE = "motion.enabled.affine", "no component is enabled where no node is affine";
    MOTION_TABLE_RANGE = "motion.table.range", "a Huffman table index is 0 to 47";
    MOTION_TRANSLATION_RANGE = "motion.translation.range", "a translation is below 2^20 grid steps in magnitude";
    MOTION_ROTATION_RANGE = "motion.rotation.range", "an angle is at most 4 in magnitude";
    MOTION_SCALE_RANGE = "motion.scale.range", "a scale is greater than 0 and at most 8";
    MOTION_SHEAR_RANGE = "motion.shear.range", "a shear is at most 8 in magnitude";

    DEFORM_INFLUENCE_STRICT = "deform.influence.strict", "in strict mode every region that has a vertex has a key node";
    DEFORM_POSITION_RANGE = "deform.position.range", "deformed positions stay inside the coordinate range";
    DEFORM_NODES_MOVE = "deform.nodes.move", "moved nodes stay inside the coordinate range";

    INDEX_COUNT_RANGE = "index.count.range", "group_count is at least 1";
    INDEX_FRAMES_RANGE = "index.frames.range", "group_frames is from 1 to max_group_length";
    INDEX_SIZE_VALUE = "index.size.value", "index_size is the size of the index unit";
    INDEX_GROUPS_MATCH = "index.groups.match", "the index lists the groups of the file as they are";
}

/// What the rule says, `None` for an id that is not in [`ALL`].
pub fn sentence(id: &str) -> Option<&'static str> {
    ALL.iter().find(|(known, _)| *known == id).map(|(_, sentence)| *sentence)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_unique() {
        let mut ids: Vec<_> = ALL.iter().map(|(id, _)| id).collect();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), ALL.len());
    }
}
