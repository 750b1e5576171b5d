//! Document entries for violated parity relations and for those that hold.

use socam_model::{
    Model,
    effects::{CATALOGUE, Form, Steady},
};

use super::{explain::Explanation, least_squares::ResidualFit, outcome::Outcome, parity::RelationKind};
use crate::{
    document::{
        ChannelFit, Curve, EffectParameter, Finding, FindingEvidence, NotFound, Over, ParameterChange,
        Region, Rival, UNEXPLAINED,
    },
    words,
};

/// Fall of the sum of squares at which an effect counts as detectable.
const DETECTABLE: f64 = 25.0;
/// Least weight of a competing explanation that is listed.
const LEAST_WEIGHT: f64 = 1e-2;

/// Least and greatest finite value; `None` where there is none.
fn range(values: &[f64]) -> Option<[f64; 2]> {
    let known = || values.iter().copied().filter(|value| value.is_finite());
    let ends = [known().fold(f64::INFINITY, f64::min), known().fold(f64::NEG_INFINITY, f64::max)];
    (ends[0] <= ends[1]).then_some(ends)
}

/// The finding of a violated relation.
pub(super) fn finding(model: &Model, outcome: &Outcome<'_>, points: &[Vec<Option<f64>>]) -> Finding {
    let Outcome { relation, readings, base, .. } = outcome;
    let torque = if relation.kind == RelationKind::Speeds { None } else { range(&readings.second) };
    let region = Region {
        speed_rad_s: range(&readings.speed),
        torque_nm: torque,
        text: "at every steady state of the table; what happens in between is not in it".into(),
        ..Region::default()
    };
    let observed = observation(model, outcome);
    let named = outcome.named();
    let mut evidence = FindingEvidence {
        p_value: Some(base.p_value),
        chi2_gain: Some(base.chi2 - named.map_or(0.0, |(_, fitted)| fitted.chi2)),
        holdout_gain_percent: None,
        misfit_percent: None,
        ..FindingEvidence::default()
    };
    let Some((own, fitted)) = named else {
        return Finding {
            effect: UNEXPLAINED.into(),
            location: unexplained_at(model, outcome),
            parameters: Vec::new(),
            components: Vec::new(),
            curve: Some(curve(model, outcome)),
            region,
            evidence,
            rivals: Vec::new(),
            richer: Vec::new(),
            drag: Vec::new(),
            formulas: Vec::new(),
            sentence: format!("{observed}: {}", without_a_name(model, outcome)),
            equation: String::new(),
        };
    };
    if let (Some(before), Some(after)) = (outcome.left_out(model, None), outcome.left_out(model, Some(own))) {
        let (before, after, count) =
            (before.iter().sum::<f64>(), after.iter().sum::<f64>(), before.len() as f64);
        let gain = before - after;
        evidence.holdout_gain_percent = Some(100.0 * gain / (before - count).max(gain).max(1.0));
    }
    let parameters = vec![estimate(model, own, fitted)];
    Finding {
        effect: own.effect.id.into(),
        location: own.place.clone(),
        sentence: format!("{}. {observed}", words::sentence(own.effect, &own.place, &parameters)),
        equation: own.effect.equation.into(),
        parameters,
        components: Vec::new(),
        curve: None,
        region,
        evidence,
        rivals: rivals(model, outcome, points),
        richer: Vec::new(),
        drag: Vec::new(),
        formulas: Vec::new(),
    }
}

/// Estimate of an explanation's parameter.
fn estimate(model: &Model, own: &Explanation, fitted: &ResidualFit) -> EffectParameter {
    let (value, ci95) = own.estimate(fitted);
    EffectParameter {
        name: own.parameter.into(),
        value: Some(value),
        unit: unit(model, own),
        ci95: ci95.map(|end| Some(end).filter(|end| end.is_finite())),
    }
}

