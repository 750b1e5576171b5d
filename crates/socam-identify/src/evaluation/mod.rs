//! One pass over the data at given parameters: for each segment, the triangular factor of residuals and sensitivities.

use std::sync::Arc;

use faer::{Mat, MatRef};
use rayon::prelude::*;
use socam_model::{Equations, effects::LawInput};

use crate::{
    IdentifyError,
    noise::{
        discrepancy::Discrepancy,
        innovations_filter::NoiseLevels,
        levels::{self, PerturbedFilters, Score},
        prewhitening::{self, Prewhitening},
    },
    optimiser::qr::{self, QrAccumulator},
    prediction::{modal::Modal, sensitivity_integrator::SensitivityIntegrator, start_state},
    preprocessing::{
        outlier_detector::{OutlierDetector, OutlierStatistics},
        segments,
    },
    problem::{Problem, StartState},
};

/// Unknowns at which a pass is made.
#[derive(Debug, Clone)]
pub(crate) struct Point {
    /// All parameters of the model, SI.
    pub(crate) values: Vec<f64>,
    /// For each segment its local unknowns: start state (if free), then offsets of the outputs that have one.
    pub(crate) nuisance: Vec<Vec<f64>>,
}

/// What a pass says of one segment.
pub(crate) struct SegmentEvaluation {
    /// Factor over [local | free parameters | residual], residuals weighted by 1/noise, sensitivities by the scales.
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
    /// Transposed sensitivities times residuals, summed over consecutive blocks of [`BLOCK_S`] or [`COMPARED_BLOCK_S`]; over
    /// [local | free]. Only when asked for.
    pub(crate) scores: Vec<Vec<f64>>,
    /// Squared whitened residuals, summed over the same blocks.
    pub(crate) block_squares: Vec<f64>,
    /// Whitened residuals by output, nothing where one is missing. Only when asked for.
    pub(crate) innovations: Vec<Vec<f64>>,
    /// What the residuals say of the noise levels; only when asked for.
    pub(crate) levels: Option<Score>,
    /// What was seen of each output while looking for outliers; only when asked for.
    pub(crate) detector: Option<Vec<OutlierStatistics>>,
}

impl SegmentEvaluation {
    pub(crate) fn nuisance(&self) -> usize {
        self.pivots.len()
    }

    /// What the segment says of [free parameters | residual] once its local unknowns have followed.
    pub(crate) fn schur_complement(&self) -> MatRef<'_, f64> {
        let (rows, columns) = self.factor.shape();
        let shown = self.pivots.iter().flatten().count();
        self.factor.as_ref().submatrix(shown, self.nuisance(), rows - shown, columns - self.nuisance())
    }

    /// Solves for the local unknowns that the data show, `right` being by row of the factor; the others stay zero.
    pub(crate) fn solve_nuisance(&self, right: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut solution = vec![0.0; self.nuisance()];
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

/// Sums of sensitivities times residuals over blocks of that length, by free parameter.
pub(crate) fn blocks(passed: &[SegmentEvaluation], free: usize) -> Vec<Vec<f64>> {
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

/// How residuals and sensitivities are weighted in a pass.
#[derive(Clone)]
pub(crate) struct Weights {
    /// Noise standard deviation of each output, SI.
    pub(crate) noise_std: Vec<f64>,
    /// Of each input.
    pub(crate) input_std: Vec<f64>,
    /// Sensitivities with respect to free parameter j are multiplied by `scales[j]`.
    pub(crate) scales: Vec<f64>,
    /// Whether block scores are wanted.
    pub(crate) scores: bool,
    /// Whether whitened residuals are wanted.
    pub(crate) innovations: bool,
    /// Noise levels under test, one set for each sample time; empty where none are.
    pub(crate) perturbed_filters: Arc<Vec<(f64, PerturbedFilters)>>,
    /// Sizes of remainders when outliers are looked for.
    pub(crate) detector: Option<Arc<Vec<f64>>>,
    /// Filters to be used instead of those that follow the parameters.
    pub(crate) frozen: Option<Arc<Vec<Prewhitening>>>,
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
            perturbed_filters: Arc::default(),
            detector: None,
            frozen: None,
            discrepancy: Arc::default(),
        }
    }

    pub(crate) fn levels(&self) -> NoiseLevels {
        NoiseLevels { outputs: self.noise_std.clone(), inputs: self.input_std.clone() }
    }
}

/// The whole pass; `None` where the prediction overflowed.
pub(crate) type PassResult = Option<Vec<SegmentEvaluation>>;

/// Runs the model over every segment, in parallel; the order of the result is that of the segments.
pub(crate) fn run(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
) -> Result<PassResult, IdentifyError> {
    run_below(problem, point, weights, f64::INFINITY)
}

