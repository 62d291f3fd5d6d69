#!/usr/bin/env python3
"""Wrong readings of the specification ("mutants"), and the conformance streams that tell them from the right one.

    python3 spec/reference/mutants.py            each with the stream that the list names for it
    python3 spec/reference/mutants.py --all      each with every stream of core and uncommon that catches it
    python3 spec/reference/mutants.py --all NAME …  those whose names contain one of these words
    python3 spec/reference/mutants.py --checks      each check of the decoder left out, with the faulty stream that it then decodes

Each is this folder's decoder with one piece of its text replaced (misreadings.py). Exit code 1 where one is not caught by the
stream of misreadings.py. What differs in no frame is no mutant: see EQUIVALENT there; NOT_ALONE has the checks that can be left out
unnoticed.
"""

import importlib
import io
import json
import signal
import sys
import types
from fractions import Fraction
from pathlib import Path

from checks import MODULES, checks
from misreadings import MUTANTS, NOT_ALONE, WEAKENED

HERE = Path(__file__).resolve().parent
CORPUS = HERE.parent / "conformance"


def load(changed):
    """The decoder with other sources, or trees of them, for some modules."""
    for name in MODULES:
        sys.modules.pop(name, None)
    for name in MODULES:  # each after those that it uses
        if name in changed:
            made = types.ModuleType(name)
            made.__file__ = str(HERE / f"{name}.py")
            made.fma = lambda a, b, c: float(Fraction(a) * Fraction(b) + Fraction(c))
            sys.modules[name] = made
            exec(compile(changed[name], f"mutant of {name}", "exec"), made.__dict__)
    return importlib.import_module("kn_decode")


def mutant(module, text, instead):
    """The decoder with a piece of a module replaced; `text` may occur once only."""
    source = (HERE / f"{module}.py").read_text()
    if source.count(text) != 1:
        raise ValueError(f"{module}.py has {source.count(text)} times: {text}")
    return load({module: source.replace(text, instead)})


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


def faulty_streams():
    """By rule: names and bytes."""
    streams = {}
    for path in sorted((CORPUS / "faulty").glob("*.knm")):
        rule = json.loads(path.with_suffix(".json").read_text())["rule"]
        streams.setdefault(rule, []).append((path.stem, path.read_bytes()))
    return streams


def refusal(decoder, data):
    """What a decoder says of a stream; nothing where it decodes it."""
    signal.alarm(60)
    try:
        decoder.Decoder(io.StringIO()).decode(io.BytesIO(data))
        return None
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    finally:
        signal.alarm(0)


def out_of_time(*_):
    raise TimeoutError("a minute")


def main_checks(words):
    signal.signal(signal.SIGALRM, out_of_time)
    streams, wrong = faulty_streams(), 0
    found = checks(WEAKENED)
    for name in NOT_ALONE.keys() - found.keys():
        wrong += 1
        print(f"{name}: LISTED, BUT NO CHECK")
    for name, check in found.items():
        if words and not any(word in name for word in words):
            continue
        decoder = load(check.trees)
        said = {stream: refusal(decoder, data) for stream, data in streams.get(check.rule, [])}
        decoded = [stream for stream, refused in said.items() if not refused]
        if bool(decoded) == (name in NOT_ALONE):
            wrong += 1
            print(f"{name}: {'LISTED, BUT DECODES' if decoded else 'NOT NOTICED'} {decoded or said}", flush=True)
        else:
            print(f"{name}: {', '.join(decoded) or NOT_ALONE[name]}", flush=True)
    print(f"{len(found)} checks, {len(NOT_ALONE)} not alone, {wrong} wrong")
    return 1 if wrong else 0


def main(arguments):
    if "--checks" in arguments:
        return main_checks([a for a in arguments if a != "--checks"])
    everything, words = "--all" in arguments, [a for a in arguments if a != "--all"]
    streams = {name: (data, frames) for name, data, frames in sound_streams()}
    missed = 0
    for name, (stream, *replacement) in MUTANTS.items():
        if words and not any(word in name for word in words):
            continue
        decoder = mutant(*replacement)
        tried = streams if everything else [stream] if stream in streams else []
        caught = [s for s in tried if frames_of(decoder, streams[s][0]) != streams[s][1]]
        missed += not caught
        print(f"{name}: {', '.join(caught) or 'NOT CAUGHT'}", flush=True)
    print(f"{missed} not caught")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