/// Unit of an explanation's parameter.
fn unit(model: &Model, own: &Explanation) -> String {
    let parameter = own.effect.parameters.iter().find(|known| known.name == own.parameter);
    parameter.map_or("", |p| model.unit_at(p.kind, &own.place)).into()
}

/// The observation, in the numbers of the table.
fn observation(model: &Model, outcome: &Outcome<'_>) -> String {
    let relation = outcome.relation;
    let (first, second) = (&model.channels[relation.first].name, &model.channels[relation.second].name);
    let list =
        |values: &[f64]| values.iter().map(|value| words::short(*value)).collect::<Vec<_>>().join(", ");
    let ratio = words::short(relation.ratio);
    match relation.kind {
        RelationKind::Speeds => format!(
            "`{first}` / `{second}` is {}, where in a steady state gears and couplings allow {ratio} only",
            list(&outcome.shares())
        ),
        RelationKind::Torques => {
            format!("`{second}` is {} % of {ratio} times `{first}`", list(&outcome.shares()))
        }
        RelationKind::Load => format!(
            "`{first}` is {} {} at {} rad/s",
            list(&outcome.readings.first),
            model.channels[relation.first].unit,
            list(&outcome.readings.speed)
        ),
    }
}

/// Why no effect of the catalogue explains a violated relation.
fn without_a_name(model: &Model, outcome: &Outcome<'_>) -> String {
    let chance = |is_it: fn(&Form) -> bool| {
        let own = outcome.ranked.iter().filter(|(own, _)| is_it(&own.effect.form));
        own.map(|(_, fitted)| fitted.p_value).fold(0.0, f64::max)
    };
    match outcome.relation.kind {
        RelationKind::Speeds => format!(
            "they scatter beyond any one gain (chance {:.0e}) and any one offset (chance {:.0e}) of either sensor, so neither corrects \
             them, and whatever is worked out from both is uncertain by as much",
            chance(|form| matches!(form, Form::Gain)),
            chance(|form| !matches!(form, Form::Gain))
        ),
        RelationKind::Torques => {
            "no loss, drag, gain or offset of the catalogue takes as much at every point".into()
        }
        RelationKind::Load => {
            let viscous =
                if outcome.test.base.is_empty() { "nothing in the model" } else { "no viscous drag" };
            let place = unexplained_at(model, outcome);
            format!("{viscous} at {place} does that, nor does any constant or quadratic drag")
        }
    }
}

/// Place of a violation that nothing explains.
fn unexplained_at(model: &Model, outcome: &Outcome<'_>) -> String {
    let relation = outcome.relation;
    let bearing = relation.bearings.last().map(|(bearing, _)| model.bearings[*bearing].name.clone());
    let gear = relation.gears.first().map(|gear| model.gears[*gear].name.clone());
    let place = match relation.kind {
        RelationKind::Speeds => None,
        RelationKind::Torques => gear.or(bearing),
        RelationKind::Load => bearing,
    };
    place.unwrap_or_else(|| model.channels[relation.second].name.clone())
}

