//! Diagnosis of steady states: tables of operating points, one row each, as in X. Song's thesis (McGill 2002), tables 5.1 to 5.3.
//!
//! Means over a steady state have no course in time to whiten or to screen. What they must obey is read off the model instead
//! ([`ties`]): speeds keep the gears' ratios, torques balance. Where a tie breaks by more than readings repeat, each effect that
//! shows in a steady state is fitted on its own ([`explain`]), and those that do equally well are rivals.

mod explain;
mod findings;
mod ties;

#[cfg(test)]
mod tests;

use socam_model::{Model, ModelError, Update};
use socam_recording::Steady;
use thiserror::Error;

use crate::{
    Diagnosis,
    document::{Finding, Fit, RecordingUse, SCHEMA, UNEXPLAINED, Validation, Verdict},
    experiment, words,
};
use explain::{Case, Explanation, FittedModel, Readings};
use findings::{finding, fit, parameters, unseen};
use ties::{Kind, Tie};

/// Sums of squares no further apart are alike.
const ALIKE: f64 = 0.05;

/// What is assumed of the points.
#[derive(Debug, Clone, Copy)]
pub struct SteadyOptions {
    /// Share of benches with nothing missing on which something may be found, 1.
    pub false_alarm_rate: f64,
    /// Relative standard uncertainty of a mean, 1: how far two readings of one operating point differ by chance.
    pub repeatability: f64,
}

impl Default for SteadyOptions {
    /// 0.2 %: ratios of speeds and of torques in the thesis' coupling tests, which have nothing to lose, scatter by 0.2 %, a
    /// single reading therefore by 0.14 %.
    fn default() -> Self {
        Self { false_alarm_rate: 0.01, repeatability: 2e-3 }
    }
}

/// Tables that cannot be used.
#[derive(Debug, Error)]
pub enum SteadyError {
    /// No two readings belong together.
    #[error(
        "{model}: nothing to compare in {tables}; steady states need two speeds, two torques, or a torque and a speed of {channels} at one point at least"
    )]
    NothingTied {
        /// Name of the model.
        model: String,
        /// Tables.
        tables: String,
        /// What the model reads.
        channels: String,
    },
    /// A model with effects in it.
    #[error(
        "{model} has the effect {effect} in it; steady states are compared with a model without effects: name the base model"
    )]
    HasEffects {
        /// Name of the model.
        model: String,
        /// The first.
        effect: String,
    },
    /// The corrected model could not be written.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// A tie with what it was found to do.
struct Outcome<'a> {
    tie: &'a Tie,
    case: Case<'a>,
    readings: &'a Readings,
    base: FittedModel,
    /// What explains it, best first; not only if the tie breaks.
    ranked: Vec<(Explanation, FittedModel)>,
    broken: bool,
    /// Of these so many explain it.
    good: usize,
}

/// Says which of the ties that `model` imposes on steady states the points of `tables` break, and what may stand behind it.
///
/// # Assumes
/// Each row is a mean over a steady state, known to a share of its reading ([`SteadyOptions::repeatability`]); one effect breaks
/// a tie. With so few points two cannot be told from one.
///
/// # Breaks when
/// The bench was still speeding up: then inertia is mistaken for drag.
///
/// # Errors
/// [`SteadyError`] where no two readings are tied.
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
    let speeds = ties::speeds(model);
    let points = points(model, tables);
    let ties = ties::ties(model, &speeds);
    let read: Vec<(Tie, Readings)> = ties
        .into_iter()
        .map(|tie| {
            let readings = readings(model, &tie, &speeds, &points);
            (tie, readings)
        })
        .filter(|(_, readings)| !readings.first.is_empty())
        .collect();
    let count = read.len().max(1) as f64;
    let outcomes: Vec<Outcome<'_>> = read
        .iter()
        .filter_map(|(tie, readings)| {
            outcome(model, tie, readings, options, options.false_alarm_rate / count)
        })
        .collect();
    if outcomes.is_empty() {
        let channels: Vec<&str> = model.channels.iter().map(|channel| channel.column.as_str()).collect();
        let tables: Vec<&str> = tables.iter().map(|table| table.name.as_str()).collect();
        return Err(SteadyError::NothingTied {
            model: model.name.clone(),
            tables: tables.join(", "),
            channels: channels.join(", "),
        });
    }
    let mut findings: Vec<Finding> = Vec::new();
    let mut corrected = model.clone();
    for outcome in outcomes.iter().filter(|outcome| outcome.broken) {
        findings.push(finding(model, outcome, &points));
        if let Some((named, fitted)) = outcome.named() {
            let (value, _) = named.estimate(fitted);
            corrected = corrected.with_effect(named.effect.id, &named.place, &[(named.parameter, value)])?;
        }
    }
    findings
        .sort_by(|a, b| b.evidence.chi2_gain.unwrap_or(0.0).total_cmp(&a.evidence.chi2_gain.unwrap_or(0.0)));
    let verdict = match findings.iter().filter(|finding| finding.effect != UNEXPLAINED).count() {
        _ if findings.is_empty() => Verdict::Adequate,
        0 => Verdict::Unexplained,
        _ => Verdict::MissingPhysics,
    };
    let parameters = parameters(model, &outcomes);
    let updates: Vec<Update> = parameters
        .iter()
        .filter(|change| !change.fixed && change.identifiable)
        .filter_map(|change| {
            let ci95 = change.ci95[0].zip(change.ci95[1]).map(|(low, high)| [low, high]);
            Some(Update {
                name: change.name.clone(),
                value: change.after?,
                ci95,
                source: "diagnosis of steady states".into(),
            })
        })
        .collect();
    let model_toml = corrected.text_with(&updates)?;
    let warnings = vec![format!(
        "readings are taken to repeat within {} % of their value (--repeatability); each operating point was left out in turn",
        words::short(100.0 * options.repeatability)
    )];
    let diagnosis = Diagnosis {
        selection: None,
        held_out: None,
        schema: SCHEMA.into(),
        verdict,
        false_alarm_rate: options.false_alarm_rate,
        validation: Validation::Blocks,
        suggested_experiment: experiment::steady(&findings),
        findings,
        fit: Fit { channels: outcomes.iter().map(|outcome| fit(model, outcome)).collect() },
        parameters,
        combinations: Vec::new(),
        not_found: outcomes
            .iter()
            .filter(|outcome| !outcome.broken)
            .flat_map(|outcome| unseen(model, outcome))
            .collect(),
        cpu_s: clock.elapsed().as_secs_f64(),
        warnings,
        model: model.name.clone(),
        recordings: tables
            .iter()
            .map(|table| RecordingUse {
                name: table.name.clone(),
                held_out: false,
                samples: table.rows.len() as u64,
                duration_s: 0.0,
            })
            .collect(),
        version: env!("CARGO_PKG_VERSION").into(),
    };
    Ok((diagnosis, model_toml))
}