/// The same, given up as soon as one segment alone has a sum of squares of more than `most`: what leads there is not wanted, and often
/// takes the shortest steps that there are.
pub(crate) fn run_below(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    most: f64,
) -> Result<PassResult, IdentifyError> {
    let Ok((equations, sensitivities)) =
        problem.model.equations_with_derivatives(&point.values, &problem.free)
    else {
        // A step beyond what physics allows; the solver will shorten it.
        return Ok(None);
    };
    let prewhitenings = match &weights.frozen {
        Some(frozen) => Arc::clone(frozen),
        None => match prewhitening::all(problem, point, weights, &equations) {
            Some(prewhitenings) => Arc::new(prewhitenings),
            None => return Ok(None),
        },
    };
    let free_start = problem.options.start_state == StartState::Free;
    let still = if free_start { remembered(&equations) } else { Vec::new() };
    let linear = is_linear(&equations);
    let modal = if linear { Modal::new(problem, &equations, &sensitivities, point, weights) } else { None };
    // One for each sample time: to make it costs more than a short segment takes.
    let mut integrators: Vec<(f64, Option<SensitivityIntegrator<'_>>)> = Vec::new();
    for segment in problem.segments.iter().filter(|_| modal.is_none()) {
        let time_s = segment.sample_time_s;
        if integrators.iter().all(|(known_s, _)| *known_s != time_s) {
            let integrator =
                SensitivityIntegrator::new(problem, &equations, &sensitivities, point, weights, time_s);
            integrators.push((time_s, integrator));
        }
    }
    let one = |index: usize| -> Result<Option<SegmentEvaluation>, IdentifyError> {
        let time_s = problem.segments[index].sample_time_s;
        let prewhitening = prewhitenings.iter().find(|prewhitening| prewhitening.sample_time_s == time_s);
        let mut rows =
            ResidualAccumulator::new(problem, time_s, weights, prewhitening, point.nuisance[index].len());
        rows.still.clone_from(&still);
        rows.most = most;
        let integrator = || integrators.iter().find(|(known_s, _)| *known_s == time_s)?.1.as_ref();
        let finite = match &modal {
            Some(modal) => modal.predict(problem, index, point, weights, &mut rows)?,
            None => integrator()
                .map_or(Ok(false), |integrator| integrator.predict(problem, index, point, &mut rows))?,
        };
        Ok(if finite { rows.finish() } else { None })
    };
    // One at a time: whoever is free takes the next.
    let segments = (0..problem.segments.len()).into_par_iter().with_max_len(1);
    let results: Result<Vec<_>, _> = segments.map(one).collect();
    Ok(results?.into_iter().collect())
}

/// States of laws of their own: what a coupling remembers of the time before a recording is forgotten at the first reversal, and would
/// else be made to explain what has nothing to do with it. It stays where it begins.
fn remembered(equations: &Equations) -> Vec<usize> {
    let own = equations.ports.iter().enumerate();
    let own = own.filter(|(_, port)| port.law.law_inputs.get(port.law_input) == Some(&LawInput::State));
    let seen = own.filter_map(|(p, _)| (0..equations.port.ncols()).find(|i| equations.port[(p, *i)] != 0.0));
    seen.collect()
}

/// No law depends on anything.
fn is_linear(equations: &Equations) -> bool {
    equations.ports.iter().all(socam_model::Port::is_constant)
}

/// Local unknowns of a segment before anything is known: start state from the first samples, offsets zero.
pub(crate) fn first_nuisance(problem: &Problem<'_>, values: &[f64]) -> Result<Vec<Vec<f64>>, IdentifyError> {
    let equations = problem.model.equations(values)?;
    let offsets = problem.model.outputs().filter(|channel| channel.estimate_offset).count();
    problem
        .segments
        .iter()
        .map(|segment| {
            let mut nuisance = Vec::new();
            if problem.options.start_state == StartState::Free {
                let (inputs, outputs) = first_samples(problem, segment)?;
                nuisance = start_state::guess(&equations, values, &inputs, &outputs);
            }
            nuisance.extend(std::iter::repeat_n(0.0, offsets));
            Ok(nuisance)
        })
        .collect()
}

/// First sample of every input and output (NaN where missing) of a segment.
fn first_samples(
    problem: &Problem<'_>,
    segment: &segments::Segment,
) -> Result<(Vec<f64>, Vec<f64>), IdentifyError> {
    let mut first = (Vec::new(), Vec::new());
    let head = segments::Segment { rows: 2, ..segment.clone() };
    segments::read(
        problem.model,
        &problem.datasets[segment.recording],
        &head,
        &problem.intersample,
        |chunk| {
            if first.0.is_empty() {
                first.0 = chunk.inputs.iter().map(|input| input[0]).collect();
                first.1 = chunk.outputs.iter().map(|output| output[0]).collect();
            }
        },
    )?;
    Ok(first)
}

/// Takes predictions and sensitivities, sample by sample or block by block, and folds them.
pub(crate) struct ResidualAccumulator<'w> {
    nuisance: usize,
    globals: usize,
    with_nuisance: QrAccumulator,
    without_nuisance: QrAccumulator,
    channels: Vec<ChannelSums>,
    weighted_squares: f64,
    samples: f64,
    pub(crate) unresolved: u64,
    prewhitening: Option<prewhitening::PrewhiteningState<'w>>,
    discrepancy: Option<&'w Discrepancy>,
    course: Option<levels::LevelScore<'w>>,
    detector: Option<OutlierDetector<'w>>,
    scores: Option<Scores>,
    innovations: Option<Vec<Vec<f64>>>,
    present: Vec<bool>,
    /// Local columns that are not to be moved.
    still: Vec<usize>,
    /// Sum of squares at which there is no going on.
    most: f64,
}

