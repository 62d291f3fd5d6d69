"""Chapter 8: influence and deformation, in binary64.

A float of Python is a binary64; +, -, *, / and math.sqrt round each to nearest, ties to even, nothing is
fused, and the parentheses below are those of the text. round() of a float rounds ties to even.
r[conventions.binary64] r[conventions.conversion]
"""

import heapq
import math
import struct

from bits import require


def binary64(bits):
    return struct.unpack(">d", struct.pack(">Q", bits))[0]


# 8.1 Elementary functions

TwoOverPi = binary64(0x3FE45F306DC9C883)
HalfPiHead = binary64(0x3FF921FB54400000)
HalfPiTail = binary64(0x3DD0B4611A626331)
P = [-1 / 6, 1 / 120, -1 / 5040, 1 / 362880, -1 / 39916800, 1 / 6227020800, -1 / 1307674368000]
C = [-1 / 2, 1 / 24, -1 / 720, 1 / 40320, -1 / 3628800, 1 / 479001600, -1 / 87178291200]

Log2E = binary64(0x3FF71547652B82FE)
Ln2Head = binary64(0x3FE62E42FEE00000)
Ln2Tail = binary64(0x3DEA39EF35793C76)
E = [1.0, 1.0, 1 / 2, 1 / 6, 1 / 24, 1 / 120, 1 / 720, 1 / 5040, 1 / 40320, 1 / 362880, 1 / 3628800]
E += [1 / 39916800, 1 / 479001600]


def horner(coefficients, z):
    p = coefficients[-1]
    for coefficient in reversed(coefficients[:-1]):
        p = coefficient + z * p
    return p


def sincos(a):
    """r[deform.sincos]"""
    k = round(a * TwoOverPi)
    r = (a - float(k) * HalfPiHead) - float(k) * HalfPiTail
    z = r * r
    s = r + r * (z * horner(P, z))
    c = 1.0 + z * horner(C, z)
    return [(s, c), (c, -s), (-s, -c), (-c, s)][k % 4]


def expneg(x):
    """r[deform.exp]"""
    if x > 700.0:
        return 0.0
    k = round(x * Log2E)
    r = -((x - float(k) * Ln2Head) - float(k) * Ln2Tail)
    return horner(E, r) * 2.0**-k


# 8.2 Influence


