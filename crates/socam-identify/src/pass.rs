//! One pass over the data at given parameters: for each stretch, the triangular factor of residuals and slopes.

use std::sync::Arc;

use faer::{Mat, MatRef};
use rayon::prelude::*;
use socam_model::{Equations, effects::Sight};

use crate::{
    IdentifyError,
    colour::{self, Colour},
    discrepancy::Discrepancy,
    feed,
    levels::{self, Probe, Score},
    modal::Modal,
    outliers::{Gate, Track},
    problem::{Problem, StartState},
    start,
    stepper::Stepper,
    triangle::{self, Triangle},
    whitener::NoiseLevels,
};

/// Unknowns at which a pass is made.
#[derive(Debug, Clone)]
pub(crate) struct Point {
    /// All parameters of the model, SI.
    pub(crate) values: Vec<f64>,
    /// For each stretch its local unknowns: start state (if free), then offsets of the outputs that have one.
    pub(crate) locals: Vec<Vec<f64>>,
}

/// What a pass says of one stretch.
pub(crate) struct StretchResult {
    /// Factor over [local | free parameters | residual], residuals weighted by 1/noise, slopes by the scales.
    pub(crate) factor: Mat<f64>,
    /// Row of the factor that holds each local unknown's pivot; `None` where the data do not show it at all: a start term
    /// may be unobservable, decay within a sample, or repeat another. Such a one stays where it is.
    pub(crate) pivots: Vec<Option<usize>>,
    /// Per output: sum of squared residuals (SI), their number, and sums over the measured values.
    pub(crate) channels: Vec<ChannelSums>,
    /// Sum of squared residuals as they were weighted.
    pub(crate) weighted_squares: f64,
    /// Samples, each counted by the share of its outputs that were measured.
    pub(crate) samples: f64,
    /// Of these, samples in which a law was too steep for the shortest step.
    pub(crate) unresolved: u64,
    /// Transposed slopes times residuals, summed over consecutive blocks of [`BLOCK_S`] or [`COMPARED_BLOCK_S`]; over
    /// [local | free]. Only when asked for.
    pub(crate) scores: Vec<Vec<f64>>,
    /// Squared whitened residuals, summed over the same blocks.
    pub(crate) block_squares: Vec<f64>,
    /// Whitened residuals by output, nothing where one is missing. Only when asked for.
    pub(crate) innovations: Vec<Vec<f64>>,
    /// What the residuals say of the noise levels; only when asked for.
    pub(crate) levels: Option<Score>,
    /// What was seen of each output while looking for outliers; only when asked for.
    pub(crate) gate: Option<Vec<Track>>,
}

impl StretchResult {
    pub(crate) fn locals(&self) -> usize {
        self.pivots.len()
    }

    /// What the stretch says of [free parameters | residual] once its local unknowns have followed.
    pub(crate) fn corner(&self) -> MatRef<'_, f64> {
        let (rows, columns) = self.factor.shape();
        let shown = self.pivots.iter().flatten().count();
        self.factor.as_ref().submatrix(shown, self.locals(), rows - shown, columns - self.locals())
    }

    /// Solves for the local unknowns that the data show, `right` being by row of the factor; the others stay zero.
    pub(crate) fn solve_locals(&self, right: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut solution = vec![0.0; self.locals()];
        for (i, row) in self.pivots.iter().enumerate().rev() {
            if let Some(row) = *row {
                let known: f64 = (i + 1..solution.len()).map(|j| self.factor[(row, j)] * solution[j]).sum();
                solution[i] = (right(row) - known) / self.factor[(row, i)];
            }
        }
        solution
    }
}

/// Whether a local unknown's remainder, of a column of this length, shows: moving it by a whole unit must change the residuals by a
/// tenth of the noise. What dies within a sample would else be moved anywhere, and a force law would see it there.
fn shows(remainder: f64, length: f64) -> bool {
    remainder > 0.1 && remainder > 1e-8 * length
}

/// Length of the blocks over which scores are summed, s: longer than residuals stay correlated, those that are compared between models or others.
const COMPARED_BLOCK_S: f64 = 0.2;
const BLOCK_S: f64 = 0.5;

