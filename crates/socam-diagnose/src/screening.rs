//! Screening of one recording: whether a diagnosis would find anything, from the fit and the score test alone.
//!
//! The noise levels are [`Frozen`]: known from healthy recordings. The free parameters are fitted to the recording from the frozen values
//! in one descent, because sound machines of one kind differ in them. Two tests follow. The score test decides whether any candidate of the
//! catalogue is missing. The power test decides whether the whitened residuals are larger than the frozen noise allows. A search for the
//! missing physics is left to [`diagnose`](fn@crate::diagnose).

use serde::{Deserialize, Serialize};
use socam_identify::{
    Identification, LeftOut, NoiseLevels, Options as FitOptions, Problem, at_minimum,
    comparison::{self, Evaluation, NoiseModel},
    output_error,
};
use socam_model::Model;
use socam_recording::Dataset;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::{
    answer::INADEQUATE,
    candidates,
    context::{Context, FAR_BEYOND_NOISE},
    diagnose::{BASE_ITERATIONS, MOST_STEPS, levels},
    error::DiagnoseError,
    options::Options,
    preprocessing::{connected, preprocessed},
    scales::Scales,
    score_test::{self, RankedCandidate},
};

/// Length of a block of residuals, s; mean squares of blocks are taken as independent. The score test has the same blocks.
const BLOCK_S: f64 = 0.2;
/// Least number of blocks for the power test.
const FEW_BLOCKS: usize = 8;

/// Parameters and noise levels of healthy recordings, by which others are screened. All values SI, in the model's order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Frozen {
    /// Value of each parameter, from which a fit starts.
    pub values: Vec<f64>,
    /// Standard deviation of the noise of each output.
    pub output_noise_std: Vec<f64>,
    /// Standard deviation of the noise of each input; zero where the input is known exactly.
    pub input_noise_std: Vec<f64>,
    /// Mean square of the whitened residuals in units of this noise: 1 where the model is complete.
    pub excess: f64,
}

impl Frozen {
    /// Fits one recording.
    ///
    /// # Errors
    /// [`DiagnoseError`], as of [`diagnose`](fn@crate::diagnose).
    pub fn of(model: &Model, recording: &Dataset, options: &Options) -> Result<Self, DiagnoseError> {
        let (recordings, _) = connected(model, std::slice::from_ref(recording))?;
        let fit = fit_options(options);
        let near = FitOptions { max_iterations: BASE_ITERATIONS, starts: options.starts, ..fit.clone() };
        let found = output_error(&Problem::new(model, &recordings, near)?)?;
        let before = levels(model, &found);
        let (recordings, _) = preprocessed(model, &recordings, &found.point, &before, &fit)?;
        let context = Context::new(model, &recordings, fit, options)?;
        let sensors = context.sensor_noise(model, &found.point, before.clone())?;
        let diverged = || DiagnoseError::Diverged { model: model.name.clone() };
        let at = comparison::measure(&context.problem(model)?, &sensors, &found.point)?;
        let at = at.ok_or_else(diverged)?;
        let noise = context.noise_at(model, &at, &before)?.ok_or_else(diverged)?;
        Ok(Self {
            values: at.values,
            output_noise_std: noise.levels().outputs.clone(),
            input_noise_std: noise.levels().inputs.clone(),
            excess: noise.excess(),
        })
    }

