//! The adaptive binary range coder (`spec/04-entropy-range.md`): integers only, encoder and decoder
//! side by side.
//!
//! A decision is coded with a [`BitModel`], which learns how often it is `true`; a bit without a
//! model is coded at probability ½. The interval has 64 bits and is renormalised 32 bits at a time,
//! so that the common path of a decision has one multiplication and one well predicted branch.

/// Shift that limits the adaptation of [`BitModel`]'s fast estimate.
const FAST_SHIFT: usize = 4;
/// Shift that limits the adaptation of [`BitModel`]'s slow estimate.
const SLOW_SHIFT: usize = 7;
/// Number of zero bytes that a decoder may read behind the end of its input.
pub const TAIL: usize = 8;
/// Largest number of bits that one call of [`BinaryCoder::raw`] codes.
pub const RAW_LIMIT: u32 = 16;
/// Least probability, in 1/65536, that a decision is coded with.
const FLOOR: u32 = 160;
/// Number of decisions over which a model averages before it forgets exponentially.
const WARM_UP: u8 = 1 << SLOW_SHIFT;

/// Steps, in 1/32768, that move the fast and the slow estimate after n decisions:
/// ⌊65536 / (n + 1.5)⌋ / 2, but at least the limit. The 1.5 makes a first decision worth two
/// thirds, not all. (As long as a byte reaches: an index needs no check.)
const RATES: [(u16, u16); 256] = {
    let mut rates = [(0, 0); 256];
    let mut n = 0;
    while n < 256 {
        rates[n] = (rate(n, FAST_SHIFT), rate(n, SLOW_SHIFT));
        n += 1;
    }
    rates
};

const fn rate(seen: usize, limit_shift: usize) -> u16 {
    let mean = 131_072 / (2 * seen as u32 + 3);
    let limit = 65_536 >> limit_shift;
    (if mean > limit { mean as u16 } else { limit as u16 }) >> 1
}

/// Most bits of a gamma value behind the leading one: any value fits an `i32`, with a bit to spare
/// for what is added to it.
const GAMMA_PLACES: usize = 30;

/// The models of a gamma value, by place.
pub type GammaModels = [BitModel; GAMMA_PLACES];

/// The adaptive probability of one binary decision: the mean of a fast and a slow estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BitModel {
    /// Estimates of P(true) in 1/65536.
    fast: u16,
    slow: u16,
    /// Decisions seen, up to [`WARM_UP`].
    seen: u8,
}

impl Default for BitModel {
    fn default() -> Self {
        Self { fast: 1 << 15, slow: 1 << 15, seen: 0 }
    }
}

impl BitModel {
    /// P(true) in 1/65536, kept away from 0 and 1: a decision costs at least 0.0035 bit, which
    /// bounds what few bytes can unfold to.
    #[inline]
    fn probability(self) -> u64 {
        let mean = (u32::from(self.fast) + u32::from(self.slow)) >> 1;
        u64::from(mean.clamp(FLOOR, 65_536 - FLOOR))
    }

    #[inline]
    fn adapt(&mut self, bit: bool) {
        let (fast, slow) = RATES[usize::from(self.seen)];
        let target = if bit { 65_535 } else { 0 };
        self.fast = moved(self.fast, fast, target);
        self.slow = moved(self.slow, slow, target);
        self.seen += u8::from(self.seen < WARM_UP);
    }
}

/// `estimate` moved towards `target`, 0 or 65535, by `rate` / 32768 of the way.
#[inline]
fn moved(estimate: u16, rate: u16, target: i32) -> u16 {
    let way = target - i32::from(estimate);
    (i32::from(estimate) + ((way * i32::from(rate)) >> 15)) as u16
}

/// Codes one decision after another, as an encoder or as a decoder. Code that is generic over this
/// trait is both at once, which keeps the two in step.
pub trait BinaryCoder {
    /// Codes `bit` with `model` and adapts the model. A decoder ignores `bit`; both return the bit.
    fn bit(&mut self, model: &mut BitModel, bit: bool) -> bool;

    /// Codes the low `count` ≤ [`RAW_LIMIT`] bits of `value` at probability ½, and returns them.
    fn raw(&mut self, value: u32, count: u32) -> u32;
}

/// Codes `value` < 2^31 − 1 as the length of `value + 1` in bits, less one, in unary with a model
/// per place, then the bits behind the leading one, raw. (Elias' gamma code with a learnt prefix.)
pub fn code_gamma<C: BinaryCoder>(coder: &mut C, models: &mut GammaModels, value: u32) -> u32 {
    let written = value.saturating_add(1);
    let mut extra = 0u32;
    while extra < GAMMA_PLACES as u32
        && coder.bit(&mut models[extra as usize], written >> (extra + 1) != 0)
    {
        extra += 1;
    }
    let high = extra.saturating_sub(RAW_LIMIT);
    let low = extra - high;
    let top = coder.raw((written >> low) & ((1 << high) - 1), high);
    let bottom = coder.raw(written & ((1 << low) - 1), low);
    ((1 << extra) | top << low | bottom) - 1
}

