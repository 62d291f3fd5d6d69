//! Chapter 4: decisions from the bytes of a section.

use kn_bitstream::rule::{self, Rule};

/// The rule of a section that is not consumed exactly.
pub(super) const CONSUMED: Rule = rule::RANGE_END;

/// r[range.model]
#[derive(Clone, Copy, Debug)]
pub(super) struct Model {
    fast: i64,
    slow: i64,
    seen: i64,
}

impl Default for Model {
    fn default() -> Self {
        Self { fast: 32768, slow: 32768, seen: 0 }
    }
}

impl Model {
    fn probability(&self) -> u64 {
        ((self.fast + self.slow) >> 1).clamp(160, 65376) as u64
    }

    /// r[range.model.adapt]
    fn adapt(&mut self, bit: bool) {
        let moved = |estimate: i64, rate: i64| {
            let way = (if bit { 65535 } else { 0 }) - estimate;
            estimate + ((way * (rate >> 1)) >> 15)
        };
        let mean = 131_072 / (2 * self.seen + 3);
        self.fast = moved(self.fast, mean.max(4096));
        self.slow = moved(self.slow, mean.max(512));
        if self.seen < 128 {
            self.seen += 1;
        }
    }
}

/// The 30 models of a gamma value.
pub(super) type Gamma = [Model; 30];

/// One stream of decisions.
pub(super) struct Section<'b> {
    bytes: &'b [u8],
    read: usize,
    range: u64,
    offset: u64,
}

impl<'b> Section<'b> {
    pub(super) fn new(bytes: &'b [u8]) -> Self {
        let mut section = Self { bytes, read: 0, range: u64::MAX, offset: 0 };
        for _ in 0..8 {
            section.offset = section.offset << 8 | section.byte();
        }
        section
    }

    /// Zero behind the last byte.
    fn byte(&mut self) -> u64 {
        let byte = self.bytes.get(self.read).copied().unwrap_or(0);
        self.read += 1;
        u64::from(byte)
    }

    fn renormalise(&mut self) {
        if self.range < 1 << 32 {
            self.range <<= 32;
            for _ in 0..4 {
                self.offset = self.offset << 8 | self.byte();
            }
        }
    }

    /// r[range.decision]
    pub(super) fn decision(&mut self, model: &mut Model) -> bool {
        let bound = (self.range >> 16) * model.probability();
        let bit = self.offset < bound;
        if bit {
            self.range = bound;
        } else {
            self.offset -= bound;
            self.range -= bound;
        }
        model.adapt(bit);
        self.renormalise();
        bit
    }

    /// r[range.raw]
    pub(super) fn raw(&mut self, n: u32) -> i64 {
        self.range >>= n;
        let mut value = 0;
        for place in (0..n).rev() {
            let bit = self.offset >= self.range << place;
            if bit {
                self.offset -= self.range << place;
            }
            value = 2 * value + i64::from(bit);
        }
        self.renormalise();
        value
    }

    /// r[range.gamma]
    pub(super) fn gamma(&mut self, models: &mut Gamma) -> i64 {
        let mut extra = 0;
        while extra < 30 && self.decision(&mut models[extra]) {
            extra += 1;
        }
        let high = extra.saturating_sub(16) as u32;
        let low = extra as u32 - high;
        let value = 1 << high | self.raw(high);
        (value << low | self.raw(low)) - 1
    }

    /// Whether more was read than r[range.end] allows: what was decoded since means nothing.
    pub(super) fn overrun(&self) -> bool {
        self.read > self.bytes.len() + 8
    }

    /// r[range.end]
    pub(super) fn finish(self) -> Result<(), Rule> {
        let beyond = self.read.checked_sub(self.bytes.len());
        if beyond.is_some_and(|beyond| beyond <= 8) { Ok(()) } else { Err(CONSUMED) }
    }
}
