//! Products of small matrices with blocks of signals and with rows: what a general library spends on packing is the whole
//! work here.

use faer::{MatMut, MatRef};
use nalgebra::DMatrix;
use pulp::{Simd, WithSimd};

/// Most columns of the product that are made in one reading of the signals; their sums stay in registers.
const TILE: usize = 6;

/// One row of a matrix times a few values.
pub(crate) fn row_times(matrix: &DMatrix<f64>, row: usize, by: &[f64]) -> f64 {
    by.iter().enumerate().map(|(j, value)| matrix[(row, j)] * value).sum()
}

/// Signals over some samples, one after the other.
pub(crate) struct Signals {
    samples: usize,
    values: Vec<f64>,
}

impl Signals {
    pub(crate) fn new(samples: usize, signals: usize) -> Self {
        Self { samples, values: vec![0.0; samples * signals] }
    }

    /// The first `count` samples of each signal.
    pub(crate) fn iter_mut(&mut self, count: usize) -> impl Iterator<Item = &mut [f64]> {
        self.values.chunks_mut(self.samples.max(1)).map(move |signal| &mut signal[..count])
    }
}

/// Signals to columns.
pub(crate) struct Combination {
    columns: usize,
    /// Signal by signal.
    weights: Vec<f64>,
}

impl Combination {
    /// From a matrix of signals x columns.
    pub(crate) fn new(matrix: MatRef<'_, f64>) -> Self {
        let columns = matrix.ncols();
        let weights = (0..matrix.nrows()).flat_map(|i| (0..columns).map(move |j| matrix[(i, j)]));
        Self { columns, weights: weights.collect() }
    }

    /// Makes `target` the combination of the signals' first samples, a row for each; its columns lie each in one piece.
    pub(crate) fn write(&self, signals: &Signals, target: MatMut<'_, f64>) {
        pulp::Arch::new().dispatch(Product::<false> { combination: self, signals, target });
    }

    /// Adds it to `target`.
    pub(crate) fn add(&self, signals: &Signals, target: MatMut<'_, f64>) {
        pulp::Arch::new().dispatch(Product::<true> { combination: self, signals, target });
    }
}

struct Product<'a, const ADD: bool> {
    combination: &'a Combination,
    signals: &'a Signals,
    target: MatMut<'a, f64>,
}

impl<const ADD: bool> WithSimd for Product<'_, ADD> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { combination, signals, target } = self;
        debug_assert_eq!(target.ncols(), combination.columns);
        debug_assert!(target.nrows() <= signals.samples);
        let mut columns =
            target.col_iter_mut().filter_map(|column| Some(column.try_as_col_major_mut()?.as_slice_mut()));
        for first in (0..combination.columns).step_by(TILE) {
            match combination.columns - first {
                1 => tile::<S, ADD, 1>(simd, combination, signals, first, &mut columns),
                2 => tile::<S, ADD, 2>(simd, combination, signals, first, &mut columns),
                3 => tile::<S, ADD, 3>(simd, combination, signals, first, &mut columns),
                4 => tile::<S, ADD, 4>(simd, combination, signals, first, &mut columns),
                5 => tile::<S, ADD, 5>(simd, combination, signals, first, &mut columns),
                _ => tile::<S, ADD, TILE>(simd, combination, signals, first, &mut columns),
            }
        }
    }
}

