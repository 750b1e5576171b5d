//! Output-error identification: the entry points that fit or evaluate a model.

use crate::{
    IdentifyError,
    comparison::{self, Evaluation, NoiseModel},
    evaluation::{ChannelSums, Weights},
    noise::levels,
    optimiser::{
        descent::{Descent, End},
        intersamples,
        noise_estimation::iterated_gls,
        nuisance::{with_nuisance, with_nuisance_fitted},
        starts::{Starts, best_start},
    },
    preprocessing::outliers,
    problem::Problem,
    report::{self, Fit, Identification},
};

/// Number of searches for outliers. Without the large ones the noise level falls, and smaller ones are found.
const MOST_CLEANINGS: usize = 3;

/// Fits the free parameters of the problem's model to all its recordings by output error: the model is simulated from the measured inputs,
/// and the weighted squares of its output errors are minimised. Parameters and results are in SI.
///
/// ```
/// use socam_identify::{Options, Problem, output_error};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// let problem = Problem::new(&model, &recordings, Options { starts: 1, ..Options::default() })?;
/// let found = output_error(&problem)?;
/// let stiffness = model.parameter("stiffness").unwrap();
/// assert!(found.parameters[stiffness].ci95[0].is_some(), "determined");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Method
/// Levenberg-Marquardt descents (K. Madsen, H. B. Nielsen, O. Tingleff, Methods for Non-Linear Least Squares Problems, 2004) in turn with
/// maximum-likelihood estimates of the noise levels. Residuals coloured by input noise are whitened by a filter that follows the parameters
/// (errors in variables: Söderström, Automatica 43, 2007). Intervals are sandwich estimates with the lag of D. W. K. Andrews
/// (Econometrica 59, 1991).
///
/// # Assumes
/// The residuals of a complete model are sensor noise, and the input does not depend on that noise. Noise of the inputs is estimated
/// with it. Intervals allow for coloured residuals (they come from sums of scores over blocks of 0.5 s), not for bias.
///
/// # Breaks when
/// The recording was made in a closed loop with unmodelled disturbances: the input is correlated with
/// them. Model the loop (a servo) and use its reference as the input.
///
/// # Errors
/// When a recording cannot be read, or the model overflows at its start values. A fit that does not converge is not an error: see
/// [`Identification::end`].
pub fn output_error(problem: &Problem<'_>) -> Result<Identification, IdentifyError> {
    let clock = report::CpuClock::start();
    let mut starts = Starts::default();
    let mut cleaned = problem.clone();
    let start = best_start(&mut cleaned, &mut starts)?;
    let start = if problem.free.is_empty() { with_nuisance(problem, &start.values)?.point } else { start };
    let descent = iterated_gls(&cleaned, start)?;
    let mut descent = intersamples::settled(&mut cleaned, descent, false, intersamples::fitted)?;
    for _ in 0..MOST_CLEANINGS {
        if descent.end.is_cut_off() || !outliers::leave_out(&mut cleaned, &descent.point, &descent.weights)? {
            break;
        }
        let before = descent.iterations;
        descent = iterated_gls(&cleaned, descent.point)?;
        descent.iterations += before;
    }
    report::identification(&cleaned, descent, &starts, clock)
}

/// Estimates and intervals at an existing optimum (`at`, of the problem's model) under a given noise model, without refitting. Only
/// nuisance parameters are fitted.
///
/// ```
/// use socam_identify::{NoiseLevels, Options, Problem, at_minimum, comparison::{FINE, NoiseModel, descend}};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// # let problem = Problem::new(&model, &recordings, Options::default())?;
/// # let values = model.values();
/// # let levels = NoiseLevels { outputs: vec![0.07; 2], inputs: vec![0.0] };
/// # let noise_model = NoiseModel::new(&[&problem], &values, levels.clone())?;
/// let fitted = descend(&problem, &noise_model, &values, None, (FINE, 50))?.expect("no overflow");
/// let found = at_minimum(&problem, &noise_model, &fitted)?;
/// assert!(found.parameters[model.parameter("stiffness").unwrap()].ci95[0].is_some(), "determined");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a recording cannot be read, or the prediction overflows.
pub fn at_minimum(
    problem: &Problem<'_>,
    noise: &NoiseModel,
    at: &Evaluation,
) -> Result<Identification, IdentifyError> {
    let clock = report::CpuClock::start();
    let diverged = || IdentifyError::Diverged { model: problem.model.name.clone() };
    let point = comparison::begin(problem, &at.values, Some((problem.model, at)))?.ok_or_else(diverged)?;
    let parameterless = levels::without_parameters(problem);
    let found = with_nuisance_fitted(&parameterless, point, noise.weights(&parameterless, &at.values))?
        .ok_or_else(diverged)?;
    let progress = &problem.options.progress;
    let end = if progress.stops() { End::cut_off(progress.cutoff()) } else { End::Converged };
    // The correction for regressor noise needs the share of input noise in the residuals.
    let inputs = noise.levels().inputs.iter().map(|std| std / noise.excess().max(1.0).sqrt());
    let weights = Weights { input_std: inputs.collect(), ..noise.weights(problem, &at.values) };
    report::identification(problem, Descent { weights, end, ..found }, &Starts::default(), clock)
}

/// Fit of a model at given parameter values (SI, one per parameter of the model), simulated from the measured inputs. Only start states and
/// offsets are fitted.
///
/// ```
/// use socam_identify::{Options, Problem, evaluate};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// let problem = Problem::of_known(&model, &recordings, Options::default())?;
/// let fit = evaluate(&problem, &model.values())?;
/// assert_eq!(fit.channels.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a recording cannot be read, or the prediction overflows.
pub fn evaluate(problem: &Problem<'_>, values: &[f64]) -> Result<Fit, IdentifyError> {
    let channels = with_nuisance(problem, values)?.channels();
    let noise: Vec<f64> = channels.iter().map(ChannelSums::rms).collect();
    Ok(report::fit(problem.model, &channels, &noise))
}
