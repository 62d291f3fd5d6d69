#!/usr/bin/env python3
"""Searches vertices whose rounded position hangs on the last bit of a binary64, for the streams `last_bits*`.

    python3 spec/reference/search_last_bits.py matrix | weights | smoothing

Needs numpy; takes minutes. For every wrong reading of chapter 8 below (those of misreadings.py that change a last bit
only) it prints some vertices that are rounded to another integer by it. They are the literals of the corpus' source,
uncommon_last_bits.rs; mutants.py then says whether the streams catch the readings with the arithmetic of Python.

Why it finds any. Results are rounded to 2^(−8) grid steps, and a last bit of theirs is about 2^(−25) of such a step: one
vertex in 2^25 would tell. So the scenes make what cancels large. A node far from the origin with scales and
shears of 8 has A·x of 2^35 where the position has 2^28; nodes in opposite places, whose weighted
moves cancel, have w·(A·x + b) of 2^34. One vertex in 2^18 tells then, and a million are tried in a second.
"""

import math
import random
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np

import deformation as D
import motion

PER_READING = 2
UNIT = 256  # 8 fraction bits


def fma(a, b, c):
    return float(Fraction(float(a)) * Fraction(float(b)) + Fraction(float(c)))


# Of nodes: angles from 16/65536, scales and shears from 256/65536, as in steps 8 and 24.


def node_motion(translation, rotation, scale, shear):
    return motion.NodeMotion(
        translation,
        [value * motion.parameter_step(8) / 65536 for value in rotation],
        [1 + value * motion.parameter_step(24) / 65536 for value in scale],
        [value * motion.parameter_step(24) / 65536 for value in shear],
    )


class Reading:
    """The decoder with functions of `deformation` replaced."""

    def __init__(self, **changes):
        self.changes = changes

    def __enter__(self):
        self.saved = {name: getattr(D, name) for name in self.changes}
        for name, function in self.changes.items():
            setattr(D, name, function)

    def __exit__(self, *_):
        for name, function in self.saved.items():
            setattr(D, name, function)


def sincos_without_tail(a):
    k = round(a * D.TwoOverPi)
    r = a - float(k) * (math.pi / 2)
    z = r * r
    s = r + r * (z * D.horner(D.P, z))
    c = 1.0 + z * D.horner(D.C, z)
    return [(s, c), (c, -s), (-s, -c), (-c, s)][k % 4]


def horner_fused(coefficients, z):
    p = coefficients[-1]
    for coefficient in reversed(coefficients[:-1]):
        p = fma(z, p, coefficient)
    return p


def rotation_of(angles, product):
    """product(a, b, c, d, e, f) is (a × b) × c ± d × e, with f for the sign."""
    (s_x, c_x), (s_y, c_y), (s_z, c_z) = [D.sincos(angle) for angle in angles]
    return [
        [c_z * c_y, product(c_z, s_y, s_x, s_z, c_x, -1), product(c_z, s_y, c_x, s_z, s_x, 1)],
        [s_z * c_y, product(s_z, s_y, s_x, c_z, c_x, 1), product(s_z, s_y, c_x, c_z, s_x, -1)],
        [-s_y, c_y * s_x, c_y * c_x],
    ]


def matrix_of(row):
    def matrix(m):
        return [row(*r, *m.scales, *m.shears) for r in D.rotation(m.angles)]

    return matrix


def row_from_the_right(r_0, r_1, r_2, s_x, s_y, s_z, h_xy, h_xz, h_yz):
    p_0, p_1, p_2 = r_0 * s_x, r_1 * s_y, r_2 * s_z
    return [p_0, p_0 * h_xy + p_1, p_0 * h_xz + (p_1 * h_yz + p_2)]


def row_of_products(r_0, r_1, r_2, s_x, s_y, s_z, h_xy, h_xz, h_yz):
    p_1, p_2 = r_1 * s_y, r_2 * s_z
    return [r_0 * s_x, r_0 * (s_x * h_xy) + p_1, (r_0 * (s_x * h_xz) + r_1 * (s_y * h_yz)) + p_2]


def row_fused(r_0, r_1, r_2, s_x, s_y, s_z, h_xy, h_xz, h_yz):
    p_0, p_1, p_2 = r_0 * s_x, r_1 * s_y, r_2 * s_z
    return [p_0, fma(p_0, h_xy, p_1), fma(p_0, h_xz, p_1 * h_yz) + p_2]


