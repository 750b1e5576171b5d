//! Gauss-Newton with Levenberg-Marquardt damping, from several starts, and between descents the noise levels.

use faer::Mat;
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};
use rayon::prelude::*;

use crate::{
    IdentifyError,
    comparison::{self, Evaluation, NoiseModel},
    evaluation::{self, ChannelSums, Point, SegmentEvaluation, Weights},
    noise::{innovations_filter::NoiseLevels, input_noise, levels, prewhitening},
    optimiser::{
        qr,
        step::{constrained_step, moved, promised_gain},
    },
    prediction::modal::offset_channels,
    preprocessing::{outliers, segments::Segment},
    problem::{Noise, Problem},
    progress::Stage,
    report::{self, End, Fit, Identification},
};

/// A descent ends when an undamped step promises to lower the cost (a sum of squares in noise units) by less than
/// this: then no parameter is further than a tenth of its standard deviation from the minimum.
const TOLERANCE: f64 = 0.01;
/// It also ends when [`SLOW_STEPS`] accepted steps together gained less than this: what still moves then is a direction
/// that the data do not determine.
const SLOW_GAIN: f64 = 0.2;
/// See [`SLOW_GAIN`].
const SLOW_STEPS: usize = 8;
/// Out of iterations it is where it would have ended if those gained less than this: nothing that the data determine is further from
/// there than its standard deviation.
const NEAR_GAIN: f64 = 1.0;
/// Damping is relative to each parameter's own curvature. A valley along which the cost changes 1e12 times less than
/// across it must still be walked.
const LEAST_DAMPING: f64 = 1e-14;
/// Least factor on the damping after a step that went as promised.
const LARGEST_RELIEF: f64 = 0.03;
/// While noise levels or the best start are still being sought.
const COARSE_TOLERANCE: f64 = 10.0;
/// Noise levels are settled when they change by less than this fraction.
const NOISE_SETTLED: f64 = 0.01;
/// They are near enough for a fine descent when they change by less than this fraction.
const NOISE_NEAR: f64 = 0.1;
/// Descents between which noise levels are judged anew.
const MOST_ROUNDS: usize = 6;
/// Times that outliers are looked for: once they are gone, smaller ones show.
const MOST_CLEANINGS: usize = 3;
/// Steps of the start states when only they are fitted.
const MOST_START_STEPS: usize = 20;
/// They have settled when a step gains less than this share of the sum of squares, or promises less in each segment.
const SETTLED_LOCALS: f64 = 1e-9;
/// Share of such a step that is taken when the whole of it leads up, again and again down to the least.
const SHORTER: f64 = 0.25;
const LEAST_SHARE: f64 = 1e-2;
/// Residuals of so many times a known noise are plausible: an input's noise adds to them.
const PLAUSIBLE: f64 = 1.5;
/// Samples per recording, and recordings, on which starts compete.
const RACE_ROWS: u64 = 4000;
const RACE_SEGMENTS: usize = 4;

/// Fits the free parameters of the problem's model to all its recordings by output error: the model runs free
/// from the measured input, and what separates its outputs from the measured ones is least in noise units.
///
/// # Assumes
/// The input is measured without error that matters, the residuals of a right model are sensor noise, and what
/// drives the input does not depend on that noise. Intervals allow for coloured residuals (they are taken from
/// sums of scores over blocks of half a second), not for bias.
///
/// # Breaks when
/// The recording was made in a closed loop and unmodelled disturbances matter: then the input is correlated with
/// them. Model the loop (a servo) and feed its reference instead.
///
/// # Errors
/// When a recording cannot be read, or the model overflows at its start values. Not converging is no error: see
/// [`Identification::end`].
pub fn output_error(problem: &Problem<'_>) -> Result<Identification, IdentifyError> {
    let clock = report::CpuClock::start();
    let mut races = Vec::new();
    let start = best_start(problem, &mut races)?;
    let mut descent = iterated_gls(problem, start)?;
    let mut cleaned = problem.clone();
    for _ in 0..MOST_CLEANINGS {
        if descent.end == End::Interrupted
            || !outliers::leave_out(&mut cleaned, &descent.point, &descent.weights)?
        {
            break;
        }
        let before = descent.iterations;
        descent = iterated_gls(&cleaned, descent.point)?;
        descent.iterations += before;
    }
    report::identification(&cleaned, descent, &races, clock)
}

