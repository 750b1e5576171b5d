//! Whether a finding matters: how much of the predicted signals it moves.

use socam_identify::{
    IdentifyError,
    comparison::{self, Traces},
};

use crate::{context::Context, selection::Path};

/// The channel that a finding moves most, as a share of the standard deviation of what was measured.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Moves {
    pub(crate) channel: String,
    pub(crate) share: f64,
}

/// How much a term moves the predictions of the training recordings: its amplitude set to its null value, all else as it is. `None` where
/// that cannot be predicted.
pub(crate) fn moves(context: &Context<'_>, path: &Path, term: usize) -> Result<Option<Moves>, IdentifyError> {
    let Some((model, values)) = path.begun_without(term) else { return Ok(None) };
    let problem = context.problem(&model)?;
    let Some(at) = comparison::measure(&problem, &path.noise, &values)? else { return Ok(None) };
    let without = comparison::traces(&problem, &at, None)?;
    let with = comparison::traces(&context.problem(&path.last.model)?, &path.last.at, None)?;
    let each = path.last.model.outputs().enumerate().filter_map(|(output, channel)| {
        // Beyond all of it, a free run without the term is another motion.
        let share = (difference(&with, &without, output) / spread(&with, output)).min(1.0);
        share.is_finite().then(|| Moves { channel: channel.name.clone(), share })
    });
    Ok(each.max_by(|a, b| a.share.total_cmp(&b.share)))
}

/// Root mean square difference of two predictions.
fn difference(a: &[Traces], b: &[Traces], output: usize) -> f64 {
    let pairs = a.iter().zip(b).flat_map(|(a, b)| a.predicted[output].iter().zip(&b.predicted[output]));
    let squares: Vec<f64> = pairs.map(|(a, b)| (a - b).powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

/// Standard deviation of what was measured.
fn spread(traces: &[Traces], output: usize) -> f64 {
    let values: Vec<f64> = traces
        .iter()
        .flat_map(|trace| &trace.measured[output])
        .copied()
        .filter(|value| !value.is_nan())
        .collect();
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len().max(1) as f64).sqrt()
}
