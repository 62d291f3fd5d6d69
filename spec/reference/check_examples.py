#!/usr/bin/env python3
"""Reads the worked examples (1.4) of the specification, examples.json, with this decoder's own readers.

    python3 check_examples.py [EXAMPLES.json]
"""

import io
import json
import sys
from pathlib import Path

import kn_decode
import motion
import syntax
from bits import BitReader, Refused, find_table


def header_of(known):
    header = syntax.Elements()
    header.level = known.get("level", 2)
    header.limits = syntax.LEVELS[header.level]
    header.weight_scheme = known.get("weight_scheme")
    header.label_count = known.get("LabelCount")
    header.max_group_length = known.get("max_group_length")
    return header


def read_unit(data):
    """The elements of a unit that stands alone: 3.2 without 3.1."""
    file = kn_decode.File(io.BytesIO(kn_decode.SIGNATURE.to_bytes(8, "big") + data))
    limit = syntax.HIGHEST_LEVEL["max_unit_bytes"]
    (unit,) = file.units(lambda type: None, lambda type: limit)
    payload_at = 8 * unit.bytes_before
    return [
        (0, "unit_type", unit.type),
        (8, "unit_size", len(unit.payload)),
        (payload_at, "skipped", unit.payload),
        (payload_at + 8 * len(unit.payload), "unit_crc", int.from_bytes(data[-4:], "big")),
    ]


def read(what, known, data):
    trace = []
    r = BitReader(data, trace)
    if what.startswith("descriptor "):
        kind, _, argument = what.removeprefix("descriptor ").rstrip(")").partition("(")
        arguments = [int(argument)] if argument else []
        getattr(r, kind)(*arguments, "value")
    elif what == "unit":
        trace = read_unit(data)
    elif what == "sequence_header":
        syntax.sequence_header(r)
    elif what == "frame_header":
        syntax.frame_header(r, syntax.Elements())
    elif what == "intra_frame":
        syntax.intra_frame(r, header_of(known).limits)
    elif what == "key_nodes":
        syntax.key_nodes(r, header_of(known), known["VertexCount"])
    elif what == "motion_frame":
        rigid = known["NodeCount"] - known["AffineCount"]
        affine = [False] * rigid + [True] * known["AffineCount"]
        # where it is not said, the frame is the first P-frame of its GoF
        header = syntax.Elements()
        header.fraction_bits = 8
        prediction = motion.Prediction([(0, 0, 0)] * len(affine), [0] * len(affine), [], header)
        prediction.previous_table = known.get("PreviousTable")
        prediction.previous_step, prediction.previous_translations = 1, [(0, 0, 0)] * len(affine)
        m = syntax.motion_frame(r, affine, known.get("PartCount", 1), prediction.previous_table)
        motion.dequantise(m, affine, prediction)
    elif what == "index":
        # an example has no unit around it: 1 byte of unit_type and 1 of unit_size
        syntax.index(r, header_of(known), 2)
    else:
        raise ValueError(what)
    return trace


def to_text(value, like):
    """As the example writes it (1.4)."""
    if isinstance(value, bytes):
        return "x" + value.hex()
    if like.startswith("0x"):
        return f"{value:#x}" if len(like) < 18 else f"{value:#018x}"
    return repr(value)


def check(example):
    try:
        trace = read(example["structure"], example["given"], bytes.fromhex(example["bytes"]))
    except Refused as error:
        return example.get("rule") == error.rule, str(error)
    expected = example.get("elements", [])
    values = [element["value"] for element in expected] + [""] * len(trace)
    found = [(at, name, to_text(value, like)) for (at, name, value), like in zip(trace, values)]
    right = found == [(element["bit"], element["name"], element["value"]) for element in expected]
    return right, "\n".join(f"{at} {name} = {value}" for at, name, value in found)


def main(arguments):
    path = Path(arguments[0]) if arguments else find_table("levels.csv").parent.parent / "examples.json"
    bad = 0
    examples = json.loads(path.read_text(encoding="utf-8"))
    for example in examples:
        right, found = check(example)
        if not right:
            bad += 1
            print(f"{example['place']}: differs, found:\n{found}")
    print(f"{len(examples) - bad} examples as written, {bad} not")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