/// Readings of all channels of the model at all points, SI.
fn points(model: &Model, tables: &[Steady]) -> Vec<Vec<Option<f64>>> {
    let of = |table: &Steady| -> Vec<Vec<Option<f64>>> {
        let columns = model.channels.iter().map(|channel| table.column(&channel.column));
        let columns: Vec<Option<Vec<Option<f64>>>> = columns.collect();
        let si = |row: usize| {
            let each = model.channels.iter().zip(&columns);
            each.map(|(channel, column)| Some(channel.scale * column.as_ref()?[row]? + channel.offset))
                .collect()
        };
        (0..table.rows.len()).map(si).collect()
    };
    tables.iter().flat_map(of).collect()
}

/// Those points that a tie can be tried on: both readings are there, and none that it divides by is nothing.
fn readings(model: &Model, tie: &Tie, speeds: &[Option<f64>], points: &[Vec<Option<f64>>]) -> Readings {
    let node = |at: &str| model.nodes.iter().position(|node| node.name == at);
    let at_second = {
        let spring = model.springs.iter().find(|spring| spring.name == model.channels[tie.second].at);
        spring
            .map(|spring| spring.from)
            .or_else(|| node(&model.channels[tie.second].at))
            .and_then(|node| speeds[node])
    };
    let mut readings = Readings::default();
    for point in points {
        let (Some(first), Some(second)) = (point[tie.first], point[tie.second]) else { continue };
        let turns = model.channels.iter().zip(point).find_map(|(channel, value)| {
            let is_speed = channel.quantity == socam_model::Quantity::Speed;
            Some((*value)? / speeds[node(&channel.at).filter(|_| is_speed)?]?)
        });
        let opposed = first * tie.ratio * second <= 0.0;
        if tie.kind == Kind::Speeds && opposed {
            continue;
        }
        readings.first.push(first);
        readings.second.push(second);
        readings.speed.push(turns.zip(at_second).map_or(f64::NAN, |(turns, share)| turns * share));
    }
    readings
}

fn outcome<'a>(
    model: &Model,
    tie: &'a Tie,
    readings: &'a Readings,
    options: SteadyOptions,
    threshold: f64,
) -> Option<Outcome<'a>> {
    let case = Case::new(model, tie, readings, options.repeatability);
    let base = case.fit(model, None, None)?;
    let mut ranked: Vec<(Explanation, FittedModel)> = case
        .explanations(model)
        .into_iter()
        .filter_map(|own| case.fit(model, Some(&own), None).map(|fitted| (own, fitted)))
        .filter(|(own, fitted)| own.is_possible(fitted))
        .collect();
    // Of those that do equally well the first one listed leads: a plant before its sensors.
    ranked.sort_by(|a, b| a.1.chi2.total_cmp(&b.1.chi2));
    let least = ranked.first().map_or(0.0, |(_, fitted)| fitted.chi2);
    let alike = ranked.iter().filter(|(_, fitted)| fitted.chi2 < least + ALIKE).count();
    ranked[..alike].sort_by_key(|(own, _)| own.rank);
    let good = ranked.iter().filter(|(_, fitted)| fitted.p_value >= options.false_alarm_rate).count();
    let broken = base.p_value < threshold;
    Some(Outcome { tie, case, readings, base, ranked, broken, good })
}

impl Outcome<'_> {
    /// What explains it best, if anything does.
    fn named(&self) -> Option<&(Explanation, FittedModel)> {
        self.ranked.first().filter(|_| self.broken && self.good > 0)
    }

    /// Squares of what is left at points that were left out, in units of uncertainty.
    fn left_out(&self, model: &Model, explanation: Option<&Explanation>) -> Option<Vec<f64>> {
        let each = (0..self.case.error.len()).map(|point| {
            let fitted = self.case.fit(model, explanation, Some(point))?;
            Some(fitted.left[point].powi(2))
        });
        each.collect()
    }

    /// One over `ratio` times another, as the table says it: the share of the second in the first.
    fn shares(&self) -> Vec<f64> {
        let both = self.readings.first.iter().zip(&self.readings.second);
        match self.tie.kind {
            Kind::Speeds => both.map(|(first, second)| first / second).collect(),
            _ => both.map(|(first, second)| 100.0 * second / (self.tie.ratio * first)).collect(),
        }
    }
}
