//! From the last factor to numbers with intervals, and to what the data do not determine.

mod advice;
mod intersample_check;

use faer::{Mat, MatRef};
use serde::Serialize;
use socam_model::Model;

use crate::{
    IdentifyError,
    evaluation::{self, ChannelSums, SegmentEvaluation},
    noise::{input_noise, regressor_noise},
    optimiser::{
        descent::{Descent, Race},
        qr,
        step::curve,
    },
    prediction::modal::offset_channels,
    preprocessing::{
        mask::{self, LeftOut},
        segments::Segment,
    },
    problem::Problem,
    progress::Stage,
    uncertainty::{
        combinations::{self, Combination},
        covariance::{Uncertainty, inverse_information, nuisance_sensitivities},
    },
};

/// Version of [`Identification`]'s JSON form.
pub const SCHEMA: &str = "socam.identification/1";

/// An estimate counts as determined when its 95 % interval is at most this fraction of it to either side.
const LARGEST_HALF_WIDTH: f64 = 0.5;
/// Estimates correlated more than this cannot be told apart.
const ENTANGLED: f64 = 0.9;
/// 95 % quantile of chi-square with one degree of freedom: a cost difference below it may be chance.
const CHANCE: f64 = 3.84;
/// A model that misses a channel by so many times its noise, and by such a share of its movement, does not explain it.
const UNEXPLAINED_NOISE: f64 = 10.0;
const UNEXPLAINED_SHARE: f64 = 0.2;
/// An estimate whose whole interval is within this share of what is usual for it is known to be nearly zero.
const NEARLY_ZERO: f64 = 0.05;
/// Share of samples with unresolved steps that is worth a word.
const MOST_UNRESOLVED: f64 = 1e-4;

/// How a fit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// No step lowers the cost.
    Converged,
    /// Converged with at least one parameter at its bound.
    AtBound,
    /// Steps that should help do not: the cost is not smooth here, or the model does not fit at all.
    Stalled,
    /// The iteration limit came first.
    IterationLimit,
    /// Whoever watched ended it; values and intervals are those of the best point so far.
    Interrupted,
}

/// Where a number comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// The recordings.
    Data,
    /// Mostly what was known before.
    Prior,
    /// It was not estimated.
    Fixed,
}

/// One parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterEstimate {
    /// Name.
    pub name: String,
    /// SI; `None` where the data do not determine it.
    pub value: Option<f64>,
    /// SI unit.
    pub unit: String,
    /// Standard deviation.
    pub std: Option<f64>,
    /// 95 % interval; an open end is `None`.
    pub ci95: [Option<f64>; 2],
    /// Whether the data determine it: the interval lies inside the bounds and is at most half the value to
    /// either side.
    pub identifiable: bool,
    /// Where it comes from.
    pub source: Source,
    /// Parameters that it cannot be told apart from.
    pub determined_with: Vec<String>,
    /// Why it is not determined, or anything else worth saying.
    pub note: String,
}

/// A combination of parameters that the data determine better than the parameters themselves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CombinationEstimate {
    /// Name.
    pub name: String,
    /// In terms of parameters.
    pub expression: String,
    /// SI; `None` where not even this is determined.
    pub value: Option<f64>,
    /// SI unit.
    pub unit: String,
    /// Standard deviation.
    pub std: Option<f64>,
    /// 95 % interval.
    pub ci95: [Option<f64>; 2],
}

/// How well one channel is predicted, over all recordings, running free.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelFit {
    /// Root mean square of the residual, SI.
    pub rms: f64,
    /// Noise level that was used, SI.
    pub noise_std: f64,
    /// 100 rms / standard deviation of the measured channel.
    pub nrmse_percent: f64,
    /// 100 - `nrmse_percent`.
    pub fit_percent: f64,
    /// Variance accounted for, per cent.
    pub vaf_percent: f64,
    /// 100 norm(residual) / norm(measured).
    pub relative_error_percent: f64,
}