/// Sums of slopes times residuals over blocks of that length, by free parameter.
pub(crate) fn blocks(passed: &[StretchResult], free: usize) -> Vec<Vec<f64>> {
    let all = passed.iter().flat_map(|result| result.scores.iter());
    all.map(|block| block[block.len() - free..].to_vec()).collect()
}

/// Sums over one output channel.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ChannelSums {
    pub(crate) residual_squares: f64,
    pub(crate) count: f64,
    pub(crate) sum: f64,
    pub(crate) squares: f64,
}

impl ChannelSums {
    pub(crate) fn add(&mut self, other: &Self) {
        self.residual_squares += other.residual_squares;
        self.count += other.count;
        self.sum += other.sum;
        self.squares += other.squares;
    }

    pub(crate) fn rms(&self) -> f64 {
        (self.residual_squares / self.count.max(1.0)).sqrt()
    }

    /// Standard deviation of the measured values.
    pub(crate) fn spread(&self) -> f64 {
        let mean = self.sum / self.count.max(1.0);
        (self.squares / self.count.max(1.0) - mean * mean).max(0.0).sqrt()
    }
}

/// How residuals and slopes are weighted in a pass.
#[derive(Clone)]
pub(crate) struct Weights {
    /// Noise standard deviation of each output, SI.
    pub(crate) noise_std: Vec<f64>,
    /// Of each input.
    pub(crate) input_std: Vec<f64>,
    /// Slopes with respect to free parameter j are multiplied by `scales[j]`.
    pub(crate) scales: Vec<f64>,
    /// Whether block scores are wanted.
    pub(crate) scores: bool,
    /// Whether whitened residuals are wanted.
    pub(crate) innovations: bool,
    /// Noise levels under test, one set for each sample time; empty where none are.
    pub(crate) probes: Arc<Vec<(f64, Probe)>>,
    /// Sizes of remainders when outliers are looked for.
    pub(crate) gate: Option<Arc<Vec<f64>>>,
    /// Filters to be used instead of those that follow the parameters.
    pub(crate) frozen: Option<Arc<Vec<Colour>>>,
    /// Levels of the model discrepancy, behind the filters of sensor noise; empty where residuals are taken for sensor noise only.
    pub(crate) discrepancy: Arc<Vec<Discrepancy>>,
}

impl Weights {
    /// White noise of the outputs, no other.
    pub(crate) fn white(noise_std: Vec<f64>, scales: Vec<f64>) -> Self {
        Self {
            noise_std,
            input_std: Vec::new(),
            scales,
            scores: false,
            innovations: false,
            probes: Arc::default(),
            gate: None,
            frozen: None,
            discrepancy: Arc::default(),
        }
    }

    pub(crate) fn levels(&self) -> NoiseLevels {
        NoiseLevels { outputs: self.noise_std.clone(), inputs: self.input_std.clone() }
    }
}

/// The whole pass; `None` where the prediction overflowed.
pub(crate) type PassResult = Option<Vec<StretchResult>>;

/// Runs the model over every stretch, in parallel; the order of the result is that of the stretches.
pub(crate) fn run(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
) -> Result<PassResult, IdentifyError> {
    run_below(problem, point, weights, f64::INFINITY)
}

