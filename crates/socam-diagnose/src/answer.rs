//! The document, from the way that led to it.

use socam_identify::{Identification, IdentifyError, compare::Measured};
use socam_model::Model;

use crate::{
    Diagnosis,
    bench::{Bench, Fitted},
    candidates::Candidate,
    course::{self, Course, Step},
    document::{
        ChannelFit, CombinationChange, Component, EffectParameter, Finding, Fit, NotFound, ParameterChange,
        Proof, RecordingUse, Region, Rival, SCHEMA, SuggestedExperiment, UNEXPLAINED, Validation, Verdict,
    },
    experiment, region,
    shapes::Unexplained,
    words,
};

/// Fall of the sum of squares at which an effect would have been seen.
const SEEN: f64 = 25.0;
/// Weight of a rival that is worth naming, and of one that is worth another recording.
const LEAST_WEIGHT: f64 = 1e-2;
const OPEN: f64 = 0.05;
/// Residuals of recordings that were not fitted, in noise floors, from which on a model does not explain them whatever tests say.
/// Where nothing is missing it is 0.9 to 1.1.
const CONTRADICTION: f64 = 2.0;
/// Mean square of the same, whitened and in units of noise, from which on a model is not called adequate. Where nothing is missing, a
/// noisy input and coarse converters leave up to 1.09.
pub(crate) const INADEQUATE: f64 = 1.2;

