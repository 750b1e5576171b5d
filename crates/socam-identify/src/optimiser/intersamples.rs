//! Choice of the intersample behaviour of each input by the likelihood of the recordings.
//!
//! A drive that holds its command for a sample, read as linear, looks like a delay of half a sample; a measured motion read as held leaves
//! residuals many times its sensor's noise. Neither may be left to the quantity's usual behaviour where the recordings tell.

use socam_model::{Channel, ChannelTransform, Intersample, Model, Quantity};
use socam_recording::Dataset;

use crate::{
    IdentifyError, Options, Problem,
    between::{self, Between, BetweenSource},
    evaluation::{self, Point, SegmentEvaluation, Weights},
    noise::innovations_filter::{InnovationsFilter, NoiseLevels},
    optimiser::{
        descent::{self, Descent},
        factors,
        noise_estimation::{first_weights, iterated_gls, leaves_noise},
        nuisance,
        step::{constrained_step, predicted_gain},
    },
    problem::sample_times,
    progress::Stage,
};

/// Difference of two deviances above which the recordings distinguish two assumptions.
pub(crate) const TOLD_APART: f64 = 10.0;
/// Share of the squared residuals by which another behaviour must fit better where a wrong one may gain a little by chance: while physics is
/// missing, and for a motion, which inertia makes band-limited.
const LEAST_SHARE: f64 = 0.02;
/// The linearised deviance decides alone where it exceeds [`TOLD_APART`] this many times.
pub(crate) const CLEARLY: f64 = 10.0;
/// Damping of the one step to the estimates under the other assumption.
const DAMPING: f64 = 1e-9;
/// Iterations of the descent that confirms it.
const ITERATIONS: usize = 8;
/// Tolerance of that descent.
const TOLERANCE: f64 = 0.1;
/// Most changes of one fit.
const MOST_CHANGES: usize = 4;

/// What the problem assumes of its inputs, before any recording was asked.
fn assumed(problem: &Problem<'_>) -> Vec<Between> {
    let each = problem.model.inputs().zip(&problem.intersample);
    each.map(|(channel, kind)| Between {
        kind: *kind,
        source: if is_open(&problem.options, channel) { BetweenSource::Usual } else { BetweenSource::Stated },
        rival: None,
        rival_deviance: None,
    })
    .collect()
}

/// Whether neither the model file nor an option states the intersample behaviour of an input.
pub(crate) fn is_open(options: &Options, channel: &Channel) -> bool {
    options.intersample.is_none() && channel.between.is_none()
}

/// Other intersample assumptions that are possible for a channel. A held angle would move in jumps. What is computed from another column (a
/// rate, a wave) is not tried: its noise is not that of a sample, and a wrong model of noise decides for a wrong kind.
pub fn others(channel: &Channel, kind: Intersample) -> impl Iterator<Item = Intersample> {
    let is_none = channel.quantity.is_clock()
        || channel.quantity == Quantity::Signal
        || channel.transform != ChannelTransform::Value;
    let jumps = matches!(channel.quantity, Quantity::Angle | Quantity::Turned);
    Intersample::ALL
        .into_iter()
        .filter(move |other| !is_none && *other != kind && !(jumps && *other == Intersample::Hold))
}

/// `model` with its inputs' behaviour between samples stated as it fits the recordings best at the model's values, for simulations and
/// monitoring. What the file states, and what the recordings do not tell, stays as it is.
///
/// # Errors
/// When a recording cannot be used, or the prediction overflows.
///
/// ```
/// use socam_identify::{Options, settled_inputs};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// let settled = settled_inputs(&model, &recordings, Options::default())?;
/// assert_eq!(settled.parameters, model.parameters);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn settled_inputs(model: &Model, datasets: &[Dataset], options: Options) -> Result<Model, IdentifyError> {
    let mut stated = model.clone();
    if model.inputs().any(|channel| is_open(&options, channel)) {
        let mut problem = Problem::of_known(model, datasets, options)?;
        let values = model.values();
        let nuisance = nuisance::first(&problem, &values)?;
        let descent = fitted(&problem, Point { values, nuisance })?;
        settled(&mut problem, descent, false, fitted)?;
        between::state(model.inputs().map(|channel| &channel.name).zip(&problem.between), &mut stated)?;
    }
    Ok(stated)
}