/// Fit of all channels, in the model's order.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fit {
    /// By channel name.
    #[serde(serialize_with = "as_map")]
    pub channels: Vec<(String, ChannelFit)>,
}

fn as_map<T: Serialize, S: serde::Serializer>(
    channels: &[(String, T)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(channels.iter().map(|(name, value)| (name, value)))
}

/// The answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Identification {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// Method id.
    pub method: &'static str,
    /// Model name.
    pub model: String,
    /// Recordings used.
    pub recordings: Vec<String>,
    /// Whether the estimate is a minimum.
    pub converged: bool,
    /// How it ended.
    pub end: End,
    /// Iterations of the last descents.
    pub iterations: usize,
    /// Processor time of the fit without reading files, s, all threads.
    pub cpu_s: f64,
    /// All parameters of the model, in its order.
    pub parameters: Vec<ParameterEstimate>,
    /// Combinations.
    pub combinations: Vec<CombinationEstimate>,
    /// Sensor offsets, one per channel and uninterrupted segment.
    pub nuisance: Vec<ParameterEstimate>,
    /// How well the model fits.
    pub fit: Fit,
    /// Noise levels of the inputs that were used, SI, by channel name; zero where an input was taken as exact; empty for inverse
    /// dynamics.
    #[serde(serialize_with = "as_map")]
    pub input_noise_std: Vec<(String, f64)>,
    /// Samples that were not used as measured.
    pub left_out: Vec<LeftOut>,
    /// What would settle what has no number: sensors, experiments.
    pub advice: Vec<String>,
    /// Anything a careful reader should know.
    pub warnings: Vec<String>,
    /// Point values of all parameters, SI, determined or not: what reproduces `fit`. For writing models.
    #[serde(skip)]
    pub point: Vec<f64>,
    /// Sum of squared residuals in noise units, halved.
    pub cost: f64,
}

/// Processor time since it was started.
pub(crate) struct CpuClock(cpu_time::ProcessTime);

impl CpuClock {
    pub(crate) fn start() -> Self {
        Self(cpu_time::ProcessTime::now())
    }

