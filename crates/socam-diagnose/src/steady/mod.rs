//! Diagnosis of steady states: tables of operating points, one row each, as in X. Song's thesis (McGill 2002), tables 5.1 to 5.3.
//!
//! A mean over a steady state has no time series to whiten or to test by blocks. It is tested against parity relations instead, which
//! follow from the model ([`parity`]): speeds keep the gears' ratios, and torques balance. Where readings violate a relation by more than
//! their repeatability, each effect that acts in a steady state is fitted on its own ([`explain`]). Effects that fit equally well compete.

mod explain;
mod findings;
mod least_squares;
mod options;
mod outcome;
mod parity;
mod readings;
mod residual_test;

#[cfg(test)]
mod tests;

use socam_model::{Model, ModelError, Update};
use socam_recording::Steady;
use thiserror::Error;

use crate::{
    Diagnosis,
    document::{
        Finding, Fit, ParameterChange, RecordingUse, SCHEMA, SearchEnd, UNEXPLAINED, Validation, Verdict,
    },
    experiment, words,
};
use outcome::{Outcome, outcome};
use parity::ParityRelation;
use readings::Readings;

pub use options::SteadyOptions;

/// Input that a diagnosis of steady states cannot use.
#[derive(Debug, Error)]
pub enum SteadyError {
    /// No parity relation can be tested.
    #[error(
        "{model}: nothing to compare in {tables}; steady states need two speeds, two torques, or a torque and a speed of {channels} at one point at least"
    )]
    NoTestableRelation {
        /// Name of the model.
        model: String,
        /// Names of the tables.
        tables: String,
        /// Columns that the model reads.
        channels: String,
    },
    /// The model contains an effect.
    #[error(
        "{model} has the effect {effect} in it; steady states are compared with a model without effects: name the base model"
    )]
    HasEffects {
        /// Name of the model.
        model: String,
        /// The first effect and its place.
        effect: String,
    },
    /// The corrected model could not be written.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// Tests which parity relations of `model` the points of `tables` violate, and which effects explain the violations. Returns the document
/// and the text of the corrected model's file.
///
/// # Assumes
/// Each row is a mean over a steady state, with a relative uncertainty of [`SteadyOptions::repeatability`]. One effect violates a relation:
/// so few points cannot distinguish two effects from one.
///
/// # Breaks when
/// The bench was still accelerating: inertia is then mistaken for drag.
///
/// # Errors
/// [`SteadyError`] where no parity relation can be tested, or where the model contains an effect.
///
/// ```
/// use socam_diagnose::{SteadyOptions, diagnose_steady};
/// use socam_model::Model;
/// use socam_recording::Steady;
///
/// # let table = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/tables/thesis-5.1.csv");
/// let speeds = Steady::open(table.as_ref())?;
/// let model = Model::builtin("speed-o-cam").ok_or("no such model")?;
/// let (diagnosis, _) = diagnose_steady(&model, &[speeds], SteadyOptions::default())?;
/// // A mesh eats a fixed share of the torque.
/// assert!(diagnosis.findings.iter().any(|finding| finding.effect == "mesh_loss"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn diagnose_steady(
    model: &Model,
    tables: &[Steady],
    options: SteadyOptions,
) -> Result<(Diagnosis, String), SteadyError> {
    let clock = cpu_time::ProcessTime::now();
    if let Some(used) = model.effects.first() {
        let effect = format!("{}@{}", used.effect.id, used.place);
        return Err(SteadyError::HasEffects { model: model.name.clone(), effect });
    }
    let points = readings::points(model, tables);
    let read = testable_relations(model, &points);
    let threshold = options.false_alarm_rate / read.len().max(1) as f64;
    let outcomes: Vec<Outcome<'_>> = read
        .iter()
        .filter_map(|(relation, readings)| outcome(model, relation, readings, options, threshold))
        .collect();
    if outcomes.is_empty() {
        return Err(no_testable_relation(model, tables));
    }
    let parameters = findings::parameters(model, &outcomes);
    let model_toml = corrected(model, &outcomes)?.text_with(&updates(&parameters))?;
    let findings = violations(model, &outcomes, &points);
    let diagnosis = Diagnosis {
        selection: None,
        held_out: None,
        schema: SCHEMA.into(),
        verdict: verdict(&findings),
        finished: true,
        end: SearchEnd::Completed,
        unfinished: None,
        candidates: Vec::new(),
        false_alarm_rate: options.false_alarm_rate,
        validation: Validation::Blocks,
        suggested_experiment: experiment::steady(&findings),
        findings,
        answer: Vec::new(),
        ordinary: Vec::new(),
        fit: Fit { channels: outcomes.iter().map(|outcome| findings::fit(model, outcome)).collect() },
        parameters,
        combinations: Vec::new(),
        not_found: outcomes
            .iter()
            .filter(|outcome| !outcome.violated)
            .flat_map(|outcome| findings::not_found(model, outcome))
            .collect(),
        cpu_s: clock.elapsed().as_secs_f64(),
        warnings: vec![format!(
            "readings are taken to repeat within {} % of their value; each operating point was left out in turn",
            words::short(100.0 * options.repeatability)
        )],
        model: model.name.clone(),
        recordings: tables.iter().map(used).collect(),
        version: env!("CARGO_PKG_VERSION").into(),
        overlay: None,
    };
    Ok((diagnosis, model_toml))
}