def transform_of(b_of):
    def transform(n, m):
        A = D.matrix(m)
        return A, [b_of(A[i], float(n[i]), float(m.translation[i]), *map(float, n)) for i in range(3)]

    return transform


READINGS = {
    "sine: the platform's": Reading(sincos=lambda a: (math.sin(a), math.cos(a))),
    "sine: no tail of pi/2": Reading(sincos=sincos_without_tail),
    "horner: fused": Reading(horner=horner_fused),
    "A: r × (s × h)": Reading(matrix=matrix_of(row_of_products)),
    "A: sum from the right": Reading(matrix=matrix_of(row_from_the_right)),
    "A: fused": Reading(matrix=matrix_of(row_fused)),
    "R: products from the right": Reading(
        rotation=lambda angles: rotation_of(angles, lambda a, b, c, d, e, f: a * (b * c) + f * (d * e))
    ),
    "R: fused": Reading(
        rotation=lambda angles: rotation_of(angles, lambda a, b, c, d, e, f: fma(a * b, c, f * (d * e)))
    ),
    "b: n − A·n, then t": Reading(
        transform=transform_of(lambda A, n, t, x, y, z: (n - ((A[0] * x + A[1] * y) + A[2] * z)) + t)
    ),
    "b: fused": Reading(
        transform=transform_of(lambda A, n, t, x, y, z: (n + t) - fma(A[2], z, fma(A[1], y, A[0] * x)))
    ),
}

# What follows in r[deform.blend] for one node and weight 1, of a row of A, b and the coordinates of many vertices.
BLENDS = {
    "blend: A·x + b from the right": lambda A, b, x: (A[0] * x[0] + A[1] * x[1]) + (A[2] * x[2] + b),
    "blend: begins with b": lambda A, b, x: ((b + A[0] * x[0]) + A[1] * x[1]) + A[2] * x[2],
    # 64 bits instead of one rounding: near enough to find candidates
    "blend: A·x fused": lambda A, b, x: np.float64(
        np.longdouble(A[2]) * x[2]
        + np.longdouble(np.float64(np.longdouble(A[1]) * x[1] + np.longdouble(A[0] * x[0])))
    )
    + b,
}


def blend(A, b, x):
    return ((A[0] * x[0] + A[1] * x[1]) + A[2] * x[2]) + b


def search_matrix():
    """One node a vertex. Sets of angles until each reading changes a vertex."""
    numbers = np.random.default_rng(1)
    wanted = {name: PER_READING for name in [*READINGS, *BLENDS]}
    n = (900003, -899983, 900033)
    units = [UNIT * c for c in n]
    chooser = random.Random(1)
    while any(wanted.values()):
        rotation = [chooser.randint(-16000, 16000) for _ in range(3)]
        scale = [chooser.randint(1600, 1790) for _ in range(3)]
        shear = [chooser.choice((-1, 1)) * chooser.randint(1900, 2040) for _ in range(3)]
        m = node_motion([5, -7, 11], rotation, scale, shear)
        A, b = D.transform(units, m)
        others = {}
        for name, reading in READINGS.items():
            with reading:
                others[name] = D.transform(units, m)
        same = all(transform == (A, b) for name, transform in others.items() if wanted[name])
        if same and not any(wanted[name] for name in BLENDS):
            continue
        found = {}
        for _ in range(3):
            x = [numbers.integers(-400, 401, 1 << 20) + n[axis] for axis in range(3)]
            scaled = [UNIT * c.astype(np.float64) for c in x]
            for i in range(3):
                right = np.rint(blend(A[i], b[i], scaled))
                inside = np.abs(right) < 2**28 - 1
                results = {name: blend(A2[i], b2[i], scaled) for name, (A2, b2) in others.items()}
                results |= {name: function(A[i], b[i], scaled) for name, function in BLENDS.items()}
                for name, result in results.items():
                    for j in np.nonzero((np.rint(result) != right) & inside)[0]:
                        place = tuple(int(c[j]) for c in x)
                        all_inside = all(
                            abs(blend(A[k], b[k], [float(UNIT * c) for c in place])) < 2**28 - 1 for k in range(3)
                        )
                        if all_inside and wanted[name] > len(found.get(name, ())):
                            found.setdefault(name, set()).add(place)
        new = {name: places for name, places in found.items() if wanted[name]}
        if new:
            print(f"rotation {rotation} scale {scale} shear {shear}")
        for name, places in new.items():
            wanted[name] = max(wanted[name] - len(places), 0)
            print(f"  {name}: {sorted(map(list, places))}", flush=True)


