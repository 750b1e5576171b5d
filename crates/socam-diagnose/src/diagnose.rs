//! The whole diagnosis, from recordings to the answer.

use socam_identify::{
    Identification, IdentifyError, LeftOut, NoiseLevels, Options as FitOptions, Problem, ProgressMonitor,
    StartState, output_error,
};
use socam_model::{Model, ModelError, Update};
use socam_recording::{Dataset, RecordingError};
use thiserror::Error;

use crate::{
    Diagnosis, Evidence, answer,
    context::Context,
    intervals, noise_floor,
    pictures::{self, Pair},
    preprocessing::{self, connected, preprocessed},
    proof::Proof,
    selection::{self, Path},
};

/// Most iterations of the base model's fit from its best start: it only has to be near, and where physics is missing it would walk
/// on along what the data hardly determine.
const BASE: usize = 20;
/// Attempts at a step per sample beyond which a candidate's prediction is given up: what rattles takes a few.
const MOST_STEPS: usize = 64;

/// What a diagnosis assumes and how far it goes.
#[derive(Debug, Clone)]
pub struct Options {
    /// Share of benches with nothing missing on which something may be found, 1.
    pub false_alarm_rate: f64,
    /// Most effects that are added.
    pub most_effects: usize,
    /// Share of a channel's standard deviation by which a finding must move its prediction to matter, 1.
    pub tolerance: f64,
    /// Starts of the base model's fit.
    pub starts: usize,
    /// Seed of their spread.
    pub seed: u64,
    /// Where each recording starts from.
    pub start_state: StartState,
    /// Who follows the search and may end it.
    pub watch: ProgressMonitor,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            false_alarm_rate: 0.01,
            most_effects: 3,
            tolerance: 1e-3,
            starts: 6,
            seed: 1,
            start_state: StartState::Free,
            watch: ProgressMonitor::default(),
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
    if let Some(channel) = preprocessing::disconnected(model, training)? {
        return Err(DiagnoseError::Disconnected { channel });
    }
    let mut notes = preprocessing::held_inputs(model, training)?;
    let (training, more) = connected(model, training)?;
    notes.extend(more);
    let (holdout, more) = connected(model, holdout)?;
    notes.extend(more);
    let fit = FitOptions {
        starts: options.starts,
        seed: options.seed,
        start_state: options.start_state,
        watch: options.watch.clone(),
        most_steps: Some(MOST_STEPS),
        ..FitOptions::default()
    };
    let near = FitOptions { max_iterations: BASE, ..fit.clone() };
    let before = output_error(&Problem::new(model, &training, near)?)?;
    let levels = levels(model, &before);
    let clean = |all: &[Dataset]| preprocessed(model, all, &before.point, &levels, &fit);
    let ((training, mut outliers), (holdout, more)) = (clean(&training)?, clean(&holdout)?);
    outliers.extend(more);
    let context = Context::new(model, &training, fit, options)?;
    let diverged = || DiagnoseError::Diverged { model: model.name.clone() };
    let mut path = selection::run(&context, model, &before.point, &levels)?.ok_or_else(diverged)?;
    let after = determined(&context, &mut path, &before)?;
    path.test_last(&context)?;
    // The last choice is made: only now are held-out recordings predicted.
    let proof = Proof::open(&context, &path, &holdout)?;
    let corrected = &path.last.model;
    let model_toml = corrected.text_with(&updates(corrected, &after))?;
    let step_s = training.first().map_or(1e-3, Dataset::sample_time_s);
    let pairs = Pair::all(&context, &path, proof.as_ref())?;
    let (levels, whole) = (path.levels(&context)?, path.whole());
    let floor = noise_floor::floor(&whole.model, &whole.at.values, &levels, &Pair::shown(&pairs), step_s);
    let evidence = pictures::evidence(model, &pairs, &floor);
    let cpu_s = clock.elapsed().as_secs_f64();
    let made = answer::Made {
        context: &context,
        path: &path,
        proof: proof.as_ref(),
        before: &before,
        after: &after,
        floor: &floor,
    };
    let mut diagnosis = answer::document(&made, cpu_s)?;
    notes.extend(outliers.iter().map(LeftOut::sentence));
    diagnosis.warnings.retain(|warning| !notes.contains(warning));
    diagnosis.warnings.splice(0..0, notes);
    Ok(Answer { diagnosis, evidence, model_toml })
}

/// Takes out terms whose amplitude the recordings do not determine, the latest first, until all are; estimates of what is left. Each term is
/// told what it gains beside the others.
fn determined(
    context: &Context<'_>,
    path: &mut Path,
    before: &Identification,
) -> Result<Identification, IdentifyError> {
    let found = 'determined: loop {
        if path.terms.is_empty() {
            break before.clone();
        }
        let found = intervals::estimates(context, path)?;
        for term in (0..path.terms.len()).rev().filter(|term| !intervals::is_determined(path, *term, &found))
        {
            let near = path.fitted_without(context, term)?;
            if let Some(without) =
                near.map_or_else(|| path.refitted_without(context, term), |near| Ok(Some(near)))?
            {
                path.remove(context, term, without)?;
                continue 'determined;
            }
        }
        break found;
    };
    for term in 0..path.terms.len() {
        let near = path.fitted_without(context, term)?;
        if let Some(without) = &near {
            path.terms[term].gain = path.gain(&path.last, without);
        }
        // Where no fit without it comes near, what it gained when it was added stands.
        let without = near.map_or_else(|| path.without(context, term), |near| Ok(Some(near)))?;
        path.terms[term].without = without;
    }
    Ok(found)
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
