"""Chapter 5: intra-coded meshes."""

import math
from array import array
from collections import deque
from itertools import islice

from bits import require
from range_coder import Section, clamp, divide

NONE = -1


class Mesh:
    """What the payload gives. positions: a list of (x, y, z); faces: of (i, j, k); labels or None."""

    def __init__(self, positions, faces, labels):
        self.positions = positions
        self.faces = faces
        self.labels = labels


def decode(header):
    """Decodes what syntax.intra_payload has read."""
    section = Section(header.connectivity_section)
    net = Connectivity(header, section)
    faces = net.faces()
    section.finish()

    section = Section(header.geometry_section)
    geometry = Geometry(header, section, net)
    section.finish()
    positions = geometry.positions()

    labels = None
    if header.labels_present:
        section = Section(header.label_section)
        labels = Labels(header, section, net, geometry).labels()
        section.finish()
    return Mesh(positions, faces, labels)


class Connectivity:
    """5.2 to 5.4: triangles, half-edges and vertices of the conquest, dummies and copies included."""

    def __init__(self, header, section):
        self.header = header
        self.section = section
        # of each half-edge
        self.start = array("i")
        self.mate = array("i")
        self.after = array("i")
        self.before = array("i")
        # of each vertex
        self.valence = array("q")
        self.lacking = array("q")
        self.dummy = bytearray()
        self.first = array("i")  # the first half-edge that ever started from it
        self.twin = array("i")  # the next in its cyclic list

        self.stacks = [[] for _ in range(16)]
        self.whole_triangles = 0  # those without a dummy
        self.steps_walked = 0

        for _ in range(header.component_count):
            self.seed()
            gate = self.find_gate()
            while gate != NONE:
                self.apply_symbol(gate)
                gate = self.find_gate()
        require(
            self.whole_triangles == header.F, "intra.faces.count", "the conquest does not bring F triangles"
        )
        require(not any(self.lacking), "intra.connectivity.valence", "a vertex lacks triangles at the end")
        self.join()
        self.number_vertices()

    # 5.2 Conquest

    @property
    def triangle_count(self):
        return len(self.start) // 3

    @staticmethod
    def next(h):
        return h - 2 if h % 3 == 2 else h + 1

    @staticmethod
    def prev(h):
        return h + 2 if h % 3 == 0 else h - 1

    def end(self, h):
        return self.start[self.next(h)]

    def tip_across(self, h):
        return self.start[self.prev(self.mate[h])]

    def around(self, v):
        """r[intra.geometry.around]"""
        h = self.first[v]
        while True:
            yield h
            h = self.mate[self.prev(h)]
            if h == self.first[v]:
                return

    def new_vertex(self, valence, dummy):
        self.valence.append(valence)
        self.lacking.append(valence)
        self.dummy.append(dummy)
        self.first.append(NONE)
        self.twin.append(len(self.twin))
        return len(self.valence) - 1

    def new_triangle(self, corners):
        h = len(self.start)
        if not any(self.dummy[v] for v in corners):
            self.whole_triangles += 1
        # r[intra.faces.count]; both numbers only grow
        require(self.whole_triangles <= self.header.F, "intra.faces.count", "more than F triangles")
        require(
            self.triangle_count + 1 <= 4 * self.header.F, "intra.faces.count", "more than 4 F triangles in all"
        )
        for v in corners:
            self.start.append(v)
            self.mate.append(NONE)
            self.after.append(NONE)
            self.before.append(NONE)
            # r[intra.connectivity.valence]
            require(self.lacking[v] > 0, "intra.connectivity.valence", "a vertex with too many triangles")
            self.lacking[v] -= 1
        return h

    def link(self, *chain):
        for h, g in zip(chain, chain[1:]):
            self.after[h] = g
            self.before[g] = h

    def make_mates(self, h, g):
        self.mate[h] = g
        self.mate[g] = h

    def wait(self, h):
        self.stacks[min(self.lacking[self.end(h)], 15)].append(h)

    def seed(self):
        """r[intra.connectivity.seed]"""
        corners = [self.new_vertex(self.read_valence(4), False) for _ in range(3)]
        h = self.new_triangle(corners)
        for k in range(3):
            self.first[corners[k]] = h + k
        self.link(h, h + 1, h + 2, h)
        for k in range(3):
            self.wait(h + k)

    def find_gate(self):
        """r[intra.connectivity.gate]"""
        while True:
            number = 0
            while number < 16 and not self.stacks[number]:
                number += 1
            if number == 16:
                return NONE
            h = self.stacks[number].pop()
            if self.mate[h] == NONE:
                return h

    def read_valence(self, context):
        """r[intra.connectivity.valence.code]"""
        decision, c = self.section.decision, context
        if decision("is_six", c):
            return 6
        if decision("is_less", c):
            v = 5
            while v > 1 and decision("less_than", c, v):
                v -= 1
            return v
        v = 7
        while v < 16 and decision("more_than", c, v):
            v += 1
        return v if v < 16 else 16 + self.section.gamma("escaped", c)

    def is_short(self, gate):
        """r[intra.connectivity.close]"""
        return self.after[self.after[gate]] == self.before[gate]

    def read_symbol(self, gate):
        """r[intra.connectivity.symbol]. For a jump, also its half-edge."""
        decision = self.section.decision
        a, b = self.start[gate], self.end(gate)
        A, B = self.lacking[a], self.lacking[b]

        def c(n):
            return min(max(n - 2, 0), 3)

        if A == 1 or B == 1:
            if self.is_short(gate):
                third = self.end(self.after[gate])
                n = sum(self.lacking[v] == 1 for v in (a, b, third))
                if n >= 2 or decision("is_close", 0):
                    return "Close", NONE
            return ("Right" if B == 1 else "Left"), NONE
        if decision("is_new", c(B), c(A)):
            return "New", NONE
        if decision("is_jump"):
            if decision("is_merge"):
                high = self.section.raw(16)
                return "Jump", self.merge((high << 16) + self.section.raw(16))
            steps = self.section.gamma("split_steps")
            backward = decision("is_backward")
            return "Jump", self.split(gate, steps, backward)
        if decision("is_close", 1):
            return "Close", NONE
        if decision("is_right"):
            return "Right", NONE
        return "Left", NONE

    def merge(self, e):
        """r[intra.connectivity.merge]"""
        require(
            e < len(self.mate) and self.mate[e] == NONE,
            "intra.connectivity.merge",
            "a jump to a half-edge that is not open",
        )
        return e

    def split(self, gate, steps, backward):
        """r[intra.connectivity.split]"""
        self.steps_walked += steps
        require(
            self.steps_walked <= 1024 + 64 * self.triangle_count,
            "intra.connectivity.split",
            "splits walk too far",
        )
        way = self.before if backward else self.after
        e = gate
        for _ in range(steps):
            e = way[e]
        return e

    def read_new(self, a, b):
        """r[intra.connectivity.new]"""
        if not self.dummy[a] and not self.dummy[b] and self.section.decision("is_dummy"):
            return self.new_vertex(self.section.gamma("dummy_valence"), True)
        context = clamp(self.valence[a] + self.valence[b], 8, 16) - 8
        return self.new_vertex(self.read_valence(context), False)

    def apply_symbol(self, gate):
        """r[intra.connectivity.add]"""
        symbol, e = self.read_symbol(gate)
        a, b = self.start[gate], self.end(gate)
        x, y = self.before[gate], self.after[gate]
        if symbol == "New":
            d = self.read_new(a, b)
        elif symbol == "Right":
            d = self.end(y)
        elif symbol == "Left":
            d = self.start[x]
        elif symbol == "Close":
            require(self.is_short(gate), "intra.connectivity.close", "a loop of other than three is closed")
            d = self.start[x]
        else:
            d = self.start[e]
        require(d != a and d != b, "intra.connectivity.tip", "the tip is an end of the gate")

        h = self.new_triangle((b, a, d))
        g1, g2 = h + 1, h + 2
        self.make_mates(h, gate)
        if symbol == "New":
            self.first[d] = g2
            self.link(x, g1, g2, y)
            waiting = (x, g1, g2)
        elif symbol == "Right":
            self.make_mates(g2, y)
            self.link(x, g1, self.after[y])
            waiting = (x, g1)
        elif symbol == "Left":
            self.make_mates(g1, x)
            before_x = self.before[x]
            self.link(before_x, g2, y)
            waiting = (before_x, g2)
        elif symbol == "Close":
            self.make_mates(g1, x)
            self.make_mates(g2, y)
            waiting = ()
        else:
            before_e = self.before[e]
            self.link(x, g1, e)
            self.link(before_e, g2, y)
            waiting = (x, before_e, g1, g2)
        for half_edge in waiting:
            self.wait(half_edge)

    # 5.3 Cut vertices

    def join(self):
        self.earlier = {}  # of each copy
        first = 0
        for _ in range(self.header.join_count):
            # r[intra.join]
            copy = first + self.section.gamma("gaps")
            earlier = copy - 1 - self.section.gamma("depths")
            first = copy + 1
            # r[intra.join.order]
            require(
                earlier >= 0 and copy < len(self.dummy) and not self.dummy[copy] and not self.dummy[earlier],
                "intra.join.order",
                "a join of what is no vertex of the mesh",
            )
            # r[intra.join.twins]
            self.twin[copy] = self.twin[earlier]
            self.twin[earlier] = copy
            self.earlier[copy] = earlier

    def twins(self, v):
        """v and the vertices that are the same point, in the order of their list."""
        yield v
        w = self.twin[v]
        while w != v:
            yield w
            w = self.twin[w]

    # 5.4 Faces

    def number_vertices(self):
        """r[intra.faces.number] r[intra.vertices.count]"""
        self.number = array("i")
        self.numbered = []  # the vertices that have a number of their own, in its order
        for v, dummy in enumerate(self.dummy):
            if dummy:
                self.number.append(NONE)
            elif v in self.earlier:
                self.number.append(self.number[self.earlier[v]])
            else:
                self.number.append(len(self.numbered))
                self.numbered.append(v)
        require(
            len(self.numbered) + self.header.isolated_count == self.header.vertex_count,
            "intra.vertices.count",
            "the conquest does not bring the vertices that the header promises",
        )

    def faces(self):
        """r[intra.faces.number] r[intra.faces.raw]; reads the raw faces."""
        faces = []
        for h in range(0, len(self.start), 3):
            corners = self.start[h : h + 3]
            if not any(self.dummy[v] for v in corners):
                faces.append(tuple(self.number[v] for v in corners))
        for _ in range(self.header.raw_face_count):
            face = []
            for _ in range(3):
                high = self.section.raw(16)
                face.append((high << 16) + self.section.raw(16))
                require(face[-1] < self.header.vertex_count, "intra.faces.raw", "a raw face of no vertex")
            faces.append(tuple(face))
        return faces


