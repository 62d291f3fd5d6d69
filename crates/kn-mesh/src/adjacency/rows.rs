//! Compressed rows.

/// Lists of values, one per row, in one allocation (compressed sparse rows).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rows<T = u32> {
    /// `#rows + 1` starts into `values`, ascending; the first is 0. Empty before the first use.
    pub offsets: Vec<u32>,
    /// The rows one after the other.
    pub values: Vec<T>,
}

impl<T> Default for Rows<T> {
    fn default() -> Self {
        Self { offsets: Vec::new(), values: Vec::new() }
    }
}

impl<T> Rows<T> {
    /// The values of one row.
    #[inline]
    pub fn row(&self, row: usize) -> &[T] {
        &self.values[self.range(row)]
    }

    /// The values of one row, to be changed.
    #[inline]
    pub fn row_mut(&mut self, row: usize) -> &mut [T] {
        let range = self.range(row);
        &mut self.values[range]
    }

    /// The range of a row in [`values`](Self::values).
    #[inline]
    pub fn range(&self, row: usize) -> std::ops::Range<usize> {
        self.offsets[row] as usize..self.offsets[row + 1] as usize
    }

    /// The number of rows.
    #[inline]
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Whether there is no row at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All rows in order.
    pub fn iter(&self) -> impl Iterator<Item = &[T]> + Clone {
        self.offsets.windows(2).map(|at| &self.values[at[0] as usize..at[1] as usize])
    }

    /// Starts over without rows and keeps the buffers. Values that are then pushed to
    /// [`values`](Self::values) become a row with [`end_row`](Self::end_row).
    pub fn restart(&mut self) {
        self.values.clear();
        self.offsets.clear();
        self.offsets.push(0);
    }

    /// Makes a row of the values behind the last one.
    #[inline]
    pub fn end_row(&mut self) {
        self.offsets.push(self.values.len() as u32);
    }
}

impl<T: Copy + Default> Rows<T> {
    /// Sorts `(row, value)` pairs into rows, see [`fill`](Self::fill).
    pub fn collect(row_count: usize, pairs: impl Iterator<Item = (u32, T)> + Clone) -> Self {
        let mut rows = Self::default();
        rows.fill(row_count, pairs);
        rows
    }

    /// Replaces the rows by `(row, value)` pairs, sorted by counting. The pairs keep their order
    /// inside a row; the buffers are used again.
    ///
    /// # Panics
    /// Where a row is not below `row_count`.
    pub fn fill(&mut self, row_count: usize, pairs: impl Iterator<Item = (u32, T)> + Clone) {
        // Two places further on is the count of a row. Summed up, one place further on is its
        // start; this moves on with every value and ends where the next row starts.
        let offsets = &mut self.offsets;
        offsets.clear();
        offsets.resize(row_count + 2, 0);
        pairs.clone().for_each(|(row, _)| offsets[row as usize + 2] += 1);
        let mut sum = 0;
        for offset in &mut *offsets {
            sum += *offset;
            *offset = sum;
        }
        self.values.clear();
        self.values.resize(sum as usize, T::default());
        pairs.for_each(|(row, value)| {
            let at = &mut offsets[row as usize + 1];
            self.values[*at as usize] = value;
            *at += 1;
        });
        offsets.truncate(row_count + 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_filled_by_counting_or_pushed() {
        let pairs = [(2, 'c'), (0, 'a'), (2, 'b'), (0, 'a')];
        let mut rows = Rows::collect(4, pairs.into_iter());
        assert_eq!(rows.offsets, [0, 2, 2, 4, 4]);
        assert_eq!(
            (rows.row(0), rows.row(1), rows.row(2)),
            (&['a'; 2][..], &[][..], &['c', 'b'][..])
        );
        let mut pushed = Rows::default();
        assert!(pushed.is_empty());
        pushed.restart();
        for row in rows.iter() {
            pushed.values.extend_from_slice(row);
            pushed.end_row();
        }
        assert_eq!(pushed, rows);
        rows.fill(0, std::iter::empty());
        assert_eq!((rows.len(), &rows.offsets[..]), (0, &[0][..]));
    }
}