/// Writes decisions to the end of a byte vector.
#[derive(Debug)]
pub struct RangeEncoder<'a> {
    out: &'a mut Vec<u8>,
    start: usize,
    low: u64,
    range: u64,
}

impl<'a> RangeEncoder<'a> {
    /// Makes an encoder that appends to `out`. The bytes in it stay as they are.
    pub fn new(out: &'a mut Vec<u8>) -> Self {
        let start = out.len();
        Self { out, start, low: 0, range: u64::MAX }
    }

    /// Moves the interval's lower end; a carry runs into the bytes already written.
    #[inline]
    fn raise(&mut self, by: u64) {
        let (low, carry) = self.low.overflowing_add(by);
        self.low = low;
        if carry {
            self.carry();
        }
    }

    #[cold]
    fn carry(&mut self) {
        for byte in self.out[self.start..].iter_mut().rev() {
            *byte = byte.wrapping_add(1);
            if *byte != 0 {
                break;
            }
        }
    }

    #[inline]
    fn renormalise(&mut self) {
        if self.range < 1 << 32 {
            self.out.extend_from_slice(&((self.low >> 32) as u32).to_be_bytes());
            self.low <<= 32;
            self.range <<= 32;
        }
    }

    /// Ends the stream: the value of the interval with the most zero bits at its end is written in
    /// eight bytes, less those that are zero at the end (the decoder reads up to [`TAIL`] zero
    /// bytes behind its input). Returns the number of bytes written in all.
    pub fn finish(mut self) -> usize {
        let below = self.low.wrapping_sub(1);
        let last = below.wrapping_add(self.range);
        // `low ..= last` may wrap past 2^64: then the carry's multiple of 2^64 itself is inside.
        let zeros = if self.low == 0 || last < below { 64 } else { (below ^ last).ilog2() };
        let value = last.checked_shr(zeros).map_or(0, |kept| kept << zeros);
        self.raise(value.wrapping_sub(self.low));
        let tail = self.low.to_be_bytes();
        let kept = tail.iter().rposition(|&byte| byte != 0).map_or(0, |at| at + 1);
        self.out.extend_from_slice(&tail[..kept]);
        self.out.len() - self.start
    }
}

impl BinaryCoder for RangeEncoder<'_> {
    #[inline]
    fn bit(&mut self, model: &mut BitModel, bit: bool) -> bool {
        let bound = (self.range >> 16) * model.probability();
        if bit {
            self.range = bound;
        } else {
            self.raise(bound);
            self.range -= bound;
        }
        model.adapt(bit);
        self.renormalise();
        bit
    }

    #[inline]
    fn raw(&mut self, value: u32, count: u32) -> u32 {
        let value = value & ((1 << count) - 1);
        self.range >>= count;
        self.raise(self.range * u64::from(value));
        self.renormalise();
        value
    }
}

/// Reads decisions from a byte slice. Safe on any bytes: behind the end it reads zeros.
#[derive(Clone, Debug)]
pub struct RangeDecoder<'a> {
    bytes: &'a [u8],
    /// Bytes taken, those behind the end included.
    taken: usize,
    /// Distance of the coded value from the interval's lower end.
    offset: u64,
    range: u64,
}

impl<'a> RangeDecoder<'a> {
    /// Makes a decoder of `bytes`, which hold one stream and nothing else.
    pub fn new(bytes: &'a [u8]) -> Self {
        let mut decoder = Self { bytes, taken: 0, offset: 0, range: u64::MAX };
        decoder.offset = u64::from(decoder.take()) << 32;
        decoder.offset |= u64::from(decoder.take());
        decoder
    }

    #[inline]
    fn take(&mut self) -> u32 {
        let at = self.taken;
        self.taken += 4;
        match self.bytes.get(at..at + 4) {
            Some(word) => u32::from_be_bytes([word[0], word[1], word[2], word[3]]),
            None => self.take_at_end(at),
        }
    }

    #[cold]
    fn take_at_end(&self, at: usize) -> u32 {
        let byte = |i: usize| u32::from(self.bytes.get(at + i).copied().unwrap_or(0));
        byte(0) << 24 | byte(1) << 16 | byte(2) << 8 | byte(3)
    }

    #[inline]
    fn renormalise(&mut self) {
        if self.range < 1 << 32 {
            self.offset = self.offset << 32 | u64::from(self.take());
            self.range <<= 32;
        }
    }