/// Estimates and intervals at a fit that a comparison of models came to (`at`, of the problem's model), under its noise model: covariance at an
/// existing optimum, without refitting. Only start states are fitted.
///
/// # Errors
/// When a recording cannot be read, or the prediction overflows.
pub fn at_minimum(
    problem: &Problem<'_>,
    noise: &NoiseModel,
    at: &Evaluation,
) -> Result<Identification, IdentifyError> {
    let clock = report::CpuClock::start();
    let diverged = || IdentifyError::Diverged { model: problem.model.name.clone() };
    let point = comparison::begin(problem, &at.values, Some((problem.model, at)))?.ok_or_else(diverged)?;
    let blind = levels::without_parameters(problem);
    let found =
        with_nuisance_fitted(&blind, point, noise.weights(&blind, &at.values))?.ok_or_else(diverged)?;
    let end = if problem.options.watch.stops() { End::Interrupted } else { End::Converged };
    // Sensitivities hold input noise, whatever else the residuals hold: it counts by its share of them.
    let inputs = noise.levels().inputs.iter().map(|std| std / noise.excess().max(1.0).sqrt());
    let weights = Weights { input_std: inputs.collect(), ..noise.weights(problem, &at.values) };
    report::identification(problem, Descent { weights, end, ..found }, &[], clock)
}

/// How well a model with given parameter values (SI, all of them) predicts recordings, running free from the measured
/// input; only what is local to a recording (start state, offsets) is fitted to it.
///
/// # Errors
/// When a recording cannot be read, or the prediction overflows.
pub fn evaluate(problem: &Problem<'_>, values: &[f64]) -> Result<Fit, IdentifyError> {
    let channels = with_nuisance(problem, values)?.channels();
    let noise: Vec<f64> = channels.iter().map(ChannelSums::rms).collect();
    Ok(report::fit(problem.model, &channels, &noise))
}

/// What is local to an uninterrupted part of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Local {
    /// Index of the recording.
    pub recording: usize,
    /// Its first row there.
    pub first_row: u64,
    /// States at that row, in the order of [`socam_model::Equations::state_names`], SI.
    pub states: Vec<f64>,
    /// What is added to each output, SI: zero where no offset is estimated.
    pub offsets: Vec<f64>,
}

/// The start states and offsets that [`evaluate`] fits: with them the model, running free, has the residuals that it reports.
///
/// # Errors
/// As those of [`evaluate`].
pub fn start_states(problem: &Problem<'_>, values: &[f64]) -> Result<Vec<Local>, IdentifyError> {
    let fitted = fitted_nuisance(problem, values)?;
    let estimated = offset_channels(problem);
    let local = |(segment, own): (&Segment, Vec<f64>)| {
        let (states, shifts) = own.split_at(own.len() - estimated.len());
        let mut offsets = vec![0.0; problem.outputs()];
        estimated.iter().zip(shifts).for_each(|(output, shift)| offsets[*output] = *shift);
        let Segment { recording, first_row, .. } = *segment;
        Local { recording, first_row, states: states.to_vec(), offsets }
    };
    Ok(problem.segments.iter().zip(fitted).map(local).collect())
}

/// For each segment what [`evaluate`] fits to it.
pub(crate) fn fitted_nuisance(problem: &Problem<'_>, values: &[f64]) -> Result<Vec<Vec<f64>>, IdentifyError> {
    Ok(with_nuisance(problem, values)?.point.nuisance)
}

/// Given parameter values, and what is local to a recording fitted to it.
fn with_nuisance(problem: &Problem<'_>, values: &[f64]) -> Result<Descent, IdentifyError> {
    let diverged = || IdentifyError::Diverged { model: problem.model.name.clone() };
    let point = Point { values: values.to_vec(), nuisance: evaluation::first_nuisance(problem, values)? };
    let weights = first_weights(problem, &point)?;
    with_nuisance_fitted(problem, point, weights)?.ok_or_else(diverged)
}

