//! Parameter-dependent prewhitening of residuals that are coloured by a noisy input, with its derivatives.
//!
//! With input noise of standard deviation s_u, the residual r(theta) of a prediction from the measured input has the covariance
//! Phi(theta) = G s_u^2 G' + s_y^2, which depends on the parameters. Least squares of Phi(theta)^-1/2 r(theta) is the likelihood of input
//! and output after elimination of the true input as an unknown (errors in variables with known noise; Söderström, Automatica 43,
//! 2007). The expectation of the noise's contribution does not depend on theta, so that the estimate is not biased towards parameters
//! that amplify noise less. The determinant of Phi does not enter.

use faer::{MatMut, reborrow::ReborrowMut};
use socam_model::Equations;

use crate::{
    Intersample,
    noise::{
        filter_batch::{FilterBatch, FilterState},
        innovations_filter::{FilterRows, InnovationsFilter, NoiseLevels},
    },
    prediction::step_level::padded,
    problem::{Problem, sample_times},
};

/// Relative step of the central differences with respect to a parameter.
const STEP: f64 = 1e-4;

/// The filter for one sample time, and those at perturbed parameters.
#[derive(Debug, Clone)]
pub(crate) struct Prewhitening {
    pub(crate) sample_time_s: f64,
    pub(crate) filter: InnovationsFilter,
    /// Filters at a larger value of each free parameter, then at a smaller value of each. Empty for fixed filters.
    neighbours: FilterBatch,
    /// Factor from the difference of the two to a derivative, in the scale of the evaluation's sensitivities.
    factors: Vec<f64>,
}

/// One prewhitening for each sample time, at parameter `values`; empty if no input is noisy. `scales` are those of the sensitivities.
/// `None` if no stationary filter exists.
pub(crate) fn all(
    problem: &Problem<'_>,
    values: &[f64],
    levels: &NoiseLevels,
    scales: &[f64],
    equations: &Equations,
) -> Option<Vec<Prewhitening>> {
    if !levels.in_the_input() {
        return Some(Vec::new());
    }
    let changed = |j: usize, step: f64| {
        let mut values = values.to_vec();
        values[problem.free[j]] += step;
        problem.model.equations(&values).ok()
    };
    let mut sides = Vec::new();
    for (j, scale) in scales.iter().enumerate() {
        let value = values[problem.free[j]].abs();
        let step = STEP * if value > 0.0 { value } else { *scale };
        // A parameter at the end of its range, such as an inertia near zero, has a one-sided difference.
        let less = changed(j, -step).map(|equations| (equations, 2.0 * step));
        let (less, distance) = less.unwrap_or_else(|| (equations.clone(), step));
        sides.push((changed(j, step)?, less, scale / distance));
    }
    let times_s = sample_times(problem);
    let with_neighbours = |prewhitening: Prewhitening| {
        let filter = |equations: &Equations| {
            InnovationsFilter::new(
                equations,
                levels,
                &levels.outputs,
                prewhitening.sample_time_s,
                &problem.intersample,
            )
        };
        let more = sides.iter().map(|(more, ..)| filter(more));
        let filters: Option<Vec<_>> = more.chain(sides.iter().map(|(_, less, _)| filter(less))).collect();
        let neighbours = FilterBatch::new(&filters?.iter().collect::<Vec<_>>());
        Some(Prewhitening {
            neighbours,
            factors: sides.iter().map(|(.., factor)| *factor).collect(),
            ..prewhitening
        })
    };
    let prewhitenings = fixed(equations, levels, &times_s, &problem.intersample)?;
    prewhitenings.into_iter().map(with_neighbours).collect()
}

/// Fixed filters, which do not follow the parameters: one for each sample time. Empty if no input is noisy, `None` where no stationary
/// filter exists.
pub(crate) fn fixed(
    equations: &Equations,
    levels: &NoiseLevels,
    times_s: &[f64],
    intersample: &[Intersample],
) -> Option<Vec<Prewhitening>> {
    if !levels.in_the_input() {
        return Some(Vec::new());
    }
    let prewhitening = |sample_time_s: &f64| {
        let filter = InnovationsFilter::new(equations, levels, &levels.outputs, *sample_time_s, intersample)?;
        Some(Prewhitening {
            sample_time_s: *sample_time_s,
            filter,
            neighbours: FilterBatch::new(&[]),
            factors: Vec::new(),
        })
    };
    times_s.iter().map(prewhitening).collect()
}

