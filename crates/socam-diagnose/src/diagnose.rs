//! The whole diagnosis, stage by stage, from recordings to the answer.

use socam_identify::{Identification, LeftOut, NoiseLevels, Options as FitOptions, Problem, output_error};
use socam_model::{Channel, Model, Update};
use socam_recording::Dataset;

use crate::{
    Diagnosis, Evidence,
    answer::{self, inputs::Inputs},
    context::{Context, FittedModel},
    error::DiagnoseError,
    extension::carried_over,
    final_choice::FinalChoice,
    forward,
    held_out::HeldOut,
    noise_floor,
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
/// Typical share of a diagnosis' time that has passed when a part begins, 1; used to estimate the remaining time.
const PART_NOISE: f64 = 0.10;
const PART_INTERVALS: f64 = 0.85;
const PART_PROOF: f64 = 0.95;

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

/// Finds out whether `model` lacks physics that the `training` recordings show, which physics, and whether the corrected model predicts the
/// `held_out` recordings better. With [`HeldOut::none`], the answer rests on cross-validation among the training recordings.
///
/// Held-out recordings are opened after the last choice. If one cannot be used, the answer has a warning in place of a proof.
///
/// A search that the progress monitor ends makes no further choice: what was found so far gets its intervals and its proof, and the answer says
/// that it is unfinished, and what was not examined.
///
/// # Method
/// Forward stepwise selection. A score test at the last fit ranks the candidates; a wild bootstrap over blocks gives family-wise p-values
/// (V. Chernozhukov, D. Chetverikov, K. Kato, Ann. Stat. 41, 2013). Candidates are fitted by successive halving (K. Jamieson and
/// A. Talwalkar, AISTATS 2016). Models are compared by the difference of cross-validated log scores, and weighted by pseudo-BMA (Y. Yao et
/// al., Bayesian Analysis 13, 2018).
///
/// # Errors
/// [`DiagnoseError`] where a training recording or the model cannot be used, or a held-out recording in memory has the samples of a
/// training recording. A diagnosis in which no candidate fits is not an error.
///
/// ```
/// use socam_diagnose::{HeldOut, Options, diagnose};
/// use socam_model::Model;
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/axis.rs"));
/// let (training, held_out) = recordings.split_at(3);
/// let options = Options { most_effects: 1, ..Options::default() };
/// let answer = diagnose(&model, training, HeldOut::in_memory(held_out), &options)?;
/// let friction = &answer.diagnosis.findings[0];
/// assert_eq!((friction.effect.as_str(), friction.location.as_str()), ("coulomb_friction", "guide"));
/// assert!((friction.parameters[0].value.unwrap() - 5.0).abs() < 0.2);
/// assert!(Model::parse(&answer.model_toml)?.effects.len() == 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn diagnose(
    model: &Model,
    training: &[Dataset],
    held_out: HeldOut<'_>,
    options: &Options,
) -> Result<Answer, DiagnoseError> {
    let clock = cpu_time::ProcessTime::now();
    let held_out = held_out.sealed(training)?;
    if let Some(channel) = preprocessing::disconnected(model, training)? {
        return Err(DiagnoseError::Disconnected { channel });
    }
    let mut notes = preprocessing::held_inputs(model, training)?;
    let (training, more) = connected(model, training)?;
    notes.extend(more);
    let fit = FitOptions {
        starts: options.starts,
        seed: options.seed,
        start_state: options.start_state,
        progress: options.progress.clone(),
        most_steps: Some(MOST_STEPS),
        ..FitOptions::default()
    };
    let near = FitOptions { max_iterations: BASE_ITERATIONS, ..fit.clone() };
    options.progress.part("fit of the model", 0.0);
    let before = output_error(&Problem::new(model, &training, near)?)?;
    options.progress.part("outliers, noise and its discrepancy", PART_NOISE);
    let levels = levels(model, &before);
    let (training, mut outliers) = preprocessed(model, &training, &before.point, &levels, &fit)?;
    let context = Context::new(model, &training, fit, options)?;
    let file = model;
    let mut settled = model.clone();
    before.state_between(&mut settled)?;
    let model = &settled;
    let diverged = || DiagnoseError::Diverged { model: model.name.clone() };
    let path = forward::run(&context, model, &before.point, &levels)?.ok_or_else(diverged)?;
    options.progress.close();
    options.progress.part("intervals", PART_INTERVALS);
    let choice = FinalChoice::make(&context, path, &before)?;
    options.progress.part("held-out recordings and pictures", PART_PROOF);
    let outcome = Proof::open(&context, &choice, held_out)?;
    let proof = outcome.proof();
    if let Some(proof) = proof {
        notes.extend(proof.notes.iter().cloned());
        outliers.extend(proof.outliers.iter().cloned());
    }
    let (path, after) = (choice.path(), choice.estimates());
    let corrected = &path.last.model;
    let source = if path.unexamined.is_none() { "diagnosis" } else { "unfinished diagnosis" };
    let model_toml = corrected_file(path, after, source)?;
    let step_s = training.first().map_or(1e-3, Dataset::sample_time_s);
    let pairs = Pair::all(&context, path, proof)?;
    let (levels, whole) = (path.levels(&context)?, path.whole());
    let floor = noise_floor::floor(&whole.model, &whole.at.values, &levels, &Pair::shown(&pairs), step_s);
    let evidence = pictures::evidence(model, &pairs, &floor);
    let cpu_s = clock.elapsed().as_secs_f64();
    let inputs =
        Inputs { context: &context, path, held_out: &outcome, before: &before, after, floor: &floor };
    let mut diagnosis = answer::document(&inputs, cpu_s)?;
    diagnosis.overlay = pictures::overlay(model, &pairs, &floor);
    notes.extend(taken_otherwise(file, corrected));
    notes.extend(path.stated_otherwise(&context)?);
    notes.extend(outliers.iter().map(LeftOut::sentence));
    diagnosis.warnings.retain(|warning| !notes.contains(warning));
    diagnosis.warnings.splice(0..0, notes);
    Ok(Answer { diagnosis, evidence, model_toml })
}

