//! The report of a fit: estimates with intervals, what the data do not determine, warnings and advice.

mod advice;
mod allowance;
mod estimates;
mod identification;
mod intersample_check;
mod model_text;
mod offsets;
mod scale_check;
mod verdict;
mod warnings;

pub(crate) use estimates::predicted;
pub(crate) use identification::as_map;
pub use identification::{
    ChannelFit, CombinationEstimate, Explained, Fit, Identification, Move, ParameterEstimate, SCHEMA, Source,
    Suspect, Verdict,
};

use socam_model::Model;

use crate::{
    IdentifyError,
    evaluation::{self, ChannelSums},
    noise::regressor_noise,
    optimiser::{
        descent::{Descent, End},
        starts::Starts,
    },
    preprocessing::mask::LeftOut,
    problem::Problem,
    progress::Stage,
    report::{
        estimates::{combinations, exchangeable, parameter_estimates},
        offsets::offsets,
        warnings::{dead_channels, left_the_data, starts_warning, unresolved},
    },
    uncertainty::covariance::Uncertainty,
};

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
    starts: &Starts,
    clock: CpuClock,
) -> Result<Identification, IdentifyError> {
    problem.options.progress.tell(Stage::Intervals, 0, None);
    let weights = evaluation::Weights { scores: true, ..descent.weights.clone() };
    let diverged = || IdentifyError::Diverged { model: problem.model.name.clone() };
    descent.evaluated = evaluation::run(problem, &descent.point, &weights)?.ok_or_else(diverged)?;
    let results = &descent.evaluated;
    let channels = evaluation::channel_sums(results);
    let noise = regressor_noise::products(problem, &descent.point, &weights, results)?;
    let uncertainty = Uncertainty::new(problem, &descent.point, &weights.scales, results, &noise);
    let cost = 0.5 * evaluation::squares(results);
    let swaps_with = exchangeable(problem, &descent)?;
    let cpu_s = clock.seconds();
    let (parameters, at_bound) =
        parameter_estimates(problem, &descent.point.values, &uncertainty, &swaps_with);
    let end = if descent.end == End::Converged && at_bound { End::AtBound } else { descent.end };
    let mut warnings = problem.warnings.clone();
    warnings.extend(problem.left_out.iter().map(LeftOut::sentence));
    warnings.extend(problem.misfits.iter().cloned());
    warnings.extend(dead_channels(problem, &channels));
    let sensor_noise = verdict::sensor_noise(problem)?;
    let mut fit = fit(problem.model, &channels, &weights.noise_std);
    fit.channels.iter_mut().zip(&sensor_noise).for_each(|((_, own), std)| own.sensor_noise_std = *std);
    let verdict = Verdict::new(problem, &channels, results, &weights, &sensor_noise);
    let unexplained = verdict.warning(&fit.channels);
    // Further recordings would not help a model that does not explain these.
    let advice = if verdict.explained == Explained::No {
        Vec::new()
    } else {
        advice::advice(problem.model, &parameters)
    };
    if verdict.explained == Explained::No && !descent.end.is_cut_off() {
        warnings.extend(scale_check::warning(problem, &descent)?);
    }
    warnings.extend(unexplained);
    warnings.extend(descent.left_the_data.map(left_the_data));
    warnings.extend(unresolved(results));
    if let Some(warning) = starts_warning(starts) {
        warnings.push(warning);
    }
    if problem.options.try_other_intersamples && !end.is_cut_off() {
        warnings.extend(intersample_check::warnings(problem, &descent, &parameters)?);
    }
    let cutoff = problem.options.progress.cutoff().filter(|_| end.is_cut_off());
    let unfinished = cutoff.map(|how| warnings::unfinished(how, starts));
    warnings.extend(unfinished.clone());
    warnings.extend(end_warning(end));
    Ok(Identification {
        schema: SCHEMA,
        method: "output-error",
        model: problem.model.name.clone(),
        recordings: problem.datasets.iter().map(|dataset| dataset.name().to_owned()).collect(),
        converged: matches!(end, End::Converged | End::AtBound),
        end,
        finished: unfinished.is_none(),
        unfinished,
        iterations: descent.iterations,
        cpu_s,
        combinations: combinations(problem, &descent.point.values, (&uncertainty, &parameters)),
        parameters,
        nuisance: offsets(problem, &descent.point.nuisance, results, &uncertainty, &weights.scales),
        fit,
        joint: Some(uncertainty),
        fit_verdict: Some(verdict.explained),
        misfit: verdict::misfit(problem, &channels, results, &weights, &sensor_noise),
        verdict: Some(verdict),
        suspects: Vec::new(),
        input_noise_std: input_noise_std(problem.model, &weights.input_std),
        between: problem
            .model
            .inputs()
            .zip(problem.between.clone())
            .filter(|(input, _)| !input.quantity.is_clock())
            .map(|(input, between)| (input.name.clone(), between))
            .collect(),
        left_out: problem.left_out.clone(),
        advice,
        warnings,
        point: descent.point.values,
        cost,
    })
}

/// Warning about a fit that did not end at a minimum.
fn end_warning(end: End) -> Option<String> {
    let warning = match end {
        End::Stalled | End::IterationLimit => {
            "the fit did not converge; its intervals mean little: give better start values, fix what is known, or look at the residuals"
        }
        // What ended the search says its own sentence.
        End::Converged | End::AtBound | End::Interrupted | End::Budget => return None,
    };
    Some(warning.into())
}

/// Noise levels of the inputs by channel name; zero where none was estimated.
fn input_noise_std(model: &Model, levels: &[f64]) -> Vec<(String, f64)> {
    let levels = levels.iter().copied().chain(std::iter::repeat(0.0));
    model.inputs().zip(levels).map(|(channel, std)| (channel.name.clone(), std)).collect()
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
    // Without measurements the rms is not a number.
    let rms = if sums.count > 0.0 { sums.rms() } else { f64::NAN };
    let spread = sums.spread().max(1e-300);
    let ratio = rms / spread;
    ChannelFit {
        rms,
        noise_std,
        sensor_noise_std: None,
        nrmse_percent: 100.0 * ratio,
        fit_percent: 100.0 * (1.0 - ratio),
        vaf_percent: 100.0 * (1.0 - ratio * ratio),
        relative_error_percent: 100.0 * (sums.residual_squares / sums.squares.max(1e-300)).sqrt(),
    }
}
