//! A sparse block Cholesky factor. It gives L-BFGS variables in which the energy is nearly round.

use crate::constants::minimisation::PIVOT;
use crate::pattern::{BlockPattern, PairSet};

/// The structure of the factor: who is eliminated when, and which blocks fill in.
#[derive(Debug)]
pub(crate) struct Elimination {
    /// `#N`: position of each node in the order of elimination.
    pub(crate) position: Vec<u16>,
    /// `#N`: the inverse.
    pub(crate) node: Vec<u16>,
    /// `#N + 1`.
    starts: Vec<u32>,
    /// Rows below the diagonal of each column, as positions, rising.
    rows: Vec<u16>,
}

impl Elimination {
    /// Minimum degree: the node with the fewest neighbours left goes next, the lowest index among
    /// equals.
    pub(crate) fn new(pattern: &BlockPattern) -> Self {
        let count = pattern.node_count();
        let mut pairs = PairSet::new(count);
        for node in 0..count {
            for &column in pattern.columns(node) {
                pairs.add_clique(&[node as u16, column]);
            }
        }
        let mut left = vec![true; count];
        let mut degree: Vec<usize> = (0..count).map(|node| pairs.row(node).count()).collect();
        let mut node = Vec::with_capacity(count);
        let mut neighbours = Vec::with_capacity(count);
        while let Some(next) = (0..count).filter(|&n| left[n]).min_by_key(|&n| degree[n]) {
            left[next] = false;
            node.push(next as u16);
            let around: Vec<u16> =
                pairs.row(next).filter(|&other| left[usize::from(other)]).collect();
            pairs.add_clique(&around);
            for &other in &around {
                let row = pairs.row(usize::from(other));
                degree[usize::from(other)] = row.filter(|&o| left[usize::from(o)]).count();
            }
            neighbours.push(around);
        }
        Self::from_order(node, neighbours)
    }

    fn from_order(node: Vec<u16>, neighbours: Vec<Vec<u16>>) -> Self {
        let mut position = vec![0; node.len()];
        for (place, &n) in node.iter().enumerate() {
            position[usize::from(n)] = place as u16;
        }
        let mut starts = vec![0];
        let mut rows: Vec<u16> = Vec::new();
        for around in neighbours {
            let first = rows.len();
            rows.extend(around.iter().map(|&n| position[usize::from(n)]));
            rows[first..].sort_unstable();
            starts.push(rows.len() as u32);
        }
        Self { position, node, starts, rows }
    }

    fn column(&self, column: usize) -> std::ops::Range<usize> {
        self.starts[column] as usize..self.starts[column + 1] as usize
    }
}

/// L of a symmetric positive definite block matrix, by columns of blocks.
#[derive(Debug, Default)]
pub(crate) struct BlockCholesky {
    /// Rows of the diagonal block, by position.
    sizes: Vec<usize>,
    /// First variable, by position.
    variables: Vec<usize>,
    /// First value of the diagonal block, by position.
    diagonals: Vec<usize>,
    /// First value of each block below, as `Elimination::rows`.
    offsets: Vec<usize>,
    values: Vec<f64>,
}

impl BlockCholesky {
    /// Empties the matrix for nodes with these numbers of parameters (`#N`, by node).
    pub(crate) fn reset(&mut self, elimination: &Elimination, sizes: impl Fn(usize) -> usize) {
        self.sizes.clear();
        self.sizes.extend(elimination.node.iter().map(|&n| sizes(usize::from(n))));
        self.variables.clear();
        self.diagonals.clear();
        self.offsets.clear();
        let (mut variable, mut value) = (0, 0);
        for (column, &size) in self.sizes.iter().enumerate() {
            self.variables.push(variable);
            variable += size;
            self.diagonals.push(value);
            value += size * size;
            for &row in &elimination.rows[elimination.column(column)] {
                self.offsets.push(value);
                value += self.sizes[usize::from(row)] * size;
            }
        }
        self.values.clear();
        self.values.resize(value, 0.0);
    }

    /// The number of variables.
    pub(crate) fn len(&self) -> usize {
        self.sizes.iter().sum()
    }

    /// The first variable of a node, in the order of elimination.
    pub(crate) fn variable(&self, elimination: &Elimination, node: usize) -> usize {
        self.variables[usize::from(elimination.position[node])]
    }

    /// Sets the block of two nodes; `entry(i, j)` is that of parameter i of `a` and j of `b`.
    pub(crate) fn set(
        &mut self,
        elimination: &Elimination,
        [a, b]: [usize; 2],
        entry: impl Fn(usize, usize) -> f64,
    ) {
        let (pa, pb) = (elimination.position[a], elimination.position[b]);
        let (row, column) = (usize::from(pa.max(pb)), usize::from(pa.min(pb)));
        let swapped = pa < pb;
        let start = if row == column {
            self.diagonals[column]
        } else {
            let range = elimination.column(column);
            let first = range.start;
            match elimination.rows[range].binary_search(&(row as u16)) {
                Ok(slot) => self.offsets[first + slot],
                Err(_) => return,
            }
        };
        let (height, width) = (self.sizes[row], self.sizes[column]);
        for i in 0..height {
            for j in 0..width {
                self.values[start + i * width + j] =
                    if swapped { entry(j, i) } else { entry(i, j) };
            }
        }
    }