# 5.5 Geometry

# Table 5-1: BLEND[min(s, 4) - 1][clamp(valence, 4, 8) - 4] = (o, m, e)
BLEND = (
    ((-15, 19, 3), (-9, 17, 4), (4, 20, 7), (28, 36, 7), (35, 38, 11)),
    ((59, 108, 1), (122, 158, 2), (154, 180, 4), (148, 164, 9), (143, 148, 14)),
    ((-5, 44, 2), (47, 90, 1), (100, 133, 2), (128, 152, 5), (134, 147, 12)),
    ((-21, 21, 1), (-3, 34, 1), (15, 47, 1), (44, 67, 4), (70, 91, 8)),
)


def plus(a, b):
    return [a[0] + b[0], a[1] + b[1], a[2] + b[2]]


def minus(a, b):
    return [a[0] - b[0], a[1] - b[1], a[2] - b[2]]


def times(a, n):
    return [a[0] * n, a[1] * n, a[2] * n]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def L(x):
    """5.5, "Spread": the logarithm in eighths of an octave."""
    if x <= 1:
        return 0
    e = x.bit_length() - 1
    behind = x - (1 << e)
    m = behind >> (e - 3) if e >= 3 else behind << (3 - e)
    return 8 * e + m


def R(n):
    return 65536 // n


