//! Binarisation and models of residuals (`spec/05-intra.md`).

use kn_bitstream::range::{BinaryCoder, BitModel};

/// Largest number of magnitude bits of a residual after the leading one. 2^23 is more than twice
/// the grid.
pub(super) const MOST_BITS: usize = 22;

/// Models of one residual. Most residuals have a set for each expected magnitude.
#[derive(Clone, Copy, Debug)]
pub(super) struct ErrorModels {
    is_zero: BitModel,
    is_negative: [BitModel; 3],
    longer: [BitModel; MOST_BITS],
    /// The bit behind the leading one, by length.
    second: [BitModel; MOST_BITS],
    /// The one behind it, by length and that bit.
    third: [[BitModel; 2]; MOST_BITS],
}

impl Default for ErrorModels {
    fn default() -> Self {
        let model = BitModel::default();
        Self {
            is_zero: model,
            is_negative: [model; 3],
            longer: [model; MOST_BITS],
            second: [model; MOST_BITS],
            third: [[model; 2]; MOST_BITS],
        }
    }
}

impl ErrorModels {
    /// Codes `error`, |error| < 2^23. `lean` is 0, 1 or 2 where the expectation, before it was
    /// rounded, was lower, about equal or higher.
    #[inline]
    pub(super) fn code<C: BinaryCoder>(&mut self, coder: &mut C, error: i32, lean: usize) -> i32 {
        if coder.bit(&mut self.is_zero, error == 0) {
            return 0;
        }
        let negative = coder.bit(&mut self.is_negative[lean], error < 0);
        let magnitude = self.code_magnitude(coder, error.unsigned_abs()) as i32;
        if negative { -magnitude } else { magnitude }
    }

    /// `magnitude` ≥ 1: its length, then two modelled bits, then raw ones.
    #[inline]
    fn code_magnitude<C: BinaryCoder>(&mut self, coder: &mut C, magnitude: u32) -> u32 {
        let mut bits = 0;
        while bits < MOST_BITS && coder.bit(&mut self.longer[bits], magnitude >> (bits + 1) != 0) {
            bits += 1;
        }
        if bits == 0 {
            return 1;
        }
        let second = coder.bit(&mut self.second[bits - 1], magnitude >> (bits - 1) & 1 != 0);
        let mut value = 2 | u32::from(second);
        if bits >= 2 {
            let third = &mut self.third[bits - 1][usize::from(second)];
            value = value << 1 | u32::from(coder.bit(third, magnitude >> (bits - 2) & 1 != 0));
        }
        let raw = bits.saturating_sub(2) as u32;
        let high = raw.saturating_sub(16);
        let low = raw - high;
        value = value << high | coder.raw(magnitude >> low, high);
        value << low | coder.raw(magnitude, low)
    }
}
