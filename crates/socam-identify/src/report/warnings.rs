//! Warnings about channels without information, unexplained residuals, unresolved steps and local minima.

use socam_model::Model;

use crate::{
    IdentifyError,
    evaluation::{ChannelSums, SegmentEvaluation},
    noise::input_noise,
    optimiser::starts::StartResult,
    problem::Problem,
};

/// Ratio of residual to noise above which a channel is not explained, if [`UNEXPLAINED_SHARE`] is exceeded too.
const UNEXPLAINED_NOISE: f64 = 10.0;

/// See [`UNEXPLAINED_NOISE`]: ratio of residual to standard deviation of the channel.
const UNEXPLAINED_SHARE: f64 = 0.2;

/// Share of samples with unresolved steps above which there is a warning.
const MOST_UNRESOLVED: f64 = 1e-4;

/// Warnings about outputs without values, or with a constant one.
pub(crate) fn dead_channels(model: &Model, channels: &[ChannelSums]) -> Vec<String> {
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

/// Warning about channels that the model does not explain.
pub(crate) fn unexplained(
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

/// Warning about samples whose steps missed their tolerance.
pub(crate) fn unresolved(results: &[SegmentEvaluation]) -> Option<String> {
    let missed: u64 = results.iter().map(|result| result.unresolved).sum();
    let share = missed as f64 / results.iter().map(|result| result.samples).sum::<f64>();
    (share > MOST_UNRESOLVED).then(|| {
        format!(
            "in {missed} samples ({:.2} %) a force law is steeper than the shortest step of the prediction resolves, which is good on average only there: make the law's transition wider, or sample faster",
            100.0 * share
        )
    })
}

/// Warning about starts that ended in different minima.
pub(crate) fn starts_warning(starts: &[StartResult]) -> Option<String> {
    let best = starts.iter().map(|race| race.cost).fold(f64::INFINITY, f64::min);
    let reached = starts.iter().filter(|race| race.cost < 1.05 * best).count();
    (starts.len() > 1 && reached * 3 < starts.len()).then(|| {
        format!("only {reached} of {} starts came near the best minimum; there may be a better one: try --starts with a larger number", starts.len())
    })
}