class Ring:
    """r[intra.geometry.ring]: what is known around a vertex."""

    def __init__(self, net, known, position, v):
        self.neighbours = []
        self.triples = []
        self.base = None
        self.centroid = [0, 0, 0]
        self.parallel = [0, 0, 0]
        self.onward = [0, 0, 0]
        self.along = [0, 0, 0]
        self.gates = 0
        self.normal = [0, 0, 0]
        for a, b, c in corners_around(net, v):
            if not known[a]:
                continue
            self.neighbours.append(a)
            if self.base is None:
                self.base = position[a]
            pa = minus(position[a], self.base)
            self.centroid = plus(self.centroid, pa)
            if not (known[b] and known[c]):
                continue
            self.triples.append((a, b, c))
            pb = minus(position[b], self.base)
            pc = minus(position[c], self.base)
            ab = plus(pa, pb)
            self.parallel = plus(self.parallel, minus(ab, pc))
            self.onward = plus(self.onward, minus(ab, times(pc, 2)))
            b_a = minus(pb, pa)
            slope = min(net.valence[a], 64) - min(net.valence[b], 64)
            self.along = plus(self.along, times(b_a, slope))
            self.gates += abs(b_a[0]) + abs(b_a[1]) + abs(b_a[2])
            self.normal = plus(self.normal, cross(minus(pa, pb), minus(pc, pb)))
        self.n = len(self.neighbours)
        self.s = len(self.triples)


