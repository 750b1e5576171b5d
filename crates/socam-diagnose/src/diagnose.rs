//! The whole diagnosis, stage by stage, from recordings to the answer.

use socam_identify::{
    Identification, IdentifyError, LeftOut, NoiseLevels, Options as FitOptions, Problem, output_error,
};
use socam_model::{Model, ModelError, Update};
use socam_recording::{Dataset, RecordingError};
use thiserror::Error;

use crate::{
    Diagnosis, Evidence,
    answer::{self, inputs::Inputs},
    context::Context,
    forward, intervals, noise_floor,
    options::Options,
    pictures::{self, Pair},
    preprocessing::{self, connected, preprocessed},
    proof::Proof,
    selection::Path,
};

/// Largest number of iterations of the base model's fit from its best start. The fit only has to come near the optimum: with missing
/// physics, further iterations move parameters that the recordings hardly determine.
pub(crate) const BASE_ITERATIONS: usize = 20;
/// Attempted integration steps per sample beyond which a candidate's prediction is given up. Rattling teeth take a few.
pub(crate) const MOST_STEPS: usize = 64;

/// The answer of a diagnosis.
#[derive(Debug, Clone)]
pub struct Answer {
    /// The document that scripts read.
    pub diagnosis: Diagnosis,
    /// The data from which pictures are drawn.
    pub evidence: Evidence,
    /// Text of the corrected model's file, its parameters at their fit.
    pub model_toml: String,
}

/// Input that a diagnosis cannot use.
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
    /// A recording is both held out and fitted.
    #[error(
        "`{holdout}` holds the same samples as `{training}`; what is held out must not be fitted: hold out another recording"
    )]
    SameSamples {
        /// Name of the recording that is held out.
        holdout: String,
        /// Name of the recording that is fitted.
        training: String,
    },
    /// A channel is constant in all recordings that are fitted.
    #[error(
        "{channel} never changes in any recording that is fitted, although others do: is its sensor connected? To do without it, take \
         it out of the model's channels"
    )]
    Disconnected {
        /// Name of the channel.
        channel: String,
    },
    /// The base model's prediction overflows.
    #[error(
        "{model} cannot follow these recordings: its prediction overflows; give start values nearer to the bench"
    )]
    Diverged {
        /// Name of the model.
        model: String,
    },
}

/// Finds out whether `model` lacks physics that the `training` recordings show, which physics, and whether the corrected model predicts the
/// `holdout` recordings better. `holdout` may be empty; the answer then rests on cross-validation among the training recordings.
///
/// # Errors
/// [`DiagnoseError`] where a recording or the model cannot be used. It is no error that no candidate fits.
///
/// ```
/// use socam_diagnose::{Options, diagnose};
/// use socam_model::Model;
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/axis.rs"));
/// let (training, holdout) = recordings.split_at(3);
/// let answer = diagnose(&model, training, holdout, &Options { most_effects: 1, ..Options::default() })?;
/// let friction = &answer.diagnosis.findings[0];
/// assert_eq!((friction.effect.as_str(), friction.location.as_str()), ("coulomb_friction", "guide"));
/// assert!((friction.parameters[0].value.unwrap() - 5.0).abs() < 0.2);
/// assert!(Model::parse(&answer.model_toml)?.effects.len() == 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn diagnose(
    model: &Model,
    training: &[Dataset],
    holdout: &[Dataset],
    options: &Options,
) -> Result<Answer, DiagnoseError> {
    let clock = cpu_time::ProcessTime::now();
    refuse_shared_samples(training, holdout)?;
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
    let near = FitOptions { max_iterations: BASE_ITERATIONS, ..fit.clone() };
    let before = output_error(&Problem::new(model, &training, near)?)?;
    let levels = levels(model, &before);
    let clean = |all: &[Dataset]| preprocessed(model, all, &before.point, &levels, &fit);
    let ((training, mut outliers), (holdout, more)) = (clean(&training)?, clean(&holdout)?);
    outliers.extend(more);
    let context = Context::new(model, &training, fit, options)?;
    let diverged = || DiagnoseError::Diverged { model: model.name.clone() };
    let mut path = forward::run(&context, model, &before.point, &levels)?.ok_or_else(diverged)?;
    let after = determined(&context, &mut path, &before)?;
    path.test_last(&context)?;
    // Held-out recordings are predicted only after the last choice.
    let proof = Proof::open(&context, &path, &holdout)?;
    let corrected = &path.last.model;
    let model_toml = corrected.text_with(&updates(corrected, &after))?;
    let step_s = training.first().map_or(1e-3, Dataset::sample_time_s);
    let pairs = Pair::all(&context, &path, proof.as_ref())?;
    let (levels, whole) = (path.levels(&context)?, path.whole());
    let floor = noise_floor::floor(&whole.model, &whole.at.values, &levels, &Pair::shown(&pairs), step_s);
    let evidence = pictures::evidence(model, &pairs, &floor);
    let cpu_s = clock.elapsed().as_secs_f64();
    let inputs = Inputs {
        context: &context,
        path: &path,
        proof: proof.as_ref(),
        before: &before,
        after: &after,
        floor: &floor,
    };
    let mut diagnosis = answer::document(&inputs, cpu_s)?;
    notes.extend(outliers.iter().map(LeftOut::sentence));
    diagnosis.warnings.retain(|warning| !notes.contains(warning));
    diagnosis.warnings.splice(0..0, notes);
    Ok(Answer { diagnosis, evidence, model_toml })
}

/// Removes terms whose amplitude the recordings do not determine, the latest first, until every term is determined. Sets each remaining
/// term's gain over the model without it. Returns the estimates of the remaining model.
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
        // Where no fit without the term comes near, the gain at which it was added stays.
        let without = near.map_or_else(|| path.validated_without(context, term), |near| Ok(Some(near)))?;
        path.terms[term].without = without;
    }
    Ok(found)
}

/// Refuses held-out recordings that equal a training recording, whatever their names.
fn refuse_shared_samples(training: &[Dataset], holdout: &[Dataset]) -> Result<(), DiagnoseError> {
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

/// Noise levels of outputs and inputs that a fit estimated, SI.
pub(crate) fn levels(model: &Model, fit: &Identification) -> NoiseLevels {
    let outputs = fit.fit.channels.iter().map(|(_, channel)| channel.noise_std).collect();
    let own =
        |name: &str| fit.input_noise_std.iter().find(|(known, _)| known == name).map_or(0.0, |(_, std)| *std);
    NoiseLevels { outputs, inputs: model.inputs().map(|input| own(&input.name)).collect() }
}

/// The free parameters' estimates as updates of a model file.
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
