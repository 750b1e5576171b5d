//! The whole diagnosis, from recordings to the answer.

use socam_identify::{
    Identification, IdentifyError, LeftOut, Noise, NoiseLevels, Options as FitOptions, ParameterEstimate,
    Problem, StartState, Watch, at_minimum, influence, output_error,
};
use socam_model::{Model, ModelError, Update};
use socam_recording::{Dataset, RecordingError};
use thiserror::Error;

use crate::{
    Diagnosis, Evidence, answer,
    bench::Bench,
    cleaned::{self, cleaned, connected},
    course::{self, Course},
    noise_floor,
    pictures::{self, Pair},
    validation::Folds,
};

/// Most iterations of the base model's fit from its best start: it only has to be near, and where physics is missing it would walk
/// on along what the data hardly determine.
const BASE: usize = 20;
/// Standard deviations that noise does not make.
const NO_NOISE: f64 = 3.0;
/// Most iterations of the last fit, where the one before had not ended or outliers showed only beside it: near contact the sum of
/// squares is rough, and has no end.
const REFINED: usize = 25;

/// What a diagnosis assumes and how far it goes.
#[derive(Debug, Clone)]
pub struct Options {
    /// Share of benches with nothing missing on which something may be found, 1.
    pub false_alarm_rate: f64,
    /// Most effects that are added.
    pub most_effects: usize,
    /// Starts of the base model's fit.
    pub starts: usize,
    /// Seed of their spread.
    pub seed: u64,
    /// Where each recording starts from.
    pub start_state: StartState,
    /// Who follows the search and may end it.
    pub watch: Watch,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            false_alarm_rate: 0.01,
            most_effects: 3,
            starts: 2,
            seed: 1,
            start_state: StartState::Free,
            watch: Watch::default(),
        }
    }
}

/// What came out.
#[derive(Debug, Clone)]
pub struct Answer {
    /// The document.
    pub diagnosis: Diagnosis,
    /// What its pictures are drawn from.
    pub evidence: Evidence,
    /// The corrected model, its parameters at their fit; a model file like any other.
    pub model_toml: String,
}

/// Input that cannot be used.
#[derive(Debug, Error)]
pub enum DiagnoseError {
    /// The base model could not be fitted.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
    /// A recording could not be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The corrected model could not be written.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A recording is held out and fitted.
    #[error(
        "`{holdout}` holds the same samples as `{training}`; what is held out must not be fitted: hold out another recording"
    )]
    SameSamples {
        /// The one that is held out.
        holdout: String,
        /// The one that is fitted.
        training: String,
    },
    /// A channel says nothing in any recording that is fitted.
    #[error(
        "{channel} never changes in any recording that is fitted, although others do: is its sensor connected? To do without it, take \
         it out of the model's channels"
    )]
    Disconnected {
        /// The channel.
        channel: String,
    },
    /// The base model cannot follow the recordings at all.
    #[error(
        "{model} cannot follow these recordings: its prediction overflows; give start values nearer to the bench"
    )]
    Diverged {
        /// Its name.
        model: String,
    },
}

