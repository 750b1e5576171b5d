//! Prediction of a model with nonlinear force laws, with the exact sensitivities of the accepted steps.
//!
//! An [`Integrator`] finds the steps; only accepted steps are differentiated ([`Sensitivity`]), so that rejected ones cost little.

use faer::MatMut;
use socam_model::Equations;

use crate::{
    IdentifyError,
    evaluation::{
        accumulator::ResidualAccumulator,
        weights::{Point, Weights},
    },
    prediction::{
        exponential::SampleSteps,
        hybrid_modes::HybridModes,
        integrator::{DEFAULT_TOLERANCE, Integrator},
        intersample::{self, InputPolynomial},
        modal::offset_channels,
        sensitivity::Sensitivity,
        start_state,
    },
    preprocessing::segments,
    problem::{Problem, StartState},
};

/// Share of their largest magnitude below which the sensitivities with respect to the start state are taken to have decayed.
const DECAYED: f64 = 1e-13;

/// Number of steps of the integrator from sample to sample, on average, where these are uneven.
const PARTS_OF_A_STEP: usize = 5;

/// A model at one parameter vector and sample time.
pub(crate) struct SensitivityIntegrator<'a> {
    equations: &'a Equations,
    sensitivities: &'a [Equations],
    free: &'a [usize],
    weights: &'a Weights,
    hybrid_modes: HybridModes,
}

impl<'a> SensitivityIntegrator<'a> {
    /// `None` where the exponential overflows.
    pub(crate) fn new(
        problem: &'a Problem<'_>,
        equations: &'a Equations,
        sensitivities: &'a [Equations],
        point: &Point,
        weights: &'a Weights,
        steps: SampleSteps,
    ) -> Option<Self> {
        Some(Self {
            equations,
            sensitivities,
            free: &problem.free,
            weights,
            hybrid_modes: HybridModes::new(equations, sensitivities, &point.values, &problem.free, steps)?,
        })
    }

    /// Predicts one segment and adds its residuals and sensitivities to `rows`; returns false where the prediction overflows or needs
    /// more than `Options::most_steps`.
    pub(crate) fn predict(
        &self,
        problem: &Problem<'_>,
        index: usize,
        point: &Point,
        rows: &mut ResidualAccumulator<'_>,
    ) -> Result<bool, IdentifyError> {
        let segment = &problem.segments[index];
        let offsets = offset_channels(problem);
        let mut run: Option<SegmentIntegration<'_>> = None;
        let bases: Vec<_> = problem.intersample.iter().map(|kind| intersample::basis(*kind)).collect();
        let mut raw = vec![0.0; self.equations.input.ncols()];
        let (mut polynomials, mut now): (Vec<InputPolynomial>, _) = (Vec::new(), Vec::new());
        let mut finite = true;
        // An uneven step is put together from parts.
        let each = if segment.longest_step_s.is_some() { PARTS_OF_A_STEP } else { 1 };
        let most_steps = problem.options.most_steps.map(|most| most * each * segment.rows as usize);
        segments::read(
            problem.model,
            &problem.datasets[segment.recording],
            segment,
            &problem.intersample,
            |chunk| {
                let capacity = rows.capacity();
                for from in (0..chunk.rows()).step_by(capacity) {
                    let count = capacity.min(chunk.rows() - from);
                    if !finite {
                        return;
                    }
                    for k in from..from + count {
                        // A sample of a stiff model may take many steps.
                        if rows.is_given_up() {
                            finite = false;
                            return;
                        }
                        raw.iter_mut().zip(&chunk.inputs).for_each(|(raw, input)| *raw = input[k]);
                        chunk.inputs_along(k, &bases, &mut polynomials);
                        now.clear();
                        now.extend(polynomials.iter().map(|polynomial| polynomial.at(1.0)));
                        match &mut run {
                            None => run = Some(self.start(problem, index, point, &offsets, &now)),
                            Some(run) => {
                                run.sample(&polynomials, chunk.parts(k, self.hybrid_modes.finest_s));
                            }
                        }
                        run.iter_mut().for_each(|run| run.observe(&raw, &now));
                    }
                    let measured: Vec<&[f64]> =
                        chunk.outputs.iter().map(|o| &o[from..from + count]).collect();
                    finite = run.as_mut().is_none_or(|run| {
                        run.hand_over(count, &measured, rows)
                            && most_steps.is_none_or(|most| run.integrator.attempts <= most)
                    });
                }
            },
        )?;
        rows.unresolved = run.map_or(0, |run| run.unresolved);
        Ok(finite)
    }

