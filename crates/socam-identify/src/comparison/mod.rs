//! Models compared on equal terms: the same recordings, the same noise, the same filters.
//!
//! Whether a model explains recordings better than another one is seen in the sum of squares of what both leave, provided that
//! both are measured by one [`NoiseModel`]: noise levels and whitening filters of one reference model, which then stay. A fit
//! by it is an ordinary descent ([`descend`]); how much a further parameter would help is foretold without one ([`screen`]).

pub mod cross_validation;

use std::sync::Arc;

use faer::{Mat, MatRef};
use rayon::prelude::*;
use socam_model::Model;

use crate::{
    IdentifyError,
    evaluation::{self, Point, SegmentEvaluation, Weights},
    noise::{
        discrepancy::Discrepancy,
        innovations_filter::NoiseLevels,
        input_noise, levels,
        prewhitening::{self, Prewhitening},
    },
    optimiser::{descent, qr},
    prediction::{
        modal,
        predictor::{Predictor, Start},
    },
    preprocessing::segments,
    problem::{Problem, StartState, sample_times},
    progress::Stage,
    report::End,
};

/// A descent ends when a step promises less than this of the sum of squares, in units of noise as strong as what is left: where
/// models are compared, and where values matter.
pub const COARSE: f64 = 2.0;
/// See [`COARSE`].
pub const FINE: f64 = 0.05;
/// Parameters that stand for one effect; more are points of a curve, which may be next to dependent on one another and are kept
/// small by a pull of [`RIDGE`] of what the data say of each.
const FEW: usize = 4;
const RIDGE: f64 = 1e-3;
/// Columns of which so little is left beside others are nothing of their own.
const LEAST_OWN: f64 = 1e-7;

/// Noise as it is taken to be while models are compared.
#[derive(Debug, Clone)]
pub struct NoiseModel {
    levels: NoiseLevels,
    prewhitenings: Arc<Vec<Prewhitening>>,
    discrepancy: Arc<Vec<Discrepancy>>,
    excess: f64,
}

