"""Chapter 7: from the quantised values of a P-frame to the motion of every node.

entropy decoding (syntax.motion_frame) -> dequantise, with Prediction -> transforms (deformation.py)
"""

from functools import cmp_to_key

from bits import require

OTHER = 14  # the label of what is no part of the body
HEAD, TORSO = 0, 7


class NodeMotion:
    """translation in reference units; angles, scales and shears as binary64, exact."""

    def __init__(self, translation, angles, scales, shears):
        self.translation = translation
        self.angles = angles
        self.scales = scales
        self.shears = shears


def translation_step(s):
    """r[motion.step.translation]"""
    return ((4 + s % 4) * 2 ** (s // 4)) // 4


def parameter_step(s):
    """r[motion.step.parameter], in 1/65536"""
    return (4 + s % 4) * 2 ** (s // 4)


class Prediction:
    """7.4: what the P-frames of a GoF predict translations from. nodes: as placed on the I-frame, in
    grid steps."""

    def __init__(self, nodes, node_labels, influences, header):
        self.nodes = nodes
        self.node_labels = node_labels
        self.influences = influences
        self.header = header
        self.path_found = None
        # r[motion.parts]
        parts = sorted(set(node_labels))
        self.part_count = len(parts)
        self.part_of = [parts.index(label) for label in node_labels]
        # r[motion.translation.previous]: of the P-frame before; None before the first
        self.previous_table = None
        self.previous_step = None
        self.previous_translations = None

    def path(self):
        if self.path_found is None:
            self.path_found = Path(self.nodes, self.node_labels, self.influences, self.header).steps
        return self.path_found

    def translations(self, m):
        """r[motion.translation] r[motion.translation.range]: in reference units, of every node."""
        t_step = translation_step(m.translation_step)
        found = [None] * len(self.nodes)
        limit = 2 ** (20 + self.header.fraction_bits)

        def add(node, predicted):
            found[node] = [predicted[axis] + m.translation[node][axis] * t_step for axis in range(3)]
            require(max(map(abs, found[node])) < limit, "motion.translation.range", f"node {node} moves too far")

        if m.translation_mode == 0:
            # r[motion.prediction.direct]
            for node in range(len(self.nodes)):
                add(node, [0, 0, 0])
        elif m.translation_mode == 1:
            # r[motion.prediction.spatial]
            for node, predecessor in self.path():
                add(node, [0, 0, 0] if predecessor is None else found[predecessor])
        else:
            # r[motion.prediction.temporal]
            for node, before in enumerate(self.previous_translations):
                change = m.translation_change[self.part_of[node]]
                add(node, [before[axis] + change[axis] * self.previous_step for axis in range(3)])
        self.previous_table = m.translation_table
        self.previous_step = t_step
        self.previous_translations = found
        return found


class Path:
    """7.5. `steps` is a list of (node, predecessor or None) in the order of the path."""

    def __init__(self, nodes, node_labels, influences, header):
        self.nodes = nodes
        self.labels = node_labels
        self.bodies = header.label_set == 1
        # r[path.plane]
        self.up = header.up_axis
        self.right = (header.up_axis + 2) % 3
        self.front = (header.up_axis + 1) % 3
        # r[path.graph]
        self.neighbours = [set() for _ in nodes]
        for slots in {frozenset(node for node, _ in slots) for slots in influences}:
            for node in slots:
                self.neighbours[node] |= slots - {node}
        self.steps = []
        self.visited = [False] * len(nodes)
        # r[path.order]
        for component in sorted(self.components(), key=lambda c: (self.part(c), -len(c), c[0])):
            self.walk(component)

    def visit(self, node, predecessor):
        self.visited[node] = True
        self.steps.append((node, predecessor))

    def distance(self, a, b):
        return sum((self.nodes[a][axis] - self.nodes[b][axis]) ** 2 for axis in range(3))

    def mean(self, nodes):
        """r[path.mean]: // rounds down."""
        return [sum(self.nodes[node][axis] for node in nodes) // len(nodes) for axis in range(3)]

    def components(self):
        """r[path.components]: lists of nodes by rising index."""
        found = []
        met = [False] * len(self.nodes)
        for first in range(len(self.nodes)):
            if met[first]:
                continue
            met[first] = True
            component = [first]
            for node in component:  # grows
                for neighbour in self.neighbours[node]:
                    if not met[neighbour]:
                        met[neighbour] = True
                        component.append(neighbour)
            found.append(sorted(component))
        return found

    def part(self, component):
        """r[path.part]"""
        return min(self.labels[node] for node in component) if self.bodies else OTHER

    def references(self, component):
        """r[path.references]"""
        part = self.part(component)
        wanted = []
        if 1 <= part <= 7:
            wanted = [node for node, label in enumerate(self.labels) if label == HEAD]
        elif 8 <= part <= 13:
            wanted = [node for node, label in enumerate(self.labels) if label == TORSO]
        return wanted or sorted(node for node, _ in self.steps)

    def walk(self, component):
        """r[path.layers]"""
        layer = [self.visit_start(component)]
        while layer:
            following = set()
            for node in layer:
                following |= self.neighbours[node]
            layer = self.ring([node for node in sorted(following) if not self.visited[node]])
            for node in layer:
                self.visit(node, self.steps[-1][0])

    def visit_start(self, component):
        """min() gives the first of the least, and nodes are by rising index."""
        references = self.references(component)
        if not references:
            # r[path.start.highest]
            start = min(component, key=lambda node: -self.nodes[node][self.up])
            self.visit(start, None)
            return start
        # r[path.start.nearest]
        C = self.mean(references)
        mean = self.mean(component)
        D = [mean[axis] - C[axis] for axis in range(3)]
        start = min(
            component, key=lambda node: sum((self.nodes[node][axis] - C[axis]) * D[axis] for axis in range(3))
        )
        self.visit(start, min(references, key=lambda reference: self.distance(reference, start)))
        return start

    def ring(self, layer):
        """r[path.angle] r[path.ring]"""
        if not layer:
            return []
        center = self.mean(layer)

        def turn(node):
            r = self.nodes[node][self.right] - center[self.right]
            f = self.nodes[node][self.front] - center[self.front]
            if r == 0 and f == 0:
                return 0, r, f
            return (1 if f > 0 or (f == 0 and r > 0) else 2), r, f

        def compare(a, b):
            half_a, r_a, f_a = turn(a)
            half_b, r_b, f_b = turn(b)
            if half_a != half_b:
                return half_a - half_b
            return -(r_a * f_b - f_a * r_b)  # 0 for the same angle

        by_angle = sorted(layer, key=cmp_to_key(compare))  # stable: equals by rising index
        last = self.steps[-1][0]
        first = min(range(len(by_angle)), key=lambda i: self.distance(by_angle[i], last))
        return by_angle[first:] + by_angle[:first]


def dequantise(m, affine, prediction):
    """7.1 and 7.3: a NodeMotion for every node."""
    translations = prediction.translations(m)
    rotation_step = parameter_step(m.rotation_step)
    scale_step = parameter_step(m.scale_step)
    shear_step = parameter_step(m.shear_step)
    # r[motion.order]: each list runs over the nodes that carry its component
    rotations, scales, shears = iter(m.rotation), iter(m.scale), iter(m.shear)
    nodes = []
    for node, is_affine in enumerate(affine):
        # r[motion.absent], in units of 2^(-16)
        angle16, scale16, shear16 = [0, 0, 0], [65536, 65536, 65536], [0, 0, 0]
        if not is_affine or m.rotation_enabled:
            angle16 = [value * rotation_step for value in next(rotations)]
        if is_affine and m.scale_enabled:
            scale16 = [65536 + value * scale_step for value in next(scales)]
        if is_affine and m.shear_enabled:
            shear16 = [value * shear_step for value in next(shears)]
        require(max(map(abs, angle16)) <= 4 * 65536, "motion.rotation.range", f"node {node} turns too far")
        require(
            0 < min(scale16) and max(scale16) <= 8 * 65536, "motion.scale.range", f"the scale of node {node}"
        )
        require(max(map(abs, shear16)) <= 8 * 65536, "motion.shear.range", f"the shear of node {node}")
        # r[motion.rotation] r[motion.scale] r[motion.shear]: a division by 2^16 is exact
        nodes.append(
            NodeMotion(
                translations[node],
                [x / 65536 for x in angle16],
                [x / 65536 for x in scale16],
                [x / 65536 for x in shear16],
            )
        )
    return nodes