    fn start<'s>(
        &'s self,
        problem: &Problem<'_>,
        index: usize,
        point: &'s Point,
        offsets: &'s [usize],
        inputs: &[f64],
    ) -> SegmentIntegration<'s> {
        let nuisance = &point.nuisance[index];
        let (equations, sensitivities) = (self.equations, self.sensitivities);
        let states = equations.state.nrows();
        let (state, moved) = if problem.options.start_state == StartState::Free {
            (nuisance[..states].to_vec(), None)
        } else {
            let x = start_state::equilibrium(equations, &point.values, inputs);
            let moved = x.as_ref().and_then(|x| {
                start_state::equilibrium_sensitivities(
                    equations,
                    sensitivities,
                    &point.values,
                    self.free,
                    inputs,
                    x,
                )
            });
            let state = x.map_or_else(|| vec![0.0; states], |x| x.iter().copied().collect());
            (state, Some(moved.unwrap_or_default()))
        };
        let integrator = Integrator::new(&self.hybrid_modes, DEFAULT_TOLERANCE, &state, inputs);
        let sensitivity = Sensitivity::new(&self.hybrid_modes, &integrator.instant(inputs), moved.as_deref());
        let outputs = equations.output.nrows();
        SegmentIntegration {
            integrator,
            sensitivity,
            weights: self.weights,
            free: sensitivities.len(),
            nuisance,
            offsets,
            values: vec![0.0; outputs],
            predictions: vec![Vec::new(); outputs],
            jacobian: vec![Vec::new(); outputs],
            largest_start: 0.0,
            unresolved: 0,
        }
    }
}

/// The integration of one segment.
struct SegmentIntegration<'s> {
    integrator: Integrator<'s>,
    sensitivity: Sensitivity<'s>,
    weights: &'s Weights,
    free: usize,
    nuisance: &'s [f64],
    offsets: &'s [usize],
    /// Present outputs.
    values: Vec<f64>,
    /// Per output, the predictions of the block's samples so far, and their sensitivities.
    predictions: Vec<Vec<f64>>,
    jacobian: Vec<Vec<f64>>,
    /// Largest sensitivity with respect to the start state so far.
    largest_start: f64,
    /// Samples in which a step missed the tolerance and could not be shortened.
    unresolved: u64,
}

impl SegmentIntegration<'_> {
    fn sample(&mut self, polynomials: &[InputPolynomial], length: Option<usize>) {
        let Self { integrator, sensitivity, .. } = self;
        let before = integrator.unresolved;
        integrator.sample(polynomials, length, |event| sensitivity.apply(event));
        self.unresolved += u64::from(integrator.unresolved > before);
    }

    /// Records outputs and sensitivities of a sample; `inputs` as measured, `held` as reconstructed.
    fn observe(&mut self, inputs: &[f64], held: &[f64]) {
        self.sensitivity.evaluate_output_only(&self.integrator, held);
        self.integrator.outputs(inputs, &mut self.values);
        for (output, value) in self.values.iter().enumerate() {
            self.predictions[output].push(*value);
            self.sensitivity.observe(output, &self.integrator, inputs, &mut self.jacobian[output]);
        }
    }

    /// Adds a block of observed samples to `rows` and clears it.
    fn hand_over(&mut self, count: usize, measured: &[&[f64]], rows: &mut ResidualAccumulator<'_>) -> bool {
        let starting = self.sensitivity.has_start();
        let any_nuisance = starting || !self.offsets.is_empty();
        let finite = rows.fold(count, any_nuisance, &self.weights.noise_std, measured, |output, target| {
            self.write(output, any_nuisance, target);
        });
        if starting {
            self.drop_decayed_start();
        }
        self.predictions.iter_mut().chain(&mut self.jacobian).for_each(Vec::clear);
        finite
    }

    /// One output's rows: [start | offsets | free | prediction], the first two only with `any_nuisance`.
    fn write(&self, output: usize, any_nuisance: bool, target: MatMut<'_, f64>) {
        let unit = 1.0 / self.weights.noise_std[output];
        let starts = self.nuisance.len() - self.offsets.len();
        let nuisance = if any_nuisance { self.nuisance.len() } else { 0 };
        let own =
            self.offsets.iter().position(|channel| *channel == output).map(|position| starts + position);
        let offset = own.map_or(0.0, |own| self.nuisance[own]);
        let stride = self.sensitivity.row_length();
        for (j, column) in target.col_iter_mut().enumerate() {
            let sensitivities =
                |place: usize| self.jacobian[output].iter().skip(place).step_by(stride.max(1));
            let column = column.iter_mut();
            if j == nuisance + self.free {
                column.zip(&self.predictions[output]).for_each(|(t, value)| *t = (value + offset) * unit);
            } else if j >= nuisance {
                let factor = unit * self.weights.scales[j - nuisance];
                let own = sensitivities(self.sensitivity.column_of(j - nuisance));
                column.zip(own).for_each(|(t, sensitivity)| *t = sensitivity * factor);
            } else if j < starts && self.sensitivity.has_start() {
                let own = sensitivities(self.sensitivity.start_columns().start + j);
                column.zip(own).for_each(|(t, sensitivity)| *t = sensitivity * unit);
            } else {
                let value = if own == Some(j) { unit } else { 0.0 };
                column.for_each(|t| *t = value);
            }
        }
    }

    /// Drops the sensitivities with respect to the start state once they have decayed.
    fn drop_decayed_start(&mut self) {
        let (stride, places) = (self.sensitivity.row_length(), self.sensitivity.start_columns());
        let units = &self.weights.noise_std;
        let blocks = self.jacobian.iter().zip(units).flat_map(|(rows, unit)| {
            let places = places.clone();
            let parts = rows.chunks_exact(stride).flat_map(move |row| &row[places.clone()]);
            parts.map(move |sensitivity| sensitivity.abs() / unit)
        });
        let size = blocks.fold(0.0, f64::max);
        self.largest_start = self.largest_start.max(size);
        if size <= DECAYED * self.largest_start && self.largest_start > 0.0 {
            self.sensitivity.drop_start();
        }
    }
}