impl NoiseModel {
    /// From a reference model at parameter `values` (SI) and noise `levels` of its channels; for all recordings that `problems` are
    /// about. Where no steady filter exists, inputs are taken as exact.
    ///
    /// # Errors
    /// When the equations cannot be formed, or there is no problem.
    pub fn new(
        problems: &[&Problem<'_>],
        values: &[f64],
        levels: NoiseLevels,
    ) -> Result<Self, IdentifyError> {
        let first = problems.first().ok_or(IdentifyError::NoRecordings)?;
        let equations = first.model.equations(values)?;
        let mut times: Vec<f64> = problems.iter().flat_map(|problem| sample_times(problem)).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let exact = NoiseLevels { inputs: vec![0.0; levels.inputs.len()], ..levels.clone() };
        let prewhitenings = prewhitening::fixed(&equations, &levels, &times, &first.intersample);
        Ok(match prewhitenings {
            Some(mut prewhitenings) => {
                for prewhitening in &mut prewhitenings {
                    prewhitening.reduce();
                }
                Self {
                    levels,
                    prewhitenings: Arc::new(prewhitenings),
                    discrepancy: Arc::default(),
                    excess: 1.0,
                }
            }
            None => Self {
                levels: exact,
                prewhitenings: Arc::default(),
                discrepancy: Arc::default(),
                excess: 1.0,
            },
        })
    }

    /// The same sensor noise with the model discrepancy that the residuals of an evaluation (`at`, of `problem`'s model) show: one
    /// level per output. `None` where the prediction overflows.
    ///
    /// # Errors
    /// When a recording cannot be read.
    pub fn with_discrepancy(
        &self,
        problem: &Problem<'_>,
        at: &Evaluation,
    ) -> Result<Option<Self>, IdentifyError> {
        let sensor = Self { discrepancy: Arc::default(), ..self.clone() };
        let Some(white) = innovations(problem, &sensor, at)? else { return Ok(None) };
        let segments: Vec<_> = white.iter().map(|one| (one.sample_time_s, &*one.outputs)).collect();
        let present =
            || segments.iter().flat_map(|(_, outputs)| outputs.iter().flatten()).filter(|v| **v != 0.0);
        let excess = present().map(|v| v * v).sum::<f64>() / present().count().max(1) as f64;
        Ok(Some(Self { discrepancy: Arc::new(Discrepancy::estimate(&segments)), excess, ..sensor }))
    }

    /// The same levels, but without the filter that input noise asks for.
    #[must_use]
    pub fn with_exact_inputs(&self) -> Self {
        Self { prewhitenings: Arc::default(), ..self.clone() }
    }

    /// Mean square of the residuals from which the discrepancy was estimated, in units of sensor noise: 1 where nothing is missing.
    pub fn excess(&self) -> f64 {
        self.excess
    }

    /// The noise levels.
    pub fn levels(&self) -> &NoiseLevels {
        &self.levels
    }

    pub(crate) fn weights(&self, problem: &Problem<'_>, values: &[f64]) -> Weights {
        Weights {
            frozen: Some(Arc::clone(&self.prewhitenings)),
            discrepancy: Arc::clone(&self.discrepancy),
            ..Weights::white(self.levels.outputs.clone(), descent::scales(problem, values))
        }
    }
}

/// A model at parameter values, measured by a noise_model.
#[derive(Debug, Clone)]
pub struct Evaluation {
    /// All parameters, SI.
    pub values: Vec<f64>,
    /// Sum of squared whitened residuals of each recording.
    pub chi2: Vec<f64>,
    /// Values that each recording has.
    pub count: Vec<f64>,
    /// Root mean square residual of each output before whitening, SI; nothing where nothing was read.
    pub rms: Vec<f64>,
    /// Values that each output has.
    pub read: Vec<f64>,
    /// Whether the descent that led here came to its end.
    pub converged: bool,
    /// What is local to each segment.
    nuisance: Vec<Vec<f64>>,
}

impl Evaluation {
    /// Of all recordings.
    pub fn total(&self) -> f64 {
        self.chi2.iter().sum()
    }

