//! How much noise a channel can hold.

use socam_model::{Channel, Quantity};

use crate::{IdentifyError, Intersample, Problem, feed, whitener::NoiseLevels};

/// Order of the differences that leave an input's noise and not its motion.
const DIFFERENCES: usize = 8;
/// Variance of white noise after them, binomial(16, 8); of a rate's, though it is blue, too.
const DIFFERENCED: f64 = 12_870.0;
/// Rows of a window over which differences are averaged.
const WINDOW: usize = 64;
/// The median of windows lies below the mean, and neither is exact.
const MARGIN: f64 = 1.1;
/// An output's noise need not be white: at its highest frequencies it may be so many times less.
const COLOURED: f64 = 3.0;
/// Rows and stretches that are looked at.
const MOST_ROWS: u64 = 32_768;
const MOST_STRETCHES: usize = 8;

/// Whether a channel drives the model by what a sensor said of a motion.
pub(crate) fn is_measured(channel: &Channel) -> bool {
    channel.quantity != Quantity::Reference && !channel.quantity.is_clock()
}

/// Most noise that each channel can hold, SI: what its highest frequencies hold, were they noise alone. Zero for an input
/// that is not measured, what the model file gives for one whose noise is known. What an output's residual has beyond it is
/// misfit: to take it for noise would be to believe that output less, and noisy inputs more, than they deserve.
pub(crate) fn most(problem: &Problem<'_>) -> Result<NoiseLevels, IdentifyError> {
    let inputs = problem.model.inputs().count();
    let mut windows: Vec<Vec<f64>> = vec![Vec::new(); inputs + problem.outputs()];
    for stretch in problem.stretches.iter().take(MOST_STRETCHES) {
        let head = feed::Stretch { rows: stretch.rows.min(MOST_ROWS), ..stretch.clone() };
        let dataset = &problem.datasets[stretch.recording];
        feed::read(problem.model, dataset, &head, Intersample::Linear, |chunk| {
            for (values, windows) in chunk.inputs.iter().chain(&chunk.outputs).zip(&mut windows) {
                let variances = values.chunks_exact(WINDOW).map(differenced);
                windows.extend(variances.filter(|variance| !variance.is_nan()));
            }
        })?;
    }
    let quantile = |mut values: Vec<f64>, part: f64| {
        values.sort_by(f64::total_cmp);
        let at = (part * values.len() as f64) as usize;
        values.get(at).map(|variance| variance.sqrt()).filter(|std| *std > 0.0)
    };
    let outputs = windows.split_off(inputs).into_iter();
    let outputs = outputs.map(|windows| quantile(windows, 0.9).map_or(f64::INFINITY, |std| COLOURED * std));
    let inputs = windows.into_iter().zip(problem.model.inputs()).map(|(windows, channel)| {
        let held = || MARGIN * quantile(windows, 0.5).unwrap_or(0.0);
        if is_measured(channel) { channel.noise_std.unwrap_or_else(held) } else { 0.0 }
    });
    Ok(NoiseLevels { outputs: outputs.collect(), inputs: inputs.collect() })
}

/// Variance of white noise that would leave differences of this size.
fn differenced(window: &[f64]) -> f64 {
    let mut values = window.to_vec();
    for _ in 0..DIFFERENCES {
        values = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    values.iter().map(|v| v * v).sum::<f64>() / (values.len() as f64 * DIFFERENCED)
}
