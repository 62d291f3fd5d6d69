//! Sets of lanes as bits.

/// The positions of the set bits, ascending.
#[inline]
pub(crate) fn lanes(mut bits: u8) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = (bits != 0).then(|| bits.trailing_zeros() as usize);
        bits &= bits.wrapping_sub(1);
        lane
    })
}

/// Calls `take` for each set bit, and at least `USUAL` times, with whether it is a bit at all: for
/// sets of about that size, so that the number of rounds can be predicted.
#[inline(always)]
pub(crate) fn each_lane<const USUAL: usize>(mut bits: u8, mut take: impl FnMut(bool, usize)) {
    for _ in 0..USUAL {
        take(bits != 0, bits.trailing_zeros() as usize);
        bits &= bits.wrapping_sub(1);
    }
    lanes(bits).for_each(|lane| take(true, lane));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_bit_is_found_once() {
        for bits in 0..=255u8 {
            let mut found = 0u8;
            each_lane::<3>(bits, |is_one, lane| found += u8::from(is_one) << (lane % 8));
            assert_eq!(found, bits);
            assert_eq!(lanes(bits).map(|lane| 1u8 << lane).sum::<u8>(), bits);
        }
    }
}