    /// What was measured on one recording of `problem`, as if there were no other; channels' residuals stay those of all.
    #[must_use]
    pub fn on_one(&self, problem: &Problem<'_>, recording: usize) -> Self {
        let own = problem.segments.iter().zip(&self.nuisance);
        let own = own.filter(|(segment, _)| segment.recording == recording);
        Self {
            chi2: vec![self.chi2[recording]],
            count: vec![self.count[recording]],
            nuisance: own.map(|(_, nuisance)| nuisance.clone()).collect(),
            ..self.clone()
        }
    }
}

/// Goes down from `start` (all parameters, SI; start states as in `from`, where the model has the same) by a noise_model; `None`
/// where the model overflows there.
///
/// # Errors
/// When a recording cannot be read.
pub fn descend(
    problem: &Problem<'_>,
    noise_model: &NoiseModel,
    start: &[f64],
    from: Option<(&Model, &Evaluation)>,
    (tolerance, max_iterations): (f64, usize),
) -> Result<Option<Evaluation>, IdentifyError> {
    let Some(point) = begin(problem, start, from)? else { return Ok(None) };
    let weights = noise_model.weights(problem, start);
    let stage = Stage::Descent { round: 1 };
    match descent::descend(problem, point, weights, tolerance, max_iterations, stage) {
        Ok(descent) => {
            let converged = matches!(descent.end, End::Converged | End::AtBound);
            Ok(Some(measured(problem, &descent.point, &descent.passed, converged)))
        }
        Err(IdentifyError::Diverged { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

/// The model at given values; only what is local to a recording is fitted to it.
///
/// # Errors
/// When a recording cannot be read.
pub fn measure(
    problem: &Problem<'_>,
    noise_model: &NoiseModel,
    values: &[f64],
) -> Result<Option<Evaluation>, IdentifyError> {
    let problem = levels::without_parameters(problem);
    let Some(point) = begin(&problem, values, None)? else { return Ok(None) };
    let weights = noise_model.weights(&problem, values);
    let Some(at) = descent::with_nuisance_fitted(&problem, point, weights)? else { return Ok(None) };
    Ok(Some(measured(&problem, &at.point, &at.passed, true)))
}

/// How much freeing parameters would help, foretold from sensitivities.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateScore {
    /// Fall of the sum of squares, from what it is at the values.
    pub gain: f64,
    /// Sum of squares at the values.
    pub total: f64,
    /// Step of each parameter, SI; none for one that moves nothing.
    pub step: Vec<f64>,
    /// Standard error of each, SI, as far as noise goes; infinite for one that moves nothing.
    pub std: Vec<f64>,
    /// Change of the first parameter alone that moves the sum of squares by one, SI; infinite where nothing does.
    pub resolution: f64,
    /// Efficient scores (those of the group with what the base can do taken out), block by block of 0.2 s in the order of the recordings,
    /// by parameter of the group; none where the group moves nothing.
    pub scores: Vec<Vec<f64>>,
}

/// For each of `groups` (indices of free parameters that belong together) what freeing it along with `base` would do; `at` was
/// measured with `model`. `None` where sensitivities overflow.
///
/// # Errors
/// When a recording cannot be read.
pub fn score_test(
    problem: &Problem<'_>,
    noise_model: &NoiseModel,
    values: &[f64],
    (model, at): (&Model, &Evaluation),
    base: &[usize],
    groups: &[Vec<usize>],
) -> Result<Option<Vec<CandidateScore>>, IdentifyError> {
    let Some(point) = begin(problem, values, Some((model, at)))? else { return Ok(None) };
    let weights = Weights { scores: true, ..noise_model.weights(problem, values) };
    let Some(passed) = evaluation::run(problem, &point, &weights)? else { return Ok(None) };
    let free = problem.free.len();
    let factor = qr::join(passed.iter().map(SegmentEvaluation::schur_complement), free + 1);
    let column = |index: &usize| problem.free.iter().position(|free| free == index);
    let base: Vec<usize> = base.iter().filter_map(column).collect();
    let blocks = evaluation::blocks(&passed, free);
    let picture = Picture { total: descent::squares(&passed), ..Picture::new(factor.as_ref(), base) };
    let each = groups.iter().map(|group| {
        let own: Vec<usize> = group.iter().filter_map(column).collect();
        let mut promise = picture.promise(&own, &blocks);
        for values in [&mut promise.step, &mut promise.std] {
            values.iter_mut().zip(&own).for_each(|(value, column)| *value *= weights.scales[*column]);
        }
        promise.resolution *= own.first().map_or(1.0, |column| weights.scales[*column]);
        promise
    });
    Ok(Some(each.collect()))
}

/// Sensitivities of all parameters with those of the base taken out.
struct Picture<'f> {
    factor: MatRef<'f, f64>,
    base: Vec<usize>,
    /// Orthonormal columns that span the base's sensitivities, and how they are made of them.
    span: Mat<f64>,
    made: Mat<f64>,
    /// Sum of squares.
    total: f64,
}

impl<'f> Picture<'f> {
    fn new(factor: MatRef<'f, f64>, base: Vec<usize>) -> Self {
        let rows = factor.nrows();
        let lengths: Vec<f64> =
            base.iter().map(|j| factor.col(*j).norm_l2().max(f64::MIN_POSITIVE)).collect();
        let scaled = Mat::from_fn(rows, base.len(), |i, j| factor[(i, base[j])] / lengths[j]);
        let (mut span, mut made) = (Mat::zeros(rows, 0), Mat::zeros(base.len(), 0));
        if let Ok(svd) = scaled.thin_svd() {
            let sizes: Vec<f64> = (0..base.len().min(rows)).map(|k| svd.S()[k]).collect();
            let kept: Vec<usize> = (0..sizes.len()).filter(|k| sizes[*k] > 1e-6 * sizes[0]).collect();
            span = Mat::from_fn(rows, kept.len(), |i, k| svd.U()[(i, kept[k])]);
            made = Mat::from_fn(base.len(), kept.len(), |j, k| {
                svd.V()[(j, kept[k])] / (sizes[kept[k]] * lengths[j])
            });
        }
        Self { factor, base, span, made, total: 0.0 }
    }

    /// A column without what the base can do, and how much of each of the base's columns was taken from it.
    fn own(&self, column: usize) -> (Vec<f64>, Vec<f64>) {
        let full = self.factor.col(column);
        let shares: Vec<f64> = (0..self.span.ncols())
            .map(|k| (0..full.nrows()).map(|i| self.span[(i, k)] * full[i]).sum())
            .collect();
        let rest = (0..full.nrows())
            .map(|i| full[i] - (0..shares.len()).map(|k| self.span[(i, k)] * shares[k]).sum::<f64>())
            .collect();
        let taken = (0..self.base.len())
            .map(|j| (0..shares.len()).map(|k| self.made[(j, k)] * shares[k]).sum())
            .collect();
        (rest, taken)
    }

    fn promise(&self, group: &[usize], blocks: &[Vec<f64>]) -> CandidateScore {
        let nothing = CandidateScore {
            gain: 0.0,
            total: self.total,
            step: vec![0.0; group.len()],
            std: vec![f64::INFINITY; group.len()],
            resolution: f64::INFINITY,
            scores: Vec::new(),
        };
        let (residual, _) = self.own(self.factor.ncols() - 1);
        let own: Vec<(Vec<f64>, Vec<f64>)> = group.iter().map(|column| self.own(*column)).collect();
        let lengths: Vec<f64> = own.iter().map(|(rest, _)| length(rest)).collect();
        let counts = |k: &usize| {
            lengths[*k] > LEAST_OWN * self.factor.col(group[*k]).norm_l2() && lengths[*k].is_normal()
        };
        let kept: Vec<usize> = (0..group.len()).filter(counts).collect();
        // Of a few that belong together each has to count; of many, those do that were excited.
        if kept.is_empty() || (kept.len() < group.len() && group.len() <= FEW) {
            return nothing;
        }
        let n = kept.len();
        let sensitivities = Mat::from_fn(residual.len(), n, |i, k| own[kept[k]].0[i] / lengths[kept[k]]);
        let right = Mat::from_fn(residual.len(), 1, |i, _| -residual[i]);
        let ridge = if n > FEW { RIDGE } else { 0.0 };
        let gram =
            sensitivities.transpose() * &sensitivities + Mat::<f64>::identity(n, n) * faer::Scale(ridge);
        let Some(step) = solved(&gram, &(sensitivities.transpose() * right)) else { return nothing };
        let rest = |i: usize| residual[i] + (0..n).map(|k| sensitivities[(i, k)] * step[k]).sum::<f64>();
        let after: f64 = (0..residual.len()).map(|i| rest(i).powi(2)).sum();
        let gain = (residual.iter().map(|r| r * r).sum::<f64>() - after).max(0.0);
        // Scores of the group's own part, block by block.
        let scores: Vec<Vec<f64>> = blocks
            .iter()
            .map(|block| {
                let each = kept.iter().map(|k| {
                    let base: f64 =
                        self.base.iter().zip(&own[*k].1).map(|(j, share)| block[*j] * share).sum();
                    (block[group[*k]] - base) / lengths[*k]
                });
                each.collect()
            })
            .collect();
        let mut promise = CandidateScore { gain, resolution: 1.0 / lengths[kept[0]], scores, ..nothing };
        for (index, k) in kept.iter().enumerate() {
            let unit = Mat::from_fn(n, 1, |i, _| f64::from(i == index));
            let variance = solved(&gram, &unit).map_or(f64::INFINITY, |column| column[index]);
            promise.step[*k] = step[index] / lengths[*k];
            promise.std[*k] = variance.max(0.0).sqrt() / lengths[*k];
        }
        promise
    }
}

fn length(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Solution of a small symmetric system; `None` where it is singular.
fn solved(matrix: &Mat<f64>, right: &Mat<f64>) -> Option<Vec<f64>> {
    use faer::linalg::solvers::Solve;
    let llt = matrix.llt(faer::Side::Lower).ok()?;
    let solution = llt.solve(right);
    (0..matrix.nrows()).map(|k| Some(solution[(k, 0)]).filter(|value| value.is_finite())).collect()
}

/// Noise levels that a model's residuals speak for: none more than its channel's highest frequencies can hold, see
/// [`crate::Noise::Estimated`]. Levels that the model file gives stay.
///
/// # Errors
/// When a recording cannot be read.
pub fn noise(
    problem: &Problem<'_>,
    at: &Evaluation,
    before: &NoiseLevels,
) -> Result<NoiseLevels, IdentifyError> {
    let most = input_noise::most(problem)?;
    let known = problem.model.outputs().map(|channel| channel.noise_std);
    let outputs =
        known.zip(&at.rms).zip(&most.outputs).map(|((known, rms), most)| known.unwrap_or(rms.min(*most)));
    let point = Point { values: at.values.clone(), nuisance: at.nuisance.clone() };
    let inputs: Vec<f64> = most
        .inputs
        .iter()
        .enumerate()
        .map(|(k, most)| before.inputs.get(k).map_or(*most, |b| b.min(*most)))
        .collect();
    let start = NoiseLevels { outputs: outputs.collect(), inputs };
    if !start.in_the_input() || !prewhitening::exists(problem, &point, &start) {
        return Ok(start);
    }
    levels::maximum_likelihood(problem, &point, start, &most)
}

/// What is left of one segment of a recording once noise of a noise_model's kind was made white.
#[derive(Debug, Clone)]
pub struct Innovations {
    /// Time from one sample to the next, s.
    pub sample_time_s: f64,
    /// Per output, in units of noise; nothing where missing.
    pub outputs: Vec<Vec<f64>>,
}

/// Whitened residuals of a model at a fit, segment by segment; `None` where it overflows there.
///
/// # Errors
/// When a recording cannot be read.
pub fn innovations(
    problem: &Problem<'_>,
    noise_model: &NoiseModel,
    at: &Evaluation,
) -> Result<Option<Vec<Innovations>>, IdentifyError> {
    let problem = levels::without_parameters(problem);
    let weights = Weights { innovations: true, ..noise_model.weights(&problem, &at.values) };
    let point = Point { values: at.values.clone(), nuisance: at.nuisance.clone() };
    let Some(passed) = evaluation::run(&problem, &point, &weights)? else { return Ok(None) };
    let each = problem.segments.iter().zip(passed).map(|(segment, result)| Innovations {
        sample_time_s: segment.sample_time_s,
        outputs: result.innovations,
    });
    Ok(Some(each.collect()))
}

/// Signals of one segment of a recording.
#[derive(Debug, Clone)]
pub struct Traces {
    /// Index of the recording.
    pub recording: usize,
    /// Time of the recording, s.
    pub time_s: Vec<f64>,
    /// Per input, as the model reads it, SI.
    pub inputs: Vec<Vec<f64>>,
    /// Per output, as measured, SI; NaN where missing.
    pub measured: Vec<Vec<f64>>,
    /// Per output, as predicted running free, SI.
    pub predicted: Vec<Vec<f64>>,
}

/// What a model predicts beside what was measured, segment by segment. `observer` is the problem's model with other outputs; then
/// those are predicted.
///
/// # Errors
/// When a recording cannot be read, or the prediction overflows.
pub fn traces(
    problem: &Problem<'_>,
    at: &Evaluation,
    observer: Option<&Model>,
) -> Result<Vec<Traces>, IdentifyError> {
    let each = problem.segments.par_iter().zip(&at.nuisance).map(|(segment, nuisance)| {
        let mut own = Traces {
            recording: segment.recording,
            time_s: Vec::new(),
            inputs: vec![Vec::new(); problem.model.inputs().count()],
            measured: vec![Vec::new(); problem.outputs()],
            predicted: Vec::new(),
        };
        let dataset = &problem.datasets[segment.recording];
        segments::read(problem.model, dataset, segment, &problem.intersample, |chunk| {
            own.inputs.iter_mut().zip(&chunk.inputs).for_each(|(all, more)| all.extend(more));
            own.measured.iter_mut().zip(&chunk.outputs).for_each(|(all, more)| all.extend(more));
        })?;
        let rows = segment.first_row..segment.first_row + segment.rows;
        own.time_s = rows.map(|row| segment.origin_s + row as f64 * segment.sample_time_s).collect();
        let model = observer.unwrap_or(problem.model);
        let predictor = Predictor::new(model, &at.values, segment.sample_time_s)?;
        let inputs: Vec<&[f64]> = own.inputs.iter().map(Vec::as_slice).collect();
        let start = match problem.options.start_state {
            StartState::Free => Start::State(&nuisance[..predictor.states()]),
            StartState::Equilibrium => Start::Equilibrium,
        };
        own.predicted = predictor.run(&inputs, &problem.intersample, start)?.outputs;
        if observer.is_some() {
            return Ok(own);
        }
        let estimated = modal::offset_channels(problem);
        let offsets = &nuisance[nuisance.len() - estimated.len()..];
        for (output, offset) in estimated.into_iter().zip(offsets) {
            own.predicted[output].iter_mut().for_each(|value| *value += offset);
        }
        Ok(own)
    });
    each.collect()
}

pub(crate) fn begin(
    problem: &Problem<'_>,
    values: &[f64],
    from: Option<(&Model, &Evaluation)>,
) -> Result<Option<Point>, IdentifyError> {
    if problem.model.equations(values).is_err() {
        return Ok(None);
    }
    let mut nuisance = evaluation::first_nuisance(problem, values)?;
    if let Some((model, before)) = from
        && before.nuisance.len() == nuisance.len()
    {
        let (Ok(old), Ok(new)) = (model.equations(&before.values), problem.model.equations(values)) else {
            return Ok(None);
        };
        for (new_locals, old_locals) in nuisance.iter_mut().zip(&before.nuisance) {
            carry((&old.state_names, old_locals), (&new.state_names, new_locals));
        }
    }
    Ok(Some(Point { values: values.to_vec(), nuisance }))
}

/// Start states of the same name and offsets go over; states that are new begin at nothing.
fn carry(old: (&[String], &[f64]), new: (&[String], &mut [f64])) {
    let (names, values) = old;
    let offsets = values.len().saturating_sub(names.len());
    let states = new.1.len().saturating_sub(offsets);
    for (target, name) in new.1[..states].iter_mut().zip(new.0) {
        *target = names.iter().position(|known| known == name).map_or(0.0, |index| values[index]);
    }
    new.1[states..].copy_from_slice(&values[values.len() - offsets..]);
}

fn measured(
    problem: &Problem<'_>,
    point: &Point,
    passed: &[SegmentEvaluation],
    converged: bool,
) -> Evaluation {
    let recordings = problem.datasets.len();
    let (mut chi2, mut count) = (vec![0.0; recordings], vec![0.0; recordings]);
    for (segment, result) in problem.segments.iter().zip(passed) {
        chi2[segment.recording] += result.weighted_squares;
        count[segment.recording] += result.channels.iter().map(|channel| channel.count).sum::<f64>();
    }
    let channels = descent::channel_sums(passed);
    Evaluation {
        values: point.values.clone(),
        chi2,
        count,
        rms: channels.iter().map(evaluation::ChannelSums::rms).collect(),
        read: channels.iter().map(|channel| channel.count).collect(),
        converged,
        nuisance: point.nuisance.clone(),
    }
}
