//! Least squares in square-root form: rows go in, a triangular factor stays.
//!
//! Columns are [local | global | residual]. Local unknowns (start state, offsets) matter to one stretch of data
//! only; what the factor says of the global ones after eliminating them is its lower right corner. Blocks are
//! folded in one after the other by orthogonal transformations, so the condition number is never squared
//! (as it would be in normal equations) and memory is one block.

use faer::{Mat, MatRef};

/// Rows folded at a time.
const BLOCK_ROWS: usize = 1536;

/// Collects rows of one stretch.
pub(crate) struct Triangle {
    columns: usize,
    /// The factor so far on top, then rows not folded yet.
    buffer: Mat<f64>,
    filled: usize,
}

impl Triangle {
    pub(crate) fn new(columns: usize) -> Self {
        Self { columns, buffer: Mat::zeros(columns + BLOCK_ROWS, columns), filled: columns }
    }

    /// Room for `rows` rows, to be written by the caller; at most [`Triangle::capacity`].
    pub(crate) fn rows_mut(&mut self, rows: usize) -> faer::MatMut<'_, f64> {
        if self.filled + rows > self.buffer.nrows() {
            self.fold();
        }
        let start = self.filled;
        self.filled += rows;
        self.buffer.as_mut().subrows_mut(start, rows)
    }

    pub(crate) const fn capacity() -> usize {
        BLOCK_ROWS
    }

    fn fold(&mut self) {
        if self.filled == self.columns {
            return;
        }
        let factor = upper(self.buffer.as_ref().subrows(0, self.filled));
        self.buffer.as_mut().subrows_mut(0, self.columns).copy_from(&factor);
        self.filled = self.columns;
    }

    /// The factor, columns x columns, upper triangular.
    pub(crate) fn finish(mut self) -> Mat<f64> {
        self.fold();
        self.buffer.as_ref().subrows(0, self.columns).to_owned()
    }
}

/// Upper triangular factor R of `rows` = Q R.
pub(crate) fn upper(rows: MatRef<'_, f64>) -> Mat<f64> {
    let columns = rows.ncols();
    let qr = rows.qr();
    let r = qr.R();
    Mat::from_fn(columns, columns, |i, j| if i <= j && i < r.nrows() { r[(i, j)] } else { 0.0 })
}

/// Factor of the rows of several factors together, in their order (so the digits do not depend on threads).
pub(crate) fn join<'a>(factors: impl Iterator<Item = MatRef<'a, f64>>, columns: usize) -> Mat<f64> {
    let mut triangle = Triangle::new(columns);
    for factor in factors {
        triangle.rows_mut(factor.nrows()).copy_from(factor);
    }
    triangle.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folding_in_blocks_keeps_the_gram_matrix() {
        let rows = 5000;
        let value = |i: usize, j: usize| ((i * 7 + j * 13 + 3) % 101) as f64 / 50.0 - 1.0;
        let mut triangle = Triangle::new(4);
        for start in (0..rows).step_by(500) {
            let mut target = triangle.rows_mut(500);
            for i in 0..500 {
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