/// A point with what is local fitted to each recording; `None` where the prediction overflows.
pub(crate) fn with_nuisance_fitted(
    problem: &Problem<'_>,
    point: Point,
    weights: Weights,
) -> Result<Option<Descent>, IdentifyError> {
    let Some(passed) = evaluation::run(problem, &point, &weights)? else { return Ok(None) };
    let mut at =
        Descent { cost: squares(&passed), point, weights, passed, iterations: 0, end: End::Converged };
    refit_locals(problem, &mut at)?;
    Ok(Some(at))
}

/// Sum of squared weighted residuals at other parameter values, weights as they are, start states refitted; `None` where the
/// prediction overflows.
pub(crate) fn squares_at(
    problem: &Problem<'_>,
    from: &Descent,
    values: Vec<f64>,
) -> Result<Option<f64>, IdentifyError> {
    let point = Point { values, nuisance: from.point.nuisance.clone() };
    Ok(with_nuisance_fitted(problem, point, from.weights.clone())?.map(|at| at.cost))
}

/// Sum of squared residuals as weighted.
pub(crate) fn squares(results: &[SegmentEvaluation]) -> f64 {
    results.iter().map(|result| result.weighted_squares).sum()
}

/// Moves start states and offsets only, until that no longer helps: one step is exact for a linear model, a law that
/// bends the motion needs a few.
fn refit_locals(problem: &Problem<'_>, at: &mut Descent) -> Result<(), IdentifyError> {
    let still = vec![0.0; problem.free.len()];
    let mut share = 1.0;
    for _ in 0..MOST_START_STEPS {
        if at
            .passed
            .iter()
            .all(|result| promised_by_nuisance(result) <= SETTLED_LOCALS * result.weighted_squares)
        {
            break;
        }
        let trial = moved(problem, at, &still, share);
        let passed = evaluation::run_below(problem, &trial, &at.weights, at.cost)?;
        let passed = passed.filter(|passed| squares(passed) < at.cost);
        let Some(passed) = passed else {
            share *= SHORTER;
            if share < LEAST_SHARE {
                break;
            }
            continue;
        };
        let cost = squares(&passed);
        let is_over = cost >= at.cost * (1.0 - SETTLED_LOCALS);
        (at.point, at.passed, at.cost) = (trial, passed, cost);
        if is_over {
            break;
        }
    }
    Ok(())
}

/// What moving a segment's local unknowns alone would take from its sum of squares, were the motion linear in them.
pub(crate) fn promised_by_nuisance(result: &SegmentEvaluation) -> f64 {
    let residual = result.factor.col(result.factor.ncols() - 1);
    result.pivots.iter().flatten().map(|row| residual[*row].powi(2)).sum()
}

/// A descent and where it ended.
pub(crate) struct Descent {
    pub(crate) point: Point,
    pub(crate) weights: Weights,
    pub(crate) passed: Vec<SegmentEvaluation>,
    pub(crate) cost: f64,
    pub(crate) iterations: usize,
    pub(crate) end: End,
}

impl Descent {
    /// Mean of the squared residuals in noise units.
    pub(crate) fn misfit(&self) -> f64 {
        let values: f64 = self.channels().iter().map(|channel| channel.count).sum();
        squares(&self.passed) / values.max(1.0)
    }

    pub(crate) fn channels(&self) -> Vec<ChannelSums> {
        channel_sums(&self.passed)
    }
}

pub(crate) fn channel_sums(results: &[SegmentEvaluation]) -> Vec<ChannelSums> {
    let mut sums = vec![ChannelSums::default(); results.first().map_or(0, |r| r.channels.len())];
    for result in results {
        sums.iter_mut().zip(&result.channels).for_each(|(sum, channel)| sum.add(channel));
    }
    sums
}