def corners_around(net, v):
    """a, b and c of r[intra.geometry.ring], of at most 32 half-edges."""
    for index, h in enumerate(net.around(v)):
        if index == 32:
            return
        yield net.end(h), net.start[net.prev(h)], net.tip_across(net.next(h))


class Geometry:
    def __init__(self, header, section, net):
        self.section = section
        self.net = net
        self.lattice = self.read_lattice(header) if header.lattice_present else None
        vertices = len(net.dummy)
        self.known = bytearray(vertices)
        self.position = [None] * vertices
        self.error = [0] * vertices  # the stored error
        self.support = [0] * vertices
        self.queues = [deque() for _ in range(4)]
        self.lowest = 0
        self.coded_before = [0, 0, 0]
        # r[intra.geometry.spread]: the running means of each class
        self.tangential_mean = {}
        self.normal_mean = {}
        for s in range(1, 5):
            for valence in range(4, 9):
                self.tangential_mean[s, valence] = -8 * 256
                self.normal_mean[s, valence] = -32 * 256

        v = self.next_vertex()
        while v != NONE:
            position, error = self.code_vertex(v)
            # r[intra.geometry.twins]
            for w in net.twins(v):
                self.known[w] = True
                self.position[w] = position
                self.error[w] = error
                self.settle(w)
            self.coded_before = position
            v = self.next_vertex()
        # r[intra.geometry.isolated]
        self.isolated = []
        for _ in range(header.isolated_count):
            self.coded_before = self.code_unsupported(self.coded_before)
            self.isolated.append(self.coded_before)

    def read_lattice(self, header):
        """r[intra.geometry.lattice]"""
        decision, raw, gamma = self.section.decision, self.section.raw, self.section.gamma
        lattice = []
        for _ in range(3):
            count = gamma("counts")
            require(
                1 <= count <= header.vertex_count, "intra.geometry.lattice", "as many values as no mesh needs"
            )
            high = raw(5)
            value = (high << 16) + raw(16) - 2**20
            values = [value]
            near = far = 0
            while True:
                require(abs(value) < 2**20, "intra.geometry.lattice", "a value of 2^20 or more")
                if len(values) == count:
                    break
                gap = 1
                while gap <= 8 and decision("lattice longer", near, far, gap - 1):
                    gap += 1
                if gap == 9:
                    gap = 9 + gamma("lattice escaped")
                value += gap
                values.append(value)
                near, far = min(gap, 8), near
            lattice.append(values)
        return lattice

    def settle(self, v):
        """r[intra.geometry.order]: what a vertex that has become known does to the queues."""
        net, known = self.net, self.known
        for h in net.around(v):
            if known[net.end(h)] and known[net.start[net.prev(h)]]:
                for side in (h, net.next(h), net.prev(h)):
                    tip = net.tip_across(side)
                    if not known[tip] and not net.dummy[tip]:
                        self.support[tip] += 1
                        self.queues[min(self.support[tip], 3)].append(tip)

    def next_vertex(self):
        """r[intra.geometry.order]"""
        for number in (3, 2, 1, 0):
            queue = self.queues[number]
            while queue:
                v = queue.popleft()
                if not self.known[v]:
                    return v
        while self.lowest < len(self.known):
            if not self.known[self.lowest] and not self.net.dummy[self.lowest]:
                return self.lowest
            self.lowest += 1
        return NONE

    def code_vertex(self, v):
        """The position of a vertex, and the error to store with it."""
        ring = Ring(self.net, self.known, self.position, v)
        if ring.s > 0:
            return self.code_supported(v, ring)
        # r[intra.geometry.unsupported]
        if ring.n == 0:
            expected = self.coded_before
        else:
            expected = [
                ring.base[axis] + ((((ring.centroid[axis] * R(ring.n)) >> 10) + 32) >> 6) for axis in range(3)
            ]
        return self.code_unsupported(expected), 0

    def code_unsupported(self, expected):
        return [self.coordinate(expected[axis], axis, "unsupported", 0, 1) for axis in range(3)]

    def code_supported(self, v, ring):
        n, s, base = ring.n, ring.s, ring.base
        shape = min(s, 4), clamp(self.net.valence[v], 4, 8)

        # r[intra.geometry.blend]
        o, m, e = BLEND[shape[0] - 1][shape[1] - 4]
        offset = [
            (
                ((64 - m) * ring.parallel[axis] + ((o * ring.onward[axis]) >> 1) + e * ring.along[axis]) * R(s)
                + m * ring.centroid[axis] * R(n)
            )
            >> 16
            for axis in range(3)
        ]

        # r[intra.geometry.spread]
        gate = L(divide(64 * ring.gates, s))
        tangential = gate + (self.tangential_mean[shape] >> 8)
        stored = divide(sum(self.error[a] for a in ring.neighbours), n)
        across = ((gate + (self.normal_mean[shape] >> 8)) + stored) >> 1
        flat = clamp((tangential - across - 6) >> 2, 0, 10)

        # r[intra.geometry.frame]
        too_long = max(max(abs(x) for x in ring.normal).bit_length() - 10, 0)
        N = [x >> too_long for x in ring.normal]
        d = max(range(3), key=lambda axis: abs(N[axis]))  # the lowest of equals
        p, q = (d + 1) % 3, (d + 2) % 3
        S = max(dot(N, N), 1)
        w = 2**flat - 1
        W = S * 2**flat
        X = W - w * N[p] * N[p]

        errors = [0, 0, 0]
        position = [0, 0, 0]
        for place, axis in enumerate((p, q, d)):
            if axis == p:
                mean = 0
                variance = L(X) - L(W)
            elif axis == q:
                mean = divide(-w * N[p] * N[q] * errors[p], X)
                variance = L(X - w * N[q] * N[q]) - L(X)
            else:
                mean = divide(-w * N[d] * (N[p] * errors[p] + N[q] * errors[q]), S + w * N[d] * N[d])
                variance = L(S) - L(S + w * N[d] * N[d])
            context = clamp((2 * tangential + variance) >> 3, 0, 47)
            # r[intra.geometry.coordinate]
            exact = offset[axis] + mean
            near = (exact + 32) >> 6
            lean = (3 * (exact - 64 * near + 32)) >> 6
            expected = clamp(base[axis] + near, -(2**20), 2**20)
            coordinate = self.coordinate(expected, axis, place, context, lean)
            errors[axis] = 64 * (coordinate - base[axis]) - offset[axis]
            position[axis] = coordinate

        # r[intra.geometry.learn]
        length = sum(abs(x) for x in errors)
        error = L(abs(dot(N, errors)) + 8 * sum(abs(x) for x in N)) - divide(L(S), 2)
        self.tangential_mean[shape] += (256 * (L(length + 16) - gate) - self.tangential_mean[shape]) >> 6
        self.normal_mean[shape] += (256 * (error - gate) - self.normal_mean[shape]) >> 6
        return position, error

    def error_value(self, place, context, lean):
        """r[intra.geometry.error]"""
        decision, raw = self.section.decision, self.section.raw
        if decision("is_zero", place, context):
            return 0
        negative = decision("is_negative", place, context, lean)
        n = 0
        while n < 22 and decision("longer", place, context, n):
            n += 1
        value = 1
        if n >= 1:
            s = decision("second", place, context, n)
            value = 2 * value + s
        if n >= 2:
            value = 2 * value + decision("third", place, context, n, s)
        r = max(n - 2, 0)
        k = max(r - 16, 0)
        value = (value << k) + raw(k)
        value = (value << (r - k)) + raw(r - k)
        return -value if negative else value

    def coordinate(self, expected, axis, *models):
        """r[intra.geometry.range] r[intra.geometry.lattice]"""
        coordinate = expected + self.error_value(*models)
        require(abs(coordinate) < 2**20, "intra.geometry.range", "a coordinate of 2^20 or more")
        if self.lattice is not None:
            require(
                0 <= coordinate < len(self.lattice[axis]), "intra.geometry.lattice", "a rank that is not listed"
            )
        return coordinate

    def positions(self):
        """Of the decoded vertices (5.4)."""
        places = [self.position[v] for v in self.net.numbered] + self.isolated
        if self.lattice is None:
            return [tuple(place) for place in places]
        return [tuple(self.lattice[axis][place[axis]] for axis in range(3)) for place in places]