/// `floor` is the noise floor of each output, SI.
pub(crate) fn document(
    bench: &Bench<'_>,
    course: &Course,
    before: &Identification,
    after: &Identification,
    floor: &[f64],
    cpu_s: f64,
) -> Result<Diagnosis, IdentifyError> {
    let mut findings: Vec<Finding> =
        (0..course.steps.len()).map(|index| finding(bench, course, index, after)).collect();
    let mut warnings = after.warnings.clone();
    for ((finding, step), (gain, held_percent)) in
        findings.iter_mut().zip(&course.steps).zip(course.gains(bench)?)
    {
        finding.evidence.chi2_gain = Some(gain);
        finding.evidence.holdout_gain_percent = match step.proof {
            course::Proof::HeldOut => Some(held_percent),
            course::Proof::InTurn(percent) => {
                warnings.push(format!(
                    "no held-out recording shows `{}` at {}: it was proven on training recordings, each left out in turn",
                    finding.effect, finding.location
                ));
                Some(percent)
            }
        };
    }
    for (finding, (before, after)) in findings.iter_mut().zip(course.pairs()) {
        let own = region::region(bench, before, Some(after), &finding.location, floor)?;
        finding.region = Region { text: format!("{}; {}", finding.region.text, own.text), ..own };
    }
    if let Some(found) = &course.unexplained {
        let mut without_name = unexplained(course, found);
        let own = region::region(bench, &course.last, None, &found.place, floor)?;
        without_name.region = Region { text: format!("{}; {}", without_name.region.text, own.text), ..own };
        findings.push(without_name);
    }
    if findings.is_empty() {
        findings.extend(contradiction(course, floor));
    }
    findings.sort_by(|a, b| gain(b).total_cmp(&gain(a)));
    let findings = merged(findings);
    let verdict = if !course.steps.is_empty() {
        Verdict::MissingPhysics
    } else if !findings.is_empty() {
        Verdict::Unexplained
    } else {
        Verdict::Adequate
    };
    if bench.folds.kind == Validation::Blocks {
        warnings.push(
            "only one recording: it was held out part by part, which proves less than another recording would".into(),
        );
    }
    let left = course.last.scale();
    if course.steps.len() == bench.options.most_effects && left > course::MISFIT {
        warnings.push(format!(
            "stopped after {} effects: what was not fitted is still missed by {left:.2} times the power of noise; allow more of them",
            course.steps.len()
        ));
    }
    Ok(Diagnosis {
        schema: SCHEMA.into(),
        verdict,
        false_alarm_rate: bench.options.false_alarm_rate,
        validation: bench.folds.kind,
        suggested_experiment: suggestion(&findings),
        findings,
        fit: fit(course, floor),
        parameters: parameters(before, after),
        combinations: combinations(before, after),
        not_found: not_found(course),
        cpu_s,
        warnings,
        model: course.base.model.name.clone(),
        recordings: recordings(bench),
        version: env!("CARGO_PKG_VERSION").into(),
    })
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

fn recordings(bench: &Bench<'_>) -> Vec<RecordingUse> {
    let held_out = bench.folds.folds.iter().filter(|_| bench.folds.kind == Validation::Holdout);
    let held_out = held_out.flat_map(|fold| &fold.held_out).map(|data| (data, true));
    let all = bench.training.iter().map(|data| (data, false)).chain(held_out);
    all.map(|(data, held_out)| RecordingUse {
        name: data.name().to_owned(),
        held_out,
        samples: data.rows(),
        duration_s: data.end_s() - data.start_s(),
    })
    .collect()
}

fn finding(bench: &Bench<'_>, course: &Course, index: usize, after: &Identification) -> Finding {
    let step = &course.steps[index];
    let parameters = effect_parameters(course, index, after);
    let place = &step.candidate.place;
    Finding {
        effect: step.candidate.effect.id.into(),
        location: place.clone(),
        sentence: words::sentence(step.candidate.effect, place, &parameters),
        equation: step.candidate.effect.equation.into(),
        parameters,
        components: Vec::new(),
        curve: None,
        region: Region { text: step.candidate.effect.shows.into(), ..Region::default() },
        evidence: Proof { p_value: Some(step.p_value), ..Proof::default() },
        rivals: rivals(course, step, &course.alike(bench, index)),
    }
}

/// What has a place and a shape but no name.
fn unexplained(course: &Course, found: &Unexplained) -> Finding {
    let is_channel = course.last.model.channels.iter().any(|channel| channel.name == found.place);
    Finding {
        effect: UNEXPLAINED.into(),
        location: found.place.clone(),
        sentence: words::unexplained(found, is_channel),
        equation: String::new(),
        parameters: Vec::new(),
        components: Vec::new(),
        curve: Some(found.curve.clone()),
        region: Region { text: words::region_of_curve(&found.curve), ..Region::default() },
        evidence: Proof {
            p_value: Some(found.p_value),
            chi2_gain: Some(found.gain),
            holdout_gain_percent: Some(found.held_gain_percent),
            misfit_percent: Some(found.misfit_percent),
        },
        rivals: Vec::new(),
    }
}

/// What is left above noise although nothing that was tried holds on recordings that were not fitted: no model explains it. Held-out
/// recordings may not show it at all.
fn contradiction(course: &Course, floor: &[f64]) -> Option<Finding> {
    let last = &course.last;
    let fitted = std::slice::from_ref(&last.at);
    of_no_model(course, floor, (&last.held, "not fitted", last.scale()))
        .or_else(|| of_no_model(course, floor, (fitted, "fitted", last.training_scale())))
}

/// The same of recordings that were fitted or not, which leave so many times the power of noise.
fn of_no_model(
    course: &Course,
    floor: &[f64],
    (measured, which, left): (&[Measured], &str, f64),
) -> Option<Finding> {
    let each = course.last.model.outputs().zip(floor).enumerate().filter_map(|(output, (channel, floor))| {
        let missed = rms(measured, output)?;
        Some((channel, missed, missed / floor)).filter(|(.., times)| times.is_finite())
    });
    let (channel, missed, times) = each.max_by(|a, b| a.2.total_cmp(&b.2))?;
    let is_far = times > CONTRADICTION;
    if !is_far && left < INADEQUATE {
        return None;
    }
    let why = if is_far {
        "these recordings contradict one another, or one of them is not of this bench"
    } else {
        "something small is missing that has neither a name nor a place here"
    };
    let (missed, unit, name) = (words::short(missed), channel.unit, &channel.name);
    Some(Finding {
        effect: UNEXPLAINED.into(),
        location: channel.name.clone(),
        parameters: Vec::new(),
        components: Vec::new(),
        curve: None,
        region: Region { text: format!("on recordings that were {which}"), ..Region::default() },
        evidence: Proof::default(),
        rivals: Vec::new(),
        sentence: format!(
            "What was {which} is missed by {missed} {unit} in {name}, {times:.1} times its noise floor (all channels: {left:.1} times \
             the power of noise), and nothing that was tried helps there: {why}"
        ),
        equation: String::new(),
    })
}

/// Those that a file gives; a phase within a turn.
fn effect_parameters(course: &Course, step: usize, after: &Identification) -> Vec<EffectParameter> {
    course
        .parameters(step)
        .filter(|(_, index)| !course.last.model.parameters[*index].fixed)
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

/// Weights as of a likelihood, the finding's own being one before they are made to sum to one. What was found beside it is none.
fn rivals(course: &Course, step: &Step, alike: &[Candidate]) -> Vec<Rival> {
    let weight = |worse: f64| (-0.5 * worse).exp().min(1.0);
    let is_alike = |rival: &Candidate| alike.iter().any(|twin| twin.is_same(rival));
    let others = step.rivals.iter().filter(|(rival, _)| !is_alike(rival));
    let all = alike.iter().map(|twin| (twin, 0.0)).chain(others.map(|(rival, worse)| (rival, *worse)));
    let all: Vec<(&Candidate, f64)> = all.filter(|(rival, _)| !course.has(rival)).collect();
    let total: f64 = 1.0 + all.iter().map(|(_, worse)| weight(*worse)).sum::<f64>();
    let named = all.iter().map(|(candidate, worse)| Rival {
        effect: candidate.effect.id.into(),
        location: candidate.place.clone(),
        weight: weight(*worse) / total,
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

/// Root mean square over several measurements, output by output.
fn rms(all: &[Measured], output: usize) -> Option<f64> {
    let values = all.iter().map(|measured| {
        let count = measured.read[output];
        (count, measured.rms[output].powi(2) * count)
    });
    let (count, sum) = values.fold((0.0, 0.0), |(n, s), (count, sum)| (n + count, s + sum));
    (count > 0.0).then(|| (sum / count).sqrt())
}

fn fit(course: &Course, floor: &[f64]) -> Fit {
    let last = course.corrected().unwrap_or(&course.base);
    let outputs = course.base.model.outputs().enumerate();
    let of = |fitted: &Fitted, output: usize| rms(std::slice::from_ref(&fitted.at), output);
    let channels = outputs.map(|(output, channel)| {
        let fit = ChannelFit {
            noise_std: Some(floor[output]),
            rms_before: of(&course.base, output),
            rms_after: of(last, output),
            holdout_rms_before: rms(&course.base.held, output),
            holdout_rms_after: rms(&last.held, output),
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
fn not_found(course: &Course) -> Vec<NotFound> {
    let scale = course.whole().scale();
    let mut all: Vec<NotFound> = Vec::new();
    for one in course.screened.iter().filter(|one| !course.has(&one.start)) {
        let candidate = &one.start;
        let Some(parameter) = candidate.strength.first() else { continue };
        let size = one.promise.resolution * (SEEN * scale).sqrt();
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
                unit: unit(&course.last.model, candidate, parameter),
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
            evidence: Proof { chi2_gain: Some(gain), holdout_gain_percent: Some(50.0), ..Proof::default() },
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
