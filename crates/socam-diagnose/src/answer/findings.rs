//! Findings: one for each effect at a place, and one for the nonparametric term.

use socam_identify::{Identification, IdentifyError};
use socam_model::{
    NewParameter,
    effects::{FittedValues, USUAL_CHANGE},
};

use super::{inputs::Inputs, rivals::rivals};
use crate::{
    candidate::Candidate,
    document::{Component, EffectParameter, Finding, FindingEvidence, Region, UNEXPLAINED},
    drag, materiality,
    nonparametric::{formula::FoundFormula, term::Unexplained},
    proof::Proof,
    region,
    selection::Path,
    words,
};

/// All findings, the largest gain in log score first. Empty where nothing was found.
pub(super) fn findings(inputs: &Inputs<'_>) -> Result<Vec<Finding>, IdentifyError> {
    let Inputs { context, path, floor, .. } = *inputs;
    let proof = inputs.held_out.proof();
    let mut findings: Vec<Finding> = Vec::new();
    let mut reached = None;
    for (index, term) in path.terms.iter().enumerate() {
        let mut finding = finding(inputs, index);
        if !finding.drag.is_empty() {
            // The base model may have moved faster than the machine did.
            let rig = match &mut reached {
                Some(rig) => rig,
                None => reached.insert(path.scales(context)?.rig),
            };
            let fastest = rig.bearing(&finding.location).1.speed;
            finding.drag.retain(|drag| drag.speed <= fastest);
        }
        let without = term.without.as_ref().unwrap_or(&path.base);
        let own = region::region(context, without, Some(&path.last), &finding.location, floor)?;
        finding.region = Region { text: format!("{}; {}", finding.region.text, own.text), ..own };
        let change = materiality::largest_change(context, path, index)?;
        let is_small = change.as_ref().is_none_or(|change| change.share <= USUAL_CHANGE);
        finding.evidence = FindingEvidence {
            chi2_gain: Some((without.deviance() - path.last.deviance()).max(0.0)),
            holdout_gain_percent: proof.and_then(|proof| proof.gain_percent(index)),
            material: change.as_ref().map(|change| change.share > context.options.tolerance),
            moves_percent: change.as_ref().map(|change| 100.0 * change.share),
            moves_channel: change.map(|change| change.channel),
            ordinary: ordinary(path, index).filter(|_| is_small).map(str::to_owned),
            ..finding.evidence
        };
        findings.push(finding);
    }
    if let Some(found) = &path.unexplained {
        let mut without_name = unexplained(path, found, proof);
        let own = region::region(context, &path.last, None, &found.place, floor)?;
        without_name.region = Region { text: format!("{}; {}", without_name.region.text, own.text), ..own };
        findings.push(without_name);
    }
    // Gains in log score were found under the noise model of their step; these are all under that of the last model.
    let gain = |finding: &Finding| finding.evidence.chi2_gain.unwrap_or(0.0);
    findings.sort_by(|a, b| gain(b).total_cmp(&gain(a)));
    Ok(merged(findings))
}

/// The finding of one term; `findings` adds its region and evidence.
fn finding(inputs: &Inputs<'_>, index: usize) -> Finding {
    let Inputs { context, path, after, .. } = *inputs;
    let term = &path.terms[index];
    let parameters = effect_parameters(path, index, after);
    let place = &term.candidate.place;
    let (rivals, richer) = rivals(path, term, &path.equivalent(context, index));
    Finding {
        effect: term.candidate.effect.id.into(),
        location: place.clone(),
        sentence: words::sentence(term.candidate.effect, place, &parameters),
        equation: term.candidate.effect.equation.into(),
        parameters,
        components: Vec::new(),
        curve: None,
        region: Region { text: term.candidate.effect.shows.into(), ..Region::default() },
        evidence: FindingEvidence {
            p_value: Some(term.p_value),
            log_score_gain: Some([term.gain.log_score, term.gain.std]),
            ..FindingEvidence::default()
        },
        rivals,
        richer,
        drag: after.joint.as_ref().map_or_else(Vec::new, |joint| drag::of_term(path, term, joint)),
        formulas: Vec::new(),
    }
}

/// The finding of the nonparametric term.
fn unexplained(path: &Path, found: &Unexplained, proof: Option<&Proof>) -> Finding {
    let is_channel = path.last.model.channels.iter().any(|channel| channel.name == found.place);
    Finding {
        effect: UNEXPLAINED.into(),
        location: found.place.clone(),
        sentence: words::unexplained(found, is_channel, path.unexamined.is_none()),
        equation: found.formula.as_ref().map_or_else(String::new, |own| own.law.formula.clone()),
        parameters: found.formula.as_ref().map_or_else(Vec::new, formula_parameters),
        components: Vec::new(),
        curve: Some(found.curve.clone()),
        region: Region { text: words::region_of_curve(&found.curve), ..Region::default() },
        evidence: FindingEvidence {
            p_value: Some(found.p_value),
            chi2_gain: Some((path.last.deviance() - found.whole().deviance()).max(0.0)),
            holdout_gain_percent: proof.map(Proof::curve_gain_percent),
            misfit_percent: Some(found.misfit_percent),
            log_score_gain: Some([found.gain.log_score, found.gain.std]),
            ..FindingEvidence::default()
        },
        rivals: Vec::new(),
        richer: Vec::new(),
        drag: Vec::new(),
        formulas: found.formula.as_ref().map_or_else(Vec::new, |own| own.rivals.clone()),
    }
}