/// The relation's error at each point, over speed.
fn curve(model: &Model, outcome: &Outcome<'_>) -> Curve {
    let Outcome { relation, readings, test, .. } = outcome;
    let second = &model.channels[relation.second];
    let error = |k: usize| match relation.kind {
        // Expressed as an error of the second sensor.
        RelationKind::Speeds => readings.second[k] * (1.0 - test.error[k].exp()),
        _ => test.error[k],
    };
    let mut all: Vec<(f64, f64)> = (0..test.error.len())
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

/// Competing explanations, weighted by their likelihood.
fn rivals(model: &Model, outcome: &Outcome<'_>, points: &[Vec<Option<f64>>]) -> Vec<Rival> {
    let best = outcome.ranked[0].1.chi2;
    let mut all: Vec<(String, String, f64)> = outcome.ranked[..outcome.sufficient]
        .iter()
        .map(|(own, fitted)| (own.effect.id.into(), own.place.clone(), (-0.5 * (fitted.chi2 - best)).exp()))
        .collect();
    if outcome.relation.kind == RelationKind::Speeds {
        all.extend(slip(model, outcome, points));
    }
    let total: f64 = all.iter().map(|(.., weight)| weight).sum();
    all.into_iter()
        .skip(1)
        .map(|(effect, location, weight)| Rival { effect, location, weight: weight / total })
        .filter(|rival| rival.weight > LEAST_WEIGHT)
        .collect()
}

/// A slipping coupling as a competing explanation of two speeds. A coupling that slips transmits the same torque at every speed, so it
/// competes only where no measured torque changes.
fn slip(model: &Model, outcome: &Outcome<'_>, points: &[Vec<Option<f64>>]) -> Option<(String, String, f64)> {
    let spring = outcome.relation.springs.first().map(|spring| model.springs[*spring].name.clone())?;
    let torque = model.channels.iter().position(|channel| channel.quantity == socam_model::Quantity::Torque);
    let read: Vec<f64> = points.iter().filter_map(|point| point[torque?]).collect();
    let [least, most] = range(&read).unwrap_or([1.0, 1.0]);
    let changes = (most - least).abs() > 0.05 * most.abs().max(least.abs());
    // Akaike weight: one slip at each point has n - 1 parameters more than one gain.
    let slips = CATALOGUE.iter().find(|effect| effect.steady == Steady::Slips).filter(|_| !changes)?;
    Some((slips.id.into(), spring, (-(outcome.test.error.len() as f64 - 1.0)).exp()))
}

/// Root mean square errors of a relation, before and after the explanation.
pub(super) fn fit(model: &Model, outcome: &Outcome<'_>) -> (String, ChannelFit) {
    let relation = outcome.relation;
    // The error of speeds is relative.
    let scale =
        |k: usize| if relation.kind == RelationKind::Speeds { outcome.readings.second[k] } else { 1.0 };
    let rms = |values: &[f64]| {
        let sum: f64 = values.iter().enumerate().map(|(k, value)| (value * scale(k)).powi(2)).sum();
        Some((sum / values.len() as f64).sqrt()).filter(|rms| rms.is_finite())
    };
    // The uncertainty of a point is its residual over its residual in units of the uncertainty.
    let sigma: Vec<f64> =
        outcome.base.residual.iter().zip(&outcome.base.normalised).map(|(r, l)| r / l).collect();
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
        unit: model.channels[relation.second].unit.into(),
    };
    let name = &model.channels[relation.second].name;
    let of = match relation.kind {
        RelationKind::Load => format!("{name} by drag"),
        _ => format!("{name} by {}", model.channels[relation.first].name),
    };
    (of, fit)
}

/// All parameters of the model. Steady states determine free dampings only.
pub(super) fn parameters(model: &Model, outcomes: &[Outcome<'_>]) -> Vec<ParameterChange> {
    let each = model.parameters.iter().enumerate().map(|(index, parameter)| {
        let find = |outcome: &Outcome<'_>, fitted: &ResidualFit| {
            outcome
                .test
                .dampings(fitted)
                .into_iter()
                .find(|(own, ..)| *own == index)
                .map(|(_, value, ends)| (value, ends))
        };
        let before = outcomes.iter().find_map(|outcome| find(outcome, &outcome.base));
        let after = outcomes.iter().find_map(|outcome| match outcome.named() {
            Some((_, fitted)) => find(outcome, fitted),
            None if outcome.violated => None,
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

/// Explanations of a relation that holds, with the smallest size that would have been detected.
pub(super) fn not_found(model: &Model, outcome: &Outcome<'_>) -> Vec<NotFound> {
    let each = outcome.ranked.iter().map(|(own, fitted)| NotFound {
        effect: own.effect.id.into(),
        location: own.place.clone(),
        parameter: own.parameter.into(),
        smallest_detectable: Some(DETECTABLE.sqrt() * own.resolution(fitted)).filter(|size| size.is_finite()),
        unit: unit(model, own),
    });
    each.collect()
}
