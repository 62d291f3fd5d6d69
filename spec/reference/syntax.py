"""Chapters 3 and 6: the structures inside the units, with the rules on their elements."""

import math

from bits import Refused, read_table, require

# r[header.labels.meaning]: the region of each label of the human body
BODY_REGIONS = [0, 2, 2, 2, 3, 3, 3, 1, 4, 4, 4, 5, 5, 5, 6]

LEVELS = {row["level"]: row for row in read_table("levels.csv")}
HIGHEST_LEVEL = LEVELS[max(LEVELS)]


class Elements:
    """A structure: its elements are attributes."""


def check_characters(name):
    """r[name.characters]"""
    try:
        text = name.decode("utf-8")
    except UnicodeDecodeError:
        raise Refused("name.characters", "a name is not UTF-8") from None
    for character in text:
        code = ord(character)
        require(
            code > 0x1F and not 0x7F <= code <= 0x9F and character not in "/\\:",
            "name.characters",
            "a name has a character that is not allowed",
        )


def sequence_header(r):
    """3.3 and 6.2"""
    h = Elements()
    h.version = r.u(8, "version")
    require(h.version == 0, "header.version.value", f"version {h.version}")
    h.profile = r.u(8, "profile")
    require(h.profile == 0, "header.profile.known", f"profile {h.profile}")
    h.level = r.u(8, "level")
    require(h.level in LEVELS, "header.level.known", f"level {h.level}")
    h.limits = LEVELS[h.level]
    h.frame_rate_numerator = r.uleb("frame_rate_numerator")
    require(h.frame_rate_numerator >= 1, "header.rate.range", "a frame rate of 0")
    h.frame_rate_denominator = r.uleb("frame_rate_denominator")
    require(h.frame_rate_denominator >= 1, "header.rate.range", "a frame rate over 0")
    h.up_axis = r.u(2, "up_axis")
    require(h.up_axis <= 2, "header.axis.range", "up_axis 3")
    h.unit_of_length = r.u(4, "unit_of_length")
    require(h.unit_of_length <= 5, "header.length.known", f"unit_of_length {h.unit_of_length}")
    h.fraction_bits = r.u(4, "fraction_bits")
    require(h.fraction_bits <= 8, "header.fraction.range", f"fraction_bits {h.fraction_bits}")
    h.max_group_length = r.u(8, "max_group_length")
    require(
        1 <= h.max_group_length <= h.limits["max_group_frames"],
        "header.group.range",
        f"max_group_length {h.max_group_length}",
    )
    h.nodes_per_vertex = r.u(4, "nodes_per_vertex")
    require(1 <= h.nodes_per_vertex <= 8, "header.nodes.range", f"nodes_per_vertex {h.nodes_per_vertex}")
    h.weight_scheme = r.u(2, "weight_scheme")
    require(h.weight_scheme <= 2, "header.weight.known", "weight_scheme 3")
    h.influence_mode = r.u(1, "influence_mode")
    h.label_set = r.u(2, "label_set")
    require(h.label_set <= 2, "header.labels.known", "label_set 3")
    h.names_present = r.u(1, "names_present")
    require(r.u(4, "reserved_zero") == 0, "header.reserved.zero", "reserved_zero is not 0")
    h.grid_origin = []
    for axis in range(3):
        h.grid_origin.append(r.f64(f"grid_origin[{axis}]"))
        require(math.isfinite(h.grid_origin[axis]), "header.origin.finite", "grid_origin is not finite")
    h.grid_step = r.f64("grid_step")
    require(
        math.isfinite(h.grid_step) and h.grid_step > 0, "header.step.positive", "grid_step is not above 0"
    )
    # r[header.labels.meaning]: h.regions has the region of each of LabelCount labels
    if h.label_set == 0:
        h.regions = [0]
    elif h.label_set == 1:
        h.regions = BODY_REGIONS
    else:
        label_count = r.u(8, "label_count")
        require(1 <= label_count <= 64, "header.labels.count", f"label_count {label_count}")
        h.regions = []
        for label in range(label_count):
            h.regions.append(r.u(8, f"label_region[{label}]"))
            require(h.regions[label] < 64, "header.labels.region", f"label_region {h.regions[label]}")
    h.label_count = len(h.regions)
    if h.names_present:
        length = r.u(8, "name_prefix_length")
        h.name_prefix = r.bytes(length, "name_prefix")
        check_characters(h.name_prefix)
        h.name_digits = r.u(8, "name_digits")
        require(h.name_digits <= 9, "header.names.digits", f"name_digits {h.name_digits}")
        h.name_first = r.uleb("name_first")
    return h