/// Parameters of a formula in the place of a curve that were estimated.
fn formula_parameters(found: &FoundFormula) -> Vec<EffectParameter> {
    let free = found.law.parameters.iter().filter(|own| !own.is_fixed);
    let one = |own: &NewParameter| EffectParameter {
        name: own.name.clone(),
        value: Some(own.value),
        unit: own.unit.clone(),
        ci95: own.ci95.map_or([None; 2], |[low, high]| [Some(low), Some(high)]),
    };
    free.map(one).collect()
}

/// Why the size of a term is that of an ordinary imperfection; `None` where it is not.
fn ordinary(path: &Path, term: usize) -> Option<&'static str> {
    let Candidate { effect, place, .. } = &path.terms[term].candidate;
    let fitted = path.fitted_parameters(term);
    (effect.usual)(&path.priors.rig, place, &FittedValues(&fitted))
}

/// Deviance reduction of a finding.
fn gain(finding: &Finding) -> f64 {
    finding.evidence.chi2_gain.unwrap_or(0.0)
}

/// Findings with several orders of one effect at one place merged into one, whose components are the orders, the largest gain first.
fn merged(findings: Vec<Finding>) -> Vec<Finding> {
    let mut merged: Vec<Finding> = Vec::new();
    for finding in findings {
        let is_it = |known: &&mut Finding| {
            finding.effect != UNEXPLAINED
                && known.effect == finding.effect
                && known.location == finding.location
        };
        let Some(known) = merged.iter_mut().find(is_it) else {
            merged.push(finding);
            continue;
        };
        if known.components.is_empty() {
            known.components.push(Component { parameters: known.parameters.clone() });
        }
        known.components.push(Component { parameters: finding.parameters.clone() });
        known.evidence.chi2_gain = Some(gain(known) + gain(&finding));
        let left = |finding: &Finding| 1.0 - 0.01 * finding.evidence.holdout_gain_percent.unwrap_or(0.0);
        known.evidence.holdout_gain_percent = Some(100.0 * (1.0 - left(known) * left(&finding)));
    }
    merged
}

/// Estimates of a term's parameters that are not fixed. A phase is given within plus or minus half a turn.
fn effect_parameters(path: &Path, term: usize, after: &Identification) -> Vec<EffectParameter> {
    path.parameters(term)
        .filter(|(_, index)| !path.last.model.parameters[*index].fixed)
        .map(|(name, index)| {
            let estimate = &after.parameters[index];
            let turns = if name == "phase" {
                let value = estimate.value.unwrap_or(0.0);
                value - (value + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
                    + std::f64::consts::PI
            } else {
                0.0
            };
            EffectParameter {
                name: name.into(),
                value: estimate.value.map(|value| value - turns),
                unit: estimate.unit.clone(),
                ci95: estimate.ci95.map(|end| end.map(|end| end - turns)),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding(effect: &str, order: f64, gain: f64) -> Finding {
        let order = EffectParameter {
            name: "order".into(),
            value: Some(order),
            unit: "1".into(),
            ci95: [None, None],
        };
        Finding {
            effect: effect.into(),
            location: "mesh".into(),
            sentence: String::new(),
            equation: String::new(),
            parameters: vec![order],
            components: Vec::new(),
            curve: None,
            region: Region::default(),
            evidence: FindingEvidence {
                chi2_gain: Some(gain),
                holdout_gain_percent: Some(50.0),
                ..FindingEvidence::default()
            },
            rivals: Vec::new(),
            richer: Vec::new(),
            drag: Vec::new(),
            formulas: Vec::new(),
        }
    }

    #[test]
    fn several_orders_at_one_place_are_one_finding() {
        let all = [("kinematic_error", 1.0, 30.0), ("mesh_loss", 0.0, 20.0), ("kinematic_error", 2.0, 10.0)];
        let merged = merged(all.map(|(effect, order, gain)| finding(effect, order, gain)).into());
        assert_eq!(merged.len(), 2);
        let orders = merged[0].components.iter().map(|component| component.parameters[0].value);
        assert_eq!(orders.collect::<Vec<_>>(), [Some(1.0), Some(2.0)]);
        assert_eq!(merged[0].evidence.chi2_gain, Some(40.0));
        assert_eq!(merged[0].evidence.holdout_gain_percent, Some(75.0));
        assert!(merged[1].components.is_empty());
    }
}
