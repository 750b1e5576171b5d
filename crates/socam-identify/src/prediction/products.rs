//! Linear maps from signals to columns. A general library would spend most of its time on packing matrices as small as these.

use faer::{MatMut, MatRef};
use pulp::{Simd, WithSimd};

/// Most columns that are computed in one pass over the signals; their sums stay in registers.
const TILE: usize = 6;

/// Signals over a block of samples, signal by signal.
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

/// A linear map from signals to columns.
pub(crate) struct LinearMap {
    columns: usize,
    /// Signal by signal.
    weights: Vec<f64>,
}

impl LinearMap {
    /// The map with this matrix of signals x columns.
    pub(crate) fn new(matrix: MatRef<'_, f64>) -> Self {
        let columns = matrix.ncols();
        let weights = (0..matrix.nrows()).flat_map(|i| (0..columns).map(move |j| matrix[(i, j)]));
        Self { columns, weights: weights.collect() }
    }

    /// Sets `target` to the map of the signals' first samples, one row per sample; each column is contiguous.
    pub(crate) fn write(&self, signals: &Signals, target: MatMut<'_, f64>) {
        pulp::Arch::new().dispatch(Product::<false> { map: self, signals, target });
    }

    /// Adds the map of the signals' first samples to `target`.
    pub(crate) fn add(&self, signals: &Signals, target: MatMut<'_, f64>) {
        pulp::Arch::new().dispatch(Product::<true> { map: self, signals, target });
    }
}

struct Product<'a, const ADD: bool> {
    map: &'a LinearMap,
    signals: &'a Signals,
    target: MatMut<'a, f64>,
}

impl<const ADD: bool> WithSimd for Product<'_, ADD> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { map, signals, target } = self;
        debug_assert_eq!(target.ncols(), map.columns);
        debug_assert!(target.nrows() <= signals.samples);
        let mut columns =
            target.col_iter_mut().filter_map(|column| Some(column.try_as_col_major_mut()?.as_slice_mut()));
        for first in (0..map.columns).step_by(TILE) {
            match map.columns - first {
                1 => tile::<S, ADD, 1>(simd, map, signals, first, &mut columns),
                2 => tile::<S, ADD, 2>(simd, map, signals, first, &mut columns),
                3 => tile::<S, ADD, 3>(simd, map, signals, first, &mut columns),
                4 => tile::<S, ADD, 4>(simd, map, signals, first, &mut columns),
                5 => tile::<S, ADD, 5>(simd, map, signals, first, &mut columns),
                _ => tile::<S, ADD, TILE>(simd, map, signals, first, &mut columns),
            }
        }
    }
}

/// Computes the next `W` columns; `first` is the index of the first of them.
#[inline(always)]
fn tile<'t, S: Simd, const ADD: bool, const W: usize>(
    simd: S,
    map: &LinearMap,
    signals: &Signals,
    first: usize,
    columns: &mut impl Iterator<Item = &'t mut [f64]>,
) {
    let mut columns: [&mut [f64]; W] = std::array::from_fn(|_| columns.next().unwrap_or_default());
    let count = columns[0].len();
    let step = 2 * S::F64_LANES;
    let whole = count / step * step;
    let weights = || map.weights.chunks_exact(map.columns).map(|row| &row[first..first + W]);
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
            let map = LinearMap::new(matrix.as_ref());
            let mut sum = Mat::from_fn(samples, columns, |i, j| (i + j) as f64);
            let mut alone = sum.clone();
            map.add(&signals, sum.as_mut());
            map.write(&signals, alone.as_mut());
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