    /// Replaces the matrix by its factor.
    pub(crate) fn factor(&mut self, elimination: &Elimination) {
        for column in 0..self.sizes.len() {
            match self.sizes[column] {
                3 => self.eliminate::<3>(elimination, column),
                6 => self.eliminate::<6>(elimination, column),
                9 => self.eliminate::<9>(elimination, column),
                _ => self.eliminate::<12>(elimination, column),
            }
        }
    }

    /// One column of width `W`: its diagonal block, the blocks below, and what they take from the
    /// columns to the right.
    fn eliminate<const W: usize>(&mut self, elimination: &Elimination, column: usize) {
        let diagonal = self.diagonals[column];
        factor_diagonal::<W>(&mut self.values[diagonal..diagonal + W * W]);
        let range = elimination.column(column);
        let below_start = diagonal + W * W;
        let below_rows: usize =
            elimination.rows[range.clone()].iter().map(|&r| self.sizes[usize::from(r)]).sum();
        let (head, right) = self.values.split_at_mut(below_start + below_rows * W);
        let (diagonal, below) = head[diagonal..].split_at_mut(W * W);
        for row in below.chunks_exact_mut(W) {
            solve_row::<W>(diagonal, row);
        }
        let right_start = below_start + below_rows * W;
        for (k, slot_k) in range.clone().enumerate() {
            let target = usize::from(elimination.rows[slot_k]);
            let size = self.sizes[target];
            let left = &below[self.offsets[slot_k] - below_start..][..size * W];
            let diagonal = self.diagonals[target] - right_start;
            subtract_product::<W>(&mut right[diagonal..][..size * size], left, left, size);
            let mut search = elimination.column(target);
            for slot_r in range.start + k + 1..range.end {
                let row = elimination.rows[slot_r];
                // Both lists rise, and fill-in made sure that the row is there.
                while elimination.rows[search.start] != row {
                    search.start += 1;
                }
                let height = self.sizes[usize::from(row)];
                let upper = &below[self.offsets[slot_r] - below_start..][..height * W];
                let block = self.offsets[search.start] - right_start;
                subtract_product::<W>(&mut right[block..][..height * size], upper, left, size);
            }
        }
    }

    /// x ← L⁻¹ x.
    pub(crate) fn solve_lower(&self, elimination: &Elimination, x: &mut [f64]) {
        for column in 0..self.sizes.len() {
            match self.sizes[column] {
                3 => self.lower_column::<3>(elimination, column, x),
                6 => self.lower_column::<6>(elimination, column, x),
                9 => self.lower_column::<9>(elimination, column, x),
                _ => self.lower_column::<12>(elimination, column, x),
            }
        }
    }

    fn lower_column<const W: usize>(
        &self,
        elimination: &Elimination,
        column: usize,
        x: &mut [f64],
    ) {
        let first = self.variables[column];
        let (diagonal, below) = self.blocks::<W>(elimination, column);
        let (head, tail) = x.split_at_mut(first + W);
        let mut own = [0.0; W];
        for i in 0..W {
            let sum: f64 = (0..i).map(|j| diagonal[i][j] * own[j]).sum();
            own[i] = (head[first + i] - sum) / diagonal[i][i];
        }
        head[first..].copy_from_slice(&own);
        let mut lines = below.iter();
        for &row in &elimination.rows[elimination.column(column)] {
            let row = usize::from(row);
            let out = &mut tail[self.variables[row] - first - W..][..self.sizes[row]];
            for (out, line) in out.iter_mut().zip(&mut lines) {
                *out -= (0..W).map(|k| line[k] * own[k]).sum::<f64>();
            }
        }
    }

    /// x ← L⁻ᵀ x.
    pub(crate) fn solve_upper(&self, elimination: &Elimination, x: &mut [f64]) {
        for column in (0..self.sizes.len()).rev() {
            match self.sizes[column] {
                3 => self.upper_column::<3>(elimination, column, x),
                6 => self.upper_column::<6>(elimination, column, x),
                9 => self.upper_column::<9>(elimination, column, x),
                _ => self.upper_column::<12>(elimination, column, x),
            }
        }
    }