# 5.6 Labels


class Fit:
    """r[intra.labels.border]: the linear function that fits the targets best, by the places D."""

    def __init__(self, D, targets):
        squares = [float((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]) for d in D]  # exact
        self.scale = max(sum(squares) / float(len(D)), 1.0)  # the sum is exact, below 2^53
        self.weights = []
        N = [[0.0] * 5 for _ in range(4)]
        sum_w = 0.0
        for d, square, t in zip(D, squares, targets):
            w = 1.0 / (square / self.scale + 0.25)
            self.weights.append(w)
            sum_w = sum_w + w
            row = (float(d[0]), float(d[1]), float(d[2]), 1.0, t)
            for i in range(4):
                for j in range(i, 5):
                    N[i][j] = N[i][j] + (w * row[i]) * row[j]
        for i in range(3):
            N[i][i] = N[i][i] + (1.0 / 256.0 * sum_w) * self.scale
        self.sums = [list(row) for row in N]
        for i in range(3):
            for j in range(i + 1, 4):
                f = N[i][j] / N[i][i]
                for k in range(j, 5):
                    N[j][k] = N[j][k] - f * N[i][k]
        self.eliminated = N


class Labels:
    def __init__(self, header, section, net, geometry):
        self.section = section
        self.net = net
        self.position = geometry.position  # as coded: ranks where there is a lattice
        vertices = len(net.dummy)
        # r[intra.labels.order]: a vertex is unseen, uniform, mixed or known
        self.known = bytearray(vertices)
        self.state = ["unseen"] * vertices
        self.seen_label = [None] * vertices  # of a uniform vertex
        self.label = [None] * vertices
        self.mixed_queue = deque()  # the first of the two queues
        self.uniform_queue = deque()  # the second
        self.lowest = 0
        self.coded_before = 0

        v = self.next_vertex()
        while v != NONE:
            label = self.code_vertex(v)
            for w in net.twins(v):
                self.known[w] = True
                self.label[w] = label
                self.settle(w)
            self.coded_before = label
            v = self.next_vertex()
        # r[intra.labels.isolated]
        self.isolated = []
        for _ in range(header.isolated_count):
            self.coded_before = self.code([None, None], [0, 0], None)
            self.isolated.append(self.coded_before)

    def settle(self, v):
        """r[intra.labels.order]"""
        label = self.label[v]
        for h in self.net.around(v):
            w = self.net.end(h)
            if self.net.dummy[w] or self.known[w]:
                continue
            if self.state[w] == "unseen":
                self.state[w] = "uniform"
                self.seen_label[w] = label
                self.uniform_queue.append(w)
            elif self.state[w] == "uniform" and self.seen_label[w] != label:
                self.state[w] = "mixed"
                self.mixed_queue.append(w)

    def next_vertex(self):
        for queue in (self.mixed_queue, self.uniform_queue):
            while queue:
                v = queue.popleft()
                if not self.known[v]:
                    return v
        while self.lowest < len(self.known):
            if not self.known[self.lowest] and not self.net.dummy[self.lowest]:
                return self.lowest
            self.lowest += 1
        return NONE

    def code_vertex(self, v):
        """r[intra.labels.vote]"""
        candidates = [None, None]
        votes = [0, 0]
        for h in self.net.around(v):  # all: the limit of 32 is not one of votes
            a = self.net.end(h)
            if not self.known[a]:
                continue
            label = self.label[a]
            for i in (0, 1):
                if votes[i] == 0:
                    candidates[i] = label
                if candidates[i] == label:
                    votes[i] += 1
                    break
            if votes[1] > votes[0]:
                candidates.reverse()
                votes.reverse()
        lean = self.border(v, candidates) if votes[1] > 0 else None
        return self.code(candidates, votes, lean)

    def first_ends(self, v):
        """The ends of at most the first 32 half-edges around a vertex, in order."""
        return [self.net.end(h) for h in islice(self.net.around(v), 32)]

    def samples(self, v, candidates):
        """r[intra.labels.border]: the vertices that the fit is made to."""
        met = [v]
        distance = {v: 0}
        for u in met:  # grows, breadth first
            if distance[u] == 4:
                break
            for w in self.first_ends(u):
                if w not in distance and not self.net.dummy[w] and len(met) < 256:
                    distance[w] = distance[u] + 1
                    met.append(w)
        return [
            w
            for w in met
            if self.known[w]
            and self.label[w] in candidates
            and any(self.known[x] and self.label[x] != self.label[w] for x in self.first_ends(w))
        ]

    def border(self, v, candidates):
        """r[intra.labels.border]: lean, in binary64 in the order of the text."""
        samples = self.samples(v, candidates)
        if not samples:
            return 8
        D = [minus(self.position[w], self.position[v]) for w in samples]
        targets = [1.0 if self.label[w] == candidates[0] else -1.0 for w in samples]
        N = Fit(D, targets).eliminated
        return clamp(math.floor(3.0 * (N[3][4] / N[3][3]) + 0.5), -8, 8) + 8

    def code(self, candidates, votes, lean):
        """r[intra.labels.code]"""
        decision = self.section.decision
        # every known neighbour votes, and the first takes a place: no votes means no voters
        first = self.coded_before if votes[0] == 0 else candidates[0]
        if votes[1] == 0:
            at_first = decision("uniform", min(votes[0], 4))
        else:
            at_first = decision("mixed", lean)
        if at_first:
            return first
        if votes[1] > 0 and decision("is_second"):
            return candidates[1]
        node = 1
        for _ in range(8):
            node = 2 * node + decision("tree", node)
        return node - 256

    def labels(self):
        return [self.label[v] for v in self.net.numbered] + self.isolated
