//! Prediction of a model whose force laws bend it, with exact sensitivities of exactly the steps that are taken.
//!
//! A [`Walker`] finds the steps; only those that it takes are differentiated ([`Sensitivity`]), so that steps which turn out
//! too long cost little.

use faer::MatMut;
use socam_model::Equations;

use crate::{
    IdentifyError,
    between::{self, Course},
    feed,
    modal::offset_channels,
    pass::{Point, Rows, Weights},
    problem::{Problem, StartState},
    regimes::Regimes,
    sensitivity::Sensitivity,
    start,
    walker::{DEFAULT_TOLERANCE, Walker},
};

/// Start terms whose effect has shrunk to this are over.
const DECAYED: f64 = 1e-13;

/// A model at one parameter vector and sample time, ready for any stretch.
pub(crate) struct Stepper<'a> {
    equations: &'a Equations,
    slopes: &'a [Equations],
    free: &'a [usize],
    weights: &'a Weights,
    regimes: Regimes,
}

impl<'a> Stepper<'a> {
    /// `None` where the exponential overflows.
    pub(crate) fn new(
        problem: &'a Problem<'_>,
        equations: &'a Equations,
        slopes: &'a [Equations],
        point: &Point,
        weights: &'a Weights,
        sample_time_s: f64,
    ) -> Option<Self> {
        Some(Self {
            equations,
            slopes,
            free: &problem.free,
            weights,
            regimes: Regimes::new(equations, slopes, &point.values, &problem.free, sample_time_s)?,
        })
    }

