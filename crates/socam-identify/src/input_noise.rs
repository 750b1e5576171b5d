//! How much noise a measured input can hold.

use socam_model::{Channel, Quantity};

use crate::{IdentifyError, Intersample, Problem, feed};

/// Order of the differences that leave an input's noise and not its motion.
const DIFFERENCES: usize = 8;
/// Variance of white noise after them, binomial(16, 8).
const DIFFERENCED: f64 = 12_870.0;
/// Rows of a window over which differences are averaged.
const WINDOW: usize = 64;
/// The median of windows lies below the mean, and neither is exact.
const MARGIN: f64 = 1.1;
/// Rows and stretches that are looked at.
const MOST_ROWS: u64 = 32_768;
const MOST_STRETCHES: usize = 8;

/// Whether a channel drives the model by what a sensor said of a motion.
pub(crate) fn is_measured(channel: &Channel) -> bool {
    channel.quantity != Quantity::Reference
}

/// Most noise that each input can hold, SI: what its highest frequencies hold, were they noise alone. Zero for an input
/// that is not measured.
pub(crate) fn most(problem: &Problem<'_>) -> Result<Vec<f64>, IdentifyError> {
    let inputs: Vec<&Channel> = problem.model.inputs().collect();
    let mut windows: Vec<Vec<f64>> = vec![Vec::new(); inputs.len()];
    for stretch in problem.stretches.iter().take(MOST_STRETCHES) {
        let head = feed::Stretch { rows: stretch.rows.min(MOST_ROWS), ..stretch.clone() };
        let dataset = &problem.datasets[stretch.recording];
        feed::read(problem.model, dataset, &head, Intersample::Linear, |chunk| {
            for (input, windows) in chunk.inputs.iter().zip(&mut windows) {
                windows.extend(input.chunks_exact(WINDOW).map(differenced));
            }
        })?;
    }
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).map_or(0.0, |variance| MARGIN * variance.sqrt())
    };
    let each = windows.into_iter().zip(inputs);
    Ok(each.map(|(windows, channel)| if is_measured(channel) { median(windows) } else { 0.0 }).collect())
}

/// Variance of white noise that would leave differences of this size.
fn differenced(window: &[f64]) -> f64 {
    let mut values = window.to_vec();
    for _ in 0..DIFFERENCES {
        values = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    values.iter().map(|v| v * v).sum::<f64>() / (values.len() as f64 * DIFFERENCED)
}
