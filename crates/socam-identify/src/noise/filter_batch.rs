//! Several innovations filters of one shape run side by side on the same residuals, one SIMD lane each.

use pulp::{Simd, WithSimd};

use crate::{noise::innovations_filter::InnovationsFilter, prediction::step_level::padded};

/// Filters of one shape, such as those at perturbed values of each parameter.
#[derive(Debug, Clone)]
pub(crate) struct FilterBatch {
    lanes: usize,
    states: usize,
    outputs: usize,
    /// For each state, then for each output: the factors of the states. A factor that is zero in all filters is left out.
    transition: Vec<Vec<Factor>>,
    output: Vec<Vec<Factor>>,
    /// For each state: factors of the outputs.
    gain: Vec<Vec<Factor>>,
    /// For each output: factors of the outputs up to it.
    inverse_root: Vec<Vec<Factor>>,
}

/// Factors of row `of`, one per lane.
#[derive(Debug, Clone)]
struct Factor {
    of: usize,
    lanes: Vec<f64>,
}

/// States of the filters, and their last innovations.
#[derive(Debug, Clone)]
pub(crate) struct FilterState {
    values: Vec<f64>,
    next: Vec<f64>,
    /// Last innovations, output by output, lane by lane.
    pub(crate) innovation: Vec<f64>,
    /// Innovations divided by the root of their covariance.
    pub(crate) white: Vec<f64>,
}

impl FilterBatch {
    pub(crate) fn new(filters: &[&InnovationsFilter]) -> Self {
        let (states, outputs) = filters.first().map_or((0, 0), |filter| (filter.states, filter.outputs));
        let rows = |count: usize, width: usize, entry: &dyn Fn(&InnovationsFilter, usize, usize) -> f64| {
            let row = |i: usize| -> Vec<Factor> {
                let factor = |j: usize| {
                    let mut lanes: Vec<f64> = filters.iter().map(|filter| entry(filter, i, j)).collect();
                    lanes.resize(padded(filters.len()), 0.0);
                    lanes.iter().any(|value| *value != 0.0).then_some(Factor { of: j, lanes })
                };
                (0..width).filter_map(factor).collect()
            };
            (0..count).map(row).collect()
        };
        Self {
            lanes: padded(filters.len()),
            states,
            outputs,
            transition: rows(states, states, &|filter, i, j| filter.transition[i * states + j]),
            output: rows(outputs, states, &|filter, i, j| filter.minus_output[i * states + j]),
            gain: rows(states, outputs, &|filter, i, j| filter.gain[i * outputs + j]),
            inverse_root: rows(outputs, outputs, &|filter, i, j| filter.inverse_root[i * outputs + j]),
        }
    }

    /// Distance between the outputs of one lane.
    pub(crate) fn stride(&self) -> usize {
        self.lanes
    }

    pub(crate) fn initial_state(&self) -> FilterState {
        let zeros = |rows: usize| vec![0.0; rows * self.lanes];
        FilterState {
            values: zeros(self.states),
            next: zeros(self.states),
            innovation: zeros(self.outputs),
            white: zeros(self.outputs),
        }
    }

    /// Advances all filters by one sample of residuals, one number per output; see [`InnovationsFilter::whiten`].
    pub(crate) fn advance(&self, state: &mut FilterState, residual: &[f64], present: &[bool]) {
        pulp::Arch::new().dispatch(Advance { batch: self, state, residual, present });
        std::mem::swap(&mut state.values, &mut state.next);
    }
}

struct Advance<'a> {
    batch: &'a FilterBatch,
    state: &'a mut FilterState,
    residual: &'a [f64],
    present: &'a [bool],
}

impl WithSimd for Advance<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { batch, state, residual, present } = self;
        let lanes = batch.lanes;
        let FilterState { values, next, innovation, white } = state;
        for (o, row) in innovation.chunks_exact_mut(lanes).enumerate() {
            if present[o] {
                row.fill(residual[o]);
                add(simd, &batch.output[o], values, row);
            } else {
                row.fill(0.0);
            }
        }
        for (i, row) in next.chunks_exact_mut(lanes).enumerate() {
            row.fill(0.0);
            add(simd, &batch.transition[i], values, row);
            add(simd, &batch.gain[i], innovation, row);
        }
        for (o, row) in white.chunks_exact_mut(lanes).enumerate() {
            row.fill(0.0);
            if present[o] {
                add(simd, &batch.inverse_root[o], innovation, row);
            }
        }
    }
}

/// Adds rows to `target`, each lane times its factor.
#[inline(always)]
fn add<S: Simd>(simd: S, factors: &[Factor], rows: &[f64], target: &mut [f64]) {
    let lanes = target.len();
    let target = S::as_mut_simd_f64s(target).0;
    let mut done = 0;
    while done < target.len() {
        let rest = &mut target[done..];
        done += match rest.len() {
            1 => add_some::<S, 1>(simd, factors, rows, lanes, done, rest),
            2 | 3 => add_some::<S, 2>(simd, factors, rows, lanes, done, rest),
            _ => add_some::<S, 4>(simd, factors, rows, lanes, done, rest),
        };
    }
}

/// Adds to the first `W` vectors of `target` those from vector `first` on of every row; returns `W`.
#[inline(always)]
fn add_some<S: Simd, const W: usize>(
    simd: S,
    factors: &[Factor],
    rows: &[f64],
    lanes: usize,
    first: usize,
    target: &mut [S::f64s],
) -> usize {
    let from = first * S::F64_LANES;
    let some = from..from + W * S::F64_LANES;
    let mut sums = [simd.splat_f64s(0.0); W];
    sums.copy_from_slice(&target[..W]);
    for factor in factors {
        let row = &S::as_simd_f64s(&rows[factor.of * lanes..][some.clone()]).0[..W];
        let own = &S::as_simd_f64s(&factor.lanes[some.clone()]).0[..W];
        for ((sum, value), factor) in sums.iter_mut().zip(row).zip(own) {
            *sum = simd.mul_add_e_f64s(*factor, *value, *sum);
        }
    }
    target[..W].copy_from_slice(&sums);
    W
}
