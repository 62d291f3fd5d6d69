#!/usr/bin/env python3
"""A decoder of kn streams, written from the text of the specification.

    python3 kn_decode.py FILE

prints `index kind #V #F sha256` for each frame (9.7). Exit code 0: the stream is sound; 1: it breaks a
rule, whose id is in the one line on standard error; 2: it could not be read or decoded for another reason.
"""

import array
import hashlib
import sys

import deformation
import intra
import motion
import syntax
from bits import BitReader, Refused, crc32, read_uleb, require

SIGNATURE = 0x8B4B4E4D0D0A1A0A
SEQUENCE_HEADER, INTRA_FRAME, KEY_NODES, MOTION_FRAME, INDEX = 1, 2, 3, 4, 5
SKIPPABLE = 128


class Unit:
    def __init__(self, type, start, bytes_before, payload):
        self.type = type
        self.start = start  # first byte in the file
        self.bytes_before = bytes_before  # bytes of unit_type and unit_size
        self.payload = payload


class File:
    """3.1 and 3.2: signature and units. Only one unit is held at a time."""

    def __init__(self, stream):
        self.stream = stream
        self.position = 0
        signature = stream.read(8)
        self.position = 8
        require(len(signature) == 8, "file.order", "the file ends early")
        # r[file.signature.value]
        require(int.from_bytes(signature, "big") == SIGNATURE, "file.signature.value", "not a kn file")

    def read(self, n):
        data = self.stream.read(n)
        self.position += len(data)
        # r[descriptor.end]
        require(len(data) == n, "file.order", "the file ends inside a unit")
        return data

    def units(self, check_order, max_unit_bytes):
        """Yields the units. check_order(type) and max_unit_bytes(type) are asked as soon as the type of
        a unit is known."""
        while True:
            start = self.position
            first = self.stream.read(1)
            if not first:
                return
            self.position += 1
            type = first[0]
            check_order(type)
            # r[unit.type.known]
            require(1 <= type <= 5 or type >= 128, "unit.type.known", f"unit_type {type}")
            before = bytearray(first)

            def next_byte():
                before.extend(self.read(1))
                return before[-1]

            unit_size = read_uleb(next_byte, "unit_size")
            # r[unit.size.limit]
            require(unit_size <= max_unit_bytes(type), "unit.size.limit", f"a unit of {unit_size} bytes")
            payload = self.read(unit_size)
            unit_crc = int.from_bytes(self.read(4), "big")
            # r[unit.crc.match]
            require(crc32(bytes(before) + payload) == unit_crc, "unit.crc.match", "the CRC does not match")
            yield Unit(type, start, len(before), payload)


class Group:
    """A GoF: the state that its P-frames need."""

    def __init__(self, start):
        self.start = start  # first byte of its intra_frame in the file
        self.frames = 1
        self.mesh = None
        self.reference = None  # positions in reference units
        self.nodes = None  # positions of the key nodes in reference units, None before key_nodes
        self.affine = None
        self.influences = None
        self.prediction = None  # motion.Prediction


