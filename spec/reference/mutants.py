#!/usr/bin/env python3
"""Wrong readings of the specification ("mutants"), and the conformance streams that tell them from the right one.

    python3 spec/reference/mutants.py            each with the stream that the list names for it
    python3 spec/reference/mutants.py --all      each with every stream of core and uncommon that catches it
    python3 spec/reference/mutants.py --all NAME …  those whose names contain one of these words

Each is this folder's decoder with one piece of its text replaced (misreadings.py). Exit code 1 where one is not caught by the
stream of misreadings.py. What differs in no frame is no mutant: see EQUIVALENT there.
"""

import importlib
import io
import json
import sys
import types
from fractions import Fraction
from pathlib import Path

from misreadings import MUTANTS

HERE = Path(__file__).resolve().parent
CORPUS = HERE.parent / "conformance"
# Each after those that it uses.
MODULES = ("bits", "range_coder", "intra", "deformation", "motion", "syntax", "kn_decode")


def load(module, text, instead):
    """The decoder with a piece of a module replaced; `text` may occur once only."""
    for name in MODULES:
        sys.modules.pop(name, None)
    path = HERE / f"{module}.py"
    source = path.read_text()
    if source.count(text) != 1:
        raise ValueError(f"{module}.py has {source.count(text)} times: {text}")
    made = types.ModuleType(module)
    made.__file__ = str(path)
    made.fma = lambda a, b, c: float(Fraction(a) * Fraction(b) + Fraction(c))
    sys.modules[module] = made
    exec(compile(source.replace(text, instead), f"mutant of {module}", "exec"), made.__dict__)
    return importlib.import_module("kn_decode")


def frames_of(decoder, data):
    out = io.StringIO()
    try:
        decoder.Decoder(out).decode(io.BytesIO(data))
    except Exception as error:  # a mutant may do anything
        return [f"{type(error).__name__}: {error}"]
    return out.getvalue().splitlines()


def sound_streams():
    """By name: the bytes and the expected lines; the smallest first."""
    paths = [path for folder in ("core", "uncommon") for path in (CORPUS / folder).glob("*.knm")]
    for path in sorted(paths, key=lambda path: path.stat().st_size):
        yield path.stem, path.read_bytes(), json.loads(path.with_suffix(".json").read_text())["frames"]


def main(arguments):
    everything, words = "--all" in arguments, [a for a in arguments if a != "--all"]
    streams = {name: (data, frames) for name, data, frames in sound_streams()}
    missed = 0
    for name, (stream, *replacement) in MUTANTS.items():
        if words and not any(word in name for word in words):
            continue
        decoder = load(*replacement)
        tried = streams if everything else [stream] if stream in streams else []
        caught = [s for s in tried if frames_of(decoder, streams[s][0]) != streams[s][1]]
        missed += not caught
        print(f"{name}: {', '.join(caught) or 'NOT CAUGHT'}", flush=True)
    print(f"{missed} not caught")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