/// Says whether `model` lacks physics that `training` recordings show, which, and whether adding it predicts `holdout` recordings
/// better. Without any of those, training recordings are left out one at a time, a single one part by part.
///
/// # Errors
/// [`DiagnoseError`] where a recording or the model cannot be used. That nothing fits is no error.
pub fn diagnose(
    model: &Model,
    training: &[Dataset],
    holdout: &[Dataset],
    options: &Options,
) -> Result<Answer, DiagnoseError> {
    let clock = cpu_time::ProcessTime::now();
    apart(training, holdout)?;
    if let Some(channel) = cleaned::disconnected(model, training)? {
        return Err(DiagnoseError::Disconnected { channel });
    }
    let (training, mut notes) = connected(model, training)?;
    let (holdout, more) = connected(model, holdout)?;
    notes.extend(more);
    let fit = FitOptions {
        starts: options.starts,
        seed: options.seed,
        start_state: options.start_state,
        watch: options.watch.clone(),
        ..FitOptions::default()
    };
    let near = FitOptions { max_iterations: BASE, ..fit.clone() };
    let before = output_error(&Problem::new(model, &training, near)?)?;
    let levels = levels(model, &before);
    let clean = |all: &[Dataset]| cleaned(model, all, &before.point, &levels, &fit);
    let ((training, mut outliers), (holdout, more)) = (clean(&training)?, clean(&holdout)?);
    outliers.extend(more);
    let folds = Folds::new(model, &training, &holdout)?;
    let bench = Bench { training: &training, folds: &folds, fit, options };
    let diverged = || DiagnoseError::Diverged { model: model.name.clone() };
    let mut course = course::run(&bench, model, &before.point, levels)?.ok_or_else(diverged)?;
    let after = loop {
        if course.steps.is_empty() && before.converged {
            break before.clone();
        }
        let after = refined(&bench, &course)?;
        let steps = (0..course.steps.len()).rev();
        let doubtful = steps.filter(|step| !is_determined(&course, *step, &after)).collect();
        if !undo_one(&mut course, &bench, doubtful)? {
            break after;
        }
    };
    course.look_last(&bench)?;
    let corrected = &course.last.model;
    let model_toml = corrected.text_with(&updates(corrected, &after))?;
    let step_s = bench.training.first().map_or(1e-3, Dataset::sample_time_s);
    let pairs = Pair::all(&bench, &course)?;
    let (levels, whole) = (course.levels(&bench)?, course.whole());
    let floor = noise_floor::floor(&whole.model, &whole.at.values, &levels, &Pair::proof(&pairs), step_s);
    let evidence = pictures::evidence(model, &pairs, &floor);
    let cpu_s = clock.elapsed().as_secs_f64();
    let mut diagnosis = answer::document(&bench, &course, &before, &after, &floor, cpu_s)?;
    notes.extend(outliers.iter().map(LeftOut::sentence));
    diagnosis.warnings.retain(|warning| !notes.contains(warning));
    diagnosis.warnings.splice(0..0, notes);
    Ok(Answer { diagnosis, evidence, model_toml })
}

/// No recording proves what was fitted to it, under whatever name.
fn apart(training: &[Dataset], holdout: &[Dataset]) -> Result<(), DiagnoseError> {
    let are_same = |a: &Dataset, b: &Dataset| {
        a.rows() == b.rows()
            && a.channels() == b.channels()
            && a.statistics() == b.statistics()
            && (a.end_s() - a.start_s()).to_bits() == (b.end_s() - b.start_s()).to_bits()
    };
    for held in holdout {
        if let Some(fitted) = training.iter().find(|fitted| are_same(fitted, held)) {
            let [holdout, training] = [held, fitted].map(|data| data.name().to_owned());
            return Err(DiagnoseError::SameSamples { holdout, training });
        }
    }
    Ok(())
}

/// Noise levels that a fit found.
fn levels(model: &Model, fit: &Identification) -> NoiseLevels {
    let outputs = fit.fit.channels.iter().map(|(_, channel)| channel.noise_std).collect();
    let own =
        |name: &str| fit.input_noise_std.iter().find(|(known, _)| known == name).map_or(0.0, |(_, std)| *std);
    NoiseLevels { outputs, inputs: model.inputs().map(|input| own(&input.name)).collect() }
}

