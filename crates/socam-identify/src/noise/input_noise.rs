//! Upper bounds on the noise of each channel, from its highest frequencies.

use socam_model::Channel;

use crate::{
    IdentifyError, Intersample, Problem, noise::innovations_filter::NoiseLevels, preprocessing::segments,
};

/// Order of the differences, which remove an input's motion and keep its noise.
const DIFFERENCES: usize = 8;
/// Gain of the differences for the variance of white noise, binomial(16, 8). It is used for rates too, whose noise is blue.
const DIFFERENCED: f64 = 12_870.0;
/// Rows of a window over which squared differences are averaged.
const WINDOW: usize = 64;
/// Quantile of the windows that bounds the noise of an input.
const QUIET: f64 = 0.5;
/// Safety factor on the bound of an input: the median of the windows lies below their mean, and both have an error.
const MARGIN: f64 = 1.1;
/// Share of the steps from row to row without any change from which an input is a command, which has no noise.
const REPEATED: f64 = 0.5;
/// Safety factor on the bound of an output, whose noise may be coloured and smaller at the highest frequencies.
pub(crate) const COLOURED: f64 = 3.0;
/// An output is taken to be low-pass filtered, and its noise to be unbounded, if its highest frequencies have less than [`FILTERED`] of
/// its standard deviation and less than [`STEEP`] of the next lower frequencies.
const FILTERED: f64 = 1e-4;
const STEEP: f64 = 0.03;
/// Most rows of a segment, and most segments, that are evaluated.
const MOST_ROWS: u64 = 32_768;
const MOST_SEGMENTS: usize = 8;

/// Whether an input is measured with noise; a reference, a clock and a signal that only laws read are exact.
pub(crate) fn is_measured(channel: &Channel) -> bool {
    !channel.quantity.is_exact()
}

/// Upper bound on the standard deviation of each channel's noise, SI: its highest frequencies, taken as noise alone. It is zero for an
/// input that is not measured or is a command, and the model file's value for an input of known noise. The part of an output's residual beyond the bound is
/// misfit; counted as noise it would give that output too little weight, and noisy inputs too much.
pub(crate) fn most(problem: &Problem<'_>) -> Result<NoiseLevels, IdentifyError> {
    let inputs = problem.model.inputs().count();
    let mut windows: Vec<Vec<Sizes>> = vec![Vec::new(); inputs + problem.outputs()];
    for segment in problem.segments.iter().take(MOST_SEGMENTS) {
        let head = segment.head(MOST_ROWS);
        let dataset = &problem.datasets[segment.recording];
        segments::read(problem.model, dataset, &head, &vec![Intersample::Linear; inputs], |chunk| {
            // A recording resampled at `parts` points per sample has noise of the same spectral density, and `parts` times its variance.
            let parts = dataset.rows_per_sample() as usize;
            for (values, windows) in chunk.inputs.iter().chain(&chunk.outputs).zip(&mut windows) {
                let values: Vec<f64> = values.iter().copied().step_by(parts).collect();
                for window in values.chunks_exact(WINDOW) {
                    let sizes = Sizes::of(window, parts as f64);
                    windows.extend((!sizes.fast.is_nan()).then_some(sizes));
                }
            }
        })?;
    }
    let outputs = windows.split_off(inputs);
    let inputs = windows.into_iter().zip(problem.model.inputs()).zip(&problem.intersample);
    let inputs = inputs.map(|((windows, channel), kind)| {
        let repeated = windows.iter().map(|window| window.repeated).sum::<f64>();
        let is_command = *kind == Intersample::Hold || repeated > REPEATED * windows.len() as f64;
        let bound = MARGIN * quantile(windows.iter().map(|window| window.fast), QUIET);
        let open = if is_command { 0.0 } else { bound };
        if is_measured(channel) { channel.noise_std.unwrap_or(open) } else { 0.0 }
    });
    Ok(NoiseLevels {
        outputs: outputs.iter().map(|windows| most_of_output(windows)).collect(),
        inputs: inputs.collect(),
    })
}

/// Upper bound on an output's noise; infinity where the output is low-pass filtered.
fn most_of_output(windows: &[Sizes]) -> f64 {
    let fast = quantile(windows.iter().map(|window| window.fast), 0.9);
    let slower = quantile(windows.iter().map(|window| window.slower), 0.9);
    let count = windows.len() as f64;
    let mean = windows.iter().map(|window| window.mean).sum::<f64>() / count;
    let spread = windows.iter().map(|window| window.variance + (window.mean - mean).powi(2)).sum::<f64>();
    let is_filtered = fast < FILTERED * (spread / count).sqrt() && fast < STEEP * slower;
    if fast > 0.0 && !is_filtered { COLOURED * fast } else { f64::INFINITY }
}

/// Square root of a quantile of variances; zero if there are none.
fn quantile(variances: impl Iterator<Item = f64>, part: f64) -> f64 {
    let mut values: Vec<f64> = variances.collect();
    values.sort_by(f64::total_cmp);
    values.get((part * values.len() as f64) as usize).map_or(0.0, |variance| variance.sqrt())
}

/// Statistics of a window of a channel; NaN if a value is missing.
#[derive(Debug, Clone, Copy)]
struct Sizes {
    /// Variance of white noise with the same mean squared differences, of all values and of every other value.
    fast: f64,
    slower: f64,
    mean: f64,
    variance: f64,
    /// Share of the steps from value to value without any change.
    repeated: f64,
}

impl Sizes {
    fn of(window: &[f64], parts: f64) -> Self {
        let every_other: Vec<f64> = window.iter().copied().step_by(2).collect();
        let mean = window.iter().sum::<f64>() / window.len() as f64;
        let variance = window.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / window.len() as f64;
        let repeated =
            window.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64 / (window.len() - 1) as f64;
        let (fast, slower) = (parts * differenced(window), parts * differenced(&every_other));
        Self { fast, slower, mean, variance, repeated }
    }
}

/// Variance of white noise with the same mean squared differences.
fn differenced(window: &[f64]) -> f64 {
    let mut values = window.to_vec();
    for _ in 0..DIFFERENCES {
        values = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    values.iter().map(|v| v * v).sum::<f64>() / (values.len() as f64 * DIFFERENCED)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_low_pass_filter_left_says_nothing_of_noise() {
        let mut random = 3_u64;
        let mut draw = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let noisy: Vec<f64> = (0..6400).map(|k| (0.01 * f64::from(k)).sin() + 0.01 * draw()).collect();
        let filtered = crate::preprocessing::filters::low_pass(&noisy, 8, 0.05);
        let of = |values: &[f64]| {
            let windows: Vec<Sizes> =
                values.chunks_exact(WINDOW).map(|window| Sizes::of(window, 1.0)).collect();
            most_of_output(&windows)
        };
        let white = of(&noisy);
        assert!((0.012..0.024).contains(&white), "{white}");
        assert_eq!(of(&filtered), f64::INFINITY);
    }
}
