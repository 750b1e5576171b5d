//! Search for a channel with the wrong sign or in another unit than its column says, where a model explains next to nothing: the most frequent
//! faults of a bench's wiring and of its log.

use std::f64::consts::PI;

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
/// Factors between units that are taken for each other: powers of ten, degrees and radians, revolutions a minute and radians a second.
const FACTORS: [f64; 10] = [1e-3, 1e3, 1e-2, 1e2, 0.1, 10.0, PI / 180.0, 180.0 / PI, PI / 30.0, 30.0 / PI];
/// Segments, rows of each, and iterations of a fit with another scale.
const SEGMENTS: usize = 2;
const ROWS: u64 = 4000;
const ITERATIONS: usize = 30;

/// A sentence about the channel whose other sign or unit explains the recordings, if there is one.
pub(crate) fn warning(problem: &Problem<'_>, descent: &Descent) -> Result<Option<String>, IdentifyError> {
    let own = descent.free_run();
    if own < LEFT {
        return Ok(None);
    }
    let mut best: Option<(f64, usize, f64)> = None;
    let channels = problem.model.channels.iter().enumerate().filter(|(_, one)| !one.quantity.is_clock());
    for (index, channel) in channels {
        for factor in [Some(-1.0), likeliest_unit(problem, index)?].into_iter().flatten() {
            let Some(left) = left_with(problem, index, factor, ITERATIONS)? else { continue };
            // Two channels that are told by each other alone leave the same: the sensor is named.
            let is_sensor = channel.role == Role::Output;
            let least =
                best.map_or(RIGHT * own, |(least, ..)| if is_sensor { 1.01 * least } else { 0.99 * least });
            if left < least {
                best = Some((left, index, factor));
            }
        }
    }
    Ok(best.map(|(left, index, factor)| {
        let channel = &problem.model.channels[index];
        let (what, remedy) = if factor < 0.0 {
            ("has the wrong sign".to_owned(), "look at its wiring, or state the sign there")
        } else {
            let (times, way) = if factor > 1.0 { (factor, "small") } else { (1.0 / factor, "large") };
            let times = format!("is {} times too {way}", (1e3 * times).round() / 1e3);
            (times, "look at the unit of its column, or state the factor there")
        };
        format!(
            "`{}` {what} beside the other channels: with `scale = {}` in [channels.{}] the model leaves {:.1} % of the outputs' variance instead of {:.0} %: {remedy}",
            channel.name,
            factor * channel.scale,
            channel.name,
            100.0 * left / problem.outputs() as f64,
            100.0 * own / problem.outputs() as f64,
        )
    }))
}

/// The factor of [`FACTORS`] on a channel under which the file's values leave the least.
fn likeliest_unit(problem: &Problem<'_>, channel: usize) -> Result<Option<f64>, IdentifyError> {
    let mut best: Option<(f64, f64)> = None;
    for factor in FACTORS {
        let left = left_with(problem, channel, factor, 0)?;
        if let Some(left) = left.filter(|left| best.is_none_or(|(least, _)| *left < least)) {
            best = Some((left, factor));
        }
    }
    Ok(best.map(|(_, factor)| factor))
}

/// Misfit of a free run with a channel's scale times a factor, fitted from the file's values; `None` where the prediction overflows.
fn left_with(
    problem: &Problem<'_>,
    channel: usize,
    factor: f64,
    iterations: usize,
) -> Result<Option<f64>, IdentifyError> {
    let mut model = problem.model.clone();
    let changed = &mut model.channels[channel];
    (changed.scale, changed.offset) = (factor * changed.scale, factor * changed.offset);
    let runs = problem.segments.iter().filter(|segment| segment.starts_uninterrupted());
    let changed = Problem::of_segments(
        (&model, problem.datasets),
        problem.free.clone(),
        runs.take(SEGMENTS).map(|segment| segment.head(ROWS)).collect(),
        problem.options.clone(),
        problem.intersample.clone(),
    );
    let values = model.values();
    let nuisance = nuisance::first(&changed, &values)?;
    let point = Point { values, nuisance };
    let weights = first_weights(&changed, &point);
    let found = weights.and_then(|weights| {
        descend(&changed, point, weights, COARSE_TOLERANCE, iterations, Stage::Intervals)
    });
    match found {
        Ok(found) => Ok(Some(found.free_run())),
        Err(IdentifyError::Diverged { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}
