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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_bit_is_found_once() {
        for bits in 0..=255u8 {
            assert_eq!(lanes(bits).map(|lane| 1u8 << lane).sum::<u8>(), bits);
        }
    }
}
