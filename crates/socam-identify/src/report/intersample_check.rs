//! Check of the intersample assumption: whether another one moves an estimate out of its interval, or contradicts the recordings.

use socam_model::{Channel, ChannelTransform, Intersample};

use crate::{
    IdentifyError, Problem,
    evaluation::{self, Point},
    noise::innovations_filter::{InnovationsFilter, NoiseLevels},
    optimiser::{
        descent::{self, Descent},
        factors, nuisance,
        step::{constrained_step, predicted_gain},
    },
    problem::sample_times,
    progress::Stage,
    report::ParameterEstimate,
};

/// Difference of two deviances above which the recordings distinguish two assumptions.
const TOLD_APART: f64 = 10.0;
/// Multiple of [`TOLD_APART`] above which the linearised deviance decides without a descent.
const CLEARLY: f64 = 10.0;
/// Smallest move of an estimate that is reported, in half widths of its interval.
const LEAST_MOVE: f64 = 1.0;
/// Damping of the one step to the estimates under the other assumption.
const DAMPING: f64 = 1e-9;
/// Iterations of the descent that confirms it.
const ITERATIONS: usize = 8;
/// Tolerance of that descent.
const TOLERANCE: f64 = 0.1;

/// One sentence per input whose assumption moves a determined parameter out of its interval, unless the recordings contradict the other
/// assumption.
pub(crate) fn warnings(
    problem: &Problem<'_>,
    descent: &Descent,
    parameters: &[ParameterEstimate],
) -> Result<Vec<String>, IdentifyError> {
    let mut found = Vec::new();
    for (input, channel) in problem.model.inputs().enumerate() {
        let kind = problem.intersample[input];
        let others = others(channel, kind).iter();
        let judged = others.map(|other| Alternative::new(problem, descent, parameters, (input, *other)));
        let judged = judged.collect::<Result<Vec<_>, _>>()?.into_iter().flatten();
        let best = judged.min_by(|a, b| a.deviance.total_cmp(&b.deviance));
        found.extend(best.map(|best| best.sentence(&channel.name, kind)));
    }
    Ok(found)
}

/// Other intersample assumptions that are possible for a channel.
fn others(channel: &Channel, kind: Intersample) -> &'static [Intersample] {
    if channel.quantity.is_clock()
        || matches!(channel.transform, ChannelTransform::Cos(_) | ChannelTransform::Sin(_))
    {
        return &[];
    }
    match kind {
        Intersample::Linear => &[Intersample::Hold, Intersample::BandLimited],
        Intersample::Hold | Intersample::BandLimited => &[Intersample::Linear],
    }
}

/// An assumption that was not made and moves an estimate.
struct Alternative {
    kind: Intersample,
    /// Deviance under this assumption minus that under the assumption made.
    deviance: f64,
    /// The parameter that it moves most, and the move in half widths of its interval.
    parameter: String,
    moved: f64,
}

impl Alternative {
    /// `None` where it moves no estimate, or the recordings contradict it.
    fn new(
        problem: &Problem<'_>,
        descent: &Descent,
        parameters: &[ParameterEstimate],
        (input, kind): (usize, Intersample),
    ) -> Result<Option<Self>, IdentifyError> {
        let mut other = problem.clone();
        other.intersample[input] = kind;
        let weights = &descent.weights;
        let Some(evaluated) = evaluation::run(&other, &descent.point, weights)? else { return Ok(None) };
        let factor = factors::global_factor(&other, &descent.point, weights, &evaluated);
        let step = constrained_step(&other, &descent.point, weights, factor.as_ref(), DAMPING);
        let Some(step) = step else { return Ok(None) };
        let unit = descent.misfit().max(1.0);
        let nuisance: f64 = evaluated.iter().map(nuisance::predicted_decrease).sum();
        let levels = weights.levels();
        let sizes = log_determinant(&other, &descent.point, &levels)
            - log_determinant(problem, &descent.point, &levels);
        let own = evaluation::squares(&descent.evaluated);
        let predicted = evaluation::squares(&evaluated) - nuisance - predicted_gain(factor.as_ref(), &step);
        let moves = |j: usize| step[j] * weights.scales[j];
        let (_, moved) = furthest(problem, parameters, moves);
        if moved < LEAST_MOVE || (predicted - own) / unit + sizes > CLEARLY * TOLD_APART {
            return Ok(None);
        }
        let stage = Stage::Intervals;
        let found =
            descent::descend(&other, descent.point.clone(), weights.clone(), TOLERANCE, ITERATIONS, stage)?;
        let moves = |j: usize| {
            let index = problem.free[j];
            found.point.values[index] - descent.point.values[index]
        };
        let (parameter, moved) = furthest(problem, parameters, moves);
        let deviance = (evaluation::squares(&found.evaluated) - own) / unit + sizes;
        let told = moved >= LEAST_MOVE && deviance <= TOLD_APART;
        Ok(told.then_some(Self { kind, deviance, parameter, moved }))
    }

    fn sentence(&self, input: &str, kind: Intersample) -> String {
        let Self { kind: other, deviance, parameter, moved } = self;
        let (kind, other) = (kind.name(), other.name());
        let judged = if *deviance < -TOLD_APART {
            format!(
                "{input} was taken as {kind} between its samples, but {other} fits the recordings better (chi-square lower by {:.0}) and moves",
                -deviance
            )
        } else {
            format!(
                "the recordings do not tell whether {input} is {kind} or {other} between its samples; {kind} was taken, and {other} would move"
            )
        };
        format!(
            "{judged} {parameter} by {moved:.1} half-widths of its interval: find out what drives it, and say so with --between {input}={other} or `between` in the model file"
        )
    }
}

/// The determined parameter with the largest move, and the move in half widths of its interval.
fn furthest(
    problem: &Problem<'_>,
    parameters: &[ParameterEstimate],
    moves: impl Fn(usize) -> f64,
) -> (String, f64) {
    let each = problem.free.iter().enumerate().filter_map(|(j, index)| {
        let estimate = &parameters[*index];
        let [from, to] = [estimate.ci95[0]?, estimate.ci95[1]?];
        estimate.identifiable.then(|| (estimate.name.clone(), 2.0 * moves(j).abs() / (to - from)))
    });
    each.fold((String::new(), 0.0), |most, one| if one.1 > most.1 { one } else { most })
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