    /// Runs one stretch into `rows`; false where the prediction overflowed.
    pub(crate) fn predict(
        &self,
        problem: &Problem<'_>,
        index: usize,
        point: &Point,
        rows: &mut Rows<'_>,
    ) -> Result<bool, IdentifyError> {
        let stretch = &problem.stretches[index];
        let offsets = offset_channels(problem);
        let mut run: Option<Run<'_>> = None;
        let pieces: Vec<_> = problem.intersample.iter().map(|kind| between::pieces(*kind)).collect();
        let mut raw = vec![0.0; self.equations.input.ncols()];
        let (mut course, mut now) = (Vec::new(), Vec::new());
        let mut finite = true;
        let most_steps = problem.options.most_steps.map(|most| most * stretch.rows as usize);
        feed::read(
            problem.model,
            &problem.datasets[stretch.recording],
            stretch,
            &problem.intersample,
            |chunk| {
                let capacity = rows.capacity();
                for from in (0..chunk.rows()).step_by(capacity) {
                    let count = capacity.min(chunk.rows() - from);
                    if !finite {
                        return;
                    }
                    for k in from..from + count {
                        raw.iter_mut().zip(&chunk.inputs).for_each(|(raw, input)| *raw = input[k]);
                        course.clear();
                        let along = chunk.held.iter().zip(&pieces);
                        course.extend(along.map(|(held, pieces)| Course::new(pieces, &held[k..])));
                        now.clear();
                        now.extend(course.iter().map(|course| course.at(1.0)));
                        match &mut run {
                            None => run = Some(self.start(problem, index, point, &offsets, &now)),
                            Some(run) => run.sample(&course),
                        }
                        run.iter_mut().for_each(|run| run.observe(&raw, &now));
                    }
                    let measured: Vec<&[f64]> =
                        chunk.outputs.iter().map(|o| &o[from..from + count]).collect();
                    finite = run.as_mut().is_none_or(|run| {
                        run.hand_over(count, &measured, rows)
                            && most_steps.is_none_or(|most| run.walker.attempts <= most)
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
    ) -> Run<'s> {
        let locals = &point.locals[index];
        let (equations, slopes) = (self.equations, self.slopes);
        let states = equations.state.nrows();
        let (state, moved) = if problem.options.start_state == StartState::Free {
            (locals[..states].to_vec(), None)
        } else {
            let x = start::equilibrium(equations, &point.values, inputs);
            let moved = x.as_ref().and_then(|x| {
                start::equilibrium_slopes(equations, slopes, &point.values, self.free, inputs, x)
            });
            let state = x.map_or_else(|| vec![0.0; states], |x| x.iter().copied().collect());
            (state, Some(moved.unwrap_or_default()))
        };
        let walker = Walker::new(&self.regimes, DEFAULT_TOLERANCE, &state, inputs);
        let sensitivity = Sensitivity::new(&self.regimes, &walker.instant(inputs), moved.as_deref());
        let outputs = equations.output.nrows();
        Run {
            walker,
            sensitivity,
            weights: self.weights,
            free: slopes.len(),
            locals,
            offsets,
            values: vec![0.0; outputs],
            predictions: vec![Vec::new(); outputs],
            jacobian: vec![Vec::new(); outputs],
            largest_start: 0.0,
            unresolved: 0,
        }
    }
}

/// One stretch.
struct Run<'s> {
    walker: Walker<'s>,
    sensitivity: Sensitivity<'s>,
    weights: &'s Weights,
    free: usize,
    locals: &'s [f64],
    offsets: &'s [usize],
    /// Outputs now.
    values: Vec<f64>,
    /// Per output, those of the block's samples so far, and their slopes.
    predictions: Vec<Vec<f64>>,
    jacobian: Vec<Vec<f64>>,
    /// Largest slope with respect to the start state so far.
    largest_start: f64,
    /// Samples in which a step missed the tolerance and could not be shortened.
    unresolved: u64,
}

impl Run<'_> {
    fn sample(&mut self, course: &[Course]) {
        let Self { walker, sensitivity, .. } = self;
        let before = walker.unresolved;
        walker.sample(course, |event| sensitivity.follow(event));
        self.unresolved += u64::from(walker.unresolved > before);
    }

    /// `inputs` as measured, and as `held`.
    fn observe(&mut self, inputs: &[f64], held: &[f64]) {
        self.sensitivity.read(&self.walker, held);
        self.walker.outputs(inputs, &mut self.values);
        for (output, value) in self.values.iter().enumerate() {
            self.predictions[output].push(*value);
            self.sensitivity.observe(output, &self.walker, inputs, &mut self.jacobian[output]);
        }
    }

    /// Folds a block of samples that have been observed.
    fn hand_over(&mut self, count: usize, measured: &[&[f64]], rows: &mut Rows<'_>) -> bool {
        let starting = self.sensitivity.starting();
        let alive = starting || !self.offsets.is_empty();
        let finite = rows.take(count, alive, &self.weights.noise_std, measured, |output, target| {
            self.write(output, alive, target);
        });
        if starting {
            self.forget_start();
        }
        self.predictions.iter_mut().chain(&mut self.jacobian).for_each(Vec::clear);
        finite
    }

    /// One output's rows: [start | offsets | free | prediction], the first two only where something is alive there.
    fn write(&self, output: usize, alive: bool, target: MatMut<'_, f64>) {
        let unit = 1.0 / self.weights.noise_std[output];
        let starts = self.locals.len() - self.offsets.len();
        let locals = if alive { self.locals.len() } else { 0 };
        let own =
            self.offsets.iter().position(|channel| *channel == output).map(|position| starts + position);
        let offset = own.map_or(0.0, |own| self.locals[own]);
        let stride = self.sensitivity.observed();
        for (j, column) in target.col_iter_mut().enumerate() {
            let slopes = |place: usize| self.jacobian[output].iter().skip(place).step_by(stride.max(1));
            let column = column.iter_mut();
            if j == locals + self.free {
                column.zip(&self.predictions[output]).for_each(|(t, value)| *t = (value + offset) * unit);
            } else if j >= locals {
                let factor = unit * self.weights.scales[j - locals];
                let own = slopes(self.sensitivity.place(j - locals));
                column.zip(own).for_each(|(t, slope)| *t = slope * factor);
            } else if j < starts && self.sensitivity.starting() {
                let own = slopes(self.sensitivity.start_places().start + j);
                column.zip(own).for_each(|(t, slope)| *t = slope * unit);
            } else {
                let value = if own == Some(j) { unit } else { 0.0 };
                column.for_each(|t| *t = value);
            }
        }
    }

    /// Drops the slopes with respect to the start state once they have decayed.
    fn forget_start(&mut self) {
        let (stride, places) = (self.sensitivity.observed(), self.sensitivity.start_places());
        let units = &self.weights.noise_std;
        let blocks = self.jacobian.iter().zip(units).flat_map(|(rows, unit)| {
            let places = places.clone();
            let parts = rows.chunks_exact(stride).flat_map(move |row| &row[places.clone()]);
            parts.map(move |slope| slope.abs() / unit)
        });
        let size = blocks.fold(0.0, f64::max);
        self.largest_start = self.largest_start.max(size);
        if size <= DECAYED * self.largest_start && self.largest_start > 0.0 {
            self.sensitivity.drop_start();
        }
    }
}