impl<'w> ResidualAccumulator<'w> {
    fn new(
        problem: &Problem<'_>,
        sample_time_s: f64,
        weights: &'w Weights,
        prewhitening: Option<&'w Prewhitening>,
        nuisance: usize,
    ) -> Self {
        let globals = problem.free.len();
        let outputs = problem.outputs();
        let perturbed = weights.perturbed_filters.iter().find(|(time_s, _)| *time_s == sample_time_s);
        let block_s = if weights.discrepancy.is_empty() { BLOCK_S } else { COMPARED_BLOCK_S };
        Self {
            nuisance,
            globals,
            with_nuisance: QrAccumulator::new(nuisance + globals + 1),
            without_nuisance: QrAccumulator::new(globals + 1),
            channels: vec![ChannelSums::default(); outputs],
            weighted_squares: 0.0,
            samples: 0.0,
            unresolved: 0,
            prewhitening: prewhitening.map(|prewhitening| prewhitening.start(nuisance, globals)),
            discrepancy: Discrepancy::at(&weights.discrepancy, sample_time_s),
            course: perturbed.map(|(_, perturbed)| perturbed.start()),
            detector: weights
                .detector
                .as_ref()
                .map(|sizes| OutlierDetector::new(prewhitening.map(|c| &c.filter), Arc::clone(sizes))),
            scores: weights.scores.then(|| Scores {
                block_rows: (block_s / sample_time_s).ceil().max(1.0) as usize,
                row: 0,
                sums: Vec::new(),
                squares: Vec::new(),
                width: nuisance + globals,
            }),
            innovations: weights.innovations.then(|| vec![Vec::new(); outputs]),
            present: Vec::new(),
            still: Vec::new(),
            most: f64::INFINITY,
        }
    }

    /// Most samples in one call of [`ResidualAccumulator::take`].
    pub(crate) fn capacity(&self) -> usize {
        (QrAccumulator::capacity() / self.channels.len()).max(1)
    }

    /// Folds a block: `fill(output, target)` writes weighted sensitivities and, in the last column, the weighted
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
            (&mut self.with_nuisance, self.nuisance + self.globals + 1)
        } else {
            (&mut self.without_nuisance, self.globals + 1)
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
        if let Some(detector) = &mut self.detector {
            follow(residuals, rows, &self.present, |residual, present| detector.take(residual, present));
        }
        let skipped = if alive { 0 } else { self.nuisance };
        if let Some(prewhitening) = &mut self.prewhitening {
            prewhitening.apply(target.rb_mut(), rows, &self.present);
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

    /// `None` where sensitivities overflowed.
    fn finish(self) -> Option<SegmentEvaluation> {
        let columns = self.nuisance + self.globals + 1;
        let late = self.without_nuisance.finish();
        let shifted = Mat::from_fn(late.nrows(), columns, |i, j| {
            if j < self.nuisance { 0.0 } else { late[(i, j - self.nuisance)] }
        });
        let early = self.with_nuisance.finish();
        let mut factor = qr::join([early.as_ref(), shifted.as_ref()].into_iter(), columns);
        let moves = |column: usize| !self.still.contains(&column);
        let pivots = qr::eliminate(&mut factor, self.nuisance, |column, remainder, length| {
            moves(column) && shows(remainder, length)
        });
        let (scores, block_squares) =
            self.scores.map(|scores| (scores.sums, scores.squares)).unwrap_or_default();
        let finite = factor.col_iter().all(|column| column.iter().all(|value| value.is_finite()));
        let finite = finite && self.weighted_squares.is_finite();
        finite.then_some(SegmentEvaluation {
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
            detector: self.detector.map(OutlierDetector::finish),
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

/// Block sums of sensitivities times residuals.
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
                sums.zip(own.col_iter())
                    .for_each(|(sum, sensitivities)| *sum += sensitivities.transpose() * residual);
            }
            from = to;
        }
        self.row += samples;
    }
}