/// The next `W` columns, of which `first` is the index of the first.
#[inline(always)]
fn tile<'t, S: Simd, const ADD: bool, const W: usize>(
    simd: S,
    combination: &Combination,
    signals: &Signals,
    first: usize,
    columns: &mut impl Iterator<Item = &'t mut [f64]>,
) {
    let mut columns: [&mut [f64]; W] = std::array::from_fn(|_| columns.next().unwrap_or_default());
    let count = columns[0].len();
    let step = 2 * S::F64_LANES;
    let whole = count / step * step;
    let weights = || combination.weights.chunks_exact(combination.columns).map(|row| &row[first..first + W]);
    for k in (0..whole).step_by(step) {
        let mut sums: [[S::f64s; 2]; W] = [[simd.splat_f64s(0.0); 2]; W];
        if ADD {
            sums = std::array::from_fn(|c| two::<S>(&columns[c][k..k + step]));
        }
        for (signal, weights) in signals.values.chunks_exact(signals.samples).zip(weights()) {
            let x = two::<S>(&signal[k..k + step]);
            for (sum, weight) in sums.iter_mut().zip(weights) {
                let weight = simd.splat_f64s(*weight);
                *sum = [simd.mul_add_e_f64s(x[0], weight, sum[0]), simd.mul_add_e_f64s(x[1], weight, sum[1])];
            }
        }
        for (column, sum) in columns.iter_mut().zip(sums) {
            S::as_mut_simd_f64s(&mut column[k..k + step]).0.copy_from_slice(&sum);
        }
    }
    for (column, c) in columns.iter_mut().zip(0..) {
        if !ADD {
            column[whole..].fill(0.0);
        }
        for (signal, weights) in signals.values.chunks_exact(signals.samples).zip(weights()) {
            for (y, x) in column[whole..].iter_mut().zip(&signal[whole..count]) {
                let weight: f64 = weights[c];
                *y += weight * x;
            }
        }
    }
}

/// Two vectors' worth of values.
#[inline(always)]
fn two<S: Simd>(values: &[f64]) -> [S::f64s; 2] {
    let vectors = S::as_simd_f64s(values).0;
    [vectors[0], vectors[1]]
}

/// Adds rows, each times its factor, to `target`. All are `stride` long, the target may be shorter, in whole vectors.
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

/// ResidualAccumulator, `stride` apart, and the matrix that combines them: row by row `width` numbers, one for each of the rows.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) factors: &'a [f64],
    pub(crate) width: usize,
    pub(crate) rows: &'a [f64],
    pub(crate) stride: usize,
}

/// Makes the first `columns` entries (whole vectors) of each row of `target`, `stride` apart, what the sources combine to, or adds
/// that to them. A few rows are made in one reading of the sources: their sums are independent and keep the processor busy.
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

/// ResidualAccumulator of a [`product`] that are made together.
const STRIP: usize = 4;

/// `R` rows, of which `first` is the index of the first.
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

/// `W` vectors of each of `R` rows.
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

/// Makes `target` the sum of all rows, each times its factor, from their entry `first` on; whole vectors. Each source names its
/// factors, its rows and how far those are apart.
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

/// The first `W` vectors of `target`, by the rows' entries from `first` on; answers `W`.
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

#[cfg(test)]
mod tests {
    use super::*;
    use faer::Mat;

    #[test]
    fn any_size_is_combined() {
        for (samples, inputs, columns) in
            [(1, 1, 1), (7, 3, 2), (8, 2, 6), (31, 5, 7), (64, 0, 3), (40, 4, 13)]
        {
            let value = |i: usize, j: usize| ((i * 7 + j * 13 + 3) % 101) as f64 / 50.0 - 1.0;
            let matrix = Mat::from_fn(inputs, columns, |i, j| value(j, i));
            let mut signals = Signals::new(samples + 3, inputs);
            for (j, signal) in signals.iter_mut(samples).enumerate() {
                signal.iter_mut().enumerate().for_each(|(k, x)| *x = value(k, j));
            }
            let combination = Combination::new(matrix.as_ref());
            let mut sum = Mat::from_fn(samples, columns, |i, j| (i + j) as f64);
            let mut alone = sum.clone();
            combination.add(&signals, sum.as_mut());
            combination.write(&signals, alone.as_mut());
            for k in 0..samples {
                for c in 0..columns {
                    let expected: f64 = (0..inputs).map(|j| value(k, j) * matrix[(j, c)]).sum();
                    assert!(
                        (alone[(k, c)] - expected).abs() < 1e-12,
                        "{samples} {inputs} {columns}: {k} {c}"
                    );
                    assert!(
                        (sum[(k, c)] - expected - (k + c) as f64).abs() < 1e-12,
                        "{samples} {inputs} {columns}"
                    );
                }
            }
        }
    }
}