/// The same, given up as soon as one stretch alone has a sum of squares of more than `most`: what leads there is not wanted, and often
/// takes the shortest steps that there are.
pub(crate) fn run_below(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    most: f64,
) -> Result<PassResult, IdentifyError> {
    let Ok((equations, slopes)) = problem.model.equations_with_slopes(&point.values, &problem.free) else {
        // A step beyond what physics allows; the solver will shorten it.
        return Ok(None);
    };
    let colours = match &weights.frozen {
        Some(frozen) => Arc::clone(frozen),
        None => match colour::all(problem, point, weights, &equations) {
            Some(colours) => Arc::new(colours),
            None => return Ok(None),
        },
    };
    let free_start = problem.options.start_state == StartState::Free;
    let still = if free_start { remembered(&equations) } else { Vec::new() };
    let linear = is_linear(&equations);
    let modal = if linear { Modal::new(problem, &equations, &slopes, point, weights) } else { None };
    // One for each sample time: to make it costs more than a short stretch takes.
    let mut steppers: Vec<(f64, Option<Stepper<'_>>)> = Vec::new();
    for stretch in problem.stretches.iter().filter(|_| modal.is_none()) {
        let time_s = stretch.sample_time_s;
        if steppers.iter().all(|(known_s, _)| *known_s != time_s) {
            let stepper = Stepper::new(problem, &equations, &slopes, point, weights, time_s);
            steppers.push((time_s, stepper));
        }
    }
    let one = |index: usize| -> Result<Option<StretchResult>, IdentifyError> {
        let time_s = problem.stretches[index].sample_time_s;
        let colour = colours.iter().find(|colour| colour.sample_time_s == time_s);
        let mut rows = Rows::new(problem, time_s, weights, colour, point.locals[index].len());
        rows.still.clone_from(&still);
        rows.most = most;
        let stepper = || steppers.iter().find(|(known_s, _)| *known_s == time_s)?.1.as_ref();
        let finite = match &modal {
            Some(modal) => modal.predict(problem, index, point, weights, &mut rows)?,
            None => {
                stepper().map_or(Ok(false), |stepper| stepper.predict(problem, index, point, &mut rows))?
            }
        };
        Ok(if finite { rows.finish() } else { None })
    };
    // One at a time: whoever is free takes the next.
    let stretches = (0..problem.stretches.len()).into_par_iter().with_max_len(1);
    let results: Result<Vec<_>, _> = stretches.map(one).collect();
    Ok(results?.into_iter().collect())
}

/// States of laws of their own: what a coupling remembers of the time before a recording is forgotten at the first reversal, and would
/// else be made to explain what has nothing to do with it. It stays where it begins.
fn remembered(equations: &Equations) -> Vec<usize> {
    let own = equations.ports.iter().enumerate();
    let own = own.filter(|(_, port)| port.law.sights.get(port.sight) == Some(&Sight::State));
    let seen = own.filter_map(|(p, _)| (0..equations.port.ncols()).find(|i| equations.port[(p, *i)] != 0.0));
    seen.collect()
}

/// No law depends on anything.
fn is_linear(equations: &Equations) -> bool {
    equations.ports.iter().all(socam_model::Port::is_constant)
}

/// Local unknowns of a stretch before anything is known: start state from the first samples, offsets zero.
pub(crate) fn first_locals(problem: &Problem<'_>, values: &[f64]) -> Result<Vec<Vec<f64>>, IdentifyError> {
    let equations = problem.model.equations(values)?;
    let offsets = problem.model.outputs().filter(|channel| channel.estimate_offset).count();
    problem
        .stretches
        .iter()
        .map(|stretch| {
            let mut locals = Vec::new();
            if problem.options.start_state == StartState::Free {
                let (inputs, outputs) = first_samples(problem, stretch)?;
                locals = start::guess(&equations, values, &inputs, &outputs);
            }
            locals.extend(std::iter::repeat_n(0.0, offsets));
            Ok(locals)
        })
        .collect()
}

/// First sample of every input and output (NaN where missing) of a stretch.
fn first_samples(
    problem: &Problem<'_>,
    stretch: &feed::Stretch,
) -> Result<(Vec<f64>, Vec<f64>), IdentifyError> {
    let mut first = (Vec::new(), Vec::new());
    let head = feed::Stretch { rows: 2, ..stretch.clone() };
    feed::read(problem.model, &problem.datasets[stretch.recording], &head, &problem.intersample, |chunk| {
        if first.0.is_empty() {
            first.0 = chunk.inputs.iter().map(|input| input[0]).collect();
            first.1 = chunk.outputs.iter().map(|output| output[0]).collect();
        }
    })?;
    Ok(first)
}

/// Takes predictions and slopes, sample by sample or block by block, and folds them.
pub(crate) struct Rows<'w> {
    locals: usize,
    globals: usize,
    with_locals: Triangle,
    without_locals: Triangle,
    channels: Vec<ChannelSums>,
    weighted_squares: f64,
    samples: f64,
    pub(crate) unresolved: u64,
    colour: Option<colour::Course<'w>>,
    discrepancy: Option<&'w Discrepancy>,
    course: Option<levels::Course<'w>>,
    gate: Option<Gate<'w>>,
    scores: Option<Scores>,
    innovations: Option<Vec<Vec<f64>>>,
    present: Vec<bool>,
    /// Local columns that are not to be moved.
    still: Vec<usize>,
    /// Sum of squares at which there is no going on.
    most: f64,
}

