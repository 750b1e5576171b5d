//! Search for a channel with the wrong sign, where a model explains next to nothing: the most frequent fault of a bench's wiring.

use socam_model::Role;

use crate::{
    IdentifyError, Problem,
    evaluation::Point,
    optimiser::{
        descent::{COARSE_TOLERANCE, Descent, descend},
        noise_estimation::first_weights,
        nuisance,
    },
    progress::Stage,
};

/// Share of an output's variance, summed over the outputs, that must be left before signs are tried.
const LEFT: f64 = 0.3;
/// Share of it that may be left with the other sign.
const RIGHT: f64 = 0.1;
/// Segments, rows of each, and iterations of a fit with another sign.
const SEGMENTS: usize = 2;
const ROWS: u64 = 4000;
const ITERATIONS: usize = 30;

/// A sentence about the channel whose other sign explains the recordings, if there is one.
pub(crate) fn warning(problem: &Problem<'_>, descent: &Descent) -> Result<Option<String>, IdentifyError> {
    let own = descent.free_run();
    if own < LEFT {
        return Ok(None);
    }
    let mut best: Option<(f64, usize)> = None;
    let channels = problem.model.channels.iter().enumerate().filter(|(_, one)| !one.quantity.is_clock());
    for (index, channel) in channels {
        let Some(left) = left_with_other_sign(problem, index)? else { continue };
        // Two channels whose signs are told by each other alone leave the same: the sensor is named.
        let is_sensor = channel.role == Role::Output;
        let least =
            best.map_or(RIGHT * own, |(least, _)| if is_sensor { 1.01 * least } else { 0.99 * least });
        if left < least {
            best = Some((left, index));
        }
    }
    Ok(best.map(|(left, index)| {
        let channel = &problem.model.channels[index];
        format!(
            "`{}` has the wrong sign beside the other channels: with `scale = {}` in [channels.{}] the model leaves {:.1} % of the outputs' variance instead of {:.0} %: look at its wiring, or state the sign there",
            channel.name,
            -channel.scale,
            channel.name,
            100.0 * left / problem.outputs() as f64,
            100.0 * own / problem.outputs() as f64,
        )
    }))
}

/// Misfit of a free run with the other sign of a channel, fitted from the file's values; `None` where the prediction overflows.
fn left_with_other_sign(problem: &Problem<'_>, channel: usize) -> Result<Option<f64>, IdentifyError> {
    let mut model = problem.model.clone();
    let turned = &mut model.channels[channel];
    (turned.scale, turned.offset) = (-turned.scale, -turned.offset);
    let runs = problem.segments.iter().filter(|segment| segment.starts_uninterrupted());
    let turned = Problem::of_segments(
        (&model, problem.datasets),
        problem.free.clone(),
        runs.take(SEGMENTS).map(|segment| segment.head(ROWS)).collect(),
        problem.options.clone(),
        problem.intersample.clone(),
    );
    let values = model.values();
    let nuisance = nuisance::first(&turned, &values)?;
    let point = Point { values, nuisance };
    let weights = first_weights(&turned, &point);
    let found = weights
        .and_then(|weights| descend(&turned, point, weights, COARSE_TOLERANCE, ITERATIONS, Stage::Intervals));
    match found {
        Ok(found) => Ok(Some(found.free_run())),
        Err(IdentifyError::Diverged { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}