    /// Number of bytes that were needed so far, at most the length of the stream, for messages.
    pub fn position(&self) -> usize {
        self.taken.saturating_sub(8).min(self.bytes.len())
    }

    /// Whether more decisions were read than the bytes can hold, which is an error of the stream.
    #[inline]
    pub fn is_exhausted(&self) -> bool {
        self.taken > self.bytes.len() + TAIL
    }

    /// Whether the decisions read so far used every byte and no more than there are.
    pub fn is_finished(&self) -> bool {
        self.taken >= self.bytes.len() && !self.is_exhausted()
    }
}

impl BinaryCoder for RangeDecoder<'_> {
    #[inline]
    fn bit(&mut self, model: &mut BitModel, _bit: bool) -> bool {
        let bound = (self.range >> 16) * model.probability();
        let bit = self.offset < bound;
        // Selections, not branches: what is hard to predict is not guessed twice.
        self.offset -= if bit { 0 } else { bound };
        self.range = if bit { bound } else { self.range - bound };
        model.adapt(bit);
        self.renormalise();
        bit
    }

    #[inline]
    fn raw(&mut self, _value: u32, count: u32) -> u32 {
        self.range >>= count;
        let mut value = 0;
        for place in (0..count).rev() {
            let half = self.range << place;
            let bit = self.offset >= half;
            // A mask, not a branch: raw bits cannot be predicted.
            self.offset -= half & u64::from(bit).wrapping_neg();
            value = value << 1 | u32::from(bit);
        }
        self.renormalise();
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A decision: model index and bit, or raw bits.
    type Decision = (usize, bool, Option<(u32, u32)>);

    fn code<C: BinaryCoder>(coder: &mut C, decisions: &[Decision]) -> Vec<Decision> {
        let mut models = [BitModel::default(); 4];
        let mut coded = Vec::new();
        for &(model, bit, raw) in decisions {
            coded.push(match raw {
                Some((value, count)) => (model, bit, Some((coder.raw(value, count), count))),
                None => (model, coder.bit(&mut models[model], bit), None),
            });
        }
        coded
    }

    fn decision() -> impl Strategy<Value = Decision> {
        let raw = (0..=RAW_LIMIT).prop_flat_map(|count| (0..1u32 << count, Just(count)));
        (0..4usize, prop::bool::weighted(0.9), prop::option::weighted(0.2, raw))
    }

    proptest! {
        #[test]
        fn reads_what_it_writes(decisions in prop::collection::vec(decision(), 0..2000)) {
            let mut bytes = vec![0xff; 3];
            let mut encoder = RangeEncoder::new(&mut bytes);
            code(&mut encoder, &decisions);
            let written = encoder.finish();
            prop_assert_eq!(&bytes[..3], &[0xff; 3]);
            prop_assert_eq!(written, bytes.len() - 3);
            let mut decoder = RangeDecoder::new(&bytes[3..]);
            prop_assert_eq!(code(&mut decoder, &decisions), decisions);
            prop_assert!(decoder.is_finished());
        }

        #[test]
        fn any_bytes_can_be_read(
            bytes in prop::collection::vec(any::<u8>(), 0..64),
            decisions in prop::collection::vec(decision(), 0..2000),
        ) {
            let mut decoder = RangeDecoder::new(&bytes);
            for (_, _, raw) in code(&mut decoder, &decisions) {
                prop_assert!(raw.is_none_or(|(value, count)| value < 1 << count));
            }
            prop_assert!(decoder.position() <= bytes.len());
        }
    }

    #[test]
    fn carries_run_through_bytes_of_ones() {
        // Interval ends that hug a power of two, reached from below, then raised over it.
        for last in [1, 0x7fff, 0xffff] {
            let mut bytes = Vec::new();
            let mut encoder = RangeEncoder::new(&mut bytes);
            let values = [0xffff, 0xffff, 0xffff, 0xffff, 0xffff, last];
            assert_eq!(values.map(|value| encoder.raw(value, 16)), values);
            encoder.finish();
            let mut decoder = RangeDecoder::new(&bytes);
            assert_eq!(values.map(|_| decoder.raw(0, 16)), values);
        }
    }

    #[test]
    fn a_skewed_decision_costs_little_and_a_fair_one_a_bit() {
        let bytes_for = |bit: fn(u32) -> bool| {
            let mut bytes = Vec::new();
            let mut encoder = RangeEncoder::new(&mut bytes);
            let mut model = BitModel::default();
            for i in 0..8000 {
                encoder.bit(&mut model, bit(i));
            }
            encoder.finish()
        };
        assert!(bytes_for(|_| true) <= 6);
        // A multiplicative hash: no period that a one-decision model could learn.
        let fair = bytes_for(|i| i.wrapping_mul(0x9e37_79b9) >> 31 == 1);
        assert!((990..1080).contains(&fair), "{fair}");
    }
}
