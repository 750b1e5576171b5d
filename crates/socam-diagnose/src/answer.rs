//! The document, from the way that led to it.

use socam_identify::{Identification, IdentifyError, comparison::Evaluation};
use socam_model::Model;

use crate::{
    Diagnosis,
    candidates::Candidate,
    context::Context,
    document::{
        ChannelFit, CombinationChange, Component, EffectParameter, Finding, FindingEvidence, Fit, HeldOut,
        NotFound, ParameterChange, ProofOutcome, RecordingUse, Region, Rival, SCHEMA, SuggestedExperiment,
        UNEXPLAINED, Validation, Verdict,
    },
    experiment, materiality,
    nonparametric::Unexplained,
    proof::Proof,
    region,
    selection::{EXCESS, Path, Term},
    words,
};

/// Fall of the sum of squares at which an effect would have been seen.
const SEEN: f64 = 25.0;
/// Weight of a rival that is worth naming, and of one that is worth another recording.
const LEAST_WEIGHT: f64 = 1e-2;
const OPEN: f64 = 0.05;
/// Residuals, in noise floors, from which on a model does not explain recordings whatever tests say. Where nothing is missing it is 0.9 to 1.1.
const CONTRADICTION: f64 = 2.0;
/// Mean square of the same, whitened and in units of sensor noise, from which on a model is not called adequate. Where nothing is missing, a
/// noisy input and coarse converters leave up to 1.09.
const INADEQUATE: f64 = 1.2;

/// What the answer is made of.
pub(crate) struct Made<'a> {
    pub(crate) context: &'a Context<'a>,
    pub(crate) path: &'a Path,
    pub(crate) proof: Option<&'a Proof<'a>>,
    pub(crate) before: &'a Identification,
    pub(crate) after: &'a Identification,
    /// Noise floor of each output, SI.
    pub(crate) floor: &'a [f64],
}

pub(crate) fn document(made: &Made<'_>, cpu_s: f64) -> Result<Diagnosis, IdentifyError> {
    let Made { context, path, before, after, .. } = *made;
    let findings = findings(made)?;
    let is_material = |finding: &Finding| finding.evidence.material != Some(false);
    let verdict = if findings.iter().any(|finding| finding.effect != UNEXPLAINED && is_material(finding)) {
        Verdict::MissingPhysics
    } else if findings.iter().any(is_material) {
        Verdict::Unexplained
    } else {
        Verdict::Adequate
    };
    let mut warnings = after.warnings.clone();
    warnings.extend(cautions(made, &findings));
    let held_out = held_out(made);
    Ok(Diagnosis {
        schema: SCHEMA.into(),
        verdict,
        false_alarm_rate: context.options.false_alarm_rate,
        validation: if made.proof.is_some() { Validation::Holdout } else { context.validation() },
        selection: Some(context.validation()),
        held_out,
        suggested_experiment: suggestion(&findings),
        findings,
        fit: fit(made),
        parameters: parameters(before, after),
        combinations: combinations(before, after),
        not_found: not_found(path),
        cpu_s,
        warnings,
        model: path.base.model.name.clone(),
        recordings: recordings(made),
        version: env!("CARGO_PKG_VERSION").into(),
    })
}