/// Magnitude of each free parameter, in which its steps are measured.
pub(crate) fn scales(problem: &Problem<'_>, values: &[f64]) -> Vec<f64> {
    let scale = |index: &usize| {
        let parameter = &problem.model.parameters[*index];
        let range = parameter.bounds.1 - parameter.bounds.0;
        [
            values[*index].abs(),
            parameter.value.abs(),
            parameter.prior.map_or(0.0, |prior| prior.std),
            0.01 * range,
            1.0,
        ]
        .into_iter()
        .find(|scale| *scale > 0.0 && scale.is_finite())
        .unwrap_or(1.0)
    };
    problem.free.iter().map(scale).collect()
}

/// Noise levels to begin with: those given, or a fiftieth of each channel's movement.
fn first_weights(problem: &Problem<'_>, point: &Point) -> Result<Weights, IdentifyError> {
    let scales = scales(problem, &point.values);
    let mut weights = Weights::white(vec![1.0; problem.outputs()], scales);
    match &problem.options.noise {
        Noise::Given(given) => weights.noise_std.clone_from(&given.outputs),
        Noise::Estimated => {
            let Some(results) = evaluation::run(problem, point, &weights)? else {
                return Err(IdentifyError::Diverged { model: problem.model.name.clone() });
            };
            let known = problem.model.outputs().map(|channel| channel.noise_std);
            weights.noise_std = channel_sums(&results)
                .iter()
                .zip(known)
                .map(|(channel, known)| {
                    // A channel that stands still has no spread, but the prediction misses it by something.
                    let level = (0.02 * channel.spread()).max(1e-3 * channel.rms());
                    known.unwrap_or_else(|| floor(level, channel))
                })
                .collect();
        }
    }
    Ok(weights)
}

/// Never zero: a channel that stands still, or a perfect prediction, must not divide by nothing.
fn floor(noise_std: f64, channel: &ChannelSums) -> f64 {
    let size = (channel.squares / channel.count.max(1.0)).sqrt();
    noise_std.max(1e-9 * size).max(1e-100)
}

/// Descends, takes the noise levels from the residuals, and again until both agree.
fn iterated_gls(problem: &Problem<'_>, point: Point) -> Result<Descent, IdentifyError> {
    let weights = first_weights(problem, &point)?;
    let most = match &problem.options.noise {
        Noise::Given(given) => given.clone(),
        Noise::Estimated => input_noise::most(problem)?,
    };
    let first = Stage::Descent { round: 1 };
    if matches!(problem.options.noise, Noise::Given(_)) && !most.in_the_input() {
        return descend(problem, point, weights, TOLERANCE, problem.options.max_iterations, first);
    }
    let mut descent =
        descend(problem, point, weights, COARSE_TOLERANCE, problem.options.max_iterations, first)?;
    let mut iterations = descent.iterations;
    let mut fine = false;
    for round in 1..=MOST_ROUNDS {
        // Once judged, noise levels are good enough for whoever does not want to wait.
        if round > 1 && descent.end == End::Interrupted {
            break;
        }
        let before = descent.weights.levels();
        let levels = reestimated_levels(problem, &descent, &most)?;
        let levels = if prewhitening::exists(problem, &descent.point, &levels) {
            levels
        } else {
            NoiseLevels { inputs: vec![0.0; levels.inputs.len()], ..levels }
        };
        if fine && alike(&before, &levels, NOISE_SETTLED) {
            break;
        }
        fine = fine
            || !levels.in_the_input()
            || matches!(problem.options.noise, Noise::Given(_))
            || round + 1 >= MOST_ROUNDS
            || alike(&before, &levels, NOISE_NEAR);
        let tolerance = if fine { TOLERANCE } else { COARSE_TOLERANCE };
        let weights = Weights {
            input_std: levels.inputs.clone(),
            ..Weights::white(levels.outputs, scales(problem, &descent.point.values))
        };
        let stage = Stage::Descent { round: round + 1 };
        descent = descend(problem, descent.point, weights, tolerance, problem.options.max_iterations, stage)?;
        iterations += descent.iterations;
    }
    descent.iterations = iterations;
    Ok(descent)
}