    pub(crate) fn seconds(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
}

pub(crate) fn identification(
    problem: &Problem<'_>,
    mut descent: Descent,
    races: &[Race],
    clock: CpuClock,
) -> Result<Identification, IdentifyError> {
    problem.options.watch.tell(Stage::Intervals, 0, None);
    let weights = evaluation::Weights { scores: true, ..descent.weights.clone() };
    let diverged = || IdentifyError::Diverged { model: problem.model.name.clone() };
    descent.passed = evaluation::run(problem, &descent.point, &weights)?.ok_or_else(diverged)?;
    let results = &descent.passed;
    let channels = crate::optimiser::descent::channel_sums(results);
    let noise = regressor_noise::products(problem, &descent.point, &weights, results)?;
    let uncertainty = Uncertainty::new(problem, &descent.point, &weights.scales, results, &noise);
    let cost = 0.5 * crate::optimiser::descent::squares(results);
    let twins = exchangeable(problem, &descent)?;
    let cpu_s = clock.seconds();
    let (parameters, at_bound) = parameter_estimates(problem, &descent.point.values, &uncertainty, &twins);
    let end = if descent.end == End::Converged && at_bound { End::AtBound } else { descent.end };
    let mut warnings = problem.warnings.clone();
    warnings.extend(problem.left_out.iter().map(LeftOut::sentence));
    warnings.extend(problem.misfits.iter().cloned());
    warnings.extend(dead_channels(problem.model, &channels));
    let unexplained = unexplained(problem, &channels, &weights.noise_std)?;
    // To record more of what the model does not explain would not help.
    let advice = if unexplained.is_some() { Vec::new() } else { advice::advice(problem.model, &parameters) };
    warnings.extend(unexplained);
    warnings.extend(unresolved(results));
    if let Some(warning) = race_warning(races) {
        warnings.push(warning);
    }
    if problem.options.try_other_intersamples && end != End::Interrupted {
        warnings.extend(intersample_check::warnings(problem, &descent, &parameters)?);
    }
    if end == End::Interrupted {
        warnings.push("the search was interrupted: values are those of the best point so far, and intervals say what these recordings could determine, not how far the minimum is".into());
    }
    if end == End::Stalled || end == End::IterationLimit {
        warnings.push("the fit did not converge; its intervals mean little: give better start values, fix what is known, or look at the residuals".into());
    }
    Ok(Identification {
        schema: SCHEMA,
        method: "output-error",
        model: problem.model.name.clone(),
        recordings: problem.datasets.iter().map(|dataset| dataset.name().to_owned()).collect(),
        converged: matches!(end, End::Converged | End::AtBound),
        end,
        iterations: descent.iterations,
        cpu_s,
        advice,
        parameters,
        combinations: combinations(problem, &descent.point.values, &uncertainty),
        nuisance: offsets(problem, &descent.point.nuisance, results, &uncertainty, &weights.scales),
        fit: fit(problem.model, &channels, &weights.noise_std),
        input_noise_std: input_noise_std(problem.model, &weights.input_std),
        left_out: problem.left_out.clone(),
        warnings,
        point: descent.point.values,
        cost,
    })
}

/// By channel name; no level was sought for inputs that no sensor measures.
fn input_noise_std(model: &Model, levels: &[f64]) -> Vec<(String, f64)> {
    let levels = levels.iter().copied().chain(std::iter::repeat(0.0));
    model.inputs().zip(levels).map(|(channel, std)| (channel.name.clone(), std)).collect()
}

/// Outputs that say nothing, in words.
fn dead_channels(model: &Model, channels: &[ChannelSums]) -> Vec<String> {
    let dead = model.outputs().zip(channels).filter_map(|(channel, sums)| {
        let name = &channel.name;
        if sums.count == 0.0 {
            Some(format!("{name} holds no value: nothing was fitted to it"))
        } else if sums.spread() <= 1e-7 * (sums.squares / sums.count).sqrt() {
            Some(format!("{name} never changes, and the model was fitted to that: is its sensor connected?"))
        } else {
            None
        }
    });
    dead.collect()
}

/// Channels of which so much is left that no answer can be relied on, in words.
fn unexplained(
    problem: &Problem<'_>,
    channels: &[ChannelSums],
    noise_std: &[f64],
) -> Result<Option<String>, IdentifyError> {
    let most = input_noise::most(problem)?.outputs;
    let each = problem.model.outputs().zip(channels).zip(noise_std.iter().zip(most));
    let missed = each.filter_map(|((channel, sums), (noise_std, most))| {
        let noise_std = channel.noise_std.unwrap_or_else(|| noise_std.min(most));
        let left = sums.count > 0.0
            && sums.rms() > UNEXPLAINED_NOISE * noise_std
            && sums.rms() > UNEXPLAINED_SHARE * sums.spread();
        left.then(|| {
            let unit = channel.unit;
            format!("{:.3} {unit} rms of {} beside noise of {noise_std:.2} {unit}", sums.rms(), channel.name)
        })
    });
    let missed: Vec<String> = missed.collect();
    Ok((!missed.is_empty()).then(|| {
        format!(
            "the model does not explain these recordings: it leaves {}; its parameters and their intervals mean little: `diagnose` says what it leaves out",
            missed.join(", ")
        )
    }))
}

/// Steps that missed their tolerance, if they are more than a few.
fn unresolved(results: &[SegmentEvaluation]) -> Option<String> {
    let missed: u64 = results.iter().map(|result| result.unresolved).sum();
    let share = missed as f64 / results.iter().map(|result| result.samples).sum::<f64>();
    (share > MOST_UNRESOLVED).then(|| {
        format!(
            "in {missed} samples ({:.2} %) a force law is steeper than the shortest step of the prediction resolves, which is good on average only there: make the law's transition wider, or sample faster",
            100.0 * share
        )
    })
}

/// Starts that ended in different minima are worth a word.
fn race_warning(races: &[Race]) -> Option<String> {
    let best = races.iter().map(|race| race.cost).fold(f64::INFINITY, f64::min);
    let reached = races.iter().filter(|race| race.cost < 1.05 * best).count();
    (races.len() > 1 && reached * 3 < races.len()).then(|| {
        format!("only {reached} of {} starts came near the best minimum; there may be a better one: try --starts with a larger number", races.len())
    })
}

pub(crate) fn fit(model: &Model, channels: &[ChannelSums], noise_std: &[f64]) -> Fit {
    let each = model
        .outputs()
        .zip(channels)
        .zip(noise_std)
        .map(|((channel, sums), noise_std)| (channel.name.clone(), channel_fit(sums, *noise_std)));
    Fit { channels: each.collect() }
}

pub(crate) fn channel_fit(sums: &ChannelSums, noise_std: f64) -> ChannelFit {
    // Nothing was measured: no number is better than a perfect one.
    let rms = if sums.count > 0.0 { sums.rms() } else { f64::NAN };
    let spread = sums.spread().max(1e-300);
    let ratio = rms / spread;
    ChannelFit {
        rms,
        noise_std,
        nrmse_percent: 100.0 * ratio,
        fit_percent: 100.0 * (1.0 - ratio),
        vaf_percent: 100.0 * (1.0 - ratio * ratio),
        relative_error_percent: 100.0 * (sums.residual_squares / sums.squares.max(1e-300)).sqrt(),
    }
}

/// Estimates as a fit would report them from this factor over [free parameters, scaled | residual], residuals being white.
pub(crate) fn foretold(
    problem: &Problem<'_>,
    values: &[f64],
    factor: MatRef<'_, f64>,
    scales: &[f64],
) -> (Vec<ParameterEstimate>, Vec<CombinationEstimate>) {
    let free = problem.free.len();
    let point = evaluation::Point { values: values.to_vec(), nuisance: Vec::new() };
    let weights = evaluation::Weights::white(Vec::new(), scales.to_vec());
    let known = crate::optimiser::descent::prior_rows(problem, &point, &weights);
    let factor = qr::join([factor, known.as_ref()].into_iter(), free + 1);
    let uncertainty = Uncertainty::white(problem, values, &factor, scales);
    let (parameters, _) = parameter_estimates(problem, values, &uncertainty, &[]);
    (parameters, combinations(problem, values, &uncertainty))
}

/// Parameters of two springs in a row that can change places without changing what the sensors see by more than chance:
/// for each parameter that has one, its counterpart.
fn exchangeable(problem: &Problem<'_>, descent: &Descent) -> Result<Vec<(usize, usize)>, IdentifyError> {
    let mut found = Vec::new();
    for (a, b) in combinations::pairs(problem.model) {
        let mut swaps = vec![(a.stiffness, b.stiffness)];
        swaps.extend(a.damping.zip(b.damping));
        let free = |index: &usize| problem.free.contains(index);
        if a.damping.is_some() != b.damping.is_some() || !swaps.iter().all(|(a, b)| free(a) && free(b)) {
            continue;
        }
        let mut values = descent.point.values.clone();
        swaps.iter().for_each(|(a, b)| values.swap(*a, *b));
        let inside = swaps.iter().flat_map(|(a, b)| [*a, *b]).all(|index| {
            let bounds = problem.model.parameters[index].bounds;
            (bounds.0..=bounds.1).contains(&values[index])
        });
        let own = crate::optimiser::descent::squares(&descent.passed);
        let swapped =
            if inside { crate::optimiser::descent::squares_at(problem, descent, values)? } else { None };
        if swapped.is_some_and(|cost| cost - own < CHANCE * descent.misfit().max(1.0)) {
            found.extend(swaps.iter().flat_map(|(a, b)| [(*a, *b), (*b, *a)]));
        }
    }
    Ok(found)
}

fn parameter_estimates(
    problem: &Problem<'_>,
    values: &[f64],
    uncertainty: &Uncertainty,
    twins: &[(usize, usize)],
) -> (Vec<ParameterEstimate>, bool) {
    let mut at_bound = false;
    let estimates = problem.model.parameters.iter().enumerate().map(|(index, parameter)| {
        let value = values[index];
        let Some(j) = problem.free.iter().position(|free| *free == index) else {
            return ParameterEstimate {
                name: parameter.name.clone(),
                value: Some(value),
                unit: parameter.unit.clone(),
                std: None,
                ci95: [None, None],
                identifiable: false,
                source: Source::Fixed,
                determined_with: Vec::new(),
                note: String::new(),
            };
        };
        let std = uncertainty.std(&[(j, 1.0)]);
        let half = uncertainty.quantile * std;
        let (low, high) = parameter.bounds;
        let stuck =
            value <= low + 1e-6 * (value - low).abs().max(low.abs()) || value >= high - 1e-6 * high.abs();
        at_bound |= stuck;
        let [from, to] = curve(problem, index).interval(value, half);
        // Not finite counts as not determined.
        let narrow = (value - from).max(to - value) <= LARGEST_HALF_WIDTH * value.abs();
        let inside = from >= low && to <= high;
        let zero = low <= 0.0
            && high >= 0.0
            && from.abs().max(to.abs()) <= NEARLY_ZERO * usual(problem.model, values, index);
        // Not determined if it could as well be what its counterpart is.
        let twin = twins.iter().find(|(own, _)| *own == index).map(|(_, other)| *other);
        let twin = twin.filter(|other| (values[*other] - value).abs() > half);
        let identifiable = (zero || narrow && inside && !stuck) && twin.is_none();
        let mut determined_with = if identifiable { Vec::new() } else { entangled(problem, uncertainty, j) };
        if let Some(other) = twin.map(|other| &problem.model.parameters[other].name)
            && !determined_with.contains(other)
        {
            determined_with.push(other.clone());
        }
        let (ci, note) = if identifiable {
            let note = if zero { "nearly zero beside what is usual for it" } else { "" };
            ([Some(from.max(low)), Some(to.min(high))], note.into())
        } else {
            let ends = [Some(from).filter(|end| *end > low), Some(to).filter(|end| *end < high)];
            let ends = ends.map(|end| end.filter(|_| narrow && twin.is_none()));
            (ends, why_not(stuck, twin.is_some(), half / value.abs(), &determined_with))
        };
        let prior = parameter.prior.is_some_and(|prior| std > 0.7 * prior.std);
        ParameterEstimate {
            name: parameter.name.clone(),
            value: identifiable.then_some(value),
            unit: parameter.unit.clone(),
            std: identifiable.then_some(std),
            ci95: ci,
            identifiable,
            source: if prior { Source::Prior } else { Source::Data },
            determined_with,
            note,
        }
    });
    let estimates = estimates.collect();
    (estimates, at_bound)
}

/// What is usual for a parameter: its value in the model file, or the largest of the other parameters of its unit where that is less.
fn usual(model: &Model, values: &[f64], index: usize) -> f64 {
    let own = &model.parameters[index];
    let others = model.parameters.iter().zip(values).enumerate();
    let others = others.filter(|(other, (parameter, _))| *other != index && parameter.unit == own.unit);
    let largest = others.map(|(_, (_, value))| value.abs()).fold(0.0, f64::max);
    if largest > 0.0 { own.value.abs().min(largest) } else { own.value.abs() }
}

fn entangled(problem: &Problem<'_>, uncertainty: &Uncertainty, j: usize) -> Vec<String> {
    let std = |i: usize| uncertainty.std(&[(i, 1.0)]);
    let others = (0..problem.free.len())
        .filter(|i| *i != j && uncertainty.covariance(*i, j).abs() > ENTANGLED * std(*i) * std(j));
    others.map(|i| problem.model.parameters[problem.free[i]].name.clone()).collect()
}

fn why_not(stuck: bool, swaps: bool, relative: f64, entangled: &[String]) -> String {
    let reason = if swaps {
        "two springs in a row can change places and no sensor sees it".into()
    } else if stuck {
        "it ran to its bound".into()
    } else if relative.is_finite() && relative < 1e3 {
        format!("its 95 % interval is +-{:.0} %", 100.0 * relative)
    } else {
        "these recordings say next to nothing of it".into()
    };
    if entangled.is_empty() {
        format!("not determined: {reason}")
    } else {
        format!("not determined: {reason}; it cannot be told apart from {}", entangled.join(", "))
    }
}

fn combinations(
    problem: &Problem<'_>,
    values: &[f64],
    uncertainty: &Uncertainty,
) -> Vec<CombinationEstimate> {
    let position = |index: usize| problem.free.iter().position(|free| *free == index);
    let estimate = |combination: Combination| {
        let sensitivities = combination.sensitivities.iter();
        let own: Vec<(usize, f64)> = sensitivities
            .filter_map(|(index, sensitivity)| Some((position(*index)?, *sensitivity)))
            .collect();
        if own.is_empty() {
            return None;
        }
        let (value, std) = (combination.value, uncertainty.std(&own));
        let half = uncertainty.quantile * std;
        let determined = half <= LARGEST_HALF_WIDTH * value.abs();
        Some(CombinationEstimate {
            name: combination.name,
            expression: combination.expression,
            value: determined.then_some(value),
            unit: combination.unit,
            std: determined.then_some(std),
            ci95: [value - half, value + half].map(|end| Some(end).filter(|_| determined)),
        })
    };
    combinations::all(problem.model, values).into_iter().filter_map(estimate).collect()
}

fn offsets(
    problem: &Problem<'_>,
    nuisance: &[Vec<f64>],
    results: &[SegmentEvaluation],
    uncertainty: &Uncertainty,
    scales: &[f64],
) -> Vec<ParameterEstimate> {
    let channels = offset_channels(problem);
    if channels.is_empty() {
        return Vec::new();
    }
    let outputs: Vec<_> = problem.model.outputs().collect();
    let free = problem.free.len();
    let mut all = Vec::new();
    for ((segment, values), result) in problem.segments.iter().zip(nuisance).zip(results) {
        let follow = nuisance_sensitivities(result, free);
        let shown: Vec<usize> = (0..result.nuisance()).filter(|i| result.pivots[*i].is_some()).collect();
        let own = Mat::from_fn(shown.len(), shown.len(), |i, j| result.factor[(i, shown[j])]);
        let own = inverse_information(own.as_ref());
        for (position, output) in channels.iter().enumerate() {
            let row = result.nuisance() - channels.len() + position;
            let moved: Vec<(usize, f64)> = (0..free).map(|j| (j, follow[(row, j)] / scales[j])).collect();
            let std = |pivot: usize| own[(pivot, pivot)].sqrt().hypot(uncertainty.std(&moved));
            let std = result.pivots[row].map(std).filter(|std| std.is_finite());
            let value = std.map(|_| values[row]);
            let end = |sign: f64| Some(value? + sign * uncertainty.quantile * std?);
            all.push(ParameterEstimate {
                name: format!("offset of {} in {}", outputs[*output].name, place(problem, segment)),
                value,
                unit: outputs[*output].unit.into(),
                std,
                ci95: [end(-1.0), end(1.0)],
                identifiable: value.is_some(),
                source: Source::Data,
                determined_with: Vec::new(),
                note: if value.is_some() {
                    String::new()
                } else {
                    "not determined: the unknown start state can take its place".into()
                },
            });
        }
    }
    all
}

/// A segment as it is called in results: the recording, and from when on where it has several.
fn place(problem: &Problem<'_>, segment: &Segment) -> String {
    let dataset = &problem.datasets[segment.recording];
    let several = problem.segments.iter().filter(|other| other.recording == segment.recording).count() > 1;
    let from = mask::time_of(dataset, segment.first_row);
    if several { format!("{} from {from:.3} s", dataset.name()) } else { dataset.name().into() }
}
