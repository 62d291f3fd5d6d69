//! The pairs of key nodes that have a common term in the energy.

/// The upper block triangle of a symmetric matrix with one block row per node.
#[derive(Debug)]
pub(crate) struct BlockPattern {
    /// `#N + 1`.
    starts: Vec<u32>,
    /// Columns of each row, rising, the diagonal first.
    columns: Vec<u16>,
}

/// A square bit matrix. The fit allows at most [`crate::MAX_NODES`] nodes, so 2 MB.
#[derive(Debug)]
pub(crate) struct PairSet {
    words_per_row: usize,
    words: Vec<u64>,
}

impl PairSet {
    pub(crate) fn new(node_count: usize) -> Self {
        let words_per_row = node_count.div_ceil(64);
        Self { words_per_row, words: vec![0; words_per_row * node_count] }
    }

    /// Adds all pairs of `nodes`, both ways and each with itself.
    pub(crate) fn add_clique(&mut self, nodes: &[u16]) {
        for &a in nodes {
            let row = usize::from(a) * self.words_per_row;
            for &b in nodes {
                self.words[row + usize::from(b) / 64] |= 1 << (b % 64);
            }
        }
    }

    /// The members of a row, rising.
    pub(crate) fn row(&self, node: usize) -> impl Iterator<Item = u16> + '_ {
        let start = node * self.words_per_row;
        let words = self.words[start..start + self.words_per_row].iter().enumerate();
        words.flat_map(|(index, &word)| {
            let mut rest = word;
            std::iter::from_fn(move || {
                (rest != 0).then(|| {
                    let bit = rest.trailing_zeros() as usize;
                    rest &= rest - 1;
                    (64 * index + bit) as u16
                })
            })
        })
    }
}

impl BlockPattern {
    pub(crate) fn new(pairs: &PairSet, node_count: usize) -> Self {
        let mut starts = vec![0];
        let mut columns = Vec::new();
        for node in 0..node_count {
            columns.push(node as u16);
            columns.extend(pairs.row(node).filter(|&other| usize::from(other) > node));
            starts.push(columns.len() as u32);
        }
        Self { starts, columns }
    }

    pub(crate) fn node_count(&self) -> usize {
        self.starts.len() - 1
    }

    pub(crate) fn block_count(&self) -> usize {
        self.columns.len()
    }

    /// The blocks of a row.
    pub(crate) fn range(&self, node: usize) -> std::ops::Range<usize> {
        self.starts[node] as usize..self.starts[node + 1] as usize
    }

    /// The columns of a row, the diagonal first.
    pub(crate) fn columns(&self, node: usize) -> &[u16] {
        &self.columns[self.range(node)]
    }

    /// Cuts an array with one entry per block into rows.
    pub(crate) fn rows_mut<'a, T>(&self, blocks: &'a mut [T]) -> Vec<&'a mut [T]> {
        let mut rest = blocks;
        let mut rows = Vec::with_capacity(self.node_count());
        for node in 0..self.node_count() {
            let (row, tail) = rest.split_at_mut(self.range(node).len());
            rows.push(row);
            rest = tail;
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_hold_the_pairs_above_the_diagonal() {
        let mut pairs = PairSet::new(130);
        pairs.add_clique(&[3, 129, 64]);
        pairs.add_clique(&[3, 5]);
        let pattern = BlockPattern::new(&pairs, 130);
        assert_eq!(pattern.columns(3), [3, 5, 64, 129]);
        assert_eq!(pattern.columns(64), [64, 129]);
        assert_eq!(pattern.columns(0), [0]);
        assert_eq!(pattern.block_count(), 130 + 4);
    }
}