/// Noise levels that the residuals of a descent speak for.
fn reestimated_levels(
    problem: &Problem<'_>,
    descent: &Descent,
    most: &NoiseLevels,
) -> Result<NoiseLevels, IdentifyError> {
    if let Noise::Given(given) = &problem.options.noise {
        return Ok(given.clone());
    }
    let known: Vec<Option<f64>> = problem.model.outputs().map(|channel| channel.noise_std).collect();
    let channels = descent.channels();
    let most_matters = most.in_the_input();
    let each = channels.iter().zip(&known).zip(&most.outputs);
    let outputs = each.map(|((channel, known), most)| {
        let most = if most_matters { *most } else { f64::INFINITY };
        known.unwrap_or(floor(channel.rms().min(most), channel))
    });
    let start = if descent.weights.input_std.is_empty() {
        NoiseLevels { outputs: outputs.collect(), inputs: most.inputs.clone() }
    } else {
        descent.weights.levels()
    };
    if start.in_the_input() {
        levels::maximum_likelihood(problem, &descent.point, start, most)
    } else {
        Ok(start)
    }
}

/// Whether two sets of levels differ by less than matters.
fn alike(a: &NoiseLevels, b: &NoiseLevels, tolerance: f64) -> bool {
    let pairs = a.outputs.iter().chain(&a.inputs).zip(b.outputs.iter().chain(&b.inputs));
    a.inputs.len() == b.inputs.len()
        && pairs.fold(true, |alike, (a, b)| alike && (a - b).abs() <= tolerance * b)
}

/// What one start of the race came to.
pub(crate) struct Race {
    pub(crate) cost: f64,
}

/// Lets the file's values and spread ones compete on a part of the data; the best goes on to all of it. Where the file's values lead to
/// a fit that leaves no more than noise, there is no better one to be found.
fn best_start(problem: &Problem<'_>, races: &mut Vec<Race>) -> Result<Point, IdentifyError> {
    let first = problem.model.values();
    let with_nuisance = |values: Vec<f64>| -> Result<Point, IdentifyError> {
        let nuisance = evaluation::first_nuisance(problem, &values)?;
        Ok(Point { values, nuisance })
    };
    if problem.options.starts <= 1 {
        return with_nuisance(first);
    }
    let runs = problem.segments.iter().filter(|segment| segment.starts_uninterrupted());
    let short = Problem {
        segments: runs.take(RACE_SEGMENTS).map(|s| feed_head(s, RACE_ROWS)).collect(),
        model: problem.model,
        datasets: problem.datasets,
        free: problem.free.clone(),
        options: problem.options.clone(),
        intersample: problem.intersample.clone(),
        warnings: Vec::new(),
        left_out: Vec::new(),
        misfits: Vec::new(),
    };
    let mut random = ChaCha8Rng::seed_from_u64(problem.options.seed);
    let candidates = (0..problem.options.starts)
        .map(|index| if index == 0 { first.clone() } else { spread(problem, &first, &mut random) });
    let base = Point { values: first.clone(), nuisance: evaluation::first_nuisance(&short, &first)? };
    let weights = first_weights(&short, &base)?;
    let one = |(index, values): (usize, Vec<f64>)| {
        if index > 0 && problem.options.watch.stops() {
            return None;
        }
        let stage = Stage::Start { number: index + 1, of: problem.options.starts };
        let nuisance = evaluation::first_nuisance(&short, &values).ok()?;
        let weights = Weights { scales: scales(&short, &values), ..weights.clone() };
        descend(&short, Point { values, nuisance }, weights, COARSE_TOLERANCE, 15, stage).ok()
    };
    let mut candidates = candidates.enumerate();
    let own = candidates.next().and_then(one);
    let rest: Vec<_> = match &own {
        Some(own) if leaves_noise(&short, own)? => Vec::new(),
        _ => candidates.collect::<Vec<_>>().into_par_iter().map(one).collect(),
    };
    let mut best: Option<(f64, Vec<f64>)> = None;
    for descent in std::iter::once(own).chain(rest).flatten() {
        races.push(Race { cost: descent.cost });
        if best.as_ref().is_none_or(|(cost, _)| descent.cost < *cost) {
            best = Some((descent.cost, descent.point.values));
        }
    }
    with_nuisance(best.map_or(first, |(_, values)| values))
}