/// Takes back the first of these steps that can be.
fn undo_one(course: &mut Course, bench: &Bench<'_>, steps: Vec<usize>) -> Result<bool, IdentifyError> {
    for step in steps {
        if course.undo(bench, step)? {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Whether the recordings say that the effect that a step added is of some strength. Beside other effects, whose laws leave something
/// too, all recordings have to say so; alone, what held-out recordings confirm is there as soon as noise could not have made it, though
/// recordings may differ widely in how much of it they show.
fn is_determined(course: &Course, step: usize, after: &Identification) -> bool {
    let nothing = course.steps[step].candidate.nothing();
    let is_alone = course.steps.len() == 1;
    let is_some = |index: &usize| {
        let ParameterEstimate { value, std, ci95: [low, high], .. } = &after.parameters[*index];
        let may_be_nothing =
            low.is_some_and(|low| low <= nothing) && high.is_some_and(|high| nothing <= high);
        let is_no_noise =
            value.zip(*std).is_some_and(|(value, std)| (value - nothing).abs() > NO_NOISE * std);
        value.is_some() && (!may_be_nothing || (is_alone && is_no_noise))
    };
    let strengths = strengths(course, step);
    strengths.is_empty() || strengths.iter().any(is_some)
}

/// Parameters of the last model that say how strong the effect is that a step added.
fn strengths(course: &Course, step: usize) -> Vec<usize> {
    let strength = course.steps[step].candidate.strength;
    course.parameters(step).filter(|(name, _)| strength.contains(name)).map(|(_, index)| index).collect()
}

/// The corrected model's fit with intervals.
fn refined(bench: &Bench<'_>, course: &Course) -> Result<Identification, IdentifyError> {
    let mut model = course.last.model.clone();
    for (parameter, value) in model.parameters.iter_mut().zip(&course.last.at.values) {
        parameter.value = value.clamp(parameter.bounds.0, parameter.bounds.1);
    }
    let noise = Noise::Given(course.yardstick.levels().clone());
    let fit = FitOptions { starts: 1, noise, max_iterations: REFINED, ..bench.fit.clone() };
    let last = &course.last;
    let mut after = at_minimum(&Problem::new(&model, bench.training, fit)?, &last.at)?;
    let widths =
        influence::half_widths(&bench.problem(&last.model)?, &course.yardstick, &last.model, &last.at)?;
    let mut widths = widths.unwrap_or_else(|| vec![0.0; model.parameters.len()]);
    for (number, step) in course.steps.iter().enumerate() {
        let effect = step.candidate.effect;
        for (name, index) in course.parameters(number) {
            let least = effect.least_half_width(name, last.at.values[index]);
            widths[index] = widths[index].max(least);
        }
    }
    let bounds = model.parameters.iter().map(|parameter| parameter.bounds);
    for ((estimate, width), bounds) in after.parameters.iter_mut().zip(widths).zip(bounds) {
        widen(estimate, width, bounds);
    }
    let whole = course.whole();
    if whole.scale().max(whole.training_scale()) > answer::INADEQUATE {
        for (number, step) in course.steps.iter().enumerate() {
            for (name, index) in course.parameters(number) {
                let factor = step.candidate.effect.upper_factor(name);
                let ParameterEstimate { value, ci95: [_, high], .. } = &mut after.parameters[index];
                *high = high.zip(*value).map(|(high, value)| high.max(factor * value));
            }
        }
    }
    Ok(after)
}

/// No interval is narrower than recordings differ: noise is not all that is wrong where a law is only nearly obeyed. None goes beyond what
/// the parameter can be.
fn widen(estimate: &mut ParameterEstimate, half_width: f64, (least, most): (f64, f64)) {
    let Some(value) = estimate.value else { return };
    let [low, high] = &mut estimate.ci95;
    *low = low.map(|low| low.min(value - half_width).max(least));
    *high = high.map(|high| high.max(value + half_width).min(most));
}

fn updates(model: &Model, fit: &Identification) -> Vec<Update> {
    let free = model.parameters.iter().zip(&fit.parameters).zip(&fit.point);
    free.filter(|((parameter, _), _)| !parameter.fixed)
        .map(|((parameter, estimate), value)| Update {
            name: parameter.name.clone(),
            value: *value,
            ci95: match estimate.ci95 {
                [Some(low), Some(high)] if estimate.identifiable => Some([low, high]),
                _ => None,
            },
            source: "diagnosis".into(),
        })
        .collect()
}