def expneg(x):
    """r[deform.exp] of many."""
    k = np.rint(x * D.Log2E)
    r = -((x - k * D.Ln2Head) - k * D.Ln2Tail)
    return np.ldexp(D.horner(D.E, r), -k.astype(int))


def expneg_without_tail(x):
    k = np.rint(x * D.Log2E)
    return np.ldexp(D.horner(D.E, -(x - k * math.log(2))), -k.astype(int))


def expneg_fused(x):
    k = np.rint(x * D.Log2E)
    r = -((x - k * D.Ln2Head) - k * D.Ln2Tail)
    p = np.full_like(r, D.E[-1])
    for coefficient in reversed(D.E[:-1]):
        p = np.float64(np.longdouble(r) * p + coefficient)
    return np.ldexp(p, -k.astype(int))


def total(order):
    def of(u):
        U = np.zeros_like(u[0])
        for j in order:
            U = U + u[j]
        return U

    return of


TAIL = "exponential: no tail of ln 2"


def search_weights():
    """Two pairs of nodes in opposite places, Gaussian weights. With the second sigma the farther pair has an exponent of
    3 ln 2, and three times a rounded ln 2 is off by 2^(-52)."""
    search_weights_of(500_000, lambda name: name != TAIL)
    search_weights_of(225_000, lambda name: name == TAIL)


def search_weights_of(sigma, wanted):
    numbers = np.random.default_rng(2)
    p, q = (400_003, -399_961, 300_007), (-500_029, -450_001, 410_009)
    nodes = [p, tuple(-c for c in p), q, tuple(-c for c in q)]
    rotation, scale, shear = [9001, -5003, 12007], [1699, 1777, 1788], [2011, -1999, 2003]
    m = node_motion([5, -7, 11], rotation, scale, shear)
    transforms = [D.transform([UNIT * c for c in node], m) for node in nodes]
    print(f"nodes {nodes} sigma {sigma} rotation {rotation} scale {scale} shear {shear}")
    all_of = dict(u=expneg, U=total(range(4)), w=lambda u, U: u / U, add=lambda s, w, y, x, A, b: s + w * y)
    READ = {
        "exponential: the platform's": dict(u=lambda x: np.exp(-x)),
        TAIL: dict(u=expneg_without_tail),
        "horner: fused": dict(u=expneg_fused),
        "weights: times 1/U": dict(w=lambda u, U: u * (1.0 / U)),
        "weights: U in falling order": dict(U=total((3, 2, 1, 0))),
        "weights: U begins with the second": dict(U=total((1, 2, 3, 0))),
        "blend: slots in falling order": dict(order=(3, 2, 1, 0)),
        "blend: the weighted sum fused": dict(
            add=lambda s, w, y, x, A, b: np.float64(np.longdouble(w) * y + np.longdouble(s))
        ),
        "blend: weights times A·x and b": dict(
            add=lambda s, w, y, x, A, b: s + (w * ((A[0] * x[0] + A[1] * x[1]) + A[2] * x[2]) + w * b)
        ),
    }
    READ = {name: reading for name, reading in READ.items() if wanted(name)}
    found = {name: set() for name in READ}
    while any(len(places) < PER_READING for places in found.values()):
        x = np.array([numbers.integers(-300, 301, 1 << 18) for _ in range(3)])
        squared = [sum((x[axis] - node[axis]) ** 2 for axis in range(3)) for node in nodes]
        ranks = np.lexsort((np.arange(4)[:, None] * np.ones_like(squared[0]), np.array(squared)), axis=0)
        # vertices with the same order of nodes at a time
        for order in set(map(tuple, ranks.T)):
            chosen = np.all(ranks.T == order, axis=1)
            place = x[:, chosen]
            scaled = UNIT * place.astype(np.float64)
            d = [squared[j][chosen].astype(np.float64) for j in order]

            def blended(reading, i):
                f = all_of | reading
                u = [f["u"]((d_j - d[0]) / (2.0 * (float(sigma) * float(sigma)))) for d_j in d]
                w = [f["w"](u_j, f["U"](u)) for u_j in u]
                s = np.zeros_like(d[0])
                for j in f.get("order", range(4)):
                    A, b = transforms[order[j]]
                    s = f["add"](s, w[j], blend(A[i], b[i], scaled), scaled, A[i], b[i])
                return s

            for i in range(3):
                right = np.rint(blended({}, i))
                for name, reading in READ.items():
                    for j in np.nonzero(np.rint(blended(reading, i)) != right)[0]:
                        if len(found[name]) < PER_READING:
                            found[name].add(tuple(int(c) for c in place[:, j]))
                            print(f"  {name}: {place[:, j].tolist()} (order {order})", flush=True)