/// Whether a stable stationary filter exists at a point for every sample time.
pub(crate) fn exists(problem: &Problem<'_>, values: &[f64], levels: &NoiseLevels) -> bool {
    let Ok(equations) = problem.model.equations(values) else { return false };
    let filter = |time_s: f64| {
        InnovationsFilter::new(&equations, levels, &levels.outputs, time_s, &problem.intersample)
    };
    sample_times(problem)
        .into_iter()
        .all(|time_s| filter(time_s).is_some_and(|filter| filter.spectral_radius() < 1.0))
}

/// The filters along one segment. Each row holds the sensitivities of free parameters and the residual, then those of nuisance
/// parameters; each part is padded to whole SIMD vectors.
pub(crate) struct PrewhiteningState<'c> {
    prewhitening: &'c Prewhitening,
    globals: usize,
    state: FilterRows,
    neighbours: FilterState,
    stride: usize,
    rows: Vec<f64>,
    residual: Vec<f64>,
    here: Vec<bool>,
}

impl Prewhitening {
    /// Reduces the number of the filter's states; for fixed filters.
    pub(crate) fn reduce(&mut self) {
        if let Some(reduced) = self.filter.reduced() {
            self.filter = reduced;
        }
    }

    /// The filters before the first sample of a segment with `nuisance` nuisance parameters and `globals` free parameters.
    pub(crate) fn start(&self, nuisance: usize, globals: usize) -> PrewhiteningState<'_> {
        let stride = padded(globals + 1) + padded(nuisance);
        PrewhiteningState {
            prewhitening: self,
            globals,
            state: self.filter.initial_rows(stride),
            neighbours: self.neighbours.initial_state(),
            stride,
            rows: Vec::new(),
            residual: Vec::new(),
            here: Vec::new(),
        }
    }
}

impl PrewhiteningState<'_> {
    /// Filters consecutive samples in place. `block` holds `samples` rows of each output, one output after the other. Its columns are
    /// the nuisance parameters (all or none of them), the free parameters and the residual. `present` has one entry per row.
    pub(crate) fn apply(&mut self, mut block: MatMut<'_, f64>, samples: usize, present: &[bool]) {
        let globals = self.globals + 1;
        let nuisance = block.ncols() - globals;
        let width = if nuisance > 0 { self.stride } else { padded(globals) };
        let outputs = present.len() / samples.max(1);
        self.rows.resize(outputs * self.stride, 0.0);
        for k in 0..samples {
            self.residual.clear();
            self.here.clear();
            for (o, row) in self.rows.chunks_exact_mut(self.stride).enumerate() {
                let source = block.as_ref().row(o * samples + k);
                let (local, global) = source.split_at_col(nuisance);
                row.iter_mut().zip(global.iter()).for_each(|(target, value)| *target = *value);
                let behind = row[padded(globals)..].iter_mut();
                behind.zip(local.iter()).for_each(|(target, value)| *target = *value);
                self.residual.push(row[globals - 1]);
                self.here.push(present[o * samples + k]);
            }
            self.prewhitening.filter.whiten(&mut self.state, &mut self.rows, width, &self.here);
            self.add_sensitivities();
            for (o, row) in self.rows.chunks_exact(self.stride).enumerate() {
                let target = block.rb_mut().row_mut(o * samples + k);
                let (local, global) = target.split_at_col_mut(nuisance);
                global.iter_mut().zip(row).for_each(|(target, value)| *target = *value);
                local.iter_mut().zip(&row[padded(globals)..]).for_each(|(target, value)| *target = *value);
            }
        }
    }

    /// Adds the derivative of the filter, applied to the residual, to each parameter's sensitivity.
    fn add_sensitivities(&mut self) {
        let Prewhitening { neighbours, factors, .. } = self.prewhitening;
        if factors.is_empty() {
            return;
        }
        neighbours.advance(&mut self.neighbours, &self.residual, &self.here);
        let white = self.neighbours.white.chunks_exact(neighbours.stride());
        for (row, white) in self.rows.chunks_exact_mut(self.stride).zip(white) {
            let (more, less) = white.split_at(factors.len());
            let sensitivities =
                more.iter().zip(less).zip(factors).map(|((more, less), factor)| factor * (more - less));
            row.iter_mut().zip(sensitivities).for_each(|(target, sensitivity)| *target += sensitivity);
        }
    }
}