/// The problem and its fit under the intersample behaviour that fits the recordings best. Behaviours that are stated are kept.
///
/// One input changes at a time, the one that gains most. `descent` must be a fit of `problem` by `fit`; `is_far` says that its noise levels
/// are not yet those of the recordings.
pub(crate) fn settled<'a>(
    problem: &mut Problem<'a>,
    descent: Descent,
    is_far: bool,
    fit: impl Fn(&Problem<'a>, Point) -> Result<Descent, IdentifyError>,
) -> Result<Descent, IdentifyError> {
    let mut descent = descent;
    let mut between = assumed(problem);
    // A motion that jumps at its samples is believed only where it leaves nothing but noise.
    let mut refused = Vec::new();
    for round in 0..=MOST_CHANGES {
        if descent.end.is_cut_off() {
            break;
        }
        let mut best: Option<(usize, &Channel, Alternative)> = None;
        for (input, channel) in problem.model.inputs().enumerate() {
            if !is_open(&problem.options, channel) {
                continue;
            }
            let mut rival: Option<Alternative> = None;
            let possible = |other: &Intersample| !refused.contains(&(input, *other));
            for other in others(channel, problem.intersample[input]).filter(possible) {
                let tried = Alternative::new(problem, &descent, (input, other), CLEARLY * TOLD_APART)?;
                rival = [rival, tried].into_iter().flatten().min_by(|a, b| a.deviance.total_cmp(&b.deviance));
            }
            let Some(rival) = rival else { continue };
            between[input] = Between {
                kind: problem.intersample[input],
                source: if rival.deviance > TOLD_APART { BetweenSource::Data } else { BetweenSource::Usual },
                rival: Some(rival.kind),
                rival_deviance: Some(rival.deviance),
            };
            if best.as_ref().is_none_or(|(_, _, best)| rival.deviance < best.deviance) {
                best = Some((input, channel, rival));
            }
        }
        let whole = evaluation::squares(&descent.evaluated) / descent.misfit().max(1.0);
        match best {
            Some((input, channel, Alternative { kind, deviance, point: Some(point) }))
                if deviance < -least_gain(channel, whole, is_far) && round < MOST_CHANGES =>
            {
                let before = (problem.intersample[input], descent.iterations);
                problem.intersample[input] = kind;
                let found = fit(problem, point)?;
                if kind == Intersample::Hold && is_motion(channel) && !leaves_noise(problem, &found)? {
                    problem.intersample[input] = before.0;
                    refused.push((input, kind));
                    continue;
                }
                descent = found;
                between[input] = Between {
                    kind,
                    source: BetweenSource::Data,
                    rival: Some(before.0),
                    rival_deviance: Some(-deviance),
                };
                descent.iterations += before.1;
            }
            _ => break,
        }
    }
    problem.between = between;
    Ok(descent)
}

/// Fall of the deviance from which the recordings decide for another behaviour of an input. `squares` is the sum of squared residuals in units of
/// the misfit, `is_far` whether physics is known to be missing.
#[must_use]
pub fn least_gain(channel: &Channel, squares: f64, is_far: bool) -> f64 {
    if is_far || is_motion(channel) { TOLD_APART.max(LEAST_SHARE * squares) } else { TOLD_APART }
}

/// Whether a channel is a motion, which inertia makes smooth between its samples.
#[must_use]
pub fn is_motion(channel: &Channel) -> bool {
    Intersample::of(channel.quantity, channel.transform) == Intersample::BandLimited
}