    /// The median of each number over several recordings; one unhealthy recording changes it little. `None` if there are none.
    #[must_use]
    pub fn median(all: &[Self]) -> Option<Self> {
        let first = all.first()?;
        let of = |number: &dyn Fn(&Self) -> f64| {
            let mut sorted: Vec<f64> = all.iter().map(number).collect();
            sorted.sort_by(f64::total_cmp);
            0.5 * (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2])
        };
        let each = |list: fn(&Self) -> &Vec<f64>| -> Vec<f64> {
            (0..list(first).len()).map(|k| of(&|one| list(one).get(k).copied().unwrap_or(f64::NAN))).collect()
        };
        Some(Self {
            values: each(|one| &one.values),
            output_noise_std: each(|one| &one.output_noise_std),
            input_noise_std: each(|one| &one.input_noise_std),
            excess: of(&|one| one.excess),
        })
    }

    /// Refuses values of another model.
    ///
    /// # Errors
    /// A sentence about what does not agree.
    pub fn check(&self, model: &Model) -> Result<(), String> {
        let expected = [model.parameters.len(), model.outputs().count(), model.inputs().count()];
        let found = [&self.values, &self.output_noise_std, &self.input_noise_std].map(Vec::len);
        if found == expected {
            return Ok(());
        }
        let [parameters, outputs, inputs] = found;
        Err(format!(
            "it is of a model with {parameters} parameters, {outputs} outputs and {inputs} inputs; {} has {}, {} and {}",
            model.name, expected[0], expected[1], expected[2]
        ))
    }

    fn levels(&self) -> NoiseLevels {
        NoiseLevels { outputs: self.output_noise_std.clone(), inputs: self.input_noise_std.clone() }
    }
}

/// A candidate of the score test.
#[derive(Debug, Clone, PartialEq)]
pub struct Suspect {
    /// Id in the catalogue.
    pub effect: &'static str,
    /// Place or channel.
    pub place: String,
    /// Family-wise p-value over all candidates.
    pub p_value: f64,
    /// Decrease of the whitened sum of squares, predicted without a fit.
    pub gain: f64,
}

/// What a screening found.
#[derive(Debug, Clone)]
pub struct Screening {
    /// p-value of both tests together: probability of such a result in either test if the model is complete.
    pub p_value: f64,
    /// Mean square of the whitened residuals in units of the frozen noise.
    pub excess: f64,
    /// The fitted parameters with intervals.
    pub fit: Identification,
    /// Effects at places, the largest gain first; each effect and place occurs once.
    pub suspects: Vec<Suspect>,
    /// What was left out of the recording.
    pub notes: Vec<String>,
}

/// Screens a recording by a model and frozen values of healthy recordings (SI).
///
/// # Method
/// One descent under the frozen noise, then two tests: the smallest family-wise p-value of the score test over all candidates, and a
/// one-sided t-test of the mean square of the whitened residuals over blocks of 0.2 s. The smaller p-value is doubled (Bonferroni).
///
/// # Errors
/// The errors of [`diagnose`](fn@crate::diagnose); [`DiagnoseError::Diverged`] if the model cannot follow the recording from the frozen
/// values.
pub fn screen(
    model: &Model,
    recording: &Dataset,
    frozen: &Frozen,
    options: &Options,
) -> Result<Screening, DiagnoseError> {
    let (recordings, mut notes) = connected(model, std::slice::from_ref(recording))?;
    let fit = fit_options(options);
    let (at, _) = fitted(model, &recordings, &frozen.values, frozen, &fit)?;
    let (recordings, outliers) = preprocessed(model, &recordings, &at.values, &frozen.levels(), &fit)?;
    notes.extend(outliers.iter().map(LeftOut::sentence));
    let problem = Problem::new(model, &recordings, fit.clone())?;
    let (at, sensors) = if outliers.is_empty() {
        (at, sensor_noise(&problem, frozen)?)
    } else {
        fitted(model, &recordings, &at.values, frozen, &fit)?
    };
    let diverged = || DiagnoseError::Diverged { model: model.name.clone() };
    let (excess, by_power) = power(&problem, &sensors, &at, frozen.excess)?;
    let noise = sensors.with_discrepancy(&problem, &at)?.ok_or_else(diverged)?;
    let noise = if noise.excess() < FAR_BEYOND_NOISE {
        noise
    } else {
        sensors.with_exact_inputs().with_discrepancy(&problem, &at)?.ok_or_else(diverged)?
    };
    let scales = Scales::new(&problem, model, &noise, &at)?;
    let all = candidates::all(model, &scales);
    let ranked = score_test::run(model, &recordings, &fit, &noise, &at, (&scales, &all))?;
    let by_score = score_test::least_p_value(&ranked);
    Ok(Screening {
        // Two tests, so the smaller p-value counts double.
        p_value: (2.0 * by_score.min(by_power)).min(1.0),
        excess,
        fit: at_minimum(&problem, &noise, &at)?,
        suspects: suspects(&ranked),
        notes,
    })
}