class Decoder:
    """9.3"""

    def __init__(self, output):
        self.output = output
        self.header = None
        self.groups = []  # (first byte, frames) of each GoF that is complete
        self.group = None
        self.last_type = None  # of the last unit that is not skippable
        self.frame_index = 0

    def decode(self, stream):
        file = File(stream)
        for unit in file.units(self.check_order, self.max_unit_bytes):
            if unit.type < SKIPPABLE:  # r[unit.skipped]
                self.decode_unit(unit)
        require(self.last_type == INDEX, "file.order", "the file ends before its index")

    def check_order(self, type):
        """r[file.order] r[file.group.length]"""
        last = self.last_type
        if last is None:
            require(type == SEQUENCE_HEADER, "file.order", "the file does not begin with a sequence header")
        else:
            require(last != INDEX, "file.order", "something follows the index")
            require(type != SEQUENCE_HEADER, "file.order", "a second sequence header")
        if not 1 <= type <= 5:
            return  # unit.type.known or unit.skipped says more
        if type in (INTRA_FRAME, INDEX):
            require(last != KEY_NODES, "file.order", "key nodes without a P-frame")
        if type == INDEX:
            require(last != SEQUENCE_HEADER, "file.order", "a file without frames")
        if type == KEY_NODES:
            require(last == INTRA_FRAME, "file.order", "key nodes that do not follow an I-frame")
        if type == MOTION_FRAME:
            require(last in (KEY_NODES, MOTION_FRAME), "file.order", "a P-frame without key nodes")
            require(
                self.group.frames < self.header.max_group_length, "file.group.length", "a group of too many frames"
            )
        self.last_type = type

    def max_unit_bytes(self, type):
        limits = syntax.HIGHEST_LEVEL if type == SEQUENCE_HEADER else self.header.limits
        return limits["max_unit_bytes"]

    def decode_unit(self, unit):
        r = BitReader(unit.payload)
        if unit.type == SEQUENCE_HEADER:
            self.header = syntax.sequence_header(r)
            self.end_unit(r)
        elif unit.type == INTRA_FRAME:
            self.end_group(unit.start)
            f = syntax.intra_frame(r, self.header.limits)
            self.end_unit(r)
            self.decode_intra(f, unit.start)
        elif unit.type == KEY_NODES:
            require(self.group.mesh.positions, "intra.vertices.nodes", "key nodes of a mesh without vertices")
            k = syntax.key_nodes(r, self.header, len(self.group.mesh.positions))
            self.end_unit(r)
            self.decode_nodes(k)
        elif unit.type == MOTION_FRAME:
            prediction = self.group.prediction
            m = syntax.motion_frame(r, self.group.affine, prediction.part_count, prediction.previous_table)
            self.end_unit(r)
            self.decode_motion(m)
        elif unit.type == INDEX:
            self.end_group(unit.start)
            x = syntax.index(r, self.header, unit.bytes_before, len(self.groups))
            self.end_unit(r)
            self.check_index(x)

    def end_unit(self, r):
        """r[unit.align.zero] r[unit.size.exact]"""
        r.byte_align()
        require(r.position == 8 * len(r.data), "unit.size.exact", "the unit is longer than its structure")

    def end_group(self, start_of_next):
        if self.group is not None:
            self.groups.append((start_of_next - self.group.start, self.group.frames))

    def check_index(self, x):
        """r[index.groups.match]"""
        require(x.groups == self.groups, "index.groups.match", "the index does not list the groups of the file")

    def decode_intra(self, f, start):
        """6.4"""
        require(
            bool(f.payload.labels_present) == (self.header.label_set != 0),
            "intra.labels.present",
            "labels where there shall be none, or none where there shall be",
        )
        mesh = intra.decode(f.payload)
        if mesh.labels is None:
            mesh.labels = [0] * len(mesh.positions)
        for label in mesh.labels:
            require(label < self.header.label_count, "intra.labels.range", f"label {label}")
        if f.faces_digest is not None:
            # r[intra.digest.faces]
            digest = hashlib.sha256(numbers([len(mesh.faces)]) + rows(mesh.faces)).digest()
            require(int.from_bytes(digest[:8], "big") == f.faces_digest, "intra.digest.faces", "it differs")

        self.group = Group(start)
        self.group.mesh = mesh
        self.group.reference = deformation.smooth(
            mesh.positions, mesh.faces, f.smoothing_strength, self.header.fraction_bits
        )
        self.show("I", f.positions_digest)

    def decode_nodes(self, k):
        """6.5 and 8.2"""
        header, group, mesh = self.header, self.group, self.group.mesh
        if k.node_coding == 0:
            nodes = [mesh.positions[vertex] for vertex in k.vertices]
        else:
            nodes = k.points
        # r[nodes.label.nearest]
        node_labels = [mesh.labels[deformation.nearest_vertex(node, mesh.positions)] for node in nodes]
        # r[nodes.affine]
        if k.affine_mode == 0:
            group.affine = [False] * len(nodes)
        elif k.affine_mode == 1:
            group.affine = [k.affine_label[label] == 1 for label in node_labels]
        elif k.affine_mode == 2:
            group.affine = [True] * len(nodes)
        else:
            group.affine = [bit == 1 for bit in k.affine_node]
        group.influences = deformation.bind(
            mesh.positions,
            [header.regions[label] for label in mesh.labels],
            nodes,
            [header.regions[label] for label in node_labels],
            header,
            k.weight_sigma,
        )
        group.prediction = motion.Prediction(nodes, node_labels, group.influences, header)
        # 8: key nodes are not smoothed
        scale = 2**header.fraction_bits
        group.nodes = [tuple(x * scale for x in node) for node in nodes]

    def decode_motion(self, m):
        """Chapter 7, 8.3 and 8.4"""
        group, fraction_bits = self.group, self.header.fraction_bits
        group.frames += 1
        motions = motion.dequantise(m, group.affine, group.prediction)
        transforms = [deformation.transform(n, node) for n, node in zip(group.nodes, motions)]
        group.reference = deformation.deform(group.reference, group.influences, transforms, fraction_bits)
        group.nodes = deformation.move_nodes(group.nodes, motions, fraction_bits)
        self.show("P", m.positions_digest)

    def show(self, kind, positions_digest):
        """9.5 and 9.7. r[deform.output]: what is shown is the reference."""
        positions, faces = self.group.reference, self.group.mesh.faces
        if positions_digest is not None:
            # r[frame.digest.positions]
            digest = hashlib.sha256(numbers([len(positions)]) + rows(positions)).digest()
            require(
                int.from_bytes(digest[:8], "big") == positions_digest, "frame.digest.positions", "it differs"
            )
        # r[conformance.frame.sha256]
        sha256 = hashlib.sha256(numbers([len(positions), len(faces)]) + rows(positions) + rows(faces))
        # r[conformance.contract]
        print(self.frame_index, kind, len(positions), len(faces), sha256.hexdigest(), file=self.output)
        self.frame_index += 1


def numbers(values):
    """Each as 32 bits, two's complement, little-endian."""
    words = array.array("i", values)
    assert words.itemsize == 4
    if sys.byteorder == "big":
        words.byteswap()
    return words.tobytes()


def rows(table):
    return numbers(x for row in table for x in row)


def main(arguments):
    if len(arguments) != 1:
        print("usage: kn_decode.py FILE", file=sys.stderr)
        return 2
    try:
        with open(arguments[0], "rb") as stream:
            Decoder(sys.stdout).decode(stream)
        sys.stdout.flush()
        return 0
    except Refused as error:
        print(error, file=sys.stderr)
        return 1
    except OSError as error:
        print(f"cannot read or write: {error}", file=sys.stderr)
        return 2
    except MemoryError:
        print("this decoder has not enough memory for the stream", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
