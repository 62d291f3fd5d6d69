//! A list that grows without a branch.

use super::machine::LANES;

/// Items are always written; the end moves only past those that are kept. Where half of the items
/// are kept in no order, a branch would be mispredicted every other time.
#[derive(Clone, Debug)]
pub(super) struct List<T> {
    items: Vec<T>,
    count: usize,
}

impl<T: Copy> List<T> {
    pub(super) fn new() -> Self {
        Self { items: Vec::new(), count: 0 }
    }

    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    #[inline]
    pub(super) fn push_if(&mut self, keep: bool, item: T) {
        match self.items.get_mut(self.count) {
            Some(place) => *place = item,
            None => self.items.push(item),
        }
        self.count += usize::from(keep);
    }

    #[inline]
    pub(super) fn as_slice(&self) -> &[T] {
        &self.items[..self.count]
    }
}

impl List<u32> {
    /// Adds as many of the items as there are bits.
    #[inline(always)]
    pub(super) fn push_some(&mut self, bits: u8, items: [u32; LANES]) {
        match self.items.get_mut(self.count..).and_then(|free| free.first_chunk_mut()) {
            Some(place) => *place = items,
            None => self.grow(items),
        }
        self.count += bits.count_ones() as usize;
    }

    #[cold]
    fn grow(&mut self, items: [u32; LANES]) {
        self.items.truncate(self.count);
        self.items.extend(items);
    }
}

#[cfg(test)]
mod tests {
    use super::List;

    #[test]
    fn keeps_what_it_is_told_to() {
        let mut list = List::new();
        for round in 0..3 {
            list.clear();
            (0..20).for_each(|i| list.push_if(i % 3 == round, i));
            assert!(list.as_slice().iter().copied().eq((0..20).filter(|i| i % 3 == round)));
        }
    }

    #[test]
    fn blocks_follow_each_other() {
        let mut list = List::new();
        let blocks = [(0b1000_0001, 10), (0, 20), (0b0110_0000, 30), (0b0001_1100, 40)];
        for (bits, first) in blocks {
            list.push_some(bits, std::array::from_fn(|i| first + i as u32));
        }
        assert_eq!(list.as_slice(), [10, 11, 30, 31, 40, 41, 42]);
    }
}
