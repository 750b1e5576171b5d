//! Iterated generalised least squares: descents in turn with estimates of the noise levels.

use socam_model::Channel;

use crate::{
    IdentifyError,
    evaluation::{self, ChannelSums, Point, Weights, channel_sums},
    noise::{innovations_filter::NoiseLevels, input_noise, levels, prewhitening},
    optimiser::{
        descent::{COARSE_TOLERANCE, Descent, End, TOLERANCE, descend},
        factors,
    },
    problem::{Noise, Problem},
    progress::Stage,
};

/// Relative change of the noise levels below which they have converged.
const NOISE_SETTLED: f64 = 0.01;

/// Relative change of the noise levels below which descents get their fine tolerance.
const NOISE_NEAR: f64 = 0.1;

/// Ratio of the squared residuals of a free run to the least ones on the way above which a fit has left the data. Weights by noise of the inputs
/// may well cost some: an axis with nothing that holds it integrates the noise of its force, and fits whose free run is three times further off
/// are nearer to its published parameters (EMPS).
const LEFT_THE_DATA: f64 = 16.0;

/// Ratio of residuals to known output noise that counts as noise: noise of the inputs adds to them.
const PLAUSIBLE: f64 = 1.5;

/// Misfit of a free run below which residuals are rounding.
const PERFECT: f64 = 1e-10;

/// Largest number of re-estimations of the noise levels.
const MOST_ROUNDS: usize = 6;

/// First noise levels: those given, or 2 % of each channel's standard deviation.
pub(crate) fn first_weights(problem: &Problem<'_>, point: &Point) -> Result<Weights, IdentifyError> {
    let scales = factors::scales(problem, &point.values);
    let mut weights = Weights::white(vec![1.0; problem.outputs()], scales);
    match &problem.options.noise {
        Noise::Given(given) => weights.noise_std.clone_from(&given.outputs),
        Noise::Estimated => {
            let Some(results) = evaluation::run(problem, point, &weights)? else {
                return Err(IdentifyError::Diverged { model: problem.model.name.clone() });
            };
            let known = problem.model.outputs().map(|channel| channel.noise_std);
            weights.noise_std = channel_sums(&results)
                .iter()
                .zip(known)
                .map(|(channel, known)| {
                    // A constant channel has no standard deviation, but it has residuals.
                    let level = (0.02 * channel.spread()).max(1e-3 * channel.rms());
                    known.unwrap_or_else(|| floor(level, channel))
                })
                .collect();
        }
    }
    Ok(weights)
}

/// A noise level above zero, for constant channels and perfect predictions. That of a channel without values weights nothing.
fn floor(noise_std: f64, channel: &ChannelSums) -> f64 {
    if channel.count == 0.0 {
        return 1.0;
    }
    let size = (channel.squares / channel.count.max(1.0)).sqrt();
    noise_std.max(1e-9 * size).max(1e-100)
}

/// Descents in turn with estimates of the noise levels from their residuals, until the levels converge.
pub(crate) fn iterated_gls(problem: &Problem<'_>, point: Point) -> Result<Descent, IdentifyError> {
    let weights = first_weights(problem, &point)?;
    let most = match &problem.options.noise {
        Noise::Given(given) => given.clone(),
        Noise::Estimated => input_noise::most(problem)?,
    };
    let first = Stage::Descent { round: 1 };
    if matches!(problem.options.noise, Noise::Given(_)) && !most.in_the_input() {
        return descend(problem, point, weights, TOLERANCE, problem.options.max_iterations, first);
    }
    let mut descent =
        descend(problem, point, weights, COARSE_TOLERANCE, problem.options.max_iterations, first)?;
    let mut iterations = descent.iterations;
    if most.in_the_input() && may_be_noise(problem, &descent, &most) && !descent.end.is_cut_off() {
        // Residuals of a point that is not quite a minimum look like noise of the inputs.
        let scales = factors::scales(problem, &descent.point.values);
        let white = Weights::white(white_levels(problem, &descent, &most), scales);
        let most = problem.options.max_iterations;
        descent = descend(problem, descent.point, white, TOLERANCE, most, first)?;
        iterations += descent.iterations;
    }
    let mut fine = false;
    let mut nearest = Nearest::of(&descent);
    for round in 1..=MOST_ROUNDS {
        // A search that was cut off may end once the noise has been estimated.
        if round > 1 && descent.end.is_cut_off() {
            break;
        }
        let before = descent.weights.levels();
        let levels = reestimated_levels(problem, &descent, &most)?;
        let levels = if prewhitening::exists(problem, &descent.point.values, &levels) {
            levels
        } else {
            NoiseLevels { inputs: vec![0.0; levels.inputs.len()], ..levels }
        };
        if fine && alike(&before, &levels, NOISE_SETTLED) {
            break;
        }
        fine = fine
            || !levels.in_the_input()
            || matches!(problem.options.noise, Noise::Given(_))
            || round + 1 >= MOST_ROUNDS
            || alike(&before, &levels, NOISE_NEAR);
        let tolerance = if fine { TOLERANCE } else { COARSE_TOLERANCE };
        let weights = Weights {
            input_std: levels.inputs.clone(),
            ..Weights::white(levels.outputs, factors::scales(problem, &descent.point.values))
        };
        let stage = Stage::Descent { round: round + 1 };
        descent = descend(problem, descent.point, weights, tolerance, problem.options.max_iterations, stage)?;
        iterations += descent.iterations;
        let away = descent.free_run() / nearest.free_run;
        if away > LEFT_THE_DATA && descent.free_run() > PERFECT {
            if are_open(problem) {
                let exact = Weights::white(nearest.rms, factors::scales(problem, &nearest.point.values));
                let most = problem.options.max_iterations;
                descent = descend(problem, nearest.point, exact, TOLERANCE, most, stage)?;
                iterations += descent.iterations;
            }
            descent.left_the_data = Some(away.sqrt());
            break;
        }
        if away < 1.0 {
            nearest = Nearest::of(&descent);
        }
    }
    descent.iterations = iterations;
    Ok(descent)
}