/// Whether a descent ended in a fit that leaves no more of any channel than its noise can be.
fn leaves_noise(problem: &Problem<'_>, descent: &Descent) -> Result<bool, IdentifyError> {
    let most = match &problem.options.noise {
        Noise::Given(given) => given.outputs.iter().map(|std| PLAUSIBLE * std).collect(),
        Noise::Estimated => {
            let known = problem.model.outputs().map(|channel| channel.noise_std);
            let most = input_noise::most(problem)?.outputs.into_iter().zip(known);
            most.map(|(most, known)| known.map_or(most, |known| PLAUSIBLE * known)).collect::<Vec<_>>()
        }
    };
    let channels = descent.channels();
    let noise = |(channel, most): (&ChannelSums, &f64)| most.is_finite() && channel.rms() <= *most;
    Ok(descent.end == End::Converged && channels.iter().zip(&most).all(noise))
}

fn feed_head(
    segment: &crate::preprocessing::segments::Segment,
    rows: u64,
) -> crate::preprocessing::segments::Segment {
    crate::preprocessing::segments::Segment { rows: segment.rows.min(rows), ..segment.clone() }
}

/// Values spread by factors of up to three where the sign is known, within bounds.
fn spread(problem: &Problem<'_>, values: &[f64], random: &mut ChaCha8Rng) -> Vec<f64> {
    let mut spread = values.to_vec();
    for index in &problem.free {
        let parameter = &problem.model.parameters[*index];
        let uniform = f64::from(random.next_u32()) / f64::from(u32::MAX) * 2.0 - 1.0;
        if parameter.bounds.0 >= 0.0 {
            spread[*index] *= 3.0_f64.powf(uniform);
        }
        spread[*index] = spread[*index].clamp(parameter.bounds.0, parameter.bounds.1);
    }
    spread
}

/// [`information_factor`] and what weak_priors add: what steps are made of.
pub(crate) fn global_factor(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    passed: &[SegmentEvaluation],
) -> Mat<f64> {
    let information = information_factor(problem, point, weights, passed);
    let weak_priors = weak_prior_rows(problem, point, weights);
    let free = problem.free.len();
    qr::join([information.as_ref(), weak_priors.as_ref()].into_iter(), free + 1)
}

/// What the data say of the free parameters, with priors but without weak_priors: what intervals are made of.
pub(crate) fn information_factor(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    results: &[SegmentEvaluation],
) -> Mat<f64> {
    let free = problem.free.len();
    let known = prior_rows(problem, point, weights);
    qr::join(results.iter().map(SegmentEvaluation::schur_complement).chain([known.as_ref()]), free + 1)
}

/// Where the data leave a valley, the point nearest to the model file's values in it is taken: a pull of one unit per
/// factor of e. It moves what the data determine to 10 % by a hundredth of its standard deviation, and intervals
/// do not count it.
fn weak_prior_rows(problem: &Problem<'_>, point: &Point, weights: &Weights) -> Mat<f64> {
    let free = problem.free.len();
    let mut rows = Mat::zeros(free, free + 1);
    for (j, index) in problem.free.iter().enumerate() {
        let parameter = &problem.model.parameters[*index];
        let (file, now) = (parameter.value, point.values[*index]);
        if parameter.prior.is_none() && parameter.bounds.0 >= 0.0 && file > 0.0 && now > 0.0 {
            rows[(j, j)] = weights.scales[j] / now;
            rows[(j, free)] = (now / file).ln();
        }
    }
    rows
}

pub(crate) fn prior_rows(problem: &Problem<'_>, point: &Point, weights: &Weights) -> Mat<f64> {
    let free = problem.free.len();
    let mut rows = Mat::zeros(free, free + 1);
    for (j, index) in problem.free.iter().enumerate() {
        if let Some(prior) = problem.model.parameters[*index].prior {
            rows[(j, j)] = weights.scales[j] / prior.std;
            rows[(j, free)] = (point.values[*index] - prior.value) / prior.std;
        }
    }
    rows
}