impl<'w> Rows<'w> {
    fn new(
        problem: &Problem<'_>,
        sample_time_s: f64,
        weights: &'w Weights,
        colour: Option<&'w Colour>,
        locals: usize,
    ) -> Self {
        let globals = problem.free.len();
        let outputs = problem.outputs();
        let probe = weights.probes.iter().find(|(time_s, _)| *time_s == sample_time_s);
        let block_s = if weights.discrepancy.is_empty() { BLOCK_S } else { COMPARED_BLOCK_S };
        Self {
            locals,
            globals,
            with_locals: Triangle::new(locals + globals + 1),
            without_locals: Triangle::new(globals + 1),
            channels: vec![ChannelSums::default(); outputs],
            weighted_squares: 0.0,
            samples: 0.0,
            unresolved: 0,
            colour: colour.map(|colour| colour.start(locals, globals)),
            discrepancy: Discrepancy::at(&weights.discrepancy, sample_time_s),
            course: probe.map(|(_, probe)| probe.start()),
            gate: weights
                .gate
                .as_ref()
                .map(|sizes| Gate::new(colour.map(|c| &c.whitener), Arc::clone(sizes))),
            scores: weights.scores.then(|| Scores {
                block_rows: (block_s / sample_time_s).ceil().max(1.0) as usize,
                row: 0,
                sums: Vec::new(),
                squares: Vec::new(),
                width: locals + globals,
            }),
            innovations: weights.innovations.then(|| vec![Vec::new(); outputs]),
            present: Vec::new(),
            still: Vec::new(),
            most: f64::INFINITY,
        }
    }

    /// Most samples in one call of [`Rows::take`].
    pub(crate) fn capacity(&self) -> usize {
        (Triangle::capacity() / self.channels.len()).max(1)
    }

