//! Sums of rows, each times a factor, written for the lanes of the processor.

use nalgebra::DMatrix;
use pulp::{Simd, WithSimd};

/// Product of one row of a matrix with a vector.
pub(crate) fn row_times(matrix: &DMatrix<f64>, row: usize, by: &[f64]) -> f64 {
    by.iter().enumerate().map(|(j, value)| matrix[(row, j)] * value).sum()
}

/// Adds the sum of all rows, each times its factor, to `target`. Rows are `stride` numbers apart; the target may be shorter, in whole
/// SIMD vectors.
pub(crate) fn add_rows(factors: &[f64], rows: &[f64], stride: usize, target: &mut [f64]) {
    pulp::Arch::new().dispatch(AddRows { factors, rows, stride, target });
}

struct AddRows<'a> {
    factors: &'a [f64],
    rows: &'a [f64],
    stride: usize,
    target: &'a mut [f64],
}

impl WithSimd for AddRows<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        sum_rows::<S, true, 1>(simd, [(self.factors, self.rows, self.stride)], 0, self.target);
    }
}

/// A factor of a matrix product: `rows`, `stride` numbers apart, and the matrix that combines them, row by row `width` numbers.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) factors: &'a [f64],
    pub(crate) width: usize,
    pub(crate) rows: &'a [f64],
    pub(crate) stride: usize,
}

/// Sets the first `columns` entries (whole SIMD vectors) of each row of `target` to the sum of the sources' products, or adds that sum.
/// Rows of the target are `stride` numbers apart. Several rows are computed in one pass over the sources: their sums are independent and
/// fill the processor's pipeline.
#[inline(always)]
pub(crate) fn product<S: Simd, const ADD: bool, const N: usize>(
    simd: S,
    sources: [Source<'_>; N],
    columns: usize,
    target: &mut [f64],
    stride: usize,
) {
    for (strip, target) in target.chunks_mut((STRIP * stride).max(1)).enumerate() {
        let first = strip * STRIP;
        match target.len() / stride {
            0 => {}
            1 => rows_of::<S, ADD, N, 1>(simd, sources, first, columns, target, stride),
            2 => rows_of::<S, ADD, N, 2>(simd, sources, first, columns, target, stride),
            3 => rows_of::<S, ADD, N, 3>(simd, sources, first, columns, target, stride),
            _ => rows_of::<S, ADD, N, STRIP>(simd, sources, first, columns, target, stride),
        }
    }
}

/// Rows of a [`product`] that are computed in one pass.
const STRIP: usize = 4;

/// Computes `R` rows; `first` is the index of the first of them.
#[inline(always)]
fn rows_of<S: Simd, const ADD: bool, const N: usize, const R: usize>(
    simd: S,
    sources: [Source<'_>; N],
    first: usize,
    columns: usize,
    target: &mut [f64],
    stride: usize,
) {
    let vectors = columns / S::F64_LANES;
    for from in (0..vectors / 2).map(|pair| 2 * pair * S::F64_LANES) {
        some_of::<S, ADD, N, R, 2>(simd, sources, first, from, target, stride);
    }
    if vectors % 2 == 1 {
        some_of::<S, ADD, N, R, 1>(simd, sources, first, (vectors - 1) * S::F64_LANES, target, stride);
    }
}

/// Computes `W` vectors of each of `R` rows.
#[inline(always)]
fn some_of<S: Simd, const ADD: bool, const N: usize, const R: usize, const W: usize>(
    simd: S,
    sources: [Source<'_>; N],
    first: usize,
    from: usize,
    target: &mut [f64],
    stride: usize,
) {
    let mut sums = [[simd.splat_f64s(0.0); W]; R];
    let mut parts = target.chunks_mut(stride);
    let targets: [&mut [S::f64s]; R] = std::array::from_fn(|_| {
        let row = parts.next().unwrap_or_default();
        &mut S::as_mut_simd_f64s(&mut row[from..from + W * S::F64_LANES]).0[..W]
    });
    if ADD {
        sums.iter_mut().zip(&targets).for_each(|(sum, target)| sum.copy_from_slice(target));
    }
    for source in sources {
        let factors: [&[f64]; R] =
            std::array::from_fn(|r| &source.factors[(first + r) * source.width..][..source.width]);
        for (k, row) in source.rows.chunks_exact(source.stride).take(source.width).enumerate() {
            let row = &S::as_simd_f64s(&row[from..from + W * S::F64_LANES]).0[..W];
            for (sums, factors) in sums.iter_mut().zip(factors) {
                let factor = simd.splat_f64s(factors[k]);
                for (sum, value) in sums.iter_mut().zip(row) {
                    *sum = simd.mul_add_e_f64s(factor, *value, *sum);
                }
            }
        }
    }
    targets.into_iter().zip(sums).for_each(|(target, sum)| target.copy_from_slice(&sum));
}

/// Sets `target` (whole SIMD vectors) to the sum of all rows, each times its factor, from their entry `first` on. Each source has its
/// factors, its rows and the distance between rows.
#[inline(always)]
pub(crate) fn write<S: Simd, const N: usize>(
    simd: S,
    sources: [(&[f64], &[f64], usize); N],
    first: usize,
    target: &mut [f64],
) {
    sum_rows::<S, false, N>(simd, sources, first, target);
}

#[inline(always)]
fn sum_rows<S: Simd, const ADD: bool, const N: usize>(
    simd: S,
    sources: [(&[f64], &[f64], usize); N],
    first: usize,
    target: &mut [f64],
) {
    let target = S::as_mut_simd_f64s(target).0;
    let mut done = 0;
    while done < target.len() {
        let from = first + done * S::F64_LANES;
        let rest = &mut target[done..];
        done += match rest.len() {
            1 => sum_some::<S, ADD, N, 1>(simd, sources, from, rest),
            2 => sum_some::<S, ADD, N, 2>(simd, sources, from, rest),
            3 => sum_some::<S, ADD, N, 3>(simd, sources, from, rest),
            _ => sum_some::<S, ADD, N, 4>(simd, sources, from, rest),
        };
    }
}

/// Computes the first `W` vectors of `target` from the rows' entries from `first` on; returns `W`.
#[inline(always)]
fn sum_some<S: Simd, const ADD: bool, const N: usize, const W: usize>(
    simd: S,
    sources: [(&[f64], &[f64], usize); N],
    first: usize,
    target: &mut [S::f64s],
) -> usize {
    let mut sums = [simd.splat_f64s(0.0); W];
    if ADD {
        sums.copy_from_slice(&target[..W]);
    }
    for (factors, rows, stride) in sources {
        for (factor, row) in factors.iter().zip(rows.chunks_exact(stride)) {
            let factor = simd.splat_f64s(*factor);
            let row = &S::as_simd_f64s(&row[first..first + W * S::F64_LANES]).0[..W];
            for (sum, value) in sums.iter_mut().zip(row) {
                *sum = simd.mul_add_e_f64s(factor, *value, *sum);
            }
        }
    }
    target[..W].copy_from_slice(&sums);
    W
}
