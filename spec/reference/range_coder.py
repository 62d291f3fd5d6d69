"""Chapter 4: the adaptive binary range coder."""

from bits import require


def divide(a, b):
    """`/` of chapters 4 and 5, b > 0: rounds towards zero. (Python's // rounds down.)"""
    return a // b if a >= 0 else -(-a // b)


def clamp(x, low, high):
    return min(max(x, low), high)


class Model:
    """r[range.model]"""

    __slots__ = ("fast", "slow", "seen")

    def __init__(self):
        self.fast = 32768
        self.slow = 32768
        self.seen = 0

    def probability(self):
        """r[range.model.probability]"""
        return clamp((self.fast + self.slow) >> 1, 160, 65376)

    def adapt(self, bit):
        """r[range.model.adapt]"""

        def move(estimate, rate):
            way = (65535 if bit else 0) - estimate
            return estimate + ((way * (rate >> 1)) >> 15)

        mean = 131072 // (2 * self.seen + 3)
        self.fast = move(self.fast, max(mean, 4096))
        self.slow = move(self.slow, max(mean, 512))
        if self.seen < 128:
            self.seen += 1


class Section:
    """One stream of decisions. Models are found by their name and indices, and are made when they are
    first used: decision("is_new", 1, 2) asks with the model is_new[1][2]."""

    def __init__(self, data):
        self.data = data
        self.read = 0  # bytes, those behind the end included
        self.models = {}
        self.range = 2**64 - 1  # r[range.state]
        self.offset = self.next_bytes(8)

    def next_bytes(self, n):
        chunk = self.data[self.read : self.read + n]
        self.read += n
        # r[range.end]: `read` never falls, so that a stream can be refused here and need not be
        # followed behind its end for long.
        require(
            self.read <= len(self.data) + 8, "range.end", "a section ends too early"
        )
        return int.from_bytes(chunk + bytes(n - len(chunk)), "big")

    def finish(self):
        """r[range.end]"""
        require(self.read >= len(self.data), "range.end", "a section has bytes left")

    def renormalise(self):
        """r[range.renormalise]"""
        if self.range < 2**32:
            self.range <<= 32
            self.offset = ((self.offset << 32) + self.next_bytes(4)) % 2**64

    def decision(self, *key):
        """r[range.decision]"""
        model = self.models.get(key)
        if model is None:
            model = self.models[key] = Model()
        bound = (self.range >> 16) * model.probability()
        bit = self.offset < bound
        if bit:
            self.range = bound
        else:
            self.offset -= bound
            self.range -= bound
        model.adapt(bit)
        self.renormalise()
        return bit

    def raw(self, n):
        """r[range.raw]"""
        self.range >>= n
        value = 0
        for place in range(n - 1, -1, -1):
            bit = self.offset >= (self.range << place)
            if bit:
                self.offset -= self.range << place
            value = 2 * value + bit
        self.renormalise()
        return value

    def gamma(self, *key):
        """r[range.gamma]"""
        extra = 0
        while extra < 30 and self.decision(*key, extra):
            extra += 1
        high = max(extra - 16, 0)
        value = 1
        value = (value << high) + self.raw(high)
        value = (value << (extra - high)) + self.raw(extra - high)
        return value - 1
