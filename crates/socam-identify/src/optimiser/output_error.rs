//! Output-error identification: the entry points that fit or evaluate a model.

use crate::optimiser::descent::End;
use crate::{
    IdentifyError,
    comparison::{self, Evaluation, NoiseModel},
    evaluation::{ChannelSums, Weights},
    noise::levels,
    optimiser::{
        descent::Descent,
        noise_estimation::iterated_gls,
        nuisance::{with_nuisance, with_nuisance_fitted},
        starts::best_start,
    },
    preprocessing::outliers,
    problem::Problem,
    report::{self, Fit, Identification},
};

/// Times that outliers are looked for: once they are gone, smaller ones show.
pub(crate) const MOST_CLEANINGS: usize = 3;

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
    let mut starts = Vec::new();
    let start = best_start(problem, &mut starts)?;
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
    report::identification(&cleaned, descent, &starts, clock)
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
    let blind = levels::blind(problem);
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
