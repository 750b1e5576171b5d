//! Fills the rows of the table from the results of a screening and of a diagnosis.

use socam_diagnose::{
    Diagnosis, Screening,
    document::{self, UNEXPLAINED},
};
use socam_identify::{CombinationEstimate, ParameterEstimate};
use socam_model::{Model, effects};

use crate::row::{ChannelFit, Finding, Parameter, Row, Verdict, finite};

/// p-value, excess, parameters and fit of the base model.
pub(crate) fn screening(found: &Screening, model: &Model, row: &mut Row) {
    row.p_value = finite(found.p_value);
    row.excess = finite(found.excess);
    let combinations = found.fit.combinations.iter().map(combination);
    row.parameters = found.fit.parameters.iter().map(parameter).chain(combinations).collect();
    let channels = model.outputs().zip(&found.fit.fit.channels);
    row.channels = channels
        .map(|(output, (name, fit))| ChannelFit {
            name: name.clone(),
            unit: output.unit.to_owned(),
            noise_std: finite(fit.noise_std),
            rms: finite(fit.rms),
            rms_corrected: None,
        })
        .collect();
    add_warnings(row, &found.notes);
    add_warnings(row, &found.fit.warnings);
}

fn parameter(estimate: &ParameterEstimate) -> Parameter {
    Parameter {
        name: estimate.name.clone(),
        value: estimate.value.and_then(finite),
        std: estimate.std.and_then(finite),
        low: estimate.ci95[0].and_then(finite),
        high: estimate.ci95[1].and_then(finite),
        unit: estimate.unit.clone(),
        determined: estimate.identifiable,
    }
}

fn combination(estimate: &CombinationEstimate) -> Parameter {
    let value = estimate.value.and_then(finite);
    Parameter {
        name: estimate.name.clone(),
        value,
        std: estimate.std.and_then(finite),
        low: estimate.ci95[0].and_then(finite),
        high: estimate.ci95[1].and_then(finite),
        unit: estimate.unit.clone(),
        determined: value.is_some(),
    }
}

/// Verdict, findings and fit of the corrected model. The parameters stay those of the base model, so that all recordings of a fleet are
/// compared by one estimator.
pub(crate) fn diagnosis(found: &Diagnosis, row: &mut Row) {
    row.verdict = Some(found.verdict);
    row.findings = found.findings.iter().map(finding).collect();
    for (name, fit) in &found.fit.channels {
        match row.channels.iter_mut().find(|channel| channel.name == *name) {
            Some(channel) => channel.rms_corrected = fit.rms_after.and_then(finite),
            None => row.channels.push(ChannelFit {
                name: name.clone(),
                unit: fit.unit.clone(),
                noise_std: fit.noise_std.and_then(finite),
                rms: fit.rms_before.and_then(finite),
                rms_corrected: fit.rms_after.and_then(finite),
            }),
        }
    }
    add_warnings(row, &found.warnings);
    if found.verdict == Verdict::Adequate && row.p_value.is_some() {
        let sentence = "the recording stands out in the score test, and the diagnosis finds nothing missing that is material";
        add_warnings(row, &[sentence.into()]);
    }
}

fn finding(found: &document::Finding) -> Finding {
    let evidence = &found.evidence;
    let [gain, std] = evidence.log_score_gain.map_or([None; 2], |pair| pair.map(finite));
    let size = size(found);
    Finding {
        effect: found.effect.clone(),
        place: found.location.clone(),
        parameter: size.map(|size| size.name.clone()),
        size: size.and_then(|size| size.value).and_then(finite),
        low: size.and_then(|size| size.ci95[0]).and_then(finite),
        high: size.and_then(|size| size.ci95[1]).and_then(finite),
        unit: size.map_or_else(String::new, |size| size.unit.clone()),
        share: evidence.moves_percent.map(|percent| 0.01 * percent).and_then(finite),
        material: found.counts(),
        log_score_gain: gain,
        log_score_std: std,
        rivals: found.rivals.iter().map(|rival| format!("{}@{}", rival.effect, rival.location)).collect(),
        sentence: found.sentence.clone(),
    }
}

/// The parameter that measures the amplitude of a finding.
fn size(found: &document::Finding) -> Option<&document::EffectParameter> {
    if found.effect == UNEXPLAINED {
        return None;
    }
    let effect = effects::find(&found.effect)?;
    let amplitude = effect.amplitude.parameters.first()?;
    found.parameters.iter().find(|parameter| parameter.name == *amplitude)
}

/// Adds warnings that the row does not hold yet.
fn add_warnings(row: &mut Row, more: &[String]) {
    for warning in more {
        if !row.warnings.contains(warning) {
            row.warnings.push(warning.clone());
        }
    }
}