/// A sentence about each input that was taken otherwise between its samples than is usual for its quantity.
fn taken_otherwise(file: &Model, corrected: &Model) -> Vec<String> {
    let taken = |input: &Channel| {
        let own = corrected.inputs().find(|own| own.name == input.name)?.intersample();
        let (name, usual) = (&input.name, input.intersample());
        (own != usual).then(|| {
            format!(
                "`{name}` was taken as {} between its samples, which explains these recordings better than {}; the corrected model states it",
                own.name(),
                usual.name()
            )
        })
    };
    file.inputs().filter_map(taken).collect()
}

/// Noise levels of outputs and inputs that a fit estimated, SI.
pub(crate) fn levels(model: &Model, fit: &Identification) -> NoiseLevels {
    let outputs = fit.fit.channels.iter().map(|(_, channel)| channel.noise_std).collect();
    let own =
        |name: &str| fit.input_noise_std.iter().find(|(known, _)| known == name).map_or(0.0, |(_, std)| *std);
    NoiseLevels { outputs, inputs: model.inputs().map(|input| own(&input.name)).collect() }
}

/// The corrected model's file: with the estimates; where a curve was found, with the values that were fitted beside it and the curve as a law.
fn corrected_file(path: &Path, after: &Identification, source: &str) -> Result<String, DiagnoseError> {
    let corrected = &path.last.model;
    let Some(found) = &path.unexplained else {
        return Ok(corrected.text_with(&updates(corrected, after, source))?);
    };
    let FittedModel { model, at, .. } = found.whole();
    let values = carried_over((model, &at.values), corrected);
    let free = corrected.parameters.iter().zip(values).filter(|(parameter, _)| !parameter.fixed);
    let beside = free.map(|(parameter, value)| Update {
        name: parameter.name.clone(),
        value,
        ci95: None,
        source: source.into(),
    });
    let text = corrected.text_with(&beside.collect::<Vec<_>>())?;
    let law = found.formula.as_ref().map_or_else(|| found.law(), |formula| formula.law.clone());
    Ok(Model::parse(&text)?.text_with_law(&law, source)?)
}

/// The free parameters' estimates as updates of a model file; `source` is where they are from.
fn updates(model: &Model, fit: &Identification, source: &str) -> Vec<Update> {
    let free = model.parameters.iter().zip(&fit.parameters).zip(&fit.point);
    free.filter(|((parameter, _), _)| !parameter.fixed)
        .map(|((parameter, estimate), value)| Update {
            name: parameter.name.clone(),
            value: *value,
            ci95: match estimate.ci95 {
                [Some(low), Some(high)] if estimate.identifiable => Some([low, high]),
                _ => None,
            },
            source: source.into(),
        })
        .collect()
}
