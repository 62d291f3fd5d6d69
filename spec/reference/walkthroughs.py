#!/usr/bin/env python3
"""The walkthroughs of chapter 5 that follow a stream of the corpus, made by this decoder.

    python3 spec/reference/walkthroughs.py          compares them with the chapter
    python3 spec/reference/walkthroughs.py --print  prints them

A block of the chapter begins with the kind that BLOCKS gives. It holds what this decoder does with a frame of a stream, line by
line.
"""

import io
import re
import struct
import sys
from pathlib import Path

import intra
import kn_decode
from range_coder import Section

SPEC = Path(__file__).resolve().parent.parent


class Conquest(intra.Connectivity):
    """A line for each triangle and each join."""

    def __init__(self, header, section):
        self.lines, self.waiting = [], []
        super().__init__(header, section)

    def wait(self, h):
        super().wait(h)
        self.waiting.append(f"{h}:{min(self.lacking[self.end(h)], 15)}")

    def triangle(self, what):
        corners = list(self.start[-3:])
        lacking = [self.lacking[v] for v in corners]
        waits = "; waits " + " ".join(self.waiting) if self.waiting else ""
        names = " ".join(f"{v}*" if self.dummy[v] else f"{v}" for v in corners)
        self.lines.append(f"{what + waits:64}  ({names}) ({' '.join(map(str, lacking))})")
        self.waiting = []

    def seed(self):
        super().seed()
        self.triangle("seed, valences " + " ".join(map(str, self.valence[-3:])))

    def read_symbol(self, gate):
        self.symbol, e = super().read_symbol(gate)
        if self.symbol == "Jump":
            self.symbol = f"Jump to {e}"
        return self.symbol.partition(" ")[0], e

    def apply_symbol(self, gate):
        super().apply_symbol(gate)
        tip = self.start[-1]
        made = f", valence {self.valence[tip]}" if self.symbol == "New" else ""
        self.triangle(f"gate {gate}: {self.symbol}, tip {tip}{made}")

    def join(self):
        super().join()
        for copy, earlier in self.earlier.items():
            self.lines.append(f"join: {copy} is {earlier}")


class Lists(intra.Geometry):
    """A line for each value of a lattice."""

    def __init__(self, header, section, net):
        self.lines = []
        super().__init__(header, section, net)

    def read_lattice(self, header):
        lattice = super().read_lattice(header)
        for axis, values in enumerate(lattice):
            self.lines.append(f"axis {axis}: {len(values)} values, the least {values[0]}")
            near = far = 0
            for before, value in zip(values, values[1:]):
                gap = value - before
                bits = "1" * min(gap - 1, 8) + "0" * (gap <= 8)
                escaped = f", escaped {gap - 9}" if gap > 8 else ""
                model = f"longer[{near}][{far}]"
                self.lines.append(f"    {model} {bits:8}{escaped:18} gap {gap:7}, value {value}")
                near, far = min(gap, 8), near
        return lattice


def hexadecimal(value):
    return struct.pack(">d", value).hex()


class Fits(intra.Labels):
    """The first fit to three or four samples of both labels."""

    def __init__(self, *arguments):
        self.lines = []
        super().__init__(*arguments)

    def border(self, v, candidates):
        side = super().border(v, candidates)
        samples = self.samples(v, candidates)
        both = len({self.label[w] for w in samples}) == 2
        if not self.lines and both and len(samples) in (3, 4):
            self.lines.append(f"vertex {v} at {self.position[v]}, candidates {candidates}")
            self.lines += self.fit_lines(v, candidates, samples)
            self.lines.append(f"side {side}")
        return side

    def fit_lines(self, v, candidates, samples):
        D = [intra.minus(self.position[w], self.position[v]) for w in samples]
        targets = [1.0 if self.label[w] == candidates[0] else -1.0 for w in samples]
        fit = intra.Fit(D, targets)
        for w, d, t, weight in zip(samples, D, targets, fit.weights):
            yield f"sample {w}: d {d}, t {t:+.0f}, w {hexadecimal(weight)}"
        yield f"scale {hexadecimal(fit.scale)}"
        for name, matrix in (("M", fit.sums), ("eliminated", fit.eliminated)):
            for i in range(4):
                numbers = " ".join(hexadecimal(x) for x in matrix[i][i:])
                yield f"{name}[{i}][{i} … 4]  {numbers}"


def frames(name):
    """The payloads of a stream's I-frames."""
    found = []

    class Collector(kn_decode.Decoder):
        def decode_intra(self, f, start):
            found.append(f.payload)
            super().decode_intra(f, start)

    Collector(io.StringIO()).decode(io.BytesIO((SPEC / "conformance" / f"{name}.knm").read_bytes()))
    return found


def connectivity(payload):
    section = Section(payload.connectivity_section)
    net = Conquest(payload, section)
    net.faces()
    return net


def conquest(payload):
    return connectivity(payload).lines


def lattice(payload):
    return Lists(payload, Section(payload.geometry_section), connectivity(payload)).lines


def fit(payload):
    net = connectivity(payload)
    geometry = intra.Geometry(payload, Section(payload.geometry_section), net)
    return Fits(payload, Section(payload.label_section), net, geometry).lines


def jumps(payload):
    return conquest(payload)[51:]


# Kind of the block: the stream, its frame, and what is printed.
BLOCKS = {
    "conquest-hole": ("uncommon/knotted_mesh", 0, conquest),
    "conquest-jump": ("uncommon/flat", 0, jumps),
    "lattice": ("uncommon/lattice", 1, lattice),
    "fit": ("core/combination_rt", 0, fit),
}


def main(arguments):
    chapter = (SPEC / "05-intra.md").read_text(encoding="utf-8")
    wrong = 0
    for kind, (stream, frame, lines) in BLOCKS.items():
        made = "\n".join(lines(frames(stream)[frame])) + "\n"
        if "--print" in arguments:
            print(f"```{kind}\n{made}```\n")
            continue
        block = re.search(rf"^```{kind}\n(.*?)^```", chapter, re.M | re.S)
        if not block or block[1] != made:
            wrong += 1
            print(f"{kind}: differs, made:\n{made}")
    print(f"{len(BLOCKS) - wrong} walkthroughs as written, {wrong} not")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