/// All findings, the strongest first.
fn findings(made: &Made<'_>) -> Result<Vec<Finding>, IdentifyError> {
    let Made { context, path, proof, floor, .. } = *made;
    let mut findings: Vec<Finding> = Vec::new();
    for (index, term) in path.terms.iter().enumerate() {
        let mut finding = finding(made, index);
        let without = term.without.as_ref().unwrap_or(&path.base);
        let own = region::region(context, without, Some(&path.last), &finding.location, floor)?;
        finding.region = Region { text: format!("{}; {}", finding.region.text, own.text), ..own };
        let moves = materiality::moves(context, path, index)?;
        finding.evidence = FindingEvidence {
            chi2_gain: Some((without.deviance() - path.last.deviance()).max(0.0)),
            holdout_gain_percent: proof.and_then(|proof| proof.gain_percent(index)),
            material: moves.as_ref().map(|moves| moves.share > context.options.tolerance),
            moves_percent: moves.as_ref().map(|moves| 100.0 * moves.share),
            moves_channel: moves.map(|moves| moves.channel),
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
    if findings.is_empty() {
        findings.extend(contradiction(path, floor));
    }
    let strength = |finding: &Finding| finding.evidence.log_score_gain.map_or(0.0, |[gain, _]| gain);
    findings.sort_by(|a, b| strength(b).total_cmp(&strength(a)));
    Ok(merged(findings))
}

/// What a careful reader should know.
fn cautions(made: &Made<'_>, findings: &[Finding]) -> Vec<String> {
    let Made { context, path, proof, .. } = *made;
    let mut all = Vec::new();
    if proof.is_none() && !findings.is_empty() {
        let how = match context.validation() {
            Validation::Blocks => {
                "blocks of the recordings were left out in turn; whole recordings, three or more, would say more"
            }
            _ => "each recording was left out in turn",
        };
        all.push(format!("no recording was held out, so that nothing here is proven: findings rest on cross-validation ({how}); name one with --holdout"));
    }
    let left = path.noise.excess();
    if !path.terms.is_empty() && path.unexplained.is_none() && left > INADEQUATE {
        all.push(format!(
            "the corrected model still leaves {} the power of sensor noise in the recordings that were fitted; intervals allow for that",
            times(left)
        ));
    }
    if path.effects() >= context.options.most_effects && left > EXCESS {
        all.push(format!("stopped after {} effects, the most that --most allows", path.terms.len()));
    }
    all
}

/// What held-out recordings say of the corrected model.
fn held_out(made: &Made<'_>) -> Option<HeldOut> {
    let proof = made.proof?;
    made.path.corrected()?;
    let worse = proof.contradictions(&made.path.base.model);
    if worse.is_empty() && proof.is_better() {
        let sentence = "The corrected model predicts the held-out recordings better than the base model, and no channel worse.";
        return Some(HeldOut { outcome: ProofOutcome::Holds, sentence: sentence.into() });
    }
    let each = worse.iter().map(|(name, before, after)| {
        format!("{name} from {} to {}", words::short(*before), words::short(*after))
    });
    let each: Vec<String> = each.collect();
    let what = if each.is_empty() {
        "all channels together are predicted no better than by the base model".into()
    } else {
        format!("residuals (rms) rise in {}", each.join(", "))
    };
    let sentence =
        format!("The proof failed: on the held-out recordings {what}. Do not rely on the corrected model.");
    Some(HeldOut { outcome: ProofOutcome::Failed, sentence })
}

fn gain(finding: &Finding) -> f64 {
    finding.evidence.chi2_gain.unwrap_or(0.0)
}

/// What comes back with every turn in several orders at one place is one finding, of the strongest, the others being components of it.
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

fn recordings(made: &Made<'_>) -> Vec<RecordingUse> {
    let held_out = made.proof.iter().flat_map(|proof| proof.holdout).map(|data| (data, true));
    let all = made.context.training.iter().map(|data| (data, false)).chain(held_out);
    all.map(|(data, held_out)| RecordingUse {
        name: data.name().to_owned(),
        held_out,
        samples: data.rows(),
        duration_s: data.end_s() - data.start_s(),
    })
    .collect()
}

fn finding(made: &Made<'_>, index: usize) -> Finding {
    let Made { context, path, after, .. } = *made;
    let term = &path.terms[index];
    let parameters = effect_parameters(path, index, after);
    let place = &term.candidate.place;
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
        rivals: rivals(path, term, &path.equivalent(context, index)),
    }
}

/// What has a place and a shape but no name.
fn unexplained(path: &Path, found: &Unexplained, proof: Option<&Proof<'_>>) -> Finding {
    let is_channel = path.last.model.channels.iter().any(|channel| channel.name == found.place);
    Finding {
        effect: UNEXPLAINED.into(),
        location: found.place.clone(),
        sentence: words::unexplained(found, is_channel),
        equation: String::new(),
        parameters: Vec::new(),
        components: Vec::new(),
        curve: Some(found.curve.clone()),
        region: Region { text: words::region_of_curve(&found.curve), ..Region::default() },
        evidence: FindingEvidence {
            p_value: Some(found.p_value),
            chi2_gain: Some((path.last.deviance() - found.fitted.deviance()).max(0.0)),
            holdout_gain_percent: proof.map(Proof::curve_gain_percent),
            misfit_percent: Some(found.misfit_percent),
            log_score_gain: Some([found.gain.log_score, found.gain.std]),
            ..FindingEvidence::default()
        },
        rivals: Vec::new(),
    }
}

/// What is left above sensor noise although nothing that was tried predicts better: no model explains it.
fn contradiction(path: &Path, floor: &[f64]) -> Option<Finding> {
    let (last, left) = (&path.last, path.noise.excess());
    let each = last
        .model
        .outputs()
        .zip(floor)
        .zip(&last.at.rms)
        .map(|((channel, floor), missed)| (channel, *missed, missed / floor));
    let finite = each.filter(|(.., times)| times.is_finite());
    let (channel, missed, times) = finite.max_by(|a, b| a.2.total_cmp(&b.2))?;
    // A coarse encoder leaves no noise at high frequencies to judge it by, but what it rounds away is in the floor.
    let is_above = left >= INADEQUATE && times > INADEQUATE.sqrt();
    if times < CONTRADICTION && !is_above {
        return None;
    }
    let (missed, unit, name) = (words::short(missed), channel.unit, &channel.name);
    Some(Finding {
        effect: UNEXPLAINED.into(),
        location: channel.name.clone(),
        parameters: Vec::new(),
        components: Vec::new(),
        curve: None,
        region: Region { text: "on the recordings that were fitted".into(), ..Region::default() },
        evidence: FindingEvidence::default(),
        rivals: Vec::new(),
        sentence: format!(
            "The model misses {name} by {missed} {unit} (rms), {times:.1} times its noise floor (all channels: {} the power of \
             sensor noise), and no effect and no curve that was tried predicts it better",
            self::times(left)
        ),
        equation: String::new(),
    })
}

/// So many times, in words where the number says nothing.
fn times(power: f64) -> String {
    if power < 1e4 { format!("{power:.1} times") } else { "more than 10,000 times".into() }
}

/// Those that a file gives; a phase within a turn.
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

/// Weights of the models that were fitted, those that are observationally equivalent to the finding sharing its own. What was found beside it is
/// none.
fn rivals(path: &Path, term: &Term, equivalent: &[Candidate]) -> Vec<Rival> {
    let is_equivalent = |rival: &Candidate| equivalent.iter().any(|twin| twin.is_same(rival));
    let others: Vec<&(Candidate, f64)> =
        term.rivals.iter().filter(|(rival, _)| !is_equivalent(rival) && !path.has(rival)).collect();
    let own = 1.0 - others.iter().map(|(_, weight)| weight).sum::<f64>();
    let share = own / (1 + equivalent.len()) as f64;
    let all = equivalent
        .iter()
        .map(|twin| (twin, share))
        .chain(others.iter().map(|(rival, weight)| (rival, *weight)));
    let named = all.map(|(candidate, weight)| Rival {
        effect: candidate.effect.id.into(),
        location: candidate.place.clone(),
        weight,
    });
    let mut named: Vec<Rival> = named.filter(|rival| rival.weight > LEAST_WEIGHT).collect();
    named.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    named
}

fn suggestion(findings: &[Finding]) -> Option<SuggestedExperiment> {
    let is_open = |finding: &&Finding| finding.rivals.first().is_some_and(|rival| rival.weight > OPEN);
    match findings.iter().find(is_open) {
        Some(rivals) => Some(experiment::suggestion(rivals)),
        None => findings.iter().find_map(experiment::shape),
    }
}

fn fit(made: &Made<'_>) -> Fit {
    let Made { path, proof, floor, .. } = *made;
    let last = path.corrected().unwrap_or(&path.base);
    let rms =
        |measured: &Evaluation, output: usize| (measured.read[output] > 0.0).then(|| measured.rms[output]);
    let channels = path.base.model.outputs().enumerate().map(|(output, channel)| {
        let fit = ChannelFit {
            noise_std: Some(floor[output]),
            rms_before: rms(&path.base.at, output),
            rms_after: rms(&last.at, output),
            holdout_rms_before: proof.and_then(|proof| rms(&proof.base, output)),
            holdout_rms_after: proof.and_then(|proof| rms(&proof.corrected, output)),
            unit: channel.unit.into(),
        };
        (channel.name.clone(), fit)
    });
    Fit { channels: channels.collect() }
}

fn parameters(before: &Identification, after: &Identification) -> Vec<ParameterChange> {
    let each = before.parameters.iter().filter_map(|old| {
        let new = after.parameters.iter().find(|new| new.name == old.name)?;
        Some(ParameterChange {
            name: old.name.clone(),
            unit: old.unit.clone(),
            before: old.value,
            after: new.value,
            ci95: new.ci95,
            ci95_before: old.ci95,
            identifiable: new.identifiable,
            fixed: new.source == socam_identify::Source::Fixed,
            determined_with: new.determined_with.clone(),
        })
    });
    each.collect()
}

fn combinations(before: &Identification, after: &Identification) -> Vec<CombinationChange> {
    let each = after.combinations.iter().map(|new| CombinationChange {
        name: new.name.clone(),
        expression: new.expression.clone(),
        unit: new.unit.clone(),
        before: before.combinations.iter().find(|old| old.name == new.name).and_then(|old| old.value),
        after: new.value,
        ci95: new.ci95,
    });
    each.collect()
}

/// By effect and place, at the point of its grid where it shows best.
fn not_found(path: &Path) -> Vec<NotFound> {
    let mut all: Vec<NotFound> = Vec::new();
    for one in path.tests.iter().filter(|one| !path.has(&one.start)) {
        let candidate = &one.start;
        let Some(parameter) = candidate.strength.first() else { continue };
        let size = one.promise.resolution * SEEN.sqrt();
        // What limits is stronger the lower it is; what was looked for and not found is known to be absent up to there.
        let is_stronger_below = candidate.nothing().is_infinite();
        let size = candidate.size_of(size);
        let smallest = Some(size).filter(|size| size.is_finite());
        let known = all
            .iter_mut()
            .find(|known| known.effect == candidate.effect.id && known.location == candidate.place);
        match known {
            Some(known) => {
                let better = |a: f64, b: f64| if is_stronger_below { a.max(b) } else { a.min(b) };
                known.smallest_detectable = match (known.smallest_detectable, smallest) {
                    (Some(a), Some(b)) => Some(better(a, b)),
                    (a, b) => a.or(b),
                };
            }
            None => all.push(NotFound {
                effect: candidate.effect.id.into(),
                location: candidate.place.clone(),
                parameter: (*parameter).into(),
                smallest_detectable: smallest,
                unit: unit(&path.last.model, candidate, parameter),
            }),
        }
    }
    all.sort_by(|a, b| (&a.effect, &a.location).cmp(&(&b.effect, &b.location)));
    all
}

fn unit(model: &Model, candidate: &Candidate, parameter: &str) -> String {
    let own = candidate.effect.parameters.iter().find(|own| own.name == parameter);
    own.map_or("", |own| model.unit_at(own.kind, &candidate.place)).into()
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
