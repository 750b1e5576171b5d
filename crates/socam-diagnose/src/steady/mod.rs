//! Diagnosis of steady states: tables of operating points, one row each, as in X. Song's thesis (McGill 2002), tables 5.1 to 5.3.
//!
//! Means over a steady state have no course in time to whiten or to screen. What they must obey is read off the model instead
//! ([`ties`]): speeds keep the gears' ratios, torques balance. Where a tie breaks by more than readings repeat, each effect that
//! shows in a steady state is fitted on its own ([`explain`]), and those that do equally well are rivals.

mod explain;
mod ties;

#[cfg(test)]
mod tests;

use socam_model::{Model, ModelError, Update, effects};
use socam_recording::Steady;
use thiserror::Error;

use crate::{
    Diagnosis,
    document::{
        ChannelFit, Curve, EffectParameter, Finding, Fit, NotFound, Over, ParameterChange, Proof,
        RecordingUse, Region, Rival, SCHEMA, UNEXPLAINED, Validation, Verdict,
    },
    experiment, words,
};
use explain::{Case, Explanation, Fitted, Readings};
use ties::{Kind, Tie};

/// Fall of the sum of squares at which an effect would have been seen.
const SEEN: f64 = 25.0;
/// Sums of squares no further apart are alike.
const ALIKE: f64 = 0.05;
/// Weight of a rival that is worth naming.
const LEAST_WEIGHT: f64 = 1e-2;

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
    base: Fitted,
    /// What explains it, best first; not only if the tie breaks.
    ranked: Vec<(Explanation, Fitted)>,
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
            corrected = corrected.with_effect(named.effect, &named.place, &[(named.parameter, value)])?;
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
    let mut ranked: Vec<(Explanation, Fitted)> = case
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
    fn named(&self) -> Option<&(Explanation, Fitted)> {
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

fn range(values: &[f64]) -> Option<[f64; 2]> {
    let known = || values.iter().copied().filter(|value| value.is_finite());
    let ends = [known().fold(f64::INFINITY, f64::min), known().fold(f64::NEG_INFINITY, f64::max)];
    (ends[0] <= ends[1]).then_some(ends)
}

fn finding(model: &Model, outcome: &Outcome<'_>, points: &[Vec<Option<f64>>]) -> Finding {
    let Outcome { tie, readings, base, .. } = outcome;
    let torque = if tie.kind == Kind::Speeds { None } else { range(&readings.second) };
    let region = Region {
        speed_rad_s: range(&readings.speed),
        torque_nm: torque,
        text: "at every steady state of the table; what happens in between is not in it".into(),
        ..Region::default()
    };
    let seen = observation(model, outcome);
    let named = outcome.named();
    let mut proof = Proof {
        p_value: Some(base.p_value),
        chi2_gain: Some(base.chi2 - named.map_or(0.0, |(_, fitted)| fitted.chi2)),
        holdout_gain_percent: None,
        misfit_percent: None,
    };
    let Some((own, fitted)) = named else {
        return Finding {
            effect: UNEXPLAINED.into(),
            location: unexplained_at(model, outcome),
            parameters: Vec::new(),
            components: Vec::new(),
            curve: Some(curve(model, outcome)),
            region,
            evidence: proof,
            rivals: Vec::new(),
            sentence: format!("{seen}: {}", without_a_name(model, outcome)),
            equation: String::new(),
        };
    };
    if let (Some(before), Some(after)) = (outcome.left_out(model, None), outcome.left_out(model, Some(own))) {
        let (before, after, count) =
            (before.iter().sum::<f64>(), after.iter().sum::<f64>(), before.len() as f64);
        let gain = before - after;
        proof.holdout_gain_percent = Some(100.0 * gain / (before - count).max(gain).max(1.0));
    }
    let parameters = vec![estimate(model, own, fitted)];
    let effect = effects::find(own.effect);
    Finding {
        effect: own.effect.into(),
        location: own.place.clone(),
        sentence: format!(
            "{}. {seen}",
            effect.map_or(String::new(), |effect| words::sentence(effect, &own.place, &parameters))
        ),
        equation: effect.map_or("", |effect| effect.equation).into(),
        parameters,
        components: Vec::new(),
        curve: None,
        region,
        evidence: proof,
        rivals: rivals(model, outcome, points),
    }
}

fn estimate(model: &Model, own: &Explanation, fitted: &Fitted) -> EffectParameter {
    let (value, ci95) = own.estimate(fitted);
    EffectParameter {
        name: own.parameter.into(),
        value: Some(value),
        unit: unit(model, own),
        ci95: ci95.map(|end| Some(end).filter(|end| end.is_finite())),
    }
}

fn unit(model: &Model, own: &Explanation) -> String {
    let parameter =
        effects::find(own.effect).and_then(|e| e.parameters.iter().find(|p| p.name == own.parameter));
    parameter.map_or("", |p| model.unit_at(p.kind, &own.place)).into()
}

/// What the table says, in its own numbers.
fn observation(model: &Model, outcome: &Outcome<'_>) -> String {
    let tie = outcome.tie;
    let (first, second) = (&model.channels[tie.first].name, &model.channels[tie.second].name);
    let list =
        |values: &[f64]| values.iter().map(|value| words::short(*value)).collect::<Vec<_>>().join(", ");
    let ratio = words::short(tie.ratio);
    match tie.kind {
        Kind::Speeds => format!(
            "`{first}` / `{second}` is {}, where in a steady state gears and couplings allow {ratio} only",
            list(&outcome.shares())
        ),
        Kind::Torques => format!("`{second}` is {} % of {ratio} times `{first}`", list(&outcome.shares())),
        Kind::Load => format!(
            "`{first}` is {} {} at {} rad/s",
            list(&outcome.readings.first),
            model.channels[tie.first].unit,
            list(&outcome.readings.speed)
        ),
    }
}

fn without_a_name(model: &Model, outcome: &Outcome<'_>) -> String {
    let chance = |effect: &str| {
        let own = outcome.ranked.iter().filter(|(own, _)| own.effect == effect);
        own.map(|(_, fitted)| fitted.p_value).fold(0.0, f64::max)
    };
    match outcome.tie.kind {
        Kind::Speeds => format!(
            "they scatter beyond any one gain (chance {:.0e}) and any one offset (chance {:.0e}) of either sensor, so neither corrects \
             them, and whatever is worked out from both is uncertain by as much",
            chance("sensor_gain"),
            chance("sensor_offset")
        ),
        Kind::Torques => "no loss, drag, gain or offset of the catalogue takes as much at every point".into(),
        Kind::Load => {
            let viscous =
                if outcome.case.base.is_empty() { "nothing in the model" } else { "no viscous drag" };
            let place = unexplained_at(model, outcome);
            format!("{viscous} at {place} does that, nor does any constant or quadratic drag")
        }
    }
}

fn unexplained_at(model: &Model, outcome: &Outcome<'_>) -> String {
    let tie = outcome.tie;
    let bearing = tie.bearings.last().map(|(bearing, _)| model.bearings[*bearing].name.clone());
    let gear = tie.gears.first().map(|gear| model.gears[*gear].name.clone());
    let place = match tie.kind {
        Kind::Speeds => None,
        Kind::Torques => gear.or(bearing),
        Kind::Load => bearing,
    };
    place.unwrap_or_else(|| model.channels[tie.second].name.clone())
}

/// The error point by point, over speed.
fn curve(model: &Model, outcome: &Outcome<'_>) -> Curve {
    let Outcome { tie, readings, case, .. } = outcome;
    let second = &model.channels[tie.second];
    let error = |k: usize| match tie.kind {
        // As an error of the second sensor.
        Kind::Speeds => readings.second[k] * (1.0 - case.error[k].exp()),
        _ => case.error[k],
    };
    let mut all: Vec<(f64, f64)> = (0..case.error.len())
        .map(|k| (readings.speed[k], error(k)))
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    Curve {
        over: Over::Speed,
        unit: "rad/s".into(),
        x: all.iter().map(|(x, _)| *x).collect(),
        torque: all.iter().map(|(_, y)| Some(*y)).collect(),
        torque_std: Vec::new(),
        torque_unit: second.unit.into(),
    }
}

/// What explains it too, by its likelihood beside the best.
fn rivals(model: &Model, outcome: &Outcome<'_>, points: &[Vec<Option<f64>>]) -> Vec<Rival> {
    let best = outcome.ranked[0].1.chi2;
    let mut all: Vec<(String, String, f64)> = outcome.ranked[..outcome.good]
        .iter()
        .map(|(own, fitted)| (own.effect.into(), own.place.clone(), (-0.5 * (fitted.chi2 - best)).exp()))
        .collect();
    if outcome.tie.kind == Kind::Speeds {
        all.extend(slip(model, outcome, points));
    }
    let total: f64 = all.iter().map(|(.., weight)| weight).sum();
    all.into_iter()
        .skip(1)
        .map(|(effect, location, weight)| Rival { effect, location, weight: weight / total })
        .filter(|rival| rival.weight > LEAST_WEIGHT)
        .collect()
}

/// A coupling may run at two speeds only while it slips, and then passes on the same torque at every speed: it is a rival where no
/// torque was measured that says otherwise.
fn slip(model: &Model, outcome: &Outcome<'_>, points: &[Vec<Option<f64>>]) -> Option<(String, String, f64)> {
    let spring = outcome.tie.springs.first().map(|spring| model.springs[*spring].name.clone())?;
    let torque = model.channels.iter().position(|channel| channel.quantity == socam_model::Quantity::Torque);
    let read: Vec<f64> = points.iter().filter_map(|point| point[torque?]).collect();
    let [least, most] = range(&read).unwrap_or([1.0, 1.0]);
    let changes = (most - least).abs() > 0.05 * most.abs().max(least.abs());
    // As Akaike counts: a slip of its own at every point, against one gain.
    (!changes).then(|| ("coupling_slip".into(), spring, (-(outcome.case.error.len() as f64 - 1.0)).exp()))
}

fn fit(model: &Model, outcome: &Outcome<'_>) -> (String, ChannelFit) {
    let tie = outcome.tie;
    // The error of speeds is a share of them.
    let scale = |k: usize| if tie.kind == Kind::Speeds { outcome.readings.second[k] } else { 1.0 };
    let rms = |values: &[f64]| {
        let sum: f64 = values.iter().enumerate().map(|(k, value)| (value * scale(k)).powi(2)).sum();
        Some((sum / values.len() as f64).sqrt()).filter(|rms| rms.is_finite())
    };
    // Uncertainty is what is left over what that is in its units.
    let sigma: Vec<f64> = outcome.base.residual.iter().zip(&outcome.base.left).map(|(r, l)| r / l).collect();
    let held = |explanation: Option<&Explanation>| {
        let left = outcome.left_out(model, explanation)?;
        rms(&left.iter().zip(&sigma).map(|(left, sigma)| left.sqrt() * sigma).collect::<Vec<_>>())
    };
    let own = outcome.named();
    let fit = ChannelFit {
        noise_std: rms(&sigma),
        rms_before: rms(&outcome.base.residual),
        rms_after: rms(own.map_or(&outcome.base.residual, |(_, fitted)| &fitted.residual)),
        holdout_rms_before: held(None),
        holdout_rms_after: held(own.map(|(own, _)| own)),
        unit: model.channels[tie.second].unit.into(),
    };
    let name = &model.channels[tie.second].name;
    let of = match tie.kind {
        Kind::Load => format!("{name} by drag"),
        _ => format!("{name} by {}", model.channels[tie.first].name),
    };
    (of, fit)
}

/// Dampings that steady states determine; all else of the model they do not.
fn parameters(model: &Model, outcomes: &[Outcome<'_>]) -> Vec<ParameterChange> {
    let each = model.parameters.iter().enumerate().map(|(index, parameter)| {
        let find = |outcome: &Outcome<'_>, fitted: &Fitted| {
            outcome
                .case
                .dampings(fitted)
                .into_iter()
                .find(|(own, ..)| *own == index)
                .map(|(_, value, ends)| (value, ends))
        };
        let before = outcomes.iter().find_map(|outcome| find(outcome, &outcome.base));
        let after = outcomes.iter().find_map(|outcome| match outcome.named() {
            Some((_, fitted)) => find(outcome, fitted),
            None if outcome.broken => None,
            None => find(outcome, &outcome.base),
        });
        let determined = after.filter(|(value, ends)| ends[1] - ends[0] <= value.abs());
        let ends = |known: Option<(f64, [f64; 2])>| known.map_or([None; 2], |(_, ends)| ends.map(Some));
        let fixed = Some(parameter.value).filter(|_| parameter.fixed);
        ParameterChange {
            name: parameter.name.clone(),
            unit: parameter.unit.clone(),
            before: fixed.or(before.map(|(value, _)| value)),
            after: fixed.or(determined.map(|(value, _)| value)),
            ci95: ends(determined),
            ci95_before: ends(before),
            identifiable: determined.is_some(),
            fixed: parameter.fixed,
            determined_with: Vec::new(),
        }
    });
    each.collect()
}

fn unseen(model: &Model, outcome: &Outcome<'_>) -> Vec<NotFound> {
    let each = outcome.ranked.iter().map(|(own, fitted)| NotFound {
        effect: own.effect.into(),
        location: own.place.clone(),
        parameter: own.parameter.into(),
        smallest_detectable: Some(SEEN.sqrt() * own.resolution(fitted)).filter(|size| size.is_finite()),
        unit: unit(model, own),
    });
    each.collect()
}
