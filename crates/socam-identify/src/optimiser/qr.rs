//! Least squares in square-root form: rows are folded into a triangular factor.
//!
//! Columns are [nuisance | free | residual]. Nuisance parameters (start state, offsets) belong to one segment; after their elimination the
//! factor of the free parameters is the lower right corner. Blocks are folded in one after the other by orthogonal transformations, so the
//! condition number is never squared (as it would be in normal equations) and memory is one block.

use faer::{Mat, MatMut, MatRef};

use crate::optimiser::householder::{self, LANES};

/// Rows folded at a time: with a few columns they fit the first cache.
const BLOCK_ROWS: usize = 384;

/// Accumulates rows of one segment into a triangular factor.
pub(crate) struct QrAccumulator {
    columns: usize,
    /// The factor so far, by column.
    factor: Vec<f64>,
    /// Rows not folded yet, [`BLOCK_ROWS`] values from column to column.
    rows: Vec<f64>,
    filled: usize,
}

impl QrAccumulator {
    pub(crate) fn new(columns: usize) -> Self {
        Self {
            columns,
            factor: vec![0.0; columns * columns],
            rows: vec![0.0; columns * BLOCK_ROWS],
            filled: 0,
        }
    }

    /// Workspace for `rows` rows, to be written by the caller; at most [`QrAccumulator::capacity`].
    pub(crate) fn rows_mut(&mut self, rows: usize) -> MatMut<'_, f64> {
        if self.filled + rows > BLOCK_ROWS {
            self.fold();
        }
        let start = self.filled;
        self.filled += rows;
        let from = &mut self.rows[start.min(self.columns * BLOCK_ROWS)..];
        MatMut::from_column_major_slice_with_stride_mut(from, rows, self.columns, BLOCK_ROWS)
    }

    pub(crate) const fn capacity() -> usize {
        BLOCK_ROWS
    }

    fn fold(&mut self) {
        let height = self.filled.next_multiple_of(LANES);
        for column in self.rows.chunks_exact_mut(BLOCK_ROWS) {
            column[self.filled..height].fill(0.0);
        }
        householder::fold(&mut self.factor, &mut self.rows, BLOCK_ROWS, height, self.columns);
        self.filled = 0;
    }

    /// The factor, columns x columns, upper triangular.
    pub(crate) fn finish(mut self) -> Mat<f64> {
        self.fold();
        Mat::from_fn(self.columns, self.columns, |i, j| self.factor[j * self.columns + i])
    }
}

/// Eliminates the first `count` columns of `rows` by reflections and returns the row of each pivot. A column for which `is_determined`
/// (index, norm after elimination, norm before) is false is skipped and uses no row, so that its part stays in the following columns.
/// The rows after the last pivot belong to these.
///
/// [`QrAccumulator`] gives a dependent column a row of rounding errors, so the finished factor is processed once more here.
pub(crate) fn eliminate(
    rows: &mut Mat<f64>,
    count: usize,
    is_determined: impl Fn(usize, f64, f64) -> bool,
) -> Vec<Option<usize>> {
    let (height, width) = rows.shape();
    let mut row = 0;
    let mut pivots = Vec::with_capacity(count);
    for column in 0..count {
        let remainder = rows.col(column).subrows(row, height - row).norm_l2();
        if !is_determined(column, remainder, rows.col(column).norm_l2()) {
            (row..height).for_each(|i| rows[(i, column)] = 0.0);
            pivots.push(None);
            continue;
        }
        let pivot = -remainder.copysign(rows[(row, column)]);
        let mut mirror: Vec<f64> = (row..height).map(|i| rows[(i, column)]).collect();
        mirror[0] -= pivot;
        let length: f64 = mirror.iter().map(|m| m * m).sum();
        for j in column..width {
            let along: f64 = mirror.iter().enumerate().map(|(i, m)| m * rows[(row + i, j)]).sum();
            mirror.iter().enumerate().for_each(|(i, m)| rows[(row + i, j)] -= 2.0 * along / length * m);
        }
        (row + 1..height).for_each(|i| rows[(i, column)] = 0.0);
        pivots.push(Some(row));
        row += 1;
    }
    pivots
}

/// Norms of the first `count` columns; 1 for a zero column.
pub(crate) fn lengths(factor: MatRef<'_, f64>, count: usize) -> Vec<f64> {
    let lengths = (0..count).map(|j| factor.col(j).norm_l2());
    lengths.map(|length| if length > 1e-100 { length } else { 1.0 }).collect()
}

/// Factor of the rows of several factors together, in their order (so the digits do not depend on threads).
pub(crate) fn join<'a>(factors: impl Iterator<Item = MatRef<'a, f64>>, columns: usize) -> Mat<f64> {
    let mut triangle = QrAccumulator::new(columns);
    for factor in factors {
        for from in (0..factor.nrows()).step_by(BLOCK_ROWS) {
            let rows = factor.subrows(from, BLOCK_ROWS.min(factor.nrows() - from));
            triangle.rows_mut(rows.nrows()).copy_from(rows);
        }
    }
    triangle.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_without_information_take_none_from_others() {
        let value = |i: usize, j: usize| match j {
            1 => 0.0,
            3 => ((i * 7) % 101) as f64 - 50.0,
            _ => ((i * 7 + j * i * i + 3) % 101) as f64 - 50.0,
        };
        // Column 1 is zero, and column 3 occurs twice.
        let rows = Mat::from_fn(400, 7, |i, j| value(i, if j == 4 { 3 } else { j }));
        let mut factor = join([rows.as_ref()].into_iter(), 7);
        let pivots = eliminate(&mut factor, 5, |_, remainder, length| remainder > 1e-8 * length);
        assert_eq!(pivots, [Some(0), None, Some(1), Some(2), None]);
        let kept = Mat::from_fn(400, 5, |i, j| rows[(i, [0, 2, 3, 5, 6][j])]);
        let expected = join([kept.as_ref()].into_iter(), 5);
        for (a, b) in [(0, 0), (0, 1), (1, 1)] {
            let gram = |m: &Mat<f64>, first: usize, column: usize| -> f64 {
                (first..m.nrows()).map(|i| m[(i, column + a)] * m[(i, column + b)]).sum()
            };
            let (got, want) = (gram(&factor, 3, 5), gram(&expected, 3, 3));
            assert!((got - want).abs() < 1e-9 * want.abs().max(1.0), "{a} {b}: {got} {want}");
        }
    }

    #[test]
    fn folding_in_blocks_keeps_the_gram_matrix() {
        let rows = 5000;
        let value = |i: usize, j: usize| ((i * 7 + j * 13 + 3) % 101) as f64 / 50.0 - 1.0;
        let mut triangle = QrAccumulator::new(4);
        for start in (0..rows).step_by(250) {
            let mut target = triangle.rows_mut(250);
            for i in 0..250 {
                for j in 0..4 {
                    target[(i, j)] = value(start + i, j);
                }
            }
        }
        let r = triangle.finish();
        for a in 0..4 {
            for b in 0..4 {
                let expected: f64 = (0..rows).map(|i| value(i, a) * value(i, b)).sum();
                let got: f64 = (0..4).map(|i| r[(i, a)] * r[(i, b)]).sum();
                assert!((got - expected).abs() < 1e-10 * rows as f64, "{a} {b}: {got} {expected}");
            }
        }
    }
}