/// The model's parity relations that have readings at some points, with these readings.
fn testable_relations(model: &Model, points: &[Vec<Option<f64>>]) -> Vec<(ParityRelation, Readings)> {
    let speeds = parity::speeds(model);
    let each = parity::relations(model, &speeds).into_iter().map(|relation| {
        let readings = readings::readings(model, &relation, &speeds, points);
        (relation, readings)
    });
    each.filter(|(_, readings)| !readings.first.is_empty()).collect()
}

fn no_testable_relation(model: &Model, tables: &[Steady]) -> SteadyError {
    let channels: Vec<&str> = model.channels.iter().map(|channel| channel.column.as_str()).collect();
    let tables: Vec<&str> = tables.iter().map(|table| table.name.as_str()).collect();
    SteadyError::NoTestableRelation {
        model: model.name.clone(),
        tables: tables.join(", "),
        channels: channels.join(", "),
    }
}

/// Findings of all violated relations, the largest fall of chi-square first.
fn violations(model: &Model, outcomes: &[Outcome<'_>], points: &[Vec<Option<f64>>]) -> Vec<Finding> {
    let violated = outcomes.iter().filter(|outcome| outcome.violated);
    let mut findings: Vec<Finding> =
        violated.map(|outcome| findings::finding(model, outcome, points)).collect();
    let gain = |finding: &Finding| finding.evidence.chi2_gain.unwrap_or(0.0);
    findings.sort_by(|a, b| gain(b).total_cmp(&gain(a)));
    findings
}

fn verdict(findings: &[Finding]) -> Verdict {
    match findings.iter().filter(|finding| finding.effect != UNEXPLAINED).count() {
        _ if findings.is_empty() => Verdict::Adequate,
        0 => Verdict::Unexplained,
        _ => Verdict::MissingPhysics,
    }
}

/// The model with the effects that explain violated relations.
fn corrected(model: &Model, outcomes: &[Outcome<'_>]) -> Result<Model, ModelError> {
    let mut corrected = model.clone();
    for (named, fitted) in outcomes.iter().filter_map(Outcome::named) {
        let (value, _) = named.estimate(fitted);
        corrected = corrected.with_effect(named.effect.id, &named.place, &[(named.parameter, value)])?;
    }
    Ok(corrected)
}

/// The determined parameters as updates of a model file.
fn updates(parameters: &[ParameterChange]) -> Vec<Update> {
    let determined = parameters.iter().filter(|change| !change.fixed && change.identifiable);
    let each = determined.filter_map(|change| {
        let ci95 = change.ci95[0].zip(change.ci95[1]).map(|(low, high)| [low, high]);
        Some(Update {
            name: change.name.clone(),
            value: change.after?,
            ci95,
            source: "diagnosis of steady states".into(),
        })
    });
    each.collect()
}

fn used(table: &Steady) -> RecordingUse {
    RecordingUse {
        name: table.name.clone(),
        held_out: false,
        samples: table.rows.len() as u64,
        duration_s: 0.0,
    }
}