    fn upper_column<const W: usize>(
        &self,
        elimination: &Elimination,
        column: usize,
        x: &mut [f64],
    ) {
        let first = self.variables[column];
        let (diagonal, below) = self.blocks::<W>(elimination, column);
        let (head, tail) = x.split_at_mut(first + W);
        let mut own: [f64; W] = std::array::from_fn(|i| head[first + i]);
        let mut lines = below.iter();
        for &row in &elimination.rows[elimination.column(column)] {
            let row = usize::from(row);
            let known = &tail[self.variables[row] - first - W..][..self.sizes[row]];
            for (known, line) in known.iter().zip(&mut lines) {
                (0..W).for_each(|k| own[k] -= known * line[k]);
            }
        }
        for i in (0..W).rev() {
            let sum: f64 = (i + 1..W).map(|j| diagonal[j][i] * own[j]).sum();
            own[i] = (own[i] - sum) / diagonal[i][i];
        }
        head[first..].copy_from_slice(&own);
    }

    /// The rows of a column's diagonal block, and those of all blocks below it, which follow one
    /// another.
    fn blocks<const W: usize>(
        &self,
        elimination: &Elimination,
        column: usize,
    ) -> (&[[f64; W]], &[[f64; W]]) {
        let rows = &elimination.rows[elimination.column(column)];
        let height: usize = rows.iter().map(|&row| self.sizes[usize::from(row)]).sum();
        let values = &self.values[self.diagonals[column]..][..(W + height) * W];
        values.as_chunks::<W>().0.split_at(W)
    }
}

fn factor_diagonal<const W: usize>(block: &mut [f64]) {
    for i in 0..W {
        let original = block[i * W + i];
        for j in 0..=i {
            let mut sum = block[i * W + j];
            for k in 0..j {
                sum -= block[i * W + k] * block[j * W + k];
            }
            block[i * W + j] = if i == j {
                sum.max(PIVOT * original).max(f64::MIN_POSITIVE).sqrt()
            } else {
                sum / block[j * W + j]
            };
        }
    }
}

/// row ← row L⁻ᵀ for the diagonal block L.
fn solve_row<const W: usize>(diagonal: &[f64], row: &mut [f64]) {
    for j in 0..W {
        let mut sum = row[j];
        for k in 0..j {
            sum -= row[k] * diagonal[j * W + k];
        }
        row[j] = sum / diagonal[j * W + j];
    }
}

/// out −= a bᵀ, where `out` has `width` columns and the rows of `a` and `b` have `W`.
fn subtract_product<const W: usize>(out: &mut [f64], a: &[f64], b: &[f64], width: usize) {
    for (out, a) in out.chunks_exact_mut(width).zip(a.chunks_exact(W)) {
        for (out, b) in out.iter_mut().zip(b.chunks_exact(W)) {
            let mut sum = 0.0;
            for k in 0..W {
                sum += a[k] * b[k];
            }
            *out -= sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring of nodes with 3, 6, 9 and 12 parameters, diagonally dominant.
    fn ring(count: usize) -> (Elimination, BlockCholesky, Vec<Vec<f64>>) {
        let mut pairs = PairSet::new(count);
        for node in 0..count {
            pairs.add_clique(&[node as u16, ((node + 1) % count) as u16]);
        }
        let pattern = BlockPattern::new(&pairs, count);
        let elimination = Elimination::new(&pattern);
        let size = |node: usize| 3 * (1 + node % 4);
        let mut factor = BlockCholesky::default();
        factor.reset(&elimination, size);
        let total = factor.len();
        let mut dense = vec![vec![0.0; total]; total];
        for a in 0..count {
            for &b in pattern.columns(a) {
                let b = usize::from(b);
                let value = |i: usize, j: usize| match (a == b, i == j) {
                    (true, true) => 40.0,
                    (true, false) => 1.0 / (1.0 + (i + j) as f64),
                    _ => ((a * 7 + b * 3 + i * 5 + j) % 11) as f64 / 11.0,
                };
                factor.set(&elimination, [a, b], value);
                let (va, vb) = (factor.variable(&elimination, a), factor.variable(&elimination, b));
                for i in 0..size(a) {
                    for j in 0..size(b) {
                        dense[va + i][vb + j] = value(i, j);
                        dense[vb + j][va + i] = value(i, j);
                    }
                }
            }
        }
        (elimination, factor, dense)
    }

    #[test]
    fn the_factor_solves_the_system() {
        let (elimination, mut factor, dense) = ring(9);
        factor.factor(&elimination);
        let expected: Vec<f64> = (0..factor.len()).map(|i| (i % 5) as f64 - 2.0).collect();
        let mut x: Vec<f64> =
            dense.iter().map(|row| row.iter().zip(&expected).map(|(a, b)| a * b).sum()).collect();
        factor.solve_lower(&elimination, &mut x);
        factor.solve_upper(&elimination, &mut x);
        for (x, expected) in x.iter().zip(expected) {
            assert!((x - expected).abs() < 1e-10);
        }
    }
}
