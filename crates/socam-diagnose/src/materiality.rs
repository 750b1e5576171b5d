//! Materiality of a finding: by how much its term moves the predicted signals.

use socam_identify::{
    IdentifyError,
    comparison::{self, Traces},
};

use crate::{context::Context, selection::Path};

/// The channel that a term moves most.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LargestChange {
    pub(crate) channel: String,
    /// Root mean square change of the prediction over the standard deviation of the measured signal, 1.
    pub(crate) share: f64,
}

/// The largest change of a channel's prediction on the training recordings when a term's amplitude is set to its null value and nothing
/// else is changed. `None` if the prediction without the term overflows.
pub(crate) fn largest_change(
    context: &Context<'_>,
    path: &Path,
    term: usize,
) -> Result<Option<LargestChange>, IdentifyError> {
    let without = path.evaluated_without(context, term, &path.noise)?;
    let Some((model, at)) = without else { return Ok(None) };
    let without = comparison::traces(&context.problem(&model)?, &at, None)?;
    let with = comparison::traces(&context.problem(&path.last.model)?, &path.last.at, None)?;
    let each = path.last.model.outputs().enumerate().filter_map(|(output, channel)| {
        // A change as large as the signal means a different motion; larger shares mean no more, so the share is limited to 1.
        let share = (difference(&with, &without, output) / standard_deviation(&with, output)).min(1.0);
        share.is_finite().then(|| LargestChange { channel: channel.name.clone(), share })
    });
    Ok(each.max_by(|a, b| a.share.total_cmp(&b.share)))
}

/// Root mean square difference of two predictions.
fn difference(a: &[Traces], b: &[Traces], output: usize) -> f64 {
    let pairs = a.iter().zip(b).flat_map(|(a, b)| a.predicted[output].iter().zip(&b.predicted[output]));
    let squares: Vec<f64> = pairs.map(|(a, b)| (a - b).powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

/// Standard deviation of the measured signal over all recordings.
fn standard_deviation(traces: &[Traces], output: usize) -> f64 {
    let values: Vec<f64> = traces
        .iter()
        .flat_map(|trace| &trace.measured[output])
        .copied()
        .filter(|value| !value.is_nan())
        .collect();
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len().max(1) as f64).sqrt()
}