def frame_header(r, f):
    """3.4 and 6.3"""
    f.digest_present = r.u(1, "digest_present")
    f.name_present = r.u(1, "name_present")
    require(r.u(6, "reserved_zero") == 0, "frame.reserved.zero", "reserved_zero is not 0")
    if f.name_present:
        length = r.u(8, "name_length")
        f.name = r.bytes(length, "name")
        require(f.name not in (b"", b".", b".."), "name.whole", "a name that is empty, . or ..")
        check_characters(f.name)
    f.positions_digest = r.u(64, "positions_digest") if f.digest_present else None
    return f


def intra_frame(r, limits):
    """3.5 and 6.4"""
    f = frame_header(r, Elements())
    f.faces_digest = r.u(64, "faces_digest") if f.digest_present else None
    f.smoothing_strength = r.u(8, "smoothing_strength")
    require(
        f.smoothing_strength <= 5, "intra.smoothing.range", f"smoothing_strength {f.smoothing_strength}"
    )
    f.intra_size = r.uleb("intra_size")
    f.payload = intra_payload(r, f.intra_size, limits)
    return f


def intra_payload(r, size, limits):
    """3.5 and 5.1"""
    p = Elements()
    start = r.position
    require(r.u(6, "reserved_zero") == 0, "intra.reserved.zero", "reserved_zero is not 0")
    p.lattice_present = r.u(1, "lattice_present")
    p.labels_present = r.u(1, "labels_present")
    require(r.u(8, "attribute_count") == 0, "intra.header.attributes", "attribute_count is not 0")
    p.vertex_count = r.uleb("vertex_count")
    require(p.vertex_count <= limits["max_vertices"], "intra.size.level", "more vertices than the level allows")
    p.isolated_count = r.uleb("isolated_count")
    require(p.isolated_count <= p.vertex_count, "intra.vertices.count", "isolated_count > vertex_count")
    p.face_count = r.uleb("face_count")
    require(p.face_count <= limits["max_faces"], "intra.size.level", "more faces than the level allows")
    require(
        p.vertex_count + p.face_count <= 2048 * size,
        "intra.counts.density",
        "more vertices and faces than the payload can hold",
    )
    p.raw_face_count = r.uleb("raw_face_count")
    require(p.raw_face_count <= p.face_count, "intra.faces.count", "raw_face_count > face_count")
    p.F = p.face_count - p.raw_face_count
    p.component_count = r.uleb("component_count")
    require(p.component_count <= p.F, "intra.faces.count", "component_count > F")
    p.join_count = r.uleb("join_count")
    require(p.join_count <= 3 * p.F, "intra.join.order", "join_count > 3 F")
    p.connectivity_size = r.uleb("connectivity_size")
    p.geometry_size = r.uleb("geometry_size")
    p.label_size = r.uleb("label_size")
    require(p.labels_present or p.label_size == 0, "intra.sections.size", "a label section without labels")
    header_bytes = (r.position - start) // 8
    require(
        header_bytes + p.connectivity_size + p.geometry_size + p.label_size == size,
        "intra.sections.size",
        "the sections do not fill the payload",
    )
    p.connectivity_section = r.bytes(p.connectivity_size, "connectivity_section")
    p.geometry_section = r.bytes(p.geometry_size, "geometry_section")
    p.label_section = r.bytes(p.label_size, "label_section")
    return p


def key_nodes(r, header, vertex_count):
    """3.6 and 6.5"""
    k = Elements()
    k.node_count = r.uleb("node_count")
    require(
        1 <= k.node_count <= header.limits["max_nodes"], "nodes.count.range", f"node_count {k.node_count}"
    )
    k.node_coding = r.u(1, "node_coding")
    k.affine_mode = r.u(2, "affine_mode")
    k.weight_sigma = None
    if header.weight_scheme == 2:
        k.weight_sigma = r.uleb("weight_sigma")
        require(1 <= k.weight_sigma < 2**20, "nodes.sigma.range", f"weight_sigma {k.weight_sigma}")
    if k.affine_mode == 1:
        k.affine_label = [r.u(1, f"affine_label[{label}]") for label in range(header.label_count)]
    if k.node_coding == 0:
        # r[nodes.vertices]
        node_vertex_rice = r.u(5, "node_vertex_rice")
        k.vertices = []
        vertex = -1
        for node in range(k.node_count):
            vertex += 1 + r.rice(node_vertex_rice, f"node_vertex_gap[{node}]")
            require(vertex < vertex_count, "nodes.vertex.range", f"node {node} on vertex {vertex}")
            k.vertices.append(vertex)
    else:
        # r[nodes.points]
        node_delta_rice = r.u(5, "node_delta_rice")
        k.points = []
        point = (0, 0, 0)
        for node in range(k.node_count):
            coordinates = []
            for axis in range(3):
                coordinates.append(point[axis] + r.srice(node_delta_rice, f"node_delta[{node}][{axis}]"))
                require(
                    abs(coordinates[axis]) < 2**20, "nodes.position.range", f"node {node} outside the grid"
                )
            point = tuple(coordinates)
            k.points.append(point)
    if k.affine_mode == 3:
        k.affine_node = [r.u(1, f"affine_node[{node}]") for node in range(k.node_count)]
    return k