    /// Folds a block: `fill(output, target)` writes weighted slopes and, in the last column, the weighted
    /// prediction of all `rows` samples of one output. `measured` holds NaN where nothing was measured.
    /// Without `alive`, local columns are known to be zero and left out.
    pub(crate) fn take(
        &mut self,
        rows: usize,
        alive: bool,
        noise_std: &[f64],
        measured: &[&[f64]],
        mut fill: impl FnMut(usize, faer::MatMut<'_, f64>),
    ) -> bool {
        let outputs = self.channels.len();
        let (triangle, columns) = if alive {
            (&mut self.with_locals, self.locals + self.globals + 1)
        } else {
            (&mut self.without_locals, self.globals + 1)
        };
        let mut target = triangle.rows_mut(rows * outputs);
        let mut finite = true;
        self.present.clear();
        for (output, sums) in self.channels.iter_mut().enumerate() {
            let mut block = target.rb_mut().subrows_mut(output * rows, rows);
            fill(output, block.rb_mut());
            let std = noise_std[output];
            for (k, value) in measured[output].iter().enumerate() {
                self.present.push(!value.is_nan());
                if value.is_nan() {
                    block.rb_mut().row_mut(k).fill(0.0);
                    continue;
                }
                let residual = block[(k, columns - 1)] - value / std;
                block[(k, columns - 1)] = residual;
                sums.residual_squares += (residual * std).powi(2);
                sums.count += 1.0;
                sums.sum += value;
                sums.squares += value * value;
            }
            finite &= sums.residual_squares.is_finite();
        }
        let residuals = target.as_ref().col(columns - 1);
        if let Some(course) = &mut self.course {
            follow(residuals, rows, &self.present, |residual, present| course.take(residual, present));
        }
        if let Some(gate) = &mut self.gate {
            follow(residuals, rows, &self.present, |residual, present| gate.take(residual, present));
        }
        let skipped = if alive { 0 } else { self.locals };
        if let Some(colour) = &mut self.colour {
            colour.apply(target.rb_mut(), rows, &self.present);
        }
        if let Some(discrepancy) = self.discrepancy {
            discrepancy.apply(target.rb_mut(), rows);
        }
        self.weighted_squares += target.as_ref().col(columns - 1).squared_norm_l2();
        self.samples += self.present.iter().filter(|present| **present).count() as f64 / outputs as f64;
        for (output, all) in self.innovations.iter_mut().flatten().enumerate() {
            all.extend(target.as_ref().col(columns - 1).subrows(output * rows, rows).iter());
        }
        if let Some(scores) = &mut self.scores {
            scores.take(target.as_ref(), rows, &self.present, skipped);
        }
        finite && self.weighted_squares <= self.most
    }

    /// `None` where slopes overflowed.
    fn finish(self) -> Option<StretchResult> {
        let columns = self.locals + self.globals + 1;
        let late = self.without_locals.finish();
        let shifted = Mat::from_fn(late.nrows(), columns, |i, j| {
            if j < self.locals { 0.0 } else { late[(i, j - self.locals)] }
        });
        let early = self.with_locals.finish();
        let mut factor = triangle::join([early.as_ref(), shifted.as_ref()].into_iter(), columns);
        let moves = |column: usize| !self.still.contains(&column);
        let pivots = triangle::eliminate(&mut factor, self.locals, |column, remainder, length| {
            moves(column) && shows(remainder, length)
        });
        let (scores, block_squares) =
            self.scores.map(|scores| (scores.sums, scores.squares)).unwrap_or_default();
        let finite = factor.col_iter().all(|column| column.iter().all(|value| value.is_finite()));
        let finite = finite && self.weighted_squares.is_finite();
        finite.then_some(StretchResult {
            factor,
            pivots,
            channels: self.channels,
            weighted_squares: self.weighted_squares,
            samples: self.samples,
            unresolved: self.unresolved,
            scores,
            block_squares,
            innovations: self.innovations.unwrap_or_default(),
            levels: self.course.map(|course| course.score),
            gate: self.gate.map(Gate::finish),
        })
    }
}

/// Shows a block's residuals, sample by sample, to whoever follows them.
fn follow(
    residuals: faer::ColRef<'_, f64>,
    samples: usize,
    present: &[bool],
    mut take: impl FnMut(&[f64], &[bool]),
) {
    let outputs = present.len() / samples.max(1);
    for k in 0..samples {
        let rows = || (0..outputs).map(|o| o * samples + k);
        let residual: Vec<f64> = rows().map(|row| residuals[row]).collect();
        let here: Vec<bool> = rows().map(|row| present[row]).collect();
        take(&residual, &here);
    }
}

use faer::reborrow::ReborrowMut;

/// Block sums of slopes times residuals.
struct Scores {
    block_rows: usize,
    row: usize,
    sums: Vec<Vec<f64>>,
    squares: Vec<f64>,
    width: usize,
}

impl Scores {
    fn take(&mut self, rows: MatRef<'_, f64>, samples: usize, present: &[bool], skipped: usize) {
        let last = rows.ncols() - 1;
        let outputs = present.len() / samples.max(1);
        let mut from = 0;
        while from < samples {
            let block = (self.row + from) / self.block_rows;
            let to = samples.min((block + 1) * self.block_rows - self.row);
            if block >= self.sums.len() {
                self.sums.push(vec![0.0; self.width]);
                self.squares.push(0.0);
            }
            for output in 0..outputs {
                let own = rows.subrows(output * samples + from, to - from);
                let residual = own.col(last);
                self.squares[block] += residual.squared_norm_l2();
                let sums = self.sums[block][skipped..].iter_mut();
                sums.zip(own.col_iter()).for_each(|(sum, slopes)| *sum += slopes.transpose() * residual);
            }
            from = to;
        }
        self.row += samples;
    }
}