/// The cost of the data with what priors and weak_priors add.
fn total_cost(problem: &Problem<'_>, point: &Point, weights: &Weights, passed: &[SegmentEvaluation]) -> f64 {
    let pull = |rows: Mat<f64>| rows.as_ref().col(problem.free.len()).squared_norm_l2();
    squares(passed)
        + pull(prior_rows(problem, point, weights))
        + pull(weak_prior_rows(problem, point, weights))
}

/// Levenberg-Marquardt from `point` at fixed noise levels.
pub(crate) fn descend(
    problem: &Problem<'_>,
    point: Point,
    weights: Weights,
    tolerance: f64,
    max_iterations: usize,
    stage: Stage,
) -> Result<Descent, IdentifyError> {
    let Some(passed) = evaluation::run(problem, &point, &weights)? else {
        return Err(IdentifyError::Diverged { model: problem.model.name.clone() });
    };
    let cost = total_cost(problem, &point, &weights, &passed);
    let mut at = Descent { point, weights, passed, cost, iterations: 0, end: End::IterationLimit };
    let (mut damping, mut growth) = (1e-3_f64, 2.0);
    let mut refused = 0;
    let mut factor = global_factor(problem, &at.point, &at.weights, &at.passed);
    let mut costs = vec![at.cost];
    while at.iterations < max_iterations {
        problem.options.watch.tell(stage, at.iterations, Some(at.misfit()));
        if problem.options.watch.stops() {
            at.end = End::Interrupted;
            break;
        }
        at.iterations += 1;
        // Where the model does not fit, what a step may gain by chance is more.
        let unit = at.misfit().max(1.0);
        let promise = |damping: f64| {
            let step = constrained_step(problem, &at.point, &at.weights, factor.as_ref(), damping)?;
            let predicted = promised_gain(factor.as_ref(), &step);
            Some((step, predicted))
        };
        // Damping shortens steps along a valley to nothing; only an undamped step that gains nothing is the end.
        if promise(LEAST_DAMPING).is_some_and(|(_, predicted)| predicted <= tolerance * unit) {
            at.end = End::Converged;
            break;
        }
        let Some((step, predicted)) = promise(damping) else {
            at.end = End::Stalled;
            break;
        };
        // Start states go all the way where that leads down, and less far each time that it does not: a law may bend at rest.
        let trial = moved(problem, &at, &step, SHORTER.powi(refused));
        let gained = match evaluation::run_below(problem, &trial, &at.weights, at.cost)? {
            Some(passed) => {
                let cost = total_cost(problem, &trial, &at.weights, &passed);
                Some((passed, cost)).filter(|_| cost < at.cost)
            }
            None => None,
        };
        if let Some((passed, cost)) = gained {
            let ratio = (at.cost - cost) / predicted;
            damping = (damping * (1.0 - (2.0 * ratio - 1.0).powi(3)).max(LARGEST_RELIEF)).max(LEAST_DAMPING);
            (growth, refused) = (2.0, 0);
            (at.point, at.passed, at.cost) = (trial, passed, cost);
            factor = global_factor(problem, &at.point, &at.weights, &at.passed);
            costs.push(cost);
            if gained_lately(&costs) < SLOW_GAIN * unit {
                at.end = End::Converged;
                break;
            }
        } else {
            damping *= growth;
            growth *= 2.0;
            refused += 1;
            // A sum of squares that rises along so short a step is rough, and smaller steps would only follow its folds.
            if predicted <= tolerance * unit {
                at.end = End::Converged;
                break;
            }
            if damping > 1e9 {
                at.end = if predicted <= 1e-6 * at.cost { End::Converged } else { End::Stalled };
                break;
            }
        }
    }
    if at.end == End::IterationLimit && gained_lately(&costs) < NEAR_GAIN * at.misfit().max(1.0) {
        at.end = End::Converged;
    }
    Ok(at)
}

/// What the last [`SLOW_STEPS`] steps gained; anything where there were not so many.
fn gained_lately(costs: &[f64]) -> f64 {
    let last = |back: usize| costs.len().checked_sub(1 + back).map(|index| costs[index]);
    last(SLOW_STEPS).zip(last(0)).map_or(f64::INFINITY, |(before, now)| before - now)
}