/// Settings of all fits of a screening: one descent from the start.
fn fit_options(options: &Options) -> FitOptions {
    FitOptions {
        starts: 1,
        seed: options.seed,
        start_state: options.start_state,
        progress: options.progress.clone(),
        most_steps: Some(MOST_STEPS),
        ..FitOptions::default()
    }
}

fn sensor_noise(problem: &Problem<'_>, frozen: &Frozen) -> Result<NoiseModel, DiagnoseError> {
    Ok(NoiseModel::new(&[problem], &frozen.values, frozen.levels())?)
}

/// The fit under the frozen noise, from `start`, and the noise model.
fn fitted(
    model: &Model,
    recordings: &[Dataset],
    start: &[f64],
    frozen: &Frozen,
    fit: &FitOptions,
) -> Result<(Evaluation, NoiseModel), DiagnoseError> {
    let problem = Problem::new(model, recordings, fit.clone())?;
    let noise = sensor_noise(&problem, frozen)?;
    let at = comparison::descend(&problem, &noise, start, None, (comparison::FINE, BASE_ITERATIONS))?;
    Ok((at.ok_or_else(|| DiagnoseError::Diverged { model: model.name.clone() })?, noise))
}

/// Mean square of the whitened residuals, and its p-value if the model is complete (one-sided t-test of the blocks' mean). The scatter
/// between blocks is the scale, so that coloured residuals and heavy tails do not count as power.
fn power(
    problem: &Problem<'_>,
    sensors: &NoiseModel,
    at: &Evaluation,
    usual: f64,
) -> Result<(f64, f64), DiagnoseError> {
    let mut blocks: Vec<f64> = Vec::new();
    for segment in comparison::innovations(problem, sensors, at)?.unwrap_or_default() {
        let length = ((BLOCK_S / segment.sample_time_s).round() as usize).max(1);
        let rows = segment.outputs.iter().map(Vec::len).max().unwrap_or(0);
        for first in (0..rows).step_by(length) {
            let own = segment.outputs.iter().flat_map(|values| values.iter().skip(first).take(length));
            // Masked samples are exactly zero.
            let (count, sum) =
                own.filter(|v| **v != 0.0).fold((0.0, 0.0), |(n, sum), v| (n + 1.0, sum + v * v));
            if count > 0.0 {
                blocks.push(sum / count);
            }
        }
    }
    let count = blocks.len() as f64;
    let mean = blocks.iter().sum::<f64>() / count.max(1.0);
    if blocks.len() < FEW_BLOCKS {
        return Ok((mean, 1.0));
    }
    let variance = blocks.iter().map(|block| (block - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let error = (variance / count).sqrt();
    let beyond = mean - INADEQUATE * usual.max(1.0);
    let chance = StudentsT::new(0.0, 1.0, count - 1.0).map_or(1.0, |t| t.sf(beyond / error));
    Ok((mean, if chance.is_nan() { 1.0 } else { chance }))
}

fn suspects(ranked: &[RankedCandidate]) -> Vec<Suspect> {
    let mut found: Vec<Suspect> = Vec::new();
    for one in ranked.iter().filter(|one| one.possible) {
        let (effect, place) = (one.start.effect.id, &one.start.place);
        match found.iter_mut().find(|known| known.effect == effect && known.place == *place) {
            Some(known) => known.p_value = known.p_value.min(one.p_value),
            None => found.push(Suspect {
                effect,
                place: place.clone(),
                p_value: one.p_value,
                gain: one.score.gain,
            }),
        }
    }
    found
}