/// The fit of a problem from a point: of start states and offsets alone where no parameter is free.
pub(crate) fn fitted(problem: &Problem<'_>, point: Point) -> Result<Descent, IdentifyError> {
    if !problem.free.is_empty() {
        return iterated_gls(problem, point);
    }
    let diverged = || IdentifyError::Diverged { model: problem.model.name.clone() };
    let weights = first_weights(problem, &point)?;
    let first = nuisance::with_nuisance_fitted(problem, point, weights)?.ok_or_else(diverged)?;
    let noise = first.channels().iter().map(|channel| channel.rms().max(f64::MIN_POSITIVE)).collect();
    let weights = Weights::white(noise, Vec::new());
    nuisance::with_nuisance_fitted(problem, first.point, weights)?.ok_or_else(diverged)
}

/// A fit under an assumption that was not made.
pub(crate) struct Alternative {
    pub(crate) kind: Intersample,
    /// Deviance under this assumption minus that under the assumption made.
    pub(crate) deviance: f64,
    /// Its fit; `None` where the linearised deviance decided.
    pub(crate) point: Option<Point>,
}

impl Alternative {
    /// Fits under the assumption that `input` behaves as `kind`. A linearised deviance above `most` decides alone. `None` where the
    /// prediction overflows.
    pub(crate) fn new(
        problem: &Problem<'_>,
        descent: &Descent,
        (input, kind): (usize, Intersample),
        most: f64,
    ) -> Result<Option<Self>, IdentifyError> {
        let mut other = problem.clone();
        other.intersample[input] = kind;
        let weights = &descent.weights;
        let Some(evaluated) = evaluation::run(&other, &descent.point, weights)? else { return Ok(None) };
        let factor = factors::global_factor(&other, &descent.point, weights, &evaluated);
        let step = constrained_step(&other, &descent.point, weights, factor.as_ref(), DAMPING);
        let Some(step) = step else { return Ok(None) };
        let unit = descent.misfit().max(1.0);
        let nuisance: f64 = evaluated.iter().map(SegmentEvaluation::nuisance_gain).sum();
        let levels = weights.levels();
        let sizes = log_determinant(&other, &descent.point, &levels)
            - log_determinant(problem, &descent.point, &levels);
        let own = evaluation::squares(&descent.evaluated);
        let predicted = evaluation::squares(&evaluated) - nuisance - predicted_gain(factor.as_ref(), &step);
        let deviance = (predicted - own) / unit + sizes;
        if deviance > most {
            return Ok(Some(Self { kind, deviance, point: None }));
        }
        let (point, weights) = (descent.point.clone(), weights.clone());
        let mut found =
            descent::descend(&other, point, weights, TOLERANCE, ITERATIONS, Stage::Descent { round: 1 })?;
        if other.free.is_empty() {
            nuisance::refit(&other, &mut found)?;
        }
        let deviance = (evaluation::squares(&found.evaluated) - own) / unit + sizes;
        Ok(Some(Self { kind, deviance, point: Some(found.point) }))
    }
}

/// Logarithm of the determinant of the residuals' covariance, over all samples; zero where no input is noisy.
fn log_determinant(problem: &Problem<'_>, point: &Point, levels: &NoiseLevels) -> f64 {
    if !levels.in_the_input() {
        return 0.0;
    }
    let Ok(equations) = problem.model.equations(&point.values) else { return 0.0 };
    let of_sample = |time_s: &f64| {
        let filter =
            InnovationsFilter::new(&equations, levels, &levels.outputs, *time_s, &problem.intersample)?;
        let samples: u64 = problem
            .segments
            .iter()
            .filter(|segment| segment.sample_time_s == *time_s)
            .map(|segment| segment.rows)
            .sum();
        Some(samples as f64 * filter.covariance.determinant().ln())
    };
    sample_times(problem).iter().filter_map(of_sample).sum()
}