def motion_frame(r, affine, part_count, previous_table):
    """3.7, 6.6. affine[node] says which nodes are affine; previous_table is None in the first P-frame of a
    GoF. The values stay quantised: chapter 7 makes translations and angles of them."""
    m = frame_header(r, Elements())
    m.reference_mode = r.u(2, "reference_mode")
    require(m.reference_mode == 0, "motion.reference.known", f"reference_mode {m.reference_mode}")
    m.entropy_mode = r.u(1, "entropy_mode")
    require(m.entropy_mode == 0, "motion.entropy.known", "entropy_mode 1")
    m.residual_present = r.u(1, "residual_present")
    require(m.residual_present == 0, "motion.residual.known", "residual_present 1")
    m.translation_mode = r.u(2, "translation_mode")
    require(m.translation_mode <= 2, "motion.translation.known", "translation_mode 3")
    require(
        m.translation_mode != 2 or previous_table is not None,
        "motion.translation.first",
        "the first P-frame of a GoF has no frame before",
    )
    m.rotation_enabled = r.u(1, "rotation_enabled")
    m.scale_enabled = r.u(1, "scale_enabled")
    m.shear_enabled = r.u(1, "shear_enabled")
    # r[motion.counts]
    node_count = len(affine)
    affine_count = sum(affine)
    require(
        affine_count > 0 or not (m.rotation_enabled or m.scale_enabled or m.shear_enabled),
        "motion.enabled.affine",
        "components without affine nodes",
    )
    rotation_count = node_count - affine_count + (affine_count if m.rotation_enabled else 0)
    scale_count = affine_count if m.scale_enabled else 0
    shear_count = affine_count if m.shear_enabled else 0

    def table(name):
        t = r.u(6, name)
        require(t < 48, "motion.table.range", f"{name} {t}")
        return t

    def triples(name, count, t):
        return [[r.huffman(t, f"{name}[{node}][{axis}]") for axis in range(3)] for node in range(count)]

    m.translation_step = r.u(6, "translation_step")
    m.translation_table = table("translation_table")
    m.rotation_step = r.u(6, "rotation_step") if rotation_count > 0 else 0
    m.scale_step = r.u(6, "scale_step") if scale_count > 0 else 0
    m.shear_step = r.u(6, "shear_step") if shear_count > 0 else 0
    m.parameter_table = 0
    if rotation_count + scale_count + shear_count > 0:
        m.parameter_table = table("parameter_table")
    m.translation_change = []
    if m.translation_mode == 2:
        m.translation_change = triples("translation_change", part_count, previous_table)
    m.translation = triples("translation", node_count, m.translation_table)
    m.rotation = triples("rotation", rotation_count, m.parameter_table)
    m.scale = triples("scale", scale_count, m.parameter_table)
    m.shear = triples("shear", shear_count, m.parameter_table)
    return m


def index(r, header, bytes_before, groups_met=2**32):
    """3.8 and 6.7. bytes_before: bytes of unit_type and unit_size."""
    x = Elements()
    group_count = r.uleb("group_count")
    require(group_count >= 1, "index.count.range", "an index of no groups")
    require(group_count <= groups_met, "index.groups.match", "more groups than the file has")
    x.groups = []
    for group in range(group_count):
        group_bytes = r.uleb(f"group_bytes[{group}]")
        group_frames = r.u(8, f"group_frames[{group}]")
        require(
            1 <= group_frames <= header.max_group_length, "index.frames.range", f"group_frames {group_frames}"
        )
        x.groups.append((group_bytes, group_frames))
    x.index_size = r.u(32, "index_size")
    # r[index.size.value]: the structure is a whole number of bytes, and 4 of the CRC follow
    size = bytes_before + r.position // 8 + 4
    require(x.index_size == size, "index.size.value", f"index_size is {x.index_size}, the unit has {size}")
    return x
