//! Whether a fitted model explains its recordings, in units of the sensors' noise.

use socam_model::Channel;

use crate::{
    IdentifyError,
    evaluation::{self, ChannelSums, SegmentEvaluation, Weights},
    noise::input_noise,
    problem::Problem,
    report::{ChannelFit, Explained, Verdict},
};

/// Ratio of residual to noise up to which a channel is explained, if its noise is stated, and if it is estimated from the fastest content of
/// the channel, which may hold less than coloured noise has.
const EXPLAINED: [f64; 2] = [1.5, 2.0];
/// Ratio of residual to noise, and to the channel's standard deviation, above which a channel is not explained.
const NOT_EXPLAINED: [f64; 2] = [10.0, 0.2];

/// Noise of each output's sensor, SI: stated, or from the fastest content of the channel; `None` where neither says it.
pub(crate) fn sensor_noise(problem: &Problem<'_>) -> Result<Vec<Option<f64>>, IdentifyError> {
    let most = input_noise::most(problem)?.outputs;
    let each = problem.model.outputs().zip(most);
    let each = each.map(|(channel, most)| channel.noise_std.unwrap_or(most / input_noise::COLOURED));
    Ok(each.map(|std| Some(std).filter(|std| std.is_finite() && *std > 0.0)).collect())
}

/// What is left of each output, SI. Noise of the inputs is in the residuals of a free run, and not in what a prediction from sample to sample
/// leaves.
fn left(channels: &[ChannelSums], results: &[SegmentEvaluation], weights: &Weights) -> Vec<f64> {
    let values: f64 = channels.iter().map(|channel| channel.count).sum();
    let whitened = (evaluation::squares(results) / values.max(1.0)).sqrt();
    let inputs_are_noisy = weights.levels().in_the_input();
    let own = channels.iter().zip(&weights.noise_std);
    own.map(|(sums, std)| if inputs_are_noisy { whitened * std } else { sums.rms() }).collect()
}

/// What is left of each output in units of its sensor's noise, where that is known.
pub(crate) fn misfit(
    problem: &Problem<'_>,
    channels: &[ChannelSums],
    results: &[SegmentEvaluation],
    weights: &Weights,
    sensor_noise: &[Option<f64>],
) -> Vec<(String, f64)> {
    let each = problem.model.outputs().zip(left(channels, results, weights)).zip(sensor_noise);
    each.filter_map(|((channel, left), std)| Some((channel.name.clone(), left / (*std)?))).collect()
}

impl Verdict {
    /// Judges all outputs; the worst one decides.
    pub(crate) fn new(
        problem: &Problem<'_>,
        channels: &[ChannelSums],
        results: &[SegmentEvaluation],
        weights: &Weights,
        sensor_noise: &[Option<f64>],
    ) -> Self {
        let inputs_are_noisy = weights.levels().in_the_input();
        let lefts = left(channels, results, weights);
        let mut worst: Option<(Explained, f64, usize, f64, &Channel)> = None;
        for (index, ((channel, sums), noise_std)) in
            problem.model.outputs().zip(channels).zip(sensor_noise).enumerate()
        {
            let Some(noise_std) = noise_std.filter(|_| sums.count > 0.0 && sums.spread() > 0.0) else {
                continue;
            };
            let times = lefts[index] / noise_std;
            let own = (explained(channel, sums, times), times, index, noise_std, channel);
            if worst.is_none_or(|worst| (own.0, own.1) > (worst.0, worst.1)) {
                worst = Some(own);
            }
        }
        let Some((explained, times, index, noise_std, channel)) = worst else {
            return Self {
                explained: Explained::NotJudged,
                channel: None,
                times_noise: None,
                noise_std: None,
                unit: None,
                beside_input_noise: false,
                recording: None,
            };
        };
        let segments = problem.segments.iter().zip(results);
        let rms = |(_, result): &(_, &SegmentEvaluation)| result.channels[index].rms();
        let most = segments.max_by(|a, b| rms(a).total_cmp(&rms(b)));
        Self {
            explained,
            channel: Some(channel.name.clone()),
            times_noise: Some(times),
            noise_std: Some(noise_std),
            unit: Some(channel.unit),
            beside_input_noise: inputs_are_noisy,
            recording: most.map(|(segment, _)| problem.datasets[segment.recording].name().to_owned()),
        }
    }

    /// What a reader of the estimates should know; `None` where the model explains the recordings.
    pub(crate) fn warning(&self, channels: &[(String, ChannelFit)]) -> Option<String> {
        let (name, times, noise) = (self.channel.as_ref()?, self.times_noise?, self.noise_std?);
        let (_, fit) = channels.iter().find(|(own, _)| own == name)?;
        let (rms, unit, noise, times) = (digits(fit.rms), self.unit?, digits(noise), digits(times));
        let left = if self.beside_input_noise {
            format!(
                "{times} times the noise of {name} ({noise} {unit}) from sample to sample, and {rms} {unit} rms in free run"
            )
        } else {
            format!("{rms} {unit} rms of {name}, {times} times its noise of {noise} {unit}")
        };
        match self.explained {
            Explained::Yes | Explained::NotJudged => None,
            Explained::InPart => Some(format!(
                "the model explains these recordings only in part: it leaves {left}; `diagnose` says what it leaves out"
            )),
            Explained::No => Some(format!(
                "the model does not explain these recordings: it leaves {left}; its parameters mean little: `diagnose` says what it leaves out"
            )),
        }
    }
}

/// A number in three significant digits.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    if (1e-3..1e6).contains(&rounded.abs()) { format!("{rounded}") } else { format!("{rounded:e}") }
}

fn explained(channel: &Channel, sums: &ChannelSums, times: f64) -> Explained {
    let [stated, estimated] = EXPLAINED;
    let [times_noise, share] = NOT_EXPLAINED;
    if times <= if channel.noise_std.is_some() { stated } else { estimated } {
        Explained::Yes
    } else if times > times_noise && sums.rms() > share * sums.spread() {
        Explained::No
    } else {
        Explained::InPart
    }
}