/// The visited point with the least residuals of a free run.
struct Nearest {
    free_run: f64,
    point: Point,
    /// Root mean square of each output's residuals there.
    rms: Vec<f64>,
}

impl Nearest {
    fn of(descent: &Descent) -> Self {
        let rms = descent.channels().iter().map(|channel| floor(channel.rms(), channel)).collect();
        Self { free_run: descent.free_run(), point: descent.point.clone(), rms }
    }
}

/// Whether the noise of at least one input is estimated.
fn are_open(problem: &Problem<'_>) -> bool {
    problem.options.noise == Noise::Estimated
        && problem.model.inputs().any(|input| input_noise::is_measured(input) && input.noise_std.is_none())
}

/// Noise levels estimated from the residuals of a descent.
fn reestimated_levels(
    problem: &Problem<'_>,
    descent: &Descent,
    most: &NoiseLevels,
) -> Result<NoiseLevels, IdentifyError> {
    if let Noise::Given(given) = &problem.options.noise {
        return Ok(given.clone());
    }
    let start = if descent.weights.input_std.is_empty() {
        NoiseLevels { outputs: white_levels(problem, descent, most), inputs: most.inputs.clone() }
    } else {
        descent.weights.levels()
    };
    if start.in_the_input() {
        levels::maximum_likelihood(problem, &descent.point, start, most)
    } else {
        Ok(start)
    }
}

/// Whether noise levels are estimated and each output's residuals lie below the largest noise that it can have.
fn may_be_noise(problem: &Problem<'_>, descent: &Descent, most: &NoiseLevels) -> bool {
    let mut channels = descent.channels().into_iter().zip(&most.outputs);
    problem.options.noise == Noise::Estimated && channels.all(|(channel, most)| channel.rms() <= *most)
}

/// Whether a descent converged to a fit whose residuals can be noise in every channel.
pub(crate) fn leaves_noise(problem: &Problem<'_>, descent: &Descent) -> Result<bool, IdentifyError> {
    let most = match &problem.options.noise {
        Noise::Given(given) => given.outputs.iter().map(|std| PLAUSIBLE * std).collect(),
        Noise::Estimated => {
            let known = problem.model.outputs().map(|channel| channel.noise_std);
            let most = input_noise::most(problem)?.outputs.into_iter().zip(known);
            most.map(|(most, known)| known.map_or(most, |known| PLAUSIBLE * known)).collect::<Vec<_>>()
        }
    };
    let channels = descent.channels();
    let noise = |(channel, most): (&ChannelSums, &f64)| most.is_finite() && channel.rms() <= *most;
    Ok(descent.end == End::Converged && channels.iter().zip(&most).all(noise))
}

/// Noise levels of the outputs as if all of the residuals were white noise.
fn white_levels(problem: &Problem<'_>, descent: &Descent, most: &NoiseLevels) -> Vec<f64> {
    let most_matters = most.in_the_input();
    let channels = problem.model.outputs().zip(descent.channels()).zip(&most.outputs);
    let level = |((output, channel), most): ((&Channel, ChannelSums), &f64)| {
        let most = if most_matters { *most } else { f64::INFINITY };
        output.noise_std.unwrap_or_else(|| floor(channel.rms().min(most), &channel))
    };
    channels.map(level).collect()
}

/// Whether two sets of levels differ by less than a relative tolerance.
pub(crate) fn alike(a: &NoiseLevels, b: &NoiseLevels, tolerance: f64) -> bool {
    let pairs = a.outputs.iter().chain(&a.inputs).zip(b.outputs.iter().chain(&b.inputs));
    a.inputs.len() == b.inputs.len()
        && pairs.fold(true, |alike, (a, b)| alike && (a - b).abs() <= tolerance * b)
}
