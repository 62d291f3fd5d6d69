//! A list that grows without a branch.

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
}
