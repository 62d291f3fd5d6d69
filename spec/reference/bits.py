"""Chapter 2: descriptors. From bits to the values of syntax elements."""

import csv
import struct
import zlib
from pathlib import Path


class Refused(Exception):
    """The stream breaks a rule of the specification (1.1)."""

    def __init__(self, rule, reason):
        super().__init__(f"{rule}: {reason}")
        self.rule = rule


def require(condition, rule, reason):
    if not condition:
        raise Refused(rule, reason)


def find_table(name):
    """The folder tables/ of the specification, beside this folder or in ../spec."""
    above = Path(__file__).resolve().parent.parent
    for folder in (above / "tables", above / "spec" / "tables"):
        if (folder / name).is_file():
            return folder / name
    raise FileNotFoundError(f"the specification's tables/{name} is not beside {above.name}/")


def read_table(name):
    with open(find_table(name), newline="", encoding="ascii") as file:
        return [{key: int(value) for key, value in row.items()} for row in csv.DictReader(file)]


class HuffmanTable:
    """One row of tables/cauchy_huffman.csv."""

    def __init__(self, row):
        self.max_magnitude = row["max_magnitude"]
        self.escape_order = row["escape_order"]
        # r[descriptor.huffman.symbols]: 0, +1, -1, +2, -2, ..., +M, -M and the escape (None)
        numbers = [0]
        for magnitude in range(1, self.max_magnitude + 1):
            numbers += [magnitude, -magnitude]
        # r[descriptor.huffman.lengths]
        by_length = {length: [] for length in range(1, 25)}
        at = 0
        for length in range(1, 25):
            count = row[f"symbols_{length}"]
            by_length[length] += numbers[at : at + count]
            at += count
        by_length[row["escape_length"]].append(None)
        # r[descriptor.huffman.codes]
        self.codes = {}
        code = 0
        for length in range(1, 25):
            code <<= 1
            for symbol in by_length[length]:
                self.codes[length, code] = symbol
                code += 1


class HuffmanTables:
    """The tables, each built when it is first asked for."""

    rows = None
    built = {}

    @classmethod
    def get(cls, t):
        if cls.rows is None:
            cls.rows = read_table("cauchy_huffman.csv")
        if t not in cls.built:
            cls.built[t] = HuffmanTable(cls.rows[t])
        return cls.built[t]


class BitReader:
    """Reads the structure of one unit. Every read names its element, so that the elements that were
    met can be compared with the worked examples of the specification (see check_examples.py)."""

    def __init__(self, data, trace=None):
        self.data = data
        self.position = 0  # in bits
        self.trace = trace

    def bit(self):
        byte = self.position >> 3
        # r[descriptor.end]; that the file runs out inside a unit is found before a BitReader is made
        require(byte < len(self.data), "unit.size.exact", "the structure is longer than its unit")
        value = (self.data[byte] >> (7 - (self.position & 7))) & 1
        self.position += 1
        return value

    def bits(self, n):
        value = 0
        for _ in range(n):
            value = 2 * value + self.bit()
        return value

    def _met(self, name, start, value):
        if self.trace is not None:
            self.trace.append((start, name, value))
        return value

    def u(self, n, name):
        """r[descriptor.u]"""
        start = self.position
        return self._met(name, start, self.bits(n))

    def uleb(self, name):
        """r[descriptor.uleb]"""
        start = self.position
        return self._met(name, start, read_uleb(lambda: self.bits(8), name))

    def f64(self, name):
        """r[descriptor.f64]"""
        start = self.position
        return self._met(name, start, struct.unpack(">d", self.bits(64).to_bytes(8, "big"))[0])

    def bytes(self, n, name):
        """r[descriptor.bytes]"""
        start = self.position
        assert start % 8 == 0
        at = start >> 3
        require(n <= len(self.data) - at, "unit.size.exact", f"{name} is longer than its unit")
        self.position += 8 * n
        return self._met(name, start, self.data[at : at + n])

    def _rice(self, k, name):
        m = 0
        while self.bit():
            m += 1
            require(m <= 32, "descriptor.rice.range", f"{name}: more than 32 ones")
        value = (m << k) + self.bits(k)
        require(value < 2**32, "descriptor.rice.range", f"{name} is 2^32 or more")
        return value

    def rice(self, k, name):
        """r[descriptor.rice] r[descriptor.rice.range]"""
        start = self.position
        return self._met(name, start, self._rice(k, name))

    def srice(self, k, name):
        """r[descriptor.srice]"""
        start = self.position
        c = self._rice(k, name)
        return self._met(name, start, c // 2 if c % 2 == 0 else -((c + 1) // 2))

    def _ue(self, k, name):
        """r[descriptor.ue] r[descriptor.ue.range]"""
        m = 0
        while self.bit():
            m += 1
            require(m <= 20, "descriptor.ue.range", f"{name}: more than 20 ones")
        return (((1 << m) - 1) << k) + self.bits(m + k)

    def huffman(self, t, name):
        """r[descriptor.huffman.value] r[descriptor.huffman.range]"""
        start = self.position
        table = HuffmanTables.get(t)
        length, code = 0, 0
        while (length, code) not in table.codes:  # ends: every table is a complete code
            length, code = length + 1, 2 * code + self.bit()
        value = table.codes[length, code]
        if value is None:
            v = self._ue(table.escape_order, name)
            value = table.max_magnitude + 1 + v
            if self.bit():
                value = -value
        require(abs(value) < 2**20, "descriptor.huffman.range", f"{name} is 2^20 or more")
        return self._met(name, start, value)

    def byte_align(self):
        """r[unit.align.zero]"""
        while self.position % 8 != 0:
            require(self.bit() == 0, "unit.align.zero", "an alignment bit is 1")


def read_uleb(next_byte, name):
    """r[descriptor.uleb], with next_byte() giving one byte."""
    value = 0
    for byte_index in range(5):
        byte = next_byte()
        value += (byte & 127) << (7 * byte_index)
        if byte & 128 == 0:
            require(byte != 0 or byte_index == 0, "descriptor.uleb.shortest", f"{name} has a byte too many")
            require(value < 2**32, "descriptor.uleb.range", f"{name} is 2^32 or more")
            return value
    raise Refused("descriptor.uleb.range", f"{name} has more than 5 bytes")


def crc32(data):
    """r[descriptor.crc]"""
    return zlib.crc32(data)