def sum_of(f, around):
    S = np.zeros_like(f[0])
    for w in around:
        S = S + f[w]
    return S


def mean_less_own(f, v, around):
    return sum_of(f, around) / float(len(around)) - f[v]


def smoothed(y, neighbours, strength, U_of=mean_less_own, step=None):
    """x less y after the passes; y: #V × many."""
    mu, omega = D.STRENGTHS[strength - 1]
    step = step or (lambda x, y, m: x + omega * ((y - x) - mu * m))
    U = lambda f: np.array([U_of(f, v, around) if around else 0.0 * f[v] for v, around in enumerate(neighbours)])
    x = y
    for _ in range(3):
        x = step(x, y, U(U(x)))
    return np.clip(x - y, -float(UNIT // 2), float(UNIT // 2))


def meetings(vertices, faces):
    """Neighbours in the order in which the faces let a vertex meet them."""
    meets = [{} for _ in range(vertices)]
    for a, b, c in faces:
        for v, others in ((a, (b, c)), (b, (c, a)), (c, (a, b))):
            for other in others:
                meets[v][other] = 1
    return [list(met) for met in meets]


def smoothing_readings(neighbours, faces, strength):
    mu, omega = D.STRENGTHS[strength - 1]
    met = meetings(len(neighbours), faces)
    return {
        "smooth: neighbours in the order of meeting": dict(neighbours=met),
        "smooth: falling index": dict(neighbours=[around[::-1] for around in neighbours]),
        "smooth: 1/n": dict(U_of=lambda f, v, around: sum_of(f, around) * (1.0 / float(len(around))) - f[v]),
        "smooth: sum of differences": dict(
            U_of=lambda f, v, around: sum_of(f - f[v], around) / float(len(around))
        ),
        "smooth: in place": dict(step=lambda x, y, m: (1.0 - omega) * x + omega * (y - mu * m)),
        "smooth: half up": {},
    }


def search_smoothing():
    """Every field of coordinates printed is one axis of a frame of `last_bits_smoothing`, from which the meshes are
    taken: sums run over neighbours in the decoded order."""
    import io

    import kn_decode

    class Meshes(kn_decode.Decoder):
        def show(self, kind, digest):
            meshes.append((len(self.group.reference), list(self.group.mesh.faces)))

    meshes = []
    stream = Path(__file__).resolve().parent.parent / "conformance/uncommon/last_bits_smoothing.knm"
    Meshes(io.StringIO()).decode(io.BytesIO(stream.read_bytes()))
    numbers = np.random.default_rng(3)
    for (vertices, faces), strength in zip(meshes, (5, 4)):
        neighbours = D.neighbours(vertices, faces)
        readings = smoothing_readings(neighbours, faces, strength)
        print(f"{vertices} vertices, strength {strength}")
        for _ in range(2000):
            if not readings:
                break
            y = UNIT * (2.0**20 - 1 - numbers.integers(0, 7 - strength, (vertices, 1 << 14)))
            right = smoothed(y, neighbours, strength)
            for name, reading in list(readings.items()):
                wrong = smoothed(y, **dict(neighbours=neighbours, strength=strength) | reading)
                rounded = np.floor(wrong + 0.5) if name == "smooth: half up" else np.rint(wrong)
                differ = np.nonzero(rounded != np.rint(right))
                if len(differ[1]):
                    below = (2**20 - y[:, differ[1][0]] / UNIT).astype(int)
                    print(f"  {name}: {''.join(map(str, below))}", flush=True)
                    del readings[name]


if __name__ == "__main__":
    {"matrix": search_matrix, "weights": search_weights, "smoothing": search_smoothing}[sys.argv[1]]()