def squared_distance(a, b):
    return (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2


def nearest_vertex(point, positions):
    """r[nodes.label.nearest]: min() gives the first of the least."""
    return min(range(len(positions)), key=lambda vertex: squared_distance(positions[vertex], point))


def bind(positions, regions, nodes, node_regions, header, sigma):
    """The influence of every vertex: a list of Q pairs (node, weight). positions and nodes in grid
    steps; regions and node_regions are their regions."""
    all_nodes = list(range(len(nodes)))
    candidates_of = {region: [] for region in regions}
    for node in all_nodes:
        candidates_of.setdefault(node_regions[node], []).append(node)
    for region in candidates_of:
        if not candidates_of[region]:
            # r[deform.influence.strict] r[deform.influence.mode]
            require(header.influence_mode == 1, "deform.influence.strict", f"region {region} has no node")
            candidates_of[region] = all_nodes
    influences = []
    for x, region in zip(positions, regions):
        candidates = candidates_of[region]
        influences.append(influence(x, candidates, nodes, header.nodes_per_vertex, header.weight_scheme, sigma))
    return influences


def influence(x, candidates, nodes, Q, weight_scheme, sigma):
    # r[deform.influence.nearest]; the candidate behind the Q-th is for Sumner's weights
    ranked = heapq.nsmallest(Q + 1, ((squared_distance(x, nodes[node]), node) for node in candidates))
    M = len(candidates)
    # r[deform.influence.replication]
    if M >= Q:
        slots = ranked[:Q]
    else:
        slots = [ranked[0]] * (Q - M + 1) + ranked[1:]
    # r[deform.weights.floor]
    D = [float(max(squared, 1)) for squared, _ in slots]
    if weight_scheme == 0:
        # r[deform.weights.inverse]
        u = [1.0 / D_j for D_j in D]
    elif weight_scheme == 1:
        # r[deform.weights.sumner]
        if M > Q:
            d = math.sqrt(float(max(ranked[Q][0], 1)))
        else:
            d = 2.0 * math.sqrt(D[Q - 1])
        u = [(1.0 - math.sqrt(D_j) / d) * (1.0 - math.sqrt(D_j) / d) for D_j in D]
    else:
        # r[deform.weights.gaussian]
        u = [expneg((D_j - D[0]) / (2.0 * (float(sigma) * float(sigma)))) for D_j in D]
    # r[deform.weights.normalise]
    U = 0.0
    for u_j in u:
        U = U + u_j
    if U == 0.0:
        w = [1.0 / float(Q)] * Q
    else:
        w = [u_j / U for u_j in u]
    return [(node, w_j) for (_, node), w_j in zip(slots, w)]


# 8.3 Node transforms


def rotation(angles):
    """r[deform.rotation]"""
    (s_x, c_x), (s_y, c_y), (s_z, c_z) = [sincos(angle) for angle in angles]
    return [
        [c_z * c_y, (c_z * s_y) * s_x - s_z * c_x, (c_z * s_y) * c_x + s_z * s_x],
        [s_z * c_y, (s_z * s_y) * s_x + c_z * c_x, (s_z * s_y) * c_x - c_z * s_x],
        [-s_y, c_y * s_x, c_y * c_x],
    ]


def matrix(motion):
    """r[deform.matrix]"""
    s_x, s_y, s_z = motion.scales
    h_xy, h_xz, h_yz = motion.shears
    A = []
    for r_0, r_1, r_2 in rotation(motion.angles):
        p_0 = r_0 * s_x
        p_1 = r_1 * s_y
        p_2 = r_2 * s_z
        A.append([p_0, p_0 * h_xy + p_1, (p_0 * h_xz + p_1 * h_yz) + p_2])
    return A


def transform(n, motion):
    """A and b of a node at n (reference units). r[deform.node]"""
    A = matrix(motion)
    n_0, n_1, n_2 = float(n[0]), float(n[1]), float(n[2])
    b = []
    for i in range(3):
        moved = float(n[i] + motion.translation[i])
        b.append(moved - ((A[i][0] * n_0 + A[i][1] * n_1) + A[i][2] * n_2))
    return A, b


# 8.4 Deformation of a frame


def deform(reference, influences, transforms, fraction_bits):
    """The new reference. r[deform.blend] r[deform.round] r[deform.position.range]"""
    limit = float(2 ** (20 + fraction_bits)) - 0.5
    # rows (A_i0, A_i1, A_i2, b_i) of each node for i = 0, 1, 2
    rows = [[(*A[i], b[i]) for i in range(3)] for A, b in transforms]
    moved = []
    for x, slots in zip(reference, influences):
        x_0, x_1, x_2 = float(x[0]), float(x[1]), float(x[2])
        position = []
        for i in range(3):
            total = 0.0
            for node, w_j in slots:
                A_i0, A_i1, A_i2, b_i = rows[node][i]
                total = total + w_j * (((A_i0 * x_0 + A_i1 * x_1) + A_i2 * x_2) + b_i)
            require(abs(total) < limit, "deform.position.range", "a vertex leaves the grid")
            position.append(round(total))
        moved.append(tuple(position))
    return moved


def move_nodes(nodes, motions, fraction_bits):
    """r[deform.nodes.move]"""
    moved = []
    for n, motion in zip(nodes, motions):
        position = tuple(n[i] + motion.translation[i] for i in range(3))
        require(
            max(map(abs, position)) < 2 ** (20 + fraction_bits), "deform.nodes.move", "a node leaves the grid"
        )
        moved.append(position)
    return moved


# 8.5 Smoothing of an I-frame

# r[smooth.strength]: (mu, omega) of smoothing_strength 1 to 5; all are exact in binary64
STRENGTHS = ((0.125, 0.875), (0.25, 0.75), (0.5, 0.625), (1.0, 0.4375), (2.0, 0.28125))


def neighbours(vertex_count, faces):
    """r[smooth.neighbours]: of each vertex, by rising index."""
    meets = [{} for _ in range(vertex_count)]
    for a, b, c in faces:
        for v, others in ((a, (b, c)), (b, (c, a)), (c, (a, b))):
            for other in others:
                meets[v][other] = meets[v].get(other, 0) + 1
    result = []
    for met in meets:
        if all(times == 2 for times in met.values()):
            result.append(sorted(met))
        else:
            result.append([])
    return result


def U(f, neighbours_of):
    """r[smooth.operator]"""
    result = []
    for v, around in enumerate(neighbours_of):
        if around:
            S = 0.0
            for w in around:
                S = S + f[w]
            result.append(S / float(len(around)) - f[v])
        else:
            result.append(0.0)
    return result


def smooth(positions, faces, smoothing_strength, fraction_bits):
    """The reference of an I-frame from its positions on the grid."""
    y = [tuple(x * 2**fraction_bits for x in position) for position in positions]
    if smoothing_strength == 0:
        return y
    mu, omega = STRENGTHS[smoothing_strength - 1]
    neighbours_of = neighbours(len(y), faces)
    h = float(2**fraction_bits // 2)
    axes = []
    for axis in range(3):
        y_v = [float(position[axis]) for position in y]
        # r[smooth.pass]
        x = list(y_v)
        for _ in range(3):
            m = U(U(x, neighbours_of), neighbours_of)
            x = [x[v] + omega * ((y_v[v] - x[v]) - mu * m[v]) for v in range(len(x))]
        # r[smooth.clamp]
        axes.append([y[v][axis] + round(min(max(x[v] - y_v[v], -h), h)) for v in range(len(x))])
    return list(zip(*axes))
